//! The lobe of mattness in f32, in f64 and as a paper has it, and the test of its samples.

use crate::common::meshes::v;
use crate::common::random::Random;
use glam::DVec3;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::{FRAC_PI_4, PI, TAU};
use wavetrace::lanes::{Frame, Vec3};
use wavetrace::material::{Lobe, Matt, MattRow};

/// Half a unit in the last place of 1: what one operation errs by at most.
pub const U: f64 = f32::EPSILON as f64 / 2.0;

pub fn lobe(m: f32) -> <Matt as Lobe>::Params<f32> {
    Matt::params(MattRow::new([1.0; 3], m).into())
}

pub fn direction(theta: f64, phi: f64) -> Vec3<f32> {
    let (sin, cos) = theta.sin_cos();
    Vec3::splat([sin * phi.cos(), sin * phi.sin(), cos].map(|c| c as f32))
}

pub fn unit(w: Vec3<f32>) -> DVec3 {
    DVec3::from(w.lane(0).map(f64::from)).normalize()
}

/// Density per solid angle in f64, of the directions that the rounded ones stand for.
pub fn exact(m: f32, wo: Vec3<f32>, wi: Vec3<f32>) -> f64 {
    let t = (f64::from(m) * FRAC_PI_4).tan();
    let less = 2.0 * t / (1.0 + t);
    let rho = 1.0 - less;
    let (o, i) = (unit(wo), unit(wi));
    let mirror = v(-o.x, -o.y, o.z);
    let b = 2.0 * rho * o.z * i.z;
    let low = less * less + rho * (mirror - i).length_squared();
    let (a, q) = (low + b, low * (low + 2.0 * b));
    (less * (1.0 + rho)).powi(3) * (2.0 * a * a + b * b) / (2.0 * PI * q.powf(2.5)) * i.z
}

/// The closed form as it stands in a paper, in f32.
pub fn textbook(m: f32, wo: Vec3<f32>, wi: Vec3<f32>) -> f32 {
    let rho = ((1.0 - m) * std::f32::consts::FRAC_PI_4).tan();
    let a = 1.0 + rho * rho - 2.0 * rho * (-wo.x * wi.x - wo.y * wi.y);
    let b = 2.0 * rho * wo.z * wi.z;
    let k = (1.0 - rho * rho).powi(3) * (2.0 * a * a + b * b) / (2.0 * (a * a - b * b).powf(2.5));
    k * std::f32::consts::FRAC_1_PI * wi.z
}

/// 1 - rho.
pub fn less(m: f32) -> f64 {
    let t = (f64::from(m) * FRAC_PI_4).tan();
    2.0 * t / (1.0 + t)
}

/// p-value of samples following the density: chi-squared over rings and sectors about the mirror direction, the rings
/// as wide as the lobe. Cells of less than 5 are pooled.
pub fn chi_squared(m: f32, theta: f64, count: u32) -> f64 {
    const RINGS: usize = 40;
    const SECTORS: usize = 16;
    const STEPS: usize = 32;
    let wo = direction(theta, 0.3);
    let frame = Frame::about(Vec3::new(-wo.x, -wo.y, wo.z));
    let width = (f64::from(m) * FRAC_PI_4).tan();
    let edge = |k: f64| 2.0 * (width * k).atan2(RINGS as f64 - k);
    let (mut random, mut seen) = (Random(2), vec![0.0; RINGS * SECTORS]);
    for _ in 0..count {
        let wi = Matt::sample(&lobe(m), wo, true, [random.unit(), random.unit(), random.unit()]).wi;
        assert!(Matt::eval(&lobe(m), wo, wi).pdf > 0.0, "mattness {m}: a sample where the density is 0: {wi:?}");
        let w = unit(frame.to_local(wi));
        let t = (w.truncate().length().atan2(w.z) / 2.0).tan();
        let ring = (t / (t + width) * RINGS as f64).min(RINGS as f64 - 1.0) as usize;
        let turn = w.y.atan2(w.x) / TAU + 0.5;
        seen[ring * SECTORS + (turn * SECTORS as f64).min(SECTORS as f64 - 1.0) as usize] += 1.0;
    }
    let (mut chi2, mut cells, mut total, mut rest) = (0.0, 0, 0.0, (0.0, 0.0));
    for (cell, seen) in seen.into_iter().enumerate() {
        let (ring, sector) = ((cell / SECTORS) as f64, (cell % SECTORS) as f64);
        let mut sum = 0.0;
        for a in 0..STEPS {
            let at = |a: f64| edge(ring + a / STEPS as f64);
            let (angle, high, low) = (at(a as f64 + 0.5), at(a as f64 + 1.0), at(a as f64));
            for b in 0..STEPS {
                let phi = (sector + (b as f64 + 0.5) / STEPS as f64) / SECTORS as f64 * TAU - PI;
                let density = Matt::eval(&lobe(m), wo, frame.to_world(direction(angle, phi))).pdf;
                sum += f64::from(density) * angle.sin() * (high - low);
            }
        }
        let expected = sum * TAU / (SECTORS * STEPS) as f64 * f64::from(count);
        total += expected / f64::from(count);
        if expected < 5.0 {
            rest = (rest.0 + seen, rest.1 + expected);
        } else {
            chi2 += (seen - expected).powi(2) / expected;
            cells += 1;
        }
    }
    assert!((total - 1.0).abs() < 1e-3, "mattness {m}, {theta}: the density integrates to {total}");
    if rest.1 >= 5.0 {
        chi2 += (rest.0 - rest.1).powi(2) / rest.1;
        cells += 1;
    }
    1.0 - ChiSquared::new(f64::from(cells - 1)).expect("two cells").cdf(chi2)
}
