//! Boxes as the build sees them: eight lanes that one minimum joins.

use super::build::Aabb;
use super::parallel::*;
use crate::lanes::{F32x8, Lanes, WideU32};

/// A box and what it holds: the lower corner, the id as bits, the upper corner negated, so that one minimum of eight
/// lanes joins two boxes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Reference(pub [f32; 8]);

const ID: usize = 3;

impl Reference {
    /// The box from `lo` to `hi` of the triangle `id`.
    pub fn new(lo: [f32; 3], hi: [f32; 3], id: u32) -> Self {
        Self([lo[0], lo[1], lo[2], f32::from_bits(id), -hi[0], -hi[1], -hi[2], 0.0])
    }
    pub fn id(&self) -> u32 {
        self.0[ID].to_bits()
    }
    #[inline(always)]
    pub fn lanes(&self) -> F32x8 {
        F32x8::load(&self.0)
    }
}

/// The largest extent of any triangle along any axis.
pub(super) fn largest_extent(corners: &[[[f32; 3]; 3]]) -> f32 {
    let extent = |[a, b, c]: &[[f32; 3]; 3]| {
        let along = |axis: usize| a[axis].max(b[axis]).max(c[axis]) - a[axis].min(b[axis]).min(c[axis]);
        along(0).max(along(1)).max(along(2))
    };
    corners.par_iter().map(extent).reduce(|| 0.0, f32::max)
}

/// Sets from this size on are looked through by several threads.
pub(super) const SHARED_BINS: usize = 1 << 17;

/// Joined boxes, as in [`Reference`].
pub(super) type Bounds = F32x8;

#[inline(always)]
pub(super) fn nothing() -> Bounds {
    F32x8::splat(f32::INFINITY)
}

/// Half the surface area, of nothing negative or NaN.
#[inline(always)]
pub(super) fn half_area(b: Bounds) -> f32 {
    let b = b.array();
    let [x, y, z] = [-b[4] - b[0], -b[5] - b[1], -b[6] - b[2]];
    x * y + y * z + z * x
}

/// Twice the centre in the first three lanes, the same negated in lanes 4 to 6.
#[inline(always)]
pub(super) fn centre(b: F32x8) -> F32x8 {
    b - F32x8::from_bits(b.to_bits().permute_const([4, 5, 6, 7, 0, 1, 2, 3]))
}

/// What is known of a set: its bounds, and those of its centres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub bounds: Bounds,
    pub centres: Bounds,
}

impl Extent {
    pub fn of(refs: &[Reference]) -> Self {
        if refs.len() >= SHARED_BINS {
            let (left, right) = refs.split_at(refs.len() / 2);
            let (a, b) = join(|| Self::of(left), || Self::of(right));
            return Self { bounds: a.bounds.min(b.bounds), centres: a.centres.min(b.centres) };
        }
        let mut all = Self { bounds: nothing(), centres: nothing() };
        for r in refs {
            all.bounds = all.bounds.min(r.lanes());
            all.centres = all.centres.min(centre(r.lanes()));
        }
        all
    }
    pub fn aabb(&self) -> Aabb {
        let b = self.bounds.array();
        Aabb::new([b[0], b[1], b[2]].into(), [-b[4], -b[5], -b[6]].into())
    }
}
