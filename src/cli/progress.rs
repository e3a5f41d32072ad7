//! How far the render is: a bar on a terminal, else a line now and then. The only file that names `indicatif`.

use super::messages::plain;
use super::units::{rate, rough_time, si};
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};
use wavetrace::render::Control;

/// Time between two looks at the counters.
const TICK: Duration = Duration::from_millis(100);
/// Plain lines are this far apart at least, in time and in per cent.
const LINE_TIME: Duration = Duration::from_secs(2);
const LINE_STEP: u64 = 10;
const STOPPING: &str = "interrupted: writing the image once the jobs under way are done; once more ends at once";

/// Shows progress until the other end of `done` is dropped; `total` is the number of samples, at least 1.
pub fn watch(control: &Control, total: u64, done: &Receiver<()>) {
    let bar = ProgressBar::new(total);
    if let Ok(style) = ProgressStyle::with_template("{percent:>3} % [{bar:28}] {wide_msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    let start = Instant::now();
    let (mut last_line, mut last_step, mut told) = (start, 0, false);
    while done.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
        let state = State { samples: control.samples().min(total), rays: control.rays(), total, time: start.elapsed() };
        let tell = control.is_stopped() && !told;
        told |= tell;
        // No terminal, or one that cannot move its cursor.
        if bar.is_hidden() {
            if tell {
                plain(STOPPING);
            }
            let step = state.percent() / LINE_STEP;
            if step > last_step && last_line.elapsed() >= LINE_TIME {
                plain(format_args!("{:>3} %  {}", state.percent(), state.text()));
                (last_line, last_step) = (Instant::now(), step);
            }
        } else {
            if tell {
                bar.println(STOPPING);
            }
            bar.set_position(state.samples);
            bar.set_message(state.text());
        }
    }
    bar.finish_and_clear();
}

struct State {
    samples: u64,
    rays: u64,
    total: u64,
    time: Duration,
}

impl State {
    fn percent(&self) -> u64 {
        (u128::from(self.samples) * 100 / u128::from(self.total.max(1))) as u64
    }
    fn text(&self) -> String {
        let (samples, rays) = (rate(self.samples, self.time), rate(self.rays, self.time));
        if self.samples == 0 {
            return "starting".to_owned();
        }
        let left = Duration::try_from_secs_f64((self.total - self.samples) as f64 / samples).unwrap_or(Duration::MAX);
        format!("{}samples/s, {}rays/s, {} left", si(samples), si(rays), rough_time(left))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_extrapolates_what_was_done_so_far() {
        let state = |samples| State { samples, rays: samples, total: u64::MAX / 4, time: Duration::from_secs(2) };
        assert_eq!((state(0).percent(), state(0).text()), (0, "starting".to_owned()));
        let quarter = State { samples: 1_000_000, rays: 6_200_000, total: 4_000_000, time: Duration::from_secs(2) };
        assert_eq!(quarter.percent(), 25);
        assert_eq!(quarter.text(), "500 ksamples/s, 3.10 Mrays/s, 6 s left");
        // No overflow, however much was asked for.
        assert_eq!(state(u64::MAX / 4).percent(), 100);
        assert!(state(1).text().ends_with("min left"), "{}", state(1).text());
    }
}
