//! What a ray carries through the tree: reciprocals for boxes, a shear for triangles. Computed in lanes, kept ray by ray.

use super::Ray;
use super::way::{AXES, Longest, octant};
use crate::columns::Rows;
use crate::lanes::{Lanes, LanesU32, Vec3, Wide};

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

/// The rays of a batch.
pub trait RaySource {
    /// The rays of a group of rows of the batch.
    fn rays<L: Lanes>(&self, rows: &Rows) -> RayLanes<L>;
}

/// Rays one by one.
impl RaySource for [Ray] {
    #[inline(always)]
    fn rays<L: Lanes>(&self, rows: &Rows) -> RayLanes<L> {
        RayLanes {
            origin: Vec3::from_fn(|i| self[rows.at(i)].origin),
            direction: Vec3::from_fn(|i| self[rows.at(i)].direction),
            t_max: L::from_fn(|i| self[rows.at(i)].t_max),
        }
    }
}

/// The rays of a batch from `first` on.
pub struct RaysFrom<'a, R: ?Sized> {
    /// The batch.
    pub rays: &'a R,
    /// Number of the ray that becomes the first.
    pub first: usize,
}

impl<R: RaySource + ?Sized> RaySource for RaysFrom<'_, R> {
    #[inline(always)]
    fn rays<L: Lanes>(&self, rows: &Rows) -> RayLanes<L> {
        self.rays.rays(&rows.shifted(self.first))
    }
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
    /// Reciprocals of the direction, offsets of lower and of upper planes, the shear, the origin with its axes permuted,
    /// the end of the ray.
    numbers: [f32; 16],
    axes: [u32; 4],
    octant: u32,
}

/// Error of a slab distance `(plane - origin) / direction` for what `origin / direction` is, over that, with room: the
/// reciprocal, the product, both sums, each half an epsilon (after Ize 2013). As much for `plane / direction` is added to
/// the planes themselves.
pub(super) const OFF_ERROR: f32 = 4.0 * f32::EPSILON;
/// Direction components below this are taken as this in box tests, so that no 0 x infinity arises.
const TINY: f32 = 1e-20;

/// 1 over a component of a direction, finite. Functions here are no closures, because a closure need not be inlined.
#[inline(always)]
fn reciprocal<L: Lanes>(d: L) -> L {
    L::splat(1.0) / d.abs().max(L::splat(TINY)).copysign(d)
}

/// What to add to offsets of lower planes, and to take from those of upper ones, for what rounding may do.
#[inline(always)]
fn padded<L: Lanes>(off: Vec3<L>, inv: Vec3<L>) -> Vec3<L> {
    let pad = off.abs() * L::splat(OFF_ERROR);
    Vec3::new(pad.x.copysign(inv.x), pad.y.copysign(inv.y), pad.z.copysign(inv.z))
}

/// The sixteen numbers of each ray, its octant and its permutation, in lanes.
#[inline(always)]
pub(super) fn prepare<L: Lanes>(ray: &RayLanes<L>) -> ([L; 16], L::Uint, L::Uint) {
    let (o, d) = (ray.origin, ray.direction);
    let one = L::splat(1.0);
    let inv = Vec3::new(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z));
    let off = o.scale(inv);
    let pad = padded(off, inv);
    let (lower, upper) = (off + pad, off - pad);

    let longest = Longest::of(d);
    let (po, pd) = (longest.permute(o), longest.permute(d));
    let inv_main = one / pd.z;
    let (octant, permutation) = (octant(d), longest.number());
    let numbers = [
        inv.x,
        inv.y,
        inv.z,
        lower.x,
        lower.y,
        lower.z,
        upper.x,
        upper.y,
        upper.z,
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
    /// One ray.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let lanes = RayLanes::<f32> {
            origin: Vec3::splat(ray.origin),
            direction: Vec3::splat(ray.direction),
            t_max: ray.t_max,
        };
        let (numbers, octant, permutation) = prepare(&lanes);
        Self { numbers, axes: AXES[(permutation & 7) as usize], octant }
    }
    /// Reciprocal of the direction. Slab distances are `plane * inv - off`, with an offset for each row of planes: one
    /// padded so that distances to planes where the ray enters come out too small, and those where it leaves too large.
    #[inline(always)]
    pub fn inv(&self, axis: usize) -> f32 {
        self.numbers[axis]
    }
    /// The offset of planes of row `row` of a node.
    #[inline(always)]
    pub fn off(&self, row: usize) -> f32 {
        self.numbers[3 + row]
    }
    /// The shear that turns the direction onto the last permuted axis (Woop, Benthin and Wald 2013).
    #[inline(always)]
    pub fn shear(&self, k: usize) -> f32 {
        self.numbers[9 + k]
    }
    /// How far behind a hit a box may be entered and hold a nearer one, by the error of distances. `slack` is that along
    /// the main axis.
    #[inline(always)]
    pub fn pad(&self, slack: f32) -> f32 {
        self.shear(2).abs() * slack
    }
    /// The origin on permuted axis `k`.
    #[inline(always)]
    pub fn origin(&self, k: usize) -> f32 {
        self.numbers[12 + k]
    }
    /// Where the ray ends.
    #[inline(always)]
    pub fn t_max(&self) -> f32 {
        self.numbers[15]
    }
    /// The axis that permuted axis `k` is.
    #[inline(always)]
    pub fn axis(&self, k: usize) -> u32 {
        self.axes[k]
    }
    /// Signs of the direction, a bit per axis.
    #[inline(always)]
    pub fn octant(&self) -> u32 {
        self.octant
    }
}

/// Eight rays, kept as they come out of the lanes: whole registers are stored, single numbers are read.
#[derive(Clone, Debug)]
pub(super) struct Prepared8 {
    numbers: [[f32; 16]; 8],
    octants: [u32; 8],
    permutations: [u32; 8],
}

impl Prepared8 {
    pub fn empty() -> Self {
        Self { numbers: [[0.0; 16]; 8], octants: [0; 8], permutations: [0; 8] }
    }
    #[inline(always)]
    pub fn fill<W: Wide>(&mut self, rays: &RayLanes<W>) {
        let (n, octant, permutation) = prepare(rays);
        let low = W::transpose([n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7]]);
        let high = W::transpose([n[8], n[9], n[10], n[11], n[12], n[13], n[14], n[15]]);
        for i in 0..8 {
            low[i].store(&mut self.numbers[i][..8]);
            high[i].store(&mut self.numbers[i][8..]);
        }
        octant.store(&mut self.octants);
        permutation.store(&mut self.permutations);
    }
    /// Moves ray `i` to where it is traced from.
    #[inline(always)]
    pub fn copy_to(&self, i: usize, to: &mut Prepared) {
        to.numbers = self.numbers[i];
        to.axes = AXES[(self.permutations[i] & 7) as usize];
        to.octant = self.octants[i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::F32x8;

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
            let mut wide = Prepared8::empty();
            wide.fill::<F32x8>(&chunk.rays(&Rows::range(0, chunk.len())));
            for (i, ray) in chunk.iter().enumerate() {
                let one = Prepared::new(ray);
                let mut copy = one;
                wide.copy_to(i, &mut copy);
                assert_eq!(format!("{one:?}"), format!("{copy:?}"), "{ray:?}");
                let [x, y, z] = std::array::from_fn(|k| one.axis(k) as usize);
                let d = ray.direction;
                assert!(d[z].abs() >= d[x].abs() && d[z].abs() >= d[y].abs());
                assert_eq!((x + 1) % 3 == y, d[z] >= 0.0, "{ray:?}");
                assert_eq!([0, 1, 2].map(|k| one.origin(k)), [ray.origin[x], ray.origin[y], ray.origin[z]]);
            }
        }
    }
    #[test]
    fn boxes_behind_a_hit_are_entered_within_the_error_of_distances() {
        for (direction, main) in [([0.25, 0.5, 2.0], 2.0), ([0.0, -4.0, 1.0], 4.0)] {
            let ray = Prepared::new(&Ray { origin: [0.0; 3], direction, t_max: 1.0 });
            assert_eq!([0.0, 0.125, 1.0].map(|slack| ray.pad(slack)), [0.0, 0.125 / main, 1.0 / main]);
        }
    }
}
