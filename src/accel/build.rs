//! The binary tree, built by obvhs (PLOC with reinsertion); the only file that names it.

use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;
use obvhs::{BvhBuildParams, ploc::PlocSearchDistance};
use std::time::Duration;

/// A node of the binary tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    pub lo: [f32; 3],
    pub hi: [f32; 3],
    /// Index of the first child, the second one behind it; of a leaf, the id of its triangle.
    pub first: u32,
    pub is_leaf: bool,
}

/// Triangles up to which the slower, better build pays: past it the time to the first ray counts.
const SLOW_BUILD_LIMIT: usize = 200_000;

/// The binary tree, root first, one triangle per leaf; a triangle may stand in several. Empty for no triangles.
pub(super) fn binary_tree(corners: &[[[f32; 3]; 3]]) -> Vec<BinaryNode> {
    if corners.is_empty() {
        return Vec::new();
    }
    let triangles: Vec<Triangle> =
        corners.iter().map(|&[a, b, c]| Triangle { v0: a.into(), v1: b.into(), v2: c.into() }).collect();
    let preset = if corners.len() <= SLOW_BUILD_LIMIT {
        BvhBuildParams::slow_build()
    } else {
        BvhBuildParams { ploc_search_distance: PlocSearchDistance::Low, ..BvhBuildParams::fast_build() }
    };
    let params =
        BvhBuildParams { max_prims_per_leaf: 1, post_collapse_reinsertion_batch_ratio_multiplier: 0.0, ..preset };
    let bvh = build_bvh2_from_tris(&triangles, params, &mut Duration::default());
    bvh.nodes
        .iter()
        .map(|n| {
            let (is_leaf, box_) = (n.is_leaf(), n.aabb());
            let first = if is_leaf { bvh.primitive_indices[n.first_index as usize] } else { n.first_index };
            BinaryNode { lo: box_.min.to_array(), hi: box_.max.to_array(), first, is_leaf }
        })
        .collect()
}
