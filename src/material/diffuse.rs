//! Lambertian reflection: mattness 1.

use super::{Evaluated, Lobe, Scattered};
use crate::lanes::{Lanes, Mask, Vec3};
use crate::sampling::warp;
use std::f32::consts::FRAC_1_PI;

/// Reflects equally into all directions: f = color / pi.
#[derive(Clone, Copy, Debug, Default)]
pub struct Diffuse;

/// Share of light reflected, per channel.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseRow {
    /// Linear RGB in [0, 1].
    pub color: [f32; 3],
}

impl From<DiffuseRow> for [f32; 4] {
    fn from(row: DiffuseRow) -> Self {
        let [r, g, b] = row.color;
        [r, g, b, 0.0]
    }
}

impl Lobe for Diffuse {
    const DELTA: bool = false;
    const TRANSMITS: bool = false;
    const NUMBERS: usize = 2;
    const NAME: &'static str = "diffuse";
    type Row = DiffuseRow;
    type Params<L: Lanes> = Vec3<L>;

    #[inline(always)]
    fn params<L: Lanes>([r, g, b, _]: [L; 4]) -> Vec3<L> {
        Vec3::new(r, g, b)
    }
    #[inline(always)]
    fn sample<L: Lanes>(color: &Vec3<L>, _wo: Vec3<L>, _outside: L::Mask, u: [L; 3]) -> Scattered<L> {
        Scattered {
            wi: warp::cosine_hemisphere([u[0], u[1]]),
            weight: *color,
            radiance_scale: L::splat(1.0),
            transmitted: L::Mask::splat(false),
        }
    }
    #[inline(always)]
    fn eval<L: Lanes>(color: &Vec3<L>, _wo: Vec3<L>, wi: Vec3<L>) -> Evaluated<L> {
        let pdf = wi.z.max(L::splat(0.0)) * L::splat(FRAC_1_PI);
        Evaluated { f_cos: *color * pdf, pdf }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_util::*;
    use super::*;

    #[test]
    fn samples_follow_the_density() {
        let color = Vec3::splat([0.5; 3]);
        for theta in [0.0, 60.0, 89.0] {
            let p = chi_squared::<Diffuse>(&color, direction(theta, 0.4), Vec3::new(0.0, 0.0, 1.0), 200_000);
            assert!(p > 1e-3, "theta {theta}: p = {p}");
        }
    }
}
