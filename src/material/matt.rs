//! The mattness lobe between mirror and Lambert: a spherical Cauchy distribution (Kato and McCullagh 2020) on the
//! 3-sphere, seen through its projection to the disk of tangential components. Exactly reciprocal, exactly
//! energy-conserving, exactly importance-sampled.
//!
//! With rho = tan(pi (1 - m) / 4), r the mirror direction of `wo`, a and b the cosines of `wo` and `wi`:
//! `A - B = (1 - rho)^2 + rho |r - wi|^2`, `A + B = A - B + 4 rho a b`, and the density over the disk is
//! `K = (1/pi) (1 - rho^2)^3 (2 A^2 + B^2) / (2 (A^2 - B^2)^(5/2))`.

use super::{Evaluated, Lobe, Scattered};
use crate::lanes::{Lanes, Mask, Vec3, safe_sqrt};
use crate::sampling::warp;
use std::f32::consts::FRAC_1_PI;

/// Reflects into a lobe about the mirror direction, of any width.
#[derive(Clone, Copy, Debug, Default)]
pub struct Matt;

impl Matt {
    /// Mattness below which a lobe is a mirror. Half its directions are less than 90 degrees times this off the mirror's,
    /// 2.3e-8: f32 cannot tell them apart, and what a density says at a rounded direction is not that of the lobe.
    pub const NARROWEST: f32 = 1.0 / (1 << 26) as f32;
}

/// One material with mattness strictly between that of a mirror, [`Matt::NARROWEST`], and 1.
#[derive(Clone, Copy, Debug)]
pub struct MattRow {
    /// Share of light reflected, per channel, in [0, 1].
    pub color: [f32; 3],
    /// 1 - rho, kept apart because it is lost in rounding where rho is near 1.
    pub one_minus_rho: f32,
}

impl From<MattRow> for [f32; 4] {
    fn from(row: MattRow) -> Self {
        let [r, g, b] = row.color;
        [r, g, b, row.one_minus_rho]
    }
}

impl MattRow {
    /// The lobe of mattness `mattness` in (0, 1]; 1 is Lambert.
    pub fn new(color: [f32; 3], mattness: f32) -> Self {
        // 1 - tan(pi/4 - x) = 2 tan x / (1 + tan x), without cancellation for small mattness.
        let t = (f64::from(mattness) * std::f64::consts::FRAC_PI_4).tan();
        Self { color, one_minus_rho: (2.0 * t / (1.0 + t)) as f32 }
    }
}

/// The materials of a group of rows.
#[derive(Clone, Copy, Debug)]
pub struct MattParams<L: Lanes> {
    color: Vec3<L>,
    rho: L,
    one_minus_rho: L,
}

impl<L: Lanes> MattParams<L> {
    /// 1 - rho^2.
    #[inline(always)]
    fn complement(&self) -> L {
        self.one_minus_rho * (L::splat(1.0) + self.rho)
    }
    /// Density over the disk.
    #[inline(always)]
    fn k(&self, wo: Vec3<L>, wi: Vec3<L>) -> L {
        let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
        let b = L::splat(2.0) * self.rho * wo.z * wi.z;
        let a_minus_b = self.rho.mul_add((mirror - wi).length2(), self.one_minus_rho * self.one_minus_rho);
        let a_plus_b = b.mul_add(L::splat(2.0), a_minus_b);
        let a = a_minus_b + b;
        // Each factor (1 - rho^2) goes with a root of the product, so that neither leaves the range of a float.
        let q = a_minus_b * a_plus_b;
        let c = self.complement();
        let ratio = c / q.sqrt();
        let shape = (L::splat(2.0) * a * a).mul_add(L::splat(1.0), b * b) / q;
        L::splat(0.5 * FRAC_1_PI) * ratio * ratio * ratio * shape
    }
}

impl Lobe for Matt {
    const DELTA: bool = false;
    const TRANSMITS: bool = false;
    const NUMBERS: usize = 3;
    const NAME: &'static str = "matt";
    type Row = MattRow;
    type Params<L: Lanes> = MattParams<L>;

    #[inline(always)]
    fn params<L: Lanes>([r, g, b, one_minus_rho]: [L; 4]) -> MattParams<L> {
        MattParams { color: Vec3::new(r, g, b), rho: L::splat(1.0) - one_minus_rho, one_minus_rho }
    }
    #[inline(always)]
    fn sample<L: Lanes>(p: &MattParams<L>, wo: Vec3<L>, _outside: L::Mask, u: [L; 3]) -> Scattered<L> {
        let s = warp::sphere3(u);
        let (x, y) = (p.rho * -wo.x, p.rho * -wo.y);
        let v = [s[0] + x, s[1] + y, s[2] + p.rho * wo.z, s[3]];
        let length2 = v[0].mul_add(v[0], v[1].mul_add(v[1], v[2].mul_add(v[2], v[3] * v[3])));
        let scale = p.complement() / length2.max(L::splat(f32::MIN_POSITIVE));
        let (y1, y2) = (v[0].mul_add(scale, x), v[1].mul_add(scale, y));
        let y3 = v[2].mul_add(scale, p.rho * wo.z);
        let y4 = v[3] * scale;
        let cos = safe_sqrt(y3.mul_add(y3, y4 * y4));
        Scattered {
            wi: Vec3::new(y1, y2, cos).normalize(),
            weight: p.color,
            radiance_scale: L::splat(1.0),
            transmitted: L::Mask::splat(false),
        }
    }
    #[inline(always)]
    fn eval<L: Lanes>(p: &MattParams<L>, wo: Vec3<L>, wi: Vec3<L>) -> Evaluated<L> {
        let up = wi.z.gt(L::splat(0.0));
        let pdf = L::select(up, p.k(wo, wi) * wi.z, L::splat(0.0));
        Evaluated { f_cos: p.color * pdf, pdf }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_util::*;
    use super::*;

    fn params(mattness: f32) -> MattParams<f32> {
        Matt::params(MattRow::new([1.0; 3], mattness).into())
    }

    /// 15 tests at 10^-3 in all (Sidak): each at 6.7e-5.
    #[test]
    fn samples_follow_the_density() {
        for m in [0.02, 0.1, 0.3, 0.6, 0.95] {
            for theta in [0.0, 60.0, 85.0] {
                let wo = direction(theta, 0.3);
                let p = chi_squared::<Matt>(&params(m), wo, Vec3::new(-wo.x, -wo.y, wo.z), 100_000);
                assert!(p > 6.7e-5, "mattness {m}, theta {theta}: p = {p}");
            }
        }
    }

    #[test]
    fn is_reciprocal() {
        for m in [1e-3, 0.1, 0.5, 0.9] {
            for i in 0..1000 {
                let u = numbers(i);
                let v = numbers(i + 5000);
                let (a, b) = (
                    direction(f64::from(u[0]) * 89.0, f64::from(u[1]) * std::f64::consts::TAU),
                    direction(f64::from(v[0]) * 89.0, f64::from(v[1]) * std::f64::consts::TAU),
                );
                let (k, l) = (params(m).k(a, b), params(m).k(b, a));
                assert!((k - l).abs() <= 1e-3 * k, "mattness {m}: {k} {l}");
            }
        }
    }

    #[test]
    fn at_one_it_is_lambert() {
        let wo = direction(40.0, 1.0);
        for i in 0..100 {
            let wi = Matt::sample(&params(1.0), wo, true, numbers(i)).wi;
            let pdf = Matt::eval(&params(1.0), wo, wi).pdf;
            assert!((pdf - wi.z * FRAC_1_PI).abs() < 1e-6, "{pdf}");
        }
    }

    /// The median of the deflection on the 3-sphere is 90 degrees times mattness; at normal incidence the deflection of
    /// the direction itself is what remains of it, so half the samples lie where |y3, y4| folds it: tested through the
    /// lifted angle.
    #[test]
    fn median_deflection_is_mattness_quarter_turns() {
        for m in [0.05f32, 0.3, 0.7] {
            let p = params(m);
            let rho = p.rho;
            let n = 20_000;
            let below = (0..n)
                .filter(|&i| {
                    let s = warp::sphere3(numbers(i));
                    let v = [s[0], s[1], s[2] + rho, s[3]];
                    let l2: f32 = v.iter().map(|x| x * x).sum();
                    let y3 = rho + p.complement() * v[2] / l2;
                    y3.clamp(-1.0, 1.0).acos().to_degrees() < 90.0 * m
                })
                .count();
            let z = (below as f64 - 0.5 * f64::from(n)) / (0.25 * f64::from(n)).sqrt();
            assert!(z.abs() < 3.9, "mattness {m}: {z} standard deviations");
        }
    }

    #[test]
    fn stays_finite_down_to_the_mirror() {
        for m in [1e-7, 1e-5, 1e-3] {
            for theta in [0.0, 45.0, 89.9] {
                let wo = direction(theta, 2.0);
                for i in 0..200 {
                    let wi = Matt::sample(&params(m), wo, true, numbers(i)).wi;
                    let e = Matt::eval(&params(m), wo, wi);
                    assert!(wi.length2().is_finite() && e.pdf.is_finite() && e.pdf >= 0.0, "m {m}: {wi:?} {e:?}");
                }
            }
        }
    }
}
