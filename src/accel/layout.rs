//! How the tree lies in memory: nodes and leaves of eight, each column a SIMD register.

use super::arena::Block;
use super::boxes::Order;
use super::ray::OFF_ERROR;
use crate::lanes::{MAX_LANES, Wide};
use bytemuck::{Pod, Zeroable};

/// An inner node: eight boxes and where they lead, a register per row.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Rows min x, min y, min z, max x, max y, max z, then as bits the child codes, and for each octant of directions the
    /// order in which children are visited.
    rows: [[f32; 8]; 8],
}

const CHILD: usize = 6;
const ORDER: usize = 7;

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
    /// A node without children: unused lanes hold planes that are no numbers, which nothing hits.
    pub fn empty() -> Self {
        let none = [f32::NAN; 8];
        Self { rows: [none, none, none, none, none, none, [0.0; 8], [0.0; 8]] }
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
    /// The order in which rays of an octant visit the children.
    #[inline(always)]
    pub fn order(&self, octant: u32) -> Order {
        Order(self.rows[ORDER][(octant & 7) as usize].to_bits())
    }
    /// Sets the orders once all lanes are set: by how far the middles of boxes lie along the middle of the octant.
    pub fn set_orders(&mut self) {
        let middles = [0, 1, 2].map(|axis: usize| {
            let [lo, hi] = [self.rows[axis], self.rows[axis + 3]];
            // Unused lanes are never met, wherever they stand.
            std::array::from_fn::<f32, MAX_LANES, _>(|l| if lo[l] <= hi[l] { 0.5 * lo[l] + 0.5 * hi[l] } else { 0.0 })
        });
        for octant in 0..MAX_LANES {
            let along = |lane: usize, axis: usize| {
                if octant >> axis & 1 == 1 { -middles[axis][lane] } else { middles[axis][lane] }
            };
            let order = Order::by_distance(std::array::from_fn(|l| along(l, 0) + along(l, 1) + along(l, 2)));
            self.rows[ORDER][octant] = f32::from_bits(order.0);
        }
    }
    /// Sets where a lane leads.
    pub fn set_child(&mut self, lane: usize, code: u32) {
        self.rows[CHILD][lane] = f32::from_bits(code);
    }
    /// Sets a lane to a box, padded: the planes of pre-split boxes and of later arithmetic are rounded, as much as
    /// [`OFF_ERROR`] says each.
    pub fn set(&mut self, lane: usize, lo: [f32; 3], hi: [f32; 3], code: u32) {
        for axis in 0..3 {
            let pad = lo[axis].abs().max(hi[axis].abs()) * (2.0 * OFF_ERROR) + f32::MIN_POSITIVE;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays of an octant visit the children by how far their middles lie along its diagonal.
    #[test]
    fn orders_go_along_the_octants() {
        let boxes: Vec<[[f32; 3]; 2]> = (0..8)
            .map(|i| {
                let at = |by: f32| 3.0 * (i as f32 * by).sin();
                let lo = [at(1.3), at(2.1), at(0.7)];
                [lo, [lo[0] + 1.0 + 0.1 * i as f32, lo[1] + 0.5, lo[2] + 2.0]]
            })
            .collect();
        for used in [2, 5, 8] {
            let mut node = Node::empty();
            (0..used).for_each(|lane| node.set(lane, boxes[lane][0], boxes[lane][1], lane as u32));
            node.set_orders();
            for octant in 0..8 {
                let along = |lane: usize| {
                    let middle = |axis: usize| boxes[lane][0][axis] + boxes[lane][1][axis];
                    (0..3).map(|axis| if octant >> axis & 1 == 1 { -middle(axis) } else { middle(axis) }).sum::<f32>()
                };
                let order = node.order(octant);
                let visits: Vec<usize> = (0..8).rev().map(|at| order.lane(at)).filter(|&lane| lane < used).collect();
                assert_eq!(visits.len(), used);
                assert!(visits.windows(2).all(|w| along(w[0]) <= along(w[1])), "octant {octant}: {visits:?}");
            }
        }
    }
}
