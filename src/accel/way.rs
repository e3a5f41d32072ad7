//! The way that a ray runs: its octant, and the permutation of axes that puts its longest last. Rays of one way read the
//! same rows of nodes and the same axes of triangles.

use super::ray::RayLanes;
use crate::lanes::{Lanes, LanesU32, Vec3, select3};

/// What the rays of one way have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    rows: [u32; 8],
    axes: [u32; 4],
    octant: u32,
}

impl Way {
    /// The way of this number.
    #[inline(always)]
    pub fn new(way: u32) -> Self {
        Self { rows: ROWS[(way & 7) as usize], axes: AXES[(way >> 3 & 7) as usize], octant: way & 7 }
    }
    /// Row of a node that holds the planes where the rays enter.
    #[inline(always)]
    pub fn near_row(&self, axis: usize) -> u32 {
        self.rows[axis]
    }
    /// Row of a node that holds the planes where the rays leave.
    #[inline(always)]
    pub fn far_row(&self, axis: usize) -> u32 {
        self.rows[3 + axis]
    }
    /// The axis that permuted axis `k` is.
    #[inline(always)]
    pub fn axis(&self, k: usize) -> u32 {
        self.axes[k]
    }
    /// Signs of the directions, a bit per axis.
    #[inline(always)]
    pub fn octant(&self) -> u32 {
        self.octant
    }
}

/// Rows of near planes for each octant, then those of far ones.
const ROWS: [[u32; 8]; 8] = {
    let mut table = [[0; 8]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut axis = 0;
        while axis < 3 {
            let down = octant >> axis & 1 == 1;
            table[octant][axis] = if down { axis as u32 + 3 } else { axis as u32 };
            table[octant][axis + 3] = if down { axis as u32 } else { axis as u32 + 3 };
            axis += 1;
        }
        octant += 1;
    }
    table
};
/// Permuted axes: the direction's largest component last, upwards and downwards. The handedness of triangles stays.
pub(super) const AXES: [[u32; 4]; 8] =
    [[1, 2, 0, 0], [2, 0, 1, 0], [0, 1, 2, 0], [0, 1, 2, 0], [2, 1, 0, 0], [0, 2, 1, 0], [1, 0, 2, 0], [1, 0, 2, 0]];

/// Numbers of ways are below this.
pub(super) const WAYS: usize = 64;

/// The way that a ray runs: its octant, and above it its permutation. Rays of one way read the same rows of nodes and
/// the same axes of triangles.
#[inline(always)]
pub(super) fn way_of<L: Lanes>(ray: &RayLanes<L>) -> L::Uint {
    let d = ray.direction;
    octant(d).or(Longest::of(d).number().shl(3))
}

/// 1 where the sign is set, else 0.
#[inline(always)]
fn sign<L: Lanes>(v: L) -> L::Uint {
    v.to_bits().shr(31)
}

/// `value` in the lanes of the mask, else 0.
#[inline(always)]
fn pick<L: Lanes>(mask: L::Mask, value: u32) -> L::Uint {
    L::select(mask, L::from_bits(L::Uint::splat(value)), L::splat(0.0)).to_bits()
}

/// Signs of the direction, a bit per axis.
#[inline(always)]
pub(super) fn octant<L: Lanes>(d: Vec3<L>) -> L::Uint {
    sign(d.x).or(sign(d.y).shl(1)).or(sign(d.z).shl(2))
}

/// Which component of the direction is the largest, and whether it is upwards.
pub(super) struct Longest<L: Lanes> {
    up: L::Mask,
    z_over: L::Mask,
    y_over_x: L::Mask,
}

impl<L: Lanes> Longest<L> {
    #[inline(always)]
    pub fn of(d: Vec3<L>) -> Self {
        let a = d.abs();
        let y_over_x = a.x.le(a.y);
        let z_over = a.x.max(a.y).le(a.z);
        let main = L::select(z_over, d.z, L::select(y_over_x, d.y, d.x));
        Self { up: L::splat(0.0).le(main), z_over, y_over_x }
    }
    /// Number of the permutation in [`AXES`].
    #[inline(always)]
    pub fn number(&self) -> L::Uint {
        pick::<L>(self.z_over, 2).or(pick::<L>(self.y_over_x & !self.z_over, 1)).or(pick::<L>(!self.up, 4))
    }
    /// Axes in the order of [`AXES`].
    #[inline(always)]
    pub fn permute(&self, v: Vec3<L>) -> Vec3<L> {
        let along_x = select3(self.up, Vec3::new(v.y, v.z, v.x), Vec3::new(v.z, v.y, v.x));
        let along_y = select3(self.up, Vec3::new(v.z, v.x, v.y), Vec3::new(v.x, v.z, v.y));
        let along_z = select3(self.up, v, Vec3::new(v.y, v.x, v.z));
        select3(self.z_over, along_z, select3(self.y_over_x, along_y, along_x))
    }
}
