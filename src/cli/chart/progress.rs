//! How far a sweep is, and how long the rest takes.

use crate::cli::messages::{Console, plain};
use crate::cli::units::rough_time;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use wavetrace::chart::Forecast;
use wavetrace::render::Control;

/// Time between two looks.
const TICK: Duration = Duration::from_millis(100);
/// Plain lines are this far apart at least.
const LINE_TIME: Duration = Duration::from_secs(5);
const STOPPING: &str = "interrupted: writing what was measured so far; once more ends at once";

/// What the sweep does just now; the thread that shows it looks at it.
#[derive(Debug, Default)]
pub struct Meter(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    forecast: Forecast,
    /// Samples of all that was planned, and of what is done.
    total: u64,
    done: u64,
    doing: String,
    /// Kind, samples, and when it began.
    current: Option<(usize, u64, Instant)>,
    /// Samples that the control had counted by then.
    before: u64,
}

impl Meter {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
    /// Plans work: samples of a kind.
    pub fn plan(&self, kind: usize, samples: u64) {
        let mut state = self.state();
        state.forecast.add(kind, samples);
        state.total += samples;
    }
    /// A kind was timed before anything was planned.
    pub fn timed(&self, kind: usize, samples: u64, time: Duration) {
        self.state().forecast.timed(kind, samples, time);
    }
    /// Planned work begins.
    pub fn begin(&self, doing: String, kind: usize, samples: u64, control: &Control) {
        let mut state = self.state();
        state.doing = doing;
        state.current = Some((kind, samples, Instant::now()));
        state.before = control.samples();
    }
    /// It is done.
    pub fn end(&self) {
        let mut state = self.state();
        if let Some((kind, samples, start)) = state.current.take() {
            state.forecast.done(kind, samples, start.elapsed());
            state.done += samples;
        }
    }

    /// Shows all this until the other end of `done` is dropped.
    pub fn watch(&self, control: &Control, done: &Receiver<()>) {
        let bar = ProgressBar::new(100);
        if let Ok(style) = ProgressStyle::with_template("{percent:>3} % [{bar:28}] {wide_msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        let (mut last, mut told) = (Instant::now(), false);
        while done.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            let tell = control.is_stopped() && !told;
            told |= tell;
            let (percent, text) = self.state().shown(control.samples());
            // No terminal, or one that cannot move its cursor.
            if bar.is_hidden() {
                if tell {
                    plain(STOPPING);
                } else if last.elapsed() >= LINE_TIME {
                    plain(format_args!("{percent:>3} %  {text}"));
                    last = Instant::now();
                }
            } else {
                if tell {
                    bar.println(STOPPING);
                }
                bar.set_position(percent);
                bar.set_message(text);
            }
        }
        bar.finish_and_clear();
        // What was under way may have ended sooner than the next look.
        if control.is_stopped() && !told {
            plain(STOPPING);
        }
    }
}

impl State {
    /// Per cent of the samples, and what there is to say.
    fn shown(&self, samples: u64) -> (u64, String) {
        let (mut done, mut running) = (self.done, Duration::ZERO);
        if let Some((_, planned, start)) = self.current {
            done += samples.saturating_sub(self.before).min(planned);
            running = start.elapsed();
        }
        let percent = (u128::from(done) * 100 / u128::from(self.total.max(1))) as u64;
        let left = self.forecast.left().map(|left| left.saturating_sub(running));
        // First, because a narrow terminal cuts what stands behind.
        let left = left.map_or_else(String::new, |left| format!("{} left; ", rough_time(left)));
        (percent, format!("{left}{}", self.doing))
    }
}

/// Does `work` while another thread shows how far it is.
pub fn during<T>(meter: &Meter, control: &Control, console: &Console, work: impl FnOnce() -> T) -> T {
    std::thread::scope(|scope| {
        // Dropped at the end of this block, which is what the other thread waits for.
        let (_working, done) = std::sync::mpsc::channel();
        if !console.is_quiet() {
            scope.spawn(move || meter.watch(control, &done));
        }
        work()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_under_way_counts_in_part() {
        let (meter, control) = (Meter::default(), Control::default());
        assert_eq!(meter.state().shown(0), (0, String::new()));
        meter.plan(0, 300);
        meter.plan(1, 100);
        meter.begin("one".to_owned(), 0, 300, &control);
        assert_eq!(meter.state().shown(150), (37, "one".to_owned()));
        assert_eq!(meter.state().shown(1000).0, 75);
        meter.end();
        meter.timed(1, 1, Duration::from_secs(60));
        meter.begin("two".to_owned(), 1, 100, &control);
        let (percent, text) = meter.state().shown(50);
        assert_eq!(percent, 87);
        assert!(text.ends_with("min left; two"), "{text}");
        meter.end();
        assert_eq!(meter.state().shown(100).0, 100);
    }
}
