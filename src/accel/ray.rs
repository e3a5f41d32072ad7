//! What a ray carries through the tree: reciprocals for boxes, a shear for triangles. Computed in lanes, kept ray by ray.

use super::Ray;
use crate::lanes::{F32x8, Lanes, LanesU32, Vec3, select3};

/// Rays in lanes, as a batch hands them over.
#[derive(Clone, Copy, Debug)]
pub struct RayLanes<L> {
    /// Where they start.
    pub origin: Vec3<L>,
    /// Where they go.
    pub direction: Vec3<L>,
    /// Where they end, in lengths of their directions.
    pub t_max: L,
}

impl From<RayLanes<f32>> for Ray {
    fn from(r: RayLanes<f32>) -> Self {
        Self { origin: r.origin.lane(0), direction: r.direction.lane(0), t_max: r.t_max }
    }
}

/// A ray, ready for box and triangle tests.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Prepared {
    /// Reciprocal of the direction. Slab distances are `plane * inv - off`,
    pub inv: [f32; 3],
    /// with an offset padded so that distances to near planes come out too small
    pub near_off: [f32; 3],
    /// and one so that those to far planes come out too large.
    pub far_off: [f32; 3],
    /// The shear that turns the direction onto the last permuted axis (Woop, Benthin and Wald 2013).
    pub shear: [f32; 3],
    /// The origin, axes permuted.
    pub origin: [f32; 3],
    /// Where the ray ends.
    pub t_max: f32,
    /// Bit a is set where the ray runs down axis a.
    pub octant: u32,
    /// Which of [`AXES`].
    pub permutation: u32,
}

/// Relative error of a slab distance, with room: the reciprocal, its product, the fused sum (Ize 2013).
pub(super) const SLAB_SLACK: f32 = 1.0 + 4.0 * f32::EPSILON;
/// Direction components below this are taken as this in box tests, so that no 0 x infinity arises.
const TINY: f32 = 1e-20;

/// Rows of near planes for each octant; those of far planes are the same, three on, modulo six.
pub(super) const NEAR_ROWS: [[usize; 3]; 8] =
    [[0, 1, 2], [3, 1, 2], [0, 4, 2], [3, 4, 2], [0, 1, 5], [3, 1, 5], [0, 4, 5], [3, 4, 5]];
/// Rows of far planes for each octant.
pub(super) const FAR_ROWS: [[usize; 3]; 8] =
    [[3, 4, 5], [0, 4, 5], [3, 1, 5], [0, 1, 5], [3, 4, 2], [0, 4, 2], [3, 1, 2], [0, 1, 2]];
/// Permuted axes: the direction's largest component last, upwards and downwards. The handedness of triangles stays.
pub(super) const AXES: [[usize; 3]; 8] =
    [[1, 2, 0], [2, 0, 1], [0, 1, 2], [0, 1, 2], [2, 1, 0], [0, 2, 1], [1, 0, 2], [1, 0, 2]];

/// The sixteen numbers of each ray, its octant and its permutation, in lanes.
#[inline(always)]
fn prepare<L: Lanes>(ray: &RayLanes<L>) -> ([L; 16], L::Uint, L::Uint) {
    let (o, d) = (ray.origin, ray.direction);
    let one = L::splat(1.0);
    let inv = |d: L| one / d.abs().max(L::splat(TINY)).copysign(d);
    let inv = Vec3::new(inv(d.x), inv(d.y), inv(d.z));
    let off = o.scale(inv);
    let pad = off.abs() * L::splat(2.0 * f32::EPSILON);
    let (near, far) = (off + pad, off - pad);

    let a = d.abs();
    let y_over_x = a.x.le(a.y);
    let z_over = a.x.max(a.y).le(a.z);
    let permute = |v: Vec3<L>, up: L::Mask| {
        let along_x = select3(up, Vec3::new(v.y, v.z, v.x), Vec3::new(v.z, v.y, v.x));
        let along_y = select3(up, Vec3::new(v.z, v.x, v.y), Vec3::new(v.x, v.z, v.y));
        let along_z = select3(up, v, Vec3::new(v.y, v.x, v.z));
        select3(z_over, along_z, select3(y_over_x, along_y, along_x))
    };
    let main = L::select(z_over, d.z, L::select(y_over_x, d.y, d.x));
    let up = L::splat(0.0).le(main);
    let (po, pd) = (permute(o, up), permute(d, up));
    let inv_main = one / pd.z;
    let sign = |v: L| v.to_bits().shr(31);
    let octant = sign(inv.x).or(sign(inv.y).shl(1)).or(sign(inv.z).shl(2));
    let pick = |mask: L::Mask, yes: u32| L::select(mask, L::from_bits(L::Uint::splat(yes)), L::splat(0.0)).to_bits();
    let permutation = pick(z_over, 2).or(pick(y_over_x & !z_over, 1)).or(pick(!up, 4));
    let numbers = [
        inv.x,
        inv.y,
        inv.z,
        near.x,
        near.y,
        near.z,
        far.x,
        far.y,
        far.z,
        pd.x * inv_main,
        pd.y * inv_main,
        inv_main,
        po.x,
        po.y,
        po.z,
        ray.t_max,
    ];
    (numbers, octant, permutation)
}

impl Prepared {
    fn from_numbers(n: [f32; 16], octant: u32, permutation: u32) -> Self {
        let three = |k: usize| [n[k], n[k + 1], n[k + 2]];
        Self {
            inv: three(0),
            near_off: three(3),
            far_off: three(6),
            shear: three(9),
            origin: three(12),
            t_max: n[15],
            octant,
            permutation,
        }
    }

    /// One ray.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let lanes = RayLanes::<f32> {
            origin: Vec3::splat(ray.origin),
            direction: Vec3::splat(ray.direction),
            t_max: ray.t_max,
        };
        let (numbers, octant, permutation) = prepare(&lanes);
        Self::from_numbers(numbers, octant, permutation)
    }
}

/// Eight rays, kept as they come out of the lanes: whole registers are stored, single numbers are read.
#[derive(Clone, Debug)]
pub(super) struct Prepared8 {
    halves: [[[f32; 8]; 2]; 8],
    octants: [u32; 8],
    permutations: [u32; 8],
}

impl Prepared8 {
    pub fn empty() -> Self {
        Self { halves: [[[0.0; 8]; 2]; 8], octants: [0; 8], permutations: [0; 8] }
    }
    #[inline(always)]
    pub fn fill(&mut self, rays: &RayLanes<F32x8>) {
        let (n, octant, permutation) = prepare(rays);
        let low = F32x8::transpose([n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7]]);
        let high = F32x8::transpose([n[8], n[9], n[10], n[11], n[12], n[13], n[14], n[15]]);
        for i in 0..8 {
            low[i].store(&mut self.halves[i][0]);
            high[i].store(&mut self.halves[i][1]);
        }
        octant.store(&mut self.octants);
        permutation.store(&mut self.permutations);
    }
    /// Moves ray `i` to where it is traced from.
    #[inline(always)]
    pub fn copy_to(&self, i: usize, to: &mut Prepared) {
        let [low, high] = &self.halves[i];
        *to = Prepared {
            inv: [low[0], low[1], low[2]],
            near_off: [low[3], low[4], low[5]],
            far_off: [low[6], low[7], high[0]],
            shear: [high[1], high[2], high[3]],
            origin: [high[4], high[5], high[6]],
            t_max: high[7],
            octant: self.octants[i],
            permutation: self.permutations[i],
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_matches_scalar_and_axes_keep_their_handedness() {
        let component = [0.0, -0.0, 1.0, -2.0, 1e-30, 0.5];
        let mut rays = Vec::new();
        for x in component {
            for y in component {
                for z in [-2.0, 0.3, 1.0, 1e-25] {
                    rays.push(Ray { origin: [0.1, -0.2, 0.3], direction: [x, y, z], t_max: 2.0 });
                }
            }
        }
        for chunk in rays.chunks(8) {
            let at = |i: usize| &chunk[i.min(chunk.len() - 1)];
            let mut wide = Prepared8::empty();
            wide.fill(&RayLanes {
                origin: Vec3::from_fn(|i| at(i).origin),
                direction: Vec3::from_fn(|i| at(i).direction),
                t_max: F32x8::from_fn(|i| at(i).t_max),
            });
            for (i, ray) in chunk.iter().enumerate() {
                let one = Prepared::new(ray);
                let mut copy = one;
                wide.copy_to(i, &mut copy);
                assert_eq!(format!("{one:?}"), format!("{copy:?}"), "{ray:?}");
                let [x, y, z] = AXES[one.permutation as usize];
                let d = ray.direction;
                assert!(d[z].abs() >= d[x].abs() && d[z].abs() >= d[y].abs());
                assert_eq!((x + 1) % 3 == y, d[z] >= 0.0, "{ray:?}");
                assert_eq!(one.origin, [ray.origin[x], ray.origin[y], ray.origin[z]]);
            }
        }
    }
}
