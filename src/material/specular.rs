//! A mirror: the specular material, and diffuse with mattness 0.

use super::{Evaluated, Lobe, Scattered};
use crate::lanes::{Lanes, Mask, Vec3};

/// Reflects into the mirror direction.
#[derive(Clone, Copy, Debug, Default)]
pub struct Specular;

/// Share of light reflected, per channel.
#[derive(Clone, Copy, Debug)]
pub struct SpecularRow {
    /// Linear RGB in [0, 1].
    pub color: [f32; 3],
}

impl From<SpecularRow> for [f32; 4] {
    fn from(row: SpecularRow) -> Self {
        let [r, g, b] = row.color;
        [r, g, b, 0.0]
    }
}

impl Lobe for Specular {
    const DELTA: bool = true;
    const TRANSMITS: bool = false;
    const NUMBERS: usize = 0;
    const NAME: &'static str = "specular";
    type Row = SpecularRow;
    type Params<L: Lanes> = Vec3<L>;

    #[inline(always)]
    fn params<L: Lanes>([r, g, b, _]: [L; 4]) -> Vec3<L> {
        Vec3::new(r, g, b)
    }
    #[inline(always)]
    fn sample<L: Lanes>(color: &Vec3<L>, wo: Vec3<L>, _outside: L::Mask, _u: [L; 3]) -> Scattered<L> {
        Scattered {
            wi: Vec3::new(-wo.x, -wo.y, wo.z),
            weight: *color,
            radiance_scale: L::splat(1.0),
            transmitted: L::Mask::splat(false),
        }
    }
    #[inline(always)]
    fn eval<L: Lanes>(_color: &Vec3<L>, _wo: Vec3<L>, _wi: Vec3<L>) -> Evaluated<L> {
        Evaluated { f_cos: Vec3::splat([0.0; 3]), pdf: L::splat(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_util::*;
    use super::*;

    #[test]
    fn reflects_in_the_plane_at_the_same_angle() {
        for theta in [0.0, 30.0, 89.0] {
            let wo = direction(theta, 0.7);
            let s = Specular::sample(&Vec3::splat([0.9, 0.5, 0.1]), wo, true, [0.0; 3]);
            assert_eq!(s.wi.z, wo.z);
            assert!((s.wi + wo).lane(0)[..2].iter().all(|&c| c == 0.0));
            assert_eq!(s.weight.lane(0), [0.9, 0.5, 0.1]);
        }
    }
}
