//! Whether one series of a figure is faster than another, or only differs as the machine does.

use super::measure::{Figure, median};
use super::suite::YARDSTICKS;

/// What a comparison says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Slower by more than the tolerance, whatever noise may have done.
    Slower,
    /// Within the tolerance, whatever noise may have done.
    Same,
    /// Noise is larger than what is to be told.
    Unclear,
    /// Faster by more than the tolerance, whatever noise may have done.
    Faster,
}

impl Verdict {
    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slower => "slower",
            Self::Same => "same",
            Self::Unclear => "unclear",
            Self::Faster => "faster",
        }
    }
}

/// A figure of two series.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// What it is of.
    pub name: String,
    /// Speed over the speed before, by the medians: above 1 is faster, for rates and for times.
    pub ratio: f64,
    /// Where that may lie.
    pub interval: (f64, f64),
    /// What follows.
    pub verdict: Verdict,
}

/// Speeds: rates as they are, times by their reciprocal.
fn speeds(figure: &Figure) -> Vec<f64> {
    let speed = |&x: &f64| if figure.unit.is_rate() { x } else { 1.0 / x };
    figure.values.iter().map(speed).collect()
}

/// Speed of the machine itself over that before, from the yardsticks that both have: the least and the largest, and 1.
pub fn drift(before: &[Figure], after: &[Figure]) -> (f64, f64) {
    let of = |figures: &[Figure], name: &str| figures.iter().find(|f| f.name == name).map(Figure::median);
    let ratios = YARDSTICKS.iter().filter_map(|name| Some(of(after, name)? / of(before, name)?));
    ratios.filter(|x| x.is_finite() && *x > 0.0).fold((1.0, 1.0), |(a, b), x| (a.min(x), b.max(x)))
}

/// Compares a figure with the one of the same name before. `drift` widens the interval by what the machine itself changed;
/// `tolerance` is a share, 0.05 for 5 %.
///
/// The interval of the ratio is that from the slowest repeat over the fastest before to the fastest over the slowest. If
/// repeats are alike but for a factor, all orders of n repeats and n before are equally likely, and the factor lies outside
/// with probability 2 / C(2n, n): 0.06 % for seven, 0.8 % for five, whatever their distribution.
pub fn compare(before: &Figure, after: &Figure, drift: (f64, f64), tolerance: f64) -> Compared {
    let (old, new) = (speeds(before), speeds(after));
    let least = |v: &[f64]| v.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |v: &[f64]| v.iter().copied().fold(0.0, f64::max);
    let ratio = median(&new) / median(&old);
    let interval = (least(&new) / most(&old) / drift.1, most(&new) / least(&old) / drift.0);
    let (slow, fast) = (1.0 - tolerance, 1.0 / (1.0 - tolerance));
    let verdict = match interval {
        _ if !old.iter().chain(&new).all(|x| x.is_finite() && *x > 0.0) || old.is_empty() || new.is_empty() => {
            Verdict::Unclear
        }
        (_, hi) if hi < slow => Verdict::Slower,
        (lo, _) if lo > fast => Verdict::Faster,
        (lo, hi) if lo >= slow && hi <= fast => Verdict::Same,
        _ => Verdict::Unclear,
    };
    Compared { name: after.name.clone(), ratio, interval, verdict }
}

#[cfg(test)]
mod tests {
    use super::super::measure::Unit;
    use super::*;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    fn figure(name: &str, unit: Unit, values: &[f64]) -> Figure {
        Figure { name: name.to_owned(), unit, values: values.to_vec(), busy: None }
    }

    #[test]
    fn slower_is_told_from_noise_in_rates_and_times() {
        let old = [100.0, 101.0, 99.0];
        let verdict = |unit: Unit, new: &[f64], drift| {
            compare(&figure("a", unit, &old), &figure("a", unit, new), drift, 0.05).verdict
        };
        let still = (1.0, 1.0);
        assert_eq!(verdict(Unit::Mrays, &[90.0, 91.0, 92.0], still), Verdict::Slower);
        assert_eq!(verdict(Unit::Nanoseconds, &[90.0, 91.0, 92.0], still), Verdict::Faster);
        assert_eq!(verdict(Unit::Mrays, &[99.0, 101.0, 100.0], still), Verdict::Same);
        assert_eq!(verdict(Unit::Mrays, &[90.0, 91.0, 120.0], still), Verdict::Unclear);
        // All repeats are slower, though not surely by more than the tolerance.
        assert_eq!(verdict(Unit::Mrays, &[93.0, 95.0, 96.0], still), Verdict::Unclear);
        // The machine itself is slower by as much.
        assert_eq!(verdict(Unit::Mrays, &[90.0, 91.0, 92.0], (0.9, 1.0)), Verdict::Unclear);
        assert_eq!(verdict(Unit::Mrays, &[f64::NAN, 91.0, 92.0], still), Verdict::Unclear);
        assert_eq!(verdict(Unit::Mrays, &[], still), Verdict::Unclear);
        let twice =
            compare(&figure("a", Unit::Milliseconds, &[4.0]), &figure("a", Unit::Milliseconds, &[2.0]), still, 0.1);
        assert_eq!((twice.ratio, twice.interval), (2.0, (2.0, 2.0)));
    }

    #[test]
    fn drift_is_that_of_the_yardsticks() {
        let set = |a: f64, b: f64| {
            YARDSTICKS.iter().zip([a, b]).map(|(name, x)| figure(name, Unit::Gflops, &[x])).collect::<Vec<_>>()
        };
        assert_eq!(drift(&set(100.0, 10.0), &set(90.0, 11.0)), (0.9, 1.1));
        assert_eq!(drift(&set(100.0, 10.0), &set(120.0, 11.0)), (1.0, 1.2));
        assert_eq!(drift(&[], &set(1.0, 1.0)), (1.0, 1.0));
    }

    /// The interval misses the true ratio as seldom as it says, for a distribution with a long tail.
    #[test]
    fn the_interval_holds_the_ratio() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut time = || 1.0 - 0.1 * (((rng.next_u32() >> 8) as f64 + 0.5) / 16_777_216.0).ln();
        let (trials, mut missed) = (40_000, 0);
        for _ in 0..trials {
            let mut series = |factor: f64| figure("a", Unit::Milliseconds, &[(); 5].map(|()| factor * time()));
            let found = compare(&series(1.0), &series(0.8), (1.0, 1.0), 0.05);
            missed += u32::from(!(found.interval.0 <= 1.25 && 1.25 <= found.interval.1));
        }
        let expected = f64::from(trials) * 2.0 / 252.0;
        assert!(
            (f64::from(missed) - expected).abs() < 4.0 * expected.sqrt(),
            "{missed} of {trials}, {expected} expected"
        );
    }
}
