//! Finding what a ray hits: an 8-wide BVH, its traversal kernels, and brute force as their oracle.
//!
//! All kernels give the same hits to the last bit: the triangle test is one function, boxes are padded against
//! rounding, and of equally near triangles the one with the smallest id is taken.

mod arena;
mod batch;
mod bounds;
mod boxes;
mod brute;
mod build;
mod collapse;
mod feed;
mod group;
mod layout;
mod many;
mod parallel;
mod ray;
mod sah;
mod scalar;
mod single;
mod stream;
mod tile;
mod triangle;
mod way;
#[cfg(test)]
pub(crate) mod work;

pub use batch::BatchTracer;
pub use brute::brute_force;
pub use many::Many;
pub use ray::{RayLanes, RaySource, RaysFrom};
pub use scalar::Scalar;
pub use single::Single;
pub use stream::Streams;
pub use tile::Tiles;

use crate::error::Result;
use crate::lanes::prefetch_lines;
use arena::{Arena, Block};
use layout::{Leaf, Node};

/// A ray: points `origin + t direction` for t in (0, `t_max`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, in world coordinates.
    pub origin: [f32; 3],
    /// Where it goes; any length, not zero.
    pub direction: [f32; 3],
    /// Where it ends, in lengths of `direction`; may be infinite.
    pub t_max: f32,
}

/// The nearest hit of a ray. A miss has `triangle` [`Hit::NONE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in lengths of the ray's direction.
    pub t: f32,
    /// Weight of the triangle's second corner.
    pub u: f32,
    /// Weight of the triangle's third corner.
    pub v: f32,
    /// Id of the triangle.
    pub triangle: u32,
}

impl Hit {
    /// Stands for no triangle.
    pub const NONE: u32 = u32::MAX;
    /// Nothing hit up to `t`.
    pub const fn miss(t: f32) -> Self {
        Self { t, u: 0.0, v: 0.0, triangle: Self::NONE }
    }
    /// Whether a triangle was hit.
    pub fn is_some(&self) -> bool {
        self.triangle != Self::NONE
    }
}

/// Top bit of a child code: a leaf. The rest is the index of its first block.
const LEAF: u32 = 1 << 31;

/// What the build is for: its own time, or that of the rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Little time before the first ray.
    Fast,
    /// Pays for itself within a preview.
    #[default]
    Balanced,
    /// Pays for itself in long renders.
    Best,
}

/// How a tree is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildOptions {
    /// What the build is for.
    pub quality: Quality,
    /// Threads at most; 0 for all cores. The tree is the same on any number of them.
    pub threads: usize,
    /// Triangles of a leaf at most, 1 to [`MAX_LEAF`]; what is beyond counts as that. Changes the speed, not the hits.
    pub leaf: usize,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { quality: Quality::default(), threads: 0, leaf: MAX_LEAF }
    }
}

/// Triangles of a leaf at most: one in each lane.
pub const MAX_LEAF: usize = 8;

/// Nodes and leaves by their codes.
#[derive(Clone, Copy)]
struct Tree<'a> {
    blocks: &'a [Block],
    /// As in [`Bvh`].
    slack: f32,
}

impl<'a> Tree<'a> {
    /// The inner node of a child code without the [`LEAF`] bit; the root is 0.
    #[inline(always)]
    fn node(self, code: u32) -> &'a Node {
        #[cfg(test)]
        work::note(work::NODES);
        Node::at(self.blocks, code as usize)
    }
    /// The leaf of a child code with the [`LEAF`] bit.
    #[inline(always)]
    fn leaf(self, code: u32) -> &'a Leaf {
        #[cfg(test)]
        work::note(work::LEAVES);
        Leaf::at(self.blocks, (code & !LEAF) as usize)
    }
    /// Asks for the memory of what a child code leads to.
    #[inline(always)]
    fn prefetch(self, code: u32) {
        prefetch_lines::<Block, { Leaf::BLOCKS }>(self.blocks, (code & !LEAF) as usize);
    }
}

/// Entries of a traversal stack: each node on the way leaves at most seven, [`sah::DEPTH`] are on it, and eight are
/// written at a time.
const STACK: usize = 512;

/// The tree over a world's triangles.
#[derive(Clone, Debug)]
pub struct Bvh {
    arena: Arena,
    nodes: usize,
    leaves: usize,
    /// Entries that a traversal stack can hold at most.
    stack_bound: usize,
    /// Error of a hit's distance along the ray's main axis: a box may be entered as far behind a hit and hold a nearer
    /// one.
    slack: f32,
}

/// Error of the distance that the triangle test finds, over the triangle's largest extent: some roundings of products of
/// coordinates relative to the ray's start, with room. More at needles, in proportion to extent over width.
const DISTANCE_ERROR: f32 = 16.0 * f32::EPSILON;

impl Bvh {
    /// Builds the tree on all cores. Corners are finite.
    pub fn build(corners: &[[[f32; 3]; 3]]) -> Self {
        let options = BuildOptions::default();
        // Where threads of its own cannot be had, those that the process shares have to do.
        Self::build_with(corners, &options).unwrap_or_else(|_| Self::grow(corners, &options))
    }
    /// Builds the tree. Corners are finite.
    ///
    /// # Errors
    /// [`Error::Setting`](crate::error::Error::Setting) if the system cannot start that many threads.
    pub fn build_with(corners: &[[[f32; 3]; 3]], options: &BuildOptions) -> Result<Self> {
        parallel::within(options.threads, || Self::grow(corners, options))
    }
    fn grow(corners: &[[[f32; 3]; 3]], options: &BuildOptions) -> Self {
        let &BuildOptions { quality, leaf, .. } = options;
        let collapsed =
            |reinserted| collapse::collapse(&build::binary_tree(corners, quality, reinserted), corners, leaf);
        let bvh = collapsed(quality == Quality::Best);
        // Reinsertion may leave a way that is too long; the tree before it has none.
        if bvh.stack_bound <= STACK { bvh } else { collapsed(false) }
    }
    /// Whether there is no triangle, and so no node.
    fn is_empty(&self) -> bool {
        self.nodes == 0
    }
    /// What a traversal fetches from, once per batch.
    #[inline(always)]
    fn tree(&self) -> Tree<'_> {
        Tree { blocks: self.arena.blocks(), slack: self.slack }
    }
    /// The same for nearest hits, or for any. Where any will do, what lies behind the end of the ray is never looked at:
    /// which boxes are entered does not depend on what was hit before.
    #[inline(always)]
    fn tree_for<const ANY: bool>(&self) -> Tree<'_> {
        Tree { slack: if ANY { 0.0 } else { self.slack }, ..self.tree() }
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.arena.blocks())
    }
    /// Entries that a traversal's stack holds at most, at most 512: seven for each node on the longest way down.
    pub fn stack_bound(&self) -> usize {
        self.stack_bound
    }
    /// Number of inner nodes and of leaves.
    pub fn counts(&self) -> (usize, usize) {
        (self.nodes, self.leaves)
    }
}
