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
/// Steps of the bar.
const WHOLE: u64 = 1000;
const STOPPING: &str = "interrupted: writing the image once the jobs under way are done; once more ends at once";

/// When a render ends: at the first of these.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Samples over all pixels, at least 1.
    pub samples: u64,
    /// Time spent.
    pub time: Duration,
    /// Estimated relMSE.
    pub error: Option<f64>,
}

/// Shows the share of something that is done, on a terminal alone.
pub struct Meter(ProgressBar);

impl Meter {
    /// Shows nothing where the user wants it quiet.
    pub fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(WHOLE) };
        if let Ok(style) = ProgressStyle::with_template("{percent:>3} % [{bar:28}] {eta} left") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self(bar)
    }
    /// Shows a share, 0 to 1.
    pub fn show(&self, share: f64) {
        self.0.set_position((share * WHOLE as f64) as u64);
    }
}

impl Drop for Meter {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Shows progress until the other end of `done` is dropped.
pub fn watch(control: &Control, goal: Goal, done: &Receiver<()>) {
    let bar = ProgressBar::new(WHOLE);
    if let Ok(style) = ProgressStyle::with_template("{percent:>3} % [{bar:28}] {wide_msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    let start = Instant::now();
    let (mut last_line, mut last_step, mut told) = (start, 0, false);
    while done.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
        let state = State {
            goal,
            samples: control.samples().min(goal.samples),
            rays: control.rays(),
            error: control.error(),
            time: start.elapsed(),
        };
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
            bar.set_position((state.done() * WHOLE as f64) as u64);
            bar.set_message(state.text());
        }
    }
    bar.finish_and_clear();
}

struct State {
    goal: Goal,
    samples: u64,
    rays: u64,
    error: Option<f64>,
    time: Duration,
}

impl State {
    /// Share of the render that is done, 0 to 1. An error falls as samples rise.
    fn done(&self) -> f64 {
        let Goal { samples, time, error } = self.goal;
        let by_error = error.zip(self.error).map_or(0.0, |(goal, error)| goal / error);
        let by_time = if time == Duration::MAX { 0.0 } else { self.time.as_secs_f64() / time.as_secs_f64() };
        (self.samples as f64 / samples as f64).max(by_time).max(by_error).clamp(0.0, 1.0)
    }
    fn percent(&self) -> u64 {
        (self.done() * 100.0) as u64
    }
    fn text(&self) -> String {
        let (samples, rays) = (rate(self.samples, self.time), rate(self.rays, self.time));
        if self.samples == 0 {
            return "starting".to_owned();
        }
        let left = match self.done() {
            0.0 => Duration::MAX,
            done => Duration::try_from_secs_f64(self.time.as_secs_f64() * (1.0 / done - 1.0)).unwrap_or(Duration::MAX),
        };
        let error = self.error.map(|error| format!(", relMSE {error:.3e}")).unwrap_or_default();
        format!("{}samples/s, {}rays/s{error}, {} left", si(samples), si(rays), rough_time(left))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: Goal = Goal { samples: u64::MAX / 4, time: Duration::MAX, error: None };

    fn state(samples: u64) -> State {
        State { goal: SAMPLES, samples, rays: samples, error: None, time: Duration::from_secs(2) }
    }

    #[test]
    fn text_extrapolates_what_was_done_so_far() {
        assert_eq!((state(0).percent(), state(0).text()), (0, "starting".to_owned()));
        let quarter = State { goal: Goal { samples: 4_000_000, ..SAMPLES }, rays: 6_200_000, ..state(1_000_000) };
        assert_eq!(quarter.percent(), 25);
        assert_eq!(quarter.text(), "500 ksamples/s, 3.10 Mrays/s, 6 s left");
        // No overflow, however much was asked for.
        assert_eq!(state(u64::MAX / 4).percent(), 100);
        assert!(state(1).text().ends_with("min left"), "{}", state(1).text());
    }

    #[test]
    fn the_first_goal_counts() {
        let timed = State { goal: Goal { time: Duration::from_secs(8), ..SAMPLES }, ..state(1000) };
        assert_eq!((timed.percent(), timed.text()), (25, "500 samples/s, 500 rays/s, 6 s left".to_owned()));
        let goal = Goal { error: Some(0.01), ..timed.goal };
        assert_eq!(State { goal, ..state(1000) }.percent(), 25);
        let noisy = State { goal, error: Some(0.02), ..state(1000) };
        assert_eq!(
            (noisy.percent(), noisy.text()),
            (50, "500 samples/s, 500 rays/s, relMSE 2.000e-2, 2 s left".to_owned())
        );
    }
}
