//! Student's distribution at work: estimates of two images, their differences, p-values. The only file that names `statrs`.

use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use statrs::function::erf::erfc;

/// Relative variance of a number that was rounded to f32: uniform in a unit of the last place, at most 2^-23.
const ROUNDING: f64 = 1.0 / (12.0 * (1_u64 << 46) as f64);
/// Relative difference of two exact numbers that roundings make: some units in the last place.
const EQUAL: f64 = 1.0 / (1 << 22) as f64;
/// Beyond so many degrees of freedom Student's distribution is the normal one to far below any level that is tested at.
const NORMAL_FROM: f64 = 1e5;

/// A mean, the variance of that mean, and the degrees of freedom of the variance.
#[derive(Clone, Copy)]
pub(super) struct Estimate {
    pub mean: f64,
    pub variance: f64,
    /// Infinite for that of a normal distribution.
    pub freedom: f64,
}

/// What two estimates of a pixel and channel say.
pub(super) enum Outcome {
    /// Something is not finite.
    Unknown,
    /// Exact, and one value.
    Equal,
    /// Exact as far as the samples tell, and two values; with the p-value.
    Unequal(f64),
    /// Something to test.
    Noisy(Sums),
}

impl Estimate {
    fn is_known(&self) -> bool {
        self.mean.is_finite() && self.variance.is_finite() && self.variance >= 0.0
    }

    pub fn compare(&self, other: &Self) -> Outcome {
        if !self.is_known() || !other.is_known() {
            return Outcome::Unknown;
        }
        let (difference, variance) = (self.mean - other.mean, self.variance + other.variance);
        if variance == 0.0 {
            let equal = difference.abs() <= EQUAL * self.mean.abs().max(other.mean.abs());
            return if equal { Outcome::Equal } else { Outcome::Unequal(self.chance_of_two_values(other)) };
        }
        let rounding = ROUNDING * (self.mean * self.mean + other.mean * other.mean);
        let spread = |e: &Self| e.variance * e.variance / e.freedom;
        Outcome::Noisy(Sums { pixels: 1, difference, variance, rounding, spread: spread(self) + spread(other) })
    }

    /// Chance that a samples of a pixel with two values all have one of them, and b all have the other: twice
    /// p^a (1 - p)^b, at most 2 a^a b^b / (a + b)^(a + b). Few samples along an edge do that.
    fn chance_of_two_values(&self, other: &Self) -> f64 {
        let (a, b) = (self.freedom + 1.0, other.freedom + 1.0);
        if a.is_finite() && b.is_finite() { 2.0 * (a * (a / (a + b)).ln() + b * (b / (a + b)).ln()).exp() } else { 0.0 }
    }
}

/// Sums over pixels that are independent of each other.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums {
    pub pixels: usize,
    difference: f64,
    variance: f64,
    rounding: f64,
    /// Of variance^2 over its degrees of freedom: how uncertain the variance is (Satterthwaite).
    spread: f64,
}

impl Sums {
    pub fn merge(&mut self, other: &Self) {
        self.pixels += other.pixels;
        self.difference += other.difference;
        self.variance += other.variance;
        self.rounding += other.rounding;
        self.spread += other.spread;
    }

    /// The p-value of there being no difference.
    pub fn chance(&self) -> f64 {
        two_sided(self.difference, self.variance + self.rounding, self.variance * self.variance / self.spread)
    }
}

/// Two-sided p-value of a difference that is 0 in the mean and has an estimated variance.
fn two_sided(difference: f64, variance: f64, freedom: f64) -> f64 {
    let t = difference / variance.sqrt();
    match StudentsT::new(0.0, 1.0, freedom) {
        Ok(student) if freedom < NORMAL_FROM && t.is_finite() => 2.0 * student.cdf(-t.abs()),
        _ => erfc(t.abs() / std::f64::consts::SQRT_2),
    }
}

/// p-value of counts in equal bins being those of a uniform distribution (Pearson 1900).
pub(super) fn chi_squared(histogram: &[usize]) -> Option<f64> {
    let expected = histogram.iter().sum::<usize>() as f64 / histogram.len() as f64;
    let chi2: f64 = histogram.iter().map(|&count| (count as f64 - expected).powi(2) / expected).sum();
    ChiSquared::new(histogram.len() as f64 - 1.0).ok().map(|distribution| distribution.sf(chi2))
}
