//! Maps from uniform numbers to directions and points, each with its density.

use crate::lanes::{Lanes, Vec3, safe_sqrt, sin_cos_turns};

/// Direction about +z with density cos(theta) / pi per solid angle.
#[inline(always)]
pub fn cosine_hemisphere<L: Lanes>([u1, u2]: [L; 2]) -> Vec3<L> {
    let r = u1.sqrt();
    let (sin, cos) = sin_cos_turns(u2);
    Vec3::new(r * cos, r * sin, (L::splat(1.0) - u1).sqrt())
}

/// Point on the unit 3-sphere, density 1 / (2 pi^2) per volume: Shoemake 1992, "Uniform Random Rotations".
#[inline(always)]
pub fn sphere3<L: Lanes>([u1, u2, u3]: [L; 3]) -> [L; 4] {
    let (r, q) = (u1.sqrt(), (L::splat(1.0) - u1).sqrt());
    let ((s2, c2), (s3, c3)) = (sin_cos_turns(u2), sin_cos_turns(u3));
    [r * c2, r * s2, q * c3, q * s3]
}

/// Barycentric coordinates (u, v) of the second and third corner, density 1 / area: Turk 1990.
#[inline(always)]
pub fn triangle<L: Lanes>([u1, u2]: [L; 2]) -> (L, L) {
    let root = safe_sqrt(u1);
    (root * (L::splat(1.0) - u2), root * u2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Decision, Sampler, Xoshiro};

    fn draw<const N: usize>(i: u32) -> [f32; N] {
        let mut s = Xoshiro::start::<f32>(3, i, 0);
        Xoshiro::draw(&mut s, Decision::Scatter, 0)
    }

    /// Chi-squared statistic of counts against equal expectations, in standard deviations of its distribution.
    fn excess(counts: &[u32]) -> f64 {
        let expected = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
        let k = counts.len() as f64 - 1.0;
        (chi2 - k) / (2.0 * k).sqrt()
    }

    /// Each map turns some coordinates of its result into uniform ones (the disk's, the sphere's, a triangle's areas):
    /// all cells are equally likely. Bound: 4 standard deviations, about 1 in 10^4.
    #[test]
    fn maps_are_uniform_where_they_say() {
        let n = 400_000;
        let (mut disk, mut sphere, mut tri) = (vec![0u32; 400], vec![0u32; 400], vec![0u32; 400]);
        let cell = |a: f64, b: f64| ((a * 20.0).min(19.0) as usize) * 20 + (b * 20.0).min(19.0) as usize;
        let turn = |y: f32, x: f32| f64::from(y).atan2(f64::from(x)) / std::f64::consts::TAU + 0.5;
        for i in 0..n {
            let w = cosine_hemisphere(draw::<2>(i));
            assert!((w.length2() - 1.0).abs() < 1e-5);
            disk[cell(f64::from(w.x * w.x + w.y * w.y), turn(w.y, w.x))] += 1;
            let p = sphere3(draw::<3>(i));
            assert!((p.iter().map(|v| v * v).sum::<f32>() - 1.0).abs() < 1e-5);
            sphere[cell(turn(p[1], p[0]), turn(p[3], p[2]))] += 1;
            let (u, v) = triangle(draw::<2>(i));
            assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-6);
            tri[cell(f64::from((u + v) * (u + v)), f64::from(v / (u + v).max(1e-30)))] += 1;
        }
        for (name, counts) in [("disk", disk), ("3-sphere", sphere), ("triangle", tri)] {
            assert!(excess(&counts) < 4.0, "{name}: {} standard deviations", excess(&counts));
        }
    }
}
