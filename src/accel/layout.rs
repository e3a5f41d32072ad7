//! How the tree lies in memory: nodes and leaves of eight, each column a SIMD register.

use super::arena::Block;
use crate::lanes::Wide;
use bytemuck::{Pod, Zeroable};

/// An inner node: eight boxes and where they lead, a register per row.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Rows min x, min y, min z, max x, max y, max z, then the child codes as bits, and a spare. Eight rows, so that a
    /// masked index needs no check.
    rows: [[f32; 8]; 8],
}

const CHILD: usize = 6;

/// What a child code leads to: a run of blocks.
macro_rules! in_blocks {
    ($name:ident) => {
        impl $name {
            /// Blocks that one takes.
            pub const BLOCKS: usize = size_of::<$name>() / size_of::<Block>();
            /// The one at block `at`.
            #[inline(always)]
            pub fn at(blocks: &[Block], at: usize) -> &Self {
                bytemuck::cast_ref(&blocks[at..at + Self::BLOCKS].as_chunks::<{ Self::BLOCKS }>().0[0])
            }
            /// Writes it to the front of `out`, and returns the rest.
            pub fn write(self, out: &mut [Block]) -> &mut [Block] {
                let (own, rest) = out.split_at_mut(Self::BLOCKS);
                own.copy_from_slice(&bytemuck::cast::<Self, [Block; Self::BLOCKS]>(self));
                rest
            }
        }
    };
}
in_blocks!(Node);
in_blocks!(Leaf);

impl Node {
    /// A node without children: unused lanes hold inverted boxes, which nothing hits.
    pub fn empty() -> Self {
        let (lo, hi) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
        Self { rows: [lo, lo, lo, hi, hi, hi, [0.0; 8], [0.0; 8]] }
    }
    /// Planes of eight boxes: rows 0 to 2 are the lower ones, 3 to 5 the upper ones.
    #[inline(always)]
    pub fn row<W: Wide>(&self, row: u32) -> W {
        W::load(&self.rows[(row & 7) as usize])
    }
    /// One plane of [`Self::row`].
    #[inline(always)]
    pub fn plane(&self, row: u32, lane: usize) -> f32 {
        self.rows[(row & 7) as usize][lane & 7]
    }
    /// Index of a node, or [`super::LEAF`] and the index of a leaf, for each lane.
    #[inline(always)]
    pub fn children<W: Wide>(&self) -> W::Uint {
        W::load(&self.rows[CHILD]).to_bits()
    }
    /// One of [`Self::children`].
    #[inline(always)]
    pub fn child(&self, lane: usize) -> u32 {
        self.rows[CHILD][lane & 7].to_bits()
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
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Leaf {
    /// Rows x, y, z of the first corners, of the second, of the third, then the ids as bits.
    rows: [[f32; 8]; 10],
}

const IDS: usize = 9;

impl Leaf {
    /// The leaf of one to eight triangles.
    pub fn new(ids: &[u32], corners: &[[[f32; 3]; 3]]) -> Self {
        let id: [u32; 8] = std::array::from_fn(|i| ids[i.min(ids.len() - 1)]);
        let row = |row: usize| match row {
            IDS => id.map(f32::from_bits),
            _ => id.map(|t| corners[t as usize][row / 3][row % 3]),
        };
        Self { rows: std::array::from_fn(row) }
    }
    /// Coordinate `axis` < 3 of corner `k` < 3 of the triangles.
    #[inline(always)]
    pub fn corner<W: Wide>(&self, k: usize, axis: u32) -> W {
        W::load(&self.rows[3 * k + (axis & 3) as usize])
    }
    /// One coordinate of [`Self::corner`].
    #[inline(always)]
    pub fn coordinate(&self, k: usize, axis: u32, lane: usize) -> f32 {
        self.rows[3 * k + (axis & 3) as usize][lane & 7]
    }
    /// Lanes and ids of the triangles, each once.
    #[inline(always)]
    pub fn distinct(&self) -> impl Iterator<Item = (usize, u32)> {
        let ids = &self.rows[IDS];
        (0..8)
            .map(|lane| (lane, ids[lane].to_bits()))
            .take_while(|&(lane, id)| lane == 0 || id != ids[lane - 1].to_bits())
    }
    /// Id of a triangle.
    #[inline(always)]
    pub fn id(&self, lane: usize) -> u32 {
        self.rows[IDS][lane].to_bits()
    }
}
