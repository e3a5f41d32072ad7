//! How long the rest takes, from how long its kind took so far.

use std::collections::BTreeMap;
use std::time::Duration;

/// Work of several kinds, each with a pace of its own.
#[derive(Clone, Debug, Default)]
pub struct Forecast {
    kinds: BTreeMap<usize, Kind>,
}

/// Samples to come, and those that were timed.
#[derive(Clone, Copy, Debug, Default)]
struct Kind {
    pending: f64,
    timed: f64,
    seconds: f64,
}

impl Forecast {
    /// Adds work to come: samples of a kind.
    pub fn add(&mut self, kind: usize, samples: u64) {
        self.kinds.entry(kind).or_default().pending += samples as f64;
    }
    /// Work that was to come is done.
    pub fn done(&mut self, kind: usize, samples: u64, time: Duration) {
        self.timed(kind, samples, time);
        let entry = self.kinds.entry(kind).or_default();
        entry.pending = (entry.pending - samples as f64).max(0.0);
    }
    /// Work was timed that did not count as work to come.
    pub fn timed(&mut self, kind: usize, samples: u64, time: Duration) {
        let entry = self.kinds.entry(kind).or_default();
        entry.timed += samples as f64;
        entry.seconds += time.as_secs_f64();
    }
    /// Time for all that is to come: each kind at its own pace, or at that of all together where it was not timed.
    /// `None` before anything was timed.
    pub fn left(&self) -> Option<Duration> {
        let sum = |of: fn(&Kind) -> f64| self.kinds.values().map(of).sum::<f64>();
        let (timed, seconds) = (sum(|kind| kind.timed), sum(|kind| kind.seconds));
        if timed <= 0.0 {
            return None;
        }
        let time = |kind: &Kind| {
            let (seconds, timed) = if kind.timed > 0.0 { (kind.seconds, kind.timed) } else { (seconds, timed) };
            kind.pending * seconds / timed
        };
        Some(Duration::try_from_secs_f64(self.kinds.values().map(time).sum()).unwrap_or(Duration::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn each_kind_goes_on_at_its_own_pace() {
        let mut forecast = Forecast::default();
        assert_eq!(forecast.left(), None);
        forecast.add(0, 30);
        forecast.add(1, 30);
        forecast.add(0, 10);
        assert_eq!(forecast.left(), None);
        forecast.done(0, 10, SECOND);
        assert_eq!(forecast.left(), Some(6 * SECOND), "the pace of kind 1 is not known yet");
        forecast.done(1, 10, 2 * SECOND);
        assert_eq!(forecast.left(), Some(3 * SECOND + 4 * SECOND));
        forecast.timed(2, 100, SECOND);
        assert_eq!(forecast.left(), Some(7 * SECOND));
        forecast.done(0, 1000, SECOND);
        forecast.done(1, 20, Duration::MAX);
        assert_eq!(forecast.left(), Some(Duration::ZERO));
    }
}
