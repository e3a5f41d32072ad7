//! How the tree lies in memory: nodes and leaves of eight, each column a SIMD register.

use crate::lanes::{F32x8, Lanes, U32x8};

/// An inner node: eight boxes and where they lead, a register per row.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Rows min x, min y, min z, max x, max y, max z, then the child codes as bits, and a spare. Eight rows, so that a
    /// masked index needs no check.
    rows: [[f32; 8]; 8],
}

const CHILD: usize = 6;

impl Node {
    /// A node without children: unused lanes hold inverted boxes, which nothing hits.
    pub fn empty() -> Self {
        let (lo, hi) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
        Self { rows: [lo, lo, lo, hi, hi, hi, [0.0; 8], [0.0; 8]] }
    }
    /// Planes of eight boxes: 0 to 2 are the lower ones, 3 to 5 the upper ones.
    #[inline(always)]
    pub fn planes(&self, row: usize) -> F32x8 {
        F32x8::load(&self.rows[row & 7])
    }
    /// Index of a node, or [`super::LEAF`] and the index of a leaf, for each lane.
    #[inline(always)]
    pub fn children(&self) -> U32x8 {
        F32x8::load(&self.rows[CHILD]).to_bits()
    }
    /// Sets where a lane leads.
    pub fn set_child(&mut self, lane: usize, code: u32) {
        self.rows[CHILD][lane] = f32::from_bits(code);
    }
    /// Sets a lane to a box, padded: the planes of pre-split boxes and of later arithmetic are rounded.
    pub fn set(&mut self, lane: usize, lo: [f32; 3], hi: [f32; 3], code: u32) {
        for axis in 0..3 {
            let pad = lo[axis].abs().max(hi[axis].abs()) * (4.0 * f32::EPSILON) + f32::MIN_POSITIVE;
            self.rows[axis][lane] = lo[axis] - pad;
            self.rows[axis + 3][lane] = hi[axis] + pad;
        }
        self.set_child(lane, code);
    }
}

/// Up to eight triangles. Unused lanes repeat the last one.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Leaf {
    /// `corner[k][axis]` of eight triangles.
    pub corner: [[[f32; 8]; 3]; 3],
    /// Ids of the triangles.
    pub id: [u32; 8],
}

impl Leaf {
    /// The leaf of one to eight triangles.
    pub fn new(ids: &[u32], corners: &[[[f32; 3]; 3]]) -> Self {
        let id: [u32; 8] = std::array::from_fn(|i| ids[i.min(ids.len() - 1)]);
        let corner = std::array::from_fn(|k| std::array::from_fn(|axis| id.map(|t| corners[t as usize][k][axis])));
        Self { corner, id }
    }
}
