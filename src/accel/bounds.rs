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

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Boxes of many sizes about the origin.
    pub fn references(count: u32) -> Vec<Reference> {
        let wave = |i: u32, by: f32| (i as f32 * by).sin();
        let of = |i: u32| {
            let lo = [wave(i, 0.37), 2.0 * wave(i, 0.73), 3.0 * wave(i, 0.11)];
            let size = 0.01 + 0.3 * wave(i, 1.7).powi(4);
            Reference::new(lo, [lo[0] + size, lo[1] + 2.0 * size, lo[2] + 0.5 * size], i)
        };
        (0..count).map(of).collect()
    }

    #[test]
    fn areas_centres_and_extents_are_those_of_the_boxes() {
        let one = Reference::new([-1.0, 2.0, -5.0], [1.0, 5.0, -1.0], 7);
        assert_eq!((one.id(), half_area(one.lanes())), (7, 2.0 * 3.0 + 3.0 * 4.0 + 4.0 * 2.0));
        assert_eq!(centre(one.lanes()).array()[..3], [0.0, 7.0, -6.0]);
        // Above the size from which halves are looked through apart, too.
        for count in [1, 9, SHARED_BINS as u32 + 3] {
            let refs = references(count);
            let found = Extent::of(&refs);
            for axis in 0..3 {
                let least = |row: usize| refs.iter().map(|r| r.0[row]).fold(f32::INFINITY, f32::min);
                let (lo, hi) = (least(axis), -least(axis + 4));
                let bounds = found.bounds.array();
                assert_eq!((bounds[axis], -bounds[axis + 4]), (lo, hi));
                let middle = refs.iter().map(|r| r.0[axis] - r.0[axis + 4]).fold(f32::INFINITY, f32::min);
                assert_eq!(found.centres.array()[axis], middle);
                assert_eq!((found.aabb().min[axis], found.aabb().max[axis]), (lo, hi));
            }
        }
    }

    #[test]
    fn the_largest_extent_is_that_of_any_triangle_along_any_axis() {
        let small = [[1.0, 1.0, 1.0], [1.5, 1.0, 1.0], [1.0, 1.25, 1.0]];
        for axis in 0..3 {
            for corner in 0..3 {
                let mut large = small;
                large[corner][axis] = -7.0;
                let others = (0..3).filter(|&k| k != corner).map(|k| small[k][axis]).fold(0.0, f32::max);
                assert_eq!(largest_extent(&[small, large, small]), others + 7.0);
            }
        }
        assert_eq!(largest_extent(&[]), 0.0);
    }
}
