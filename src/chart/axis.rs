//! A logarithmic axis: its range, its ticks, and where a value is on it.

use super::number::tick;

/// Decades that an axis holds at least, so that a flat curve is no mountain.
const LEAST: f64 = 0.6;
/// Room at both ends, as a share of the range.
const ROOM: f64 = 0.05;
/// Most decades whose ticks are all labelled.
const MOST_LABELS: i32 = 9;

/// From values above 0 to places in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    low: f64,
    high: f64,
    start: f64,
    end: f64,
}

/// A line across the chart, with a label where there is room for one.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Where it is, in pixels.
    pub at: f64,
    /// What it stands for.
    pub label: Option<String>,
    /// Whether it is a power of ten.
    pub decade: bool,
}

impl Axis {
    /// An axis for `values`, of which those that are not above 0 and finite do not count, from pixel `start` to pixel
    /// `end`. `None` where no value is left.
    pub fn new(values: impl IntoIterator<Item = f64>, start: f64, end: f64) -> Option<Self> {
        let logs = values.into_iter().filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if low > high {
            return None;
        }
        let widen = ((LEAST - (high - low)) / 2.0).max(ROOM * (high - low));
        Some(Self { low: low - widen, high: high + widen, start, end })
    }

    /// Where a value is. What is not above 0, or beyond the range, is at the end that is next to it.
    pub fn place(&self, value: f64) -> f64 {
        let log = if value > 0.0 { value.log10() } else { f64::NEG_INFINITY };
        let share = (log.clamp(self.low, self.high) - self.low) / (self.high - self.low);
        self.start + share * (self.end - self.start)
    }

    /// The smallest and the largest value.
    pub fn range(&self) -> (f64, f64) {
        (10f64.powf(self.low), 10f64.powf(self.high))
    }

    /// Ticks at powers of ten and at their multiples. Powers of ten have labels; in a range of less than two of them,
    /// 2 and 5 have labels too.
    pub fn ticks(&self) -> Vec<Tick> {
        let (first, last) = (self.low.floor() as i32, self.high.floor() as i32);
        let inside = |log: f64| (self.low..=self.high).contains(&log);
        let decades = (first..=last).filter(|&power| inside(f64::from(power))).count() as i32;
        let plain = first >= -3 && last <= 5;
        let step = (decades + MOST_LABELS - 1) / MOST_LABELS;
        let mut ticks = Vec::new();
        for power in first..=last {
            for digit in 1..10u32 {
                let log = f64::from(power) + f64::from(digit).log10();
                let labelled = match digit {
                    1 => power.rem_euclid(step.max(1)) == 0,
                    2 | 5 => decades <= 2,
                    _ => false,
                };
                // Beyond some decades, lines between powers of ten are a grey wall.
                if inside(log) && (digit == 1 || decades <= MOST_LABELS) {
                    let at = self.place(10f64.powf(log));
                    ticks.push(Tick { at, label: labelled.then(|| tick(digit, power, plain)), decade: digit == 1 });
                }
            }
        }
        ticks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn values_are_placed_by_their_logarithms() {
        let axis = Axis::new([0.01, 100.0, 1.0, f64::NAN, 0.0, -3.0, f64::INFINITY], 0.0, 440.0).unwrap();
        for (value, place) in [(0.01, 20.0), (1.0, 220.0), (100.0, 420.0), (1e9, 440.0), (0.0, 0.0), (-1.0, 0.0)] {
            assert!((axis.place(value) - place).abs() < 1e-9, "{value} at {}", axis.place(value));
        }
        let upwards = Axis::new([0.01, 100.0], 440.0, 0.0).unwrap();
        assert!((upwards.place(0.01) - 420.0).abs() < 1e-9);
        assert_eq!(Axis::new([0.0, -1.0, f64::NAN], 0.0, 1.0), None);
        assert_eq!(Axis::new([], 0.0, 1.0), None);
    }

    #[test]
    fn ticks_have_labels_where_they_are_needed() {
        assert_eq!(labels(&Axis::new([0.02, 30.0], 0.0, 1.0).unwrap()), ["0.1", "1", "10"]);
        assert_eq!(labels(&Axis::new([1.0, 64.0], 0.0, 1.0).unwrap()), ["1", "2", "5", "10", "20", "50"]);
        assert_eq!(labels(&Axis::new([3e-6, 4e-6], 0.0, 1.0).unwrap()), ["2·10⁻⁶", "5·10⁻⁶"]);
        // One value alone has an axis about it.
        let one = Axis::new([7.0], 0.0, 1.0).unwrap();
        assert!(one.place(7.0) > 0.4 && one.place(7.0) < 0.6 && !labels(&one).is_empty(), "{:?}", labels(&one));
        // No range is too wide.
        let wide = Axis::new([f64::MIN_POSITIVE, f64::MAX], 0.0, 1.0).unwrap();
        let ticks = wide.ticks();
        assert!(ticks.len() < 700 && labels(&wide).len() <= MOST_LABELS as usize + 1, "{}", ticks.len());
        assert!(ticks.iter().all(|tick| (0.0..=1.0).contains(&tick.at)));
    }
}
