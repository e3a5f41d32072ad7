//! Finding what a ray hits: an 8-wide BVH, its traversal kernels, and brute force as their oracle.
//!
//! All kernels give the same hits to the last bit: the triangle test is one function, boxes are padded against
//! rounding, and of equally near triangles the one with the smallest id is taken.

mod brute;
mod build;
mod collapse;
mod layout;
mod many;
mod ray;
mod single;
mod triangle;

pub use brute::brute_force;
pub use many::{Many, from_slice};
pub use ray::RayLanes;
pub use single::Single;

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

/// Top bit of a child code: the rest counts leaves, not nodes.
const LEAF: u32 = 1 << 31;

/// The tree over a world's triangles.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// Entries that a traversal stack can hold at most.
    stack_bound: usize,
}

impl Bvh {
    /// Builds the tree. Corners are finite.
    pub fn build(corners: &[[[f32; 3]; 3]]) -> Self {
        let tree = build::binary_tree(corners);
        collapse::collapse(&tree, corners)
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>() + self.leaves.len() * size_of::<Leaf>()
    }
    /// Number of inner nodes and of leaves.
    pub fn counts(&self) -> (usize, usize) {
        (self.nodes.len(), self.leaves.len())
    }
}
