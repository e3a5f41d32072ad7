//! Statistics: estimates with their variance, t-tests, the correction for many of them.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};
use statrs::function::erf::erfc;
use wavetrace::film::{Film, Pixel};

/// Chance that a suite fails though nothing is wrong.
pub const ALPHA: f64 = 1e-3;
/// Relative error that f32 arithmetic may leave in a mean, as a standard deviation: a path's radiance takes some tens of
/// roundings of 2^-24.
pub const ROUNDING: f64 = 1.0 / (1 << 20) as f64;

/// Chance for each of `n` tests, so that the chance of any to fail is `alpha` (Sidak 1967).
pub fn sidak(alpha: f64, n: usize) -> f64 {
    -f64::exp_m1(f64::ln_1p(-alpha) / n.max(1) as f64)
}

/// A mean, the variance of that mean, and the degrees of freedom of the variance.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub mean: f64,
    pub variance: f64,
    pub freedom: f64,
}

impl Estimate {
    /// Of channel `k` of a pixel with independent samples.
    pub fn of_pixel(p: &Pixel, k: usize) -> Self {
        Self { mean: p.mean()[k], variance: p.variance_of_mean()[k], freedom: p.count as f64 - 1.0 }
    }
    /// Of the mean of independent estimates (Welch 1947, Satterthwaite 1946).
    pub fn average(parts: impl IntoIterator<Item = Self>) -> Self {
        let (mut n, mut mean, mut variance, mut spread) = (0.0, 0.0, 0.0, 0.0);
        for e in parts {
            n += 1.0;
            mean += e.mean;
            variance += e.variance;
            spread += e.variance * e.variance / e.freedom;
        }
        let freedom = if spread > 0.0 { variance * variance / spread } else { f64::INFINITY };
        Self { mean: mean / n, variance: variance / (n * n), freedom }
    }
    /// Of channel `k` of an image's mean, from independent samples.
    pub fn of_film(film: &Film, k: usize) -> Self {
        Self::average((0..film.pixels().len()).map(|i| Self::of(film, i, k)))
    }
    /// Of channel `k` of pixel number `i`, with what light paths bring.
    pub fn of(film: &Film, i: usize, k: usize) -> Self {
        let freedom = film.pixels()[i].count as f64 - 1.0;
        Self { mean: film.mean(i)[k], variance: film.variance(i)[k], freedom }
    }
    /// From replicates: whole results with seeds of their own.
    pub fn of_replicates(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let spread = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        Self { mean, variance: spread / (n - 1.0) / n, freedom: n - 1.0 }
    }
    /// The same, scaled.
    pub fn scaled(self, by: f64) -> Self {
        Self { mean: self.mean * by, variance: self.variance * by * by, ..self }
    }
    /// Standard error over mean.
    pub fn relative_error(&self) -> f64 {
        self.variance.sqrt() / self.mean
    }
    /// Two-sided p-value of being equal to `value` in the mean.
    pub fn p_exact(&self, value: f64) -> f64 {
        self.p_equal(&Self { mean: value, variance: 0.0, freedom: f64::INFINITY })
    }
    /// Two-sided p-value of having equal means: Welch's t-test.
    pub fn p_equal(&self, other: &Self) -> f64 {
        let floor = (ROUNDING * self.mean.abs().max(other.mean.abs())).powi(2);
        let variance = self.variance + other.variance;
        if variance + floor == 0.0 {
            return if self.mean == other.mean { 1.0 } else { 0.0 };
        }
        let share = |e: &Self| if e.variance > 0.0 { e.variance * e.variance / e.freedom } else { 0.0 };
        let shares = share(self) + share(other);
        let freedom = if shares > 0.0 { variance * variance / shares } else { f64::INFINITY };
        two_sided((self.mean - other.mean) / (variance + floor).sqrt(), freedom)
    }
}

/// Two-sided p-value of Student's t.
pub fn two_sided(t: f64, freedom: f64) -> f64 {
    if !t.is_finite() {
        return 0.0;
    }
    // Beyond that many degrees the two distributions agree to far below any level that is tested at.
    if freedom > 1e5 {
        return erfc(t.abs() / std::f64::consts::SQRT_2);
    }
    2.0 * StudentsT::new(0.0, 1.0, freedom.max(1.0)).unwrap().cdf(-t.abs())
}

/// Quantile of the normal distribution.
pub fn quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}

/// Relative bias that a test at level `level` finds with probability 0.99, given the relative standard error of what it
/// tests.
pub fn detectable(relative_error: f64, level: f64) -> f64 {
    relative_error * (quantile(1.0 - level / 2.0) + quantile(0.99))
}

/// p-value of p-values being uniform: chi-squared over equal bins of at least ten expected.
pub fn uniformity(p: &[f64]) -> f64 {
    let bins = (p.len() / 10).clamp(2, 20);
    let mut counts = vec![0.0; bins];
    p.iter().for_each(|p| counts[((p * bins as f64) as usize).min(bins - 1)] += 1.0);
    let expected = p.len() as f64 / bins as f64;
    let chi2 = counts.iter().map(|c: &f64| (c - expected).powi(2) / expected).sum::<f64>();
    1.0 - ChiSquared::new(bins as f64 - 1.0).unwrap().cdf(chi2)
}

/// The tests of a family, judged together.
pub struct Family {
    alpha: f64,
    results: Vec<(f64, String)>,
}

impl Family {
    /// One of `families` in a suite that fails by chance with [`ALPHA`].
    pub fn one_of(families: usize) -> Self {
        Self { alpha: sidak(ALPHA, families), results: Vec::new() }
    }
    /// Takes a p-value down.
    pub fn add(&mut self, p: f64, name: impl Into<String>) {
        self.results.push((if p.is_nan() { 0.0 } else { p }, name.into()));
    }
    /// How many tests there are.
    pub fn count(&self) -> usize {
        self.results.len()
    }
    /// Level of each test, given how many there are.
    pub fn level(&self) -> f64 {
        sidak(self.alpha, self.results.len())
    }
    /// What is rejected.
    pub fn rejected(&self) -> Vec<String> {
        let level = self.level();
        self.results.iter().filter(|r| r.0 < level).map(|(p, name)| format!("{name}: p = {p:.2e}")).collect()
    }
    /// Fails if anything is rejected.
    pub fn judge(mut self) {
        let rejected = self.rejected();
        self.results.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (level, n) = (self.level(), self.results.len());
        assert!(n > 0, "no tests");
        println!("{n} tests at {level:.1e}; smallest p = {:.1e} ({})", self.results[0].0, self.results[0].1);
        assert!(
            rejected.is_empty(),
            "{} of {n} tests rejected at {level:.1e}:\n{}",
            rejected.len(),
            rejected.join("\n")
        );
    }
}
