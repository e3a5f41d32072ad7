//! The binary tree: triangles split into boxes, a tree over these, and its improvement by reinsertion. Splitting and
//! reinsertion are obvhs's; the only file that names it.

use super::Quality;
use super::bounds::Reference;
use super::parallel::*;
use super::sah::tree;
use obvhs::bvh2::{Bvh2, reinsertion::ReinsertionOptimizer};
use obvhs::splits::split_aabbs_preset;
use obvhs::triangle::Triangle;

pub(super) use obvhs::aabb::Aabb;
/// A node of the binary tree; `first_index` is that of its first child, the second one behind it, or of a leaf the id of
/// its triangle.
pub(super) use obvhs::bvh2::node::Bvh2Node as BinaryNode;

/// Share of the nodes that the first pass of reinsertion tries to place better.
const REINSERTION: f32 = 0.2;

/// Triangles that one task turns into boxes.
const CHUNK: usize = 1 << 14;

/// Boxes met on average from which on reinsertion is not tried: where everything overlaps everything, such as in nested
/// shells, its search has to look at all nodes for each. Scenes of separate things have some tens.
const HOPELESS: f64 = 4000.0;

/// The binary tree, root first, one triangle per leaf; a triangle may stand in several. Empty for no triangles.
///
/// No way from the root is longer than [`super::sah::DEPTH`] nodes, unless `reinserted`: then it may be any length.
pub(super) fn binary_tree(corners: &[[[f32; 3]; 3]], quality: Quality, reinserted: bool) -> Vec<BinaryNode> {
    if corners.is_empty() {
        return Vec::new();
    }
    let nodes = match quality {
        Quality::Fast => tree::<8>(whole(corners)),
        Quality::Balanced => tree::<16>(split(corners)),
        Quality::Best => tree::<32>(split(corners)),
    };
    // What does not fit the stacks of reinsertion, of a fixed size whatever the depth, is not tried.
    if !reinserted || boxes_met(&nodes) >= HOPELESS {
        return nodes;
    }
    let mut tree = Bvh2 { nodes, ..Bvh2::default() };
    ReinsertionOptimizer::default().run(&mut tree, REINSERTION, None);
    tree.nodes
}

/// Boxes that a random line through the tree meets, on average.
fn boxes_met(nodes: &[BinaryNode]) -> f64 {
    let area = |node: &BinaryNode| f64::from(node.aabb().half_area());
    let sums: Vec<f64> = nodes.par_chunks(CHUNK).map(|chunk| chunk.iter().map(area).sum()).collect();
    sums.iter().sum::<f64>() / area(&nodes[0])
}

fn triangle(&[a, b, c]: &[[f32; 3]; 3]) -> Triangle {
    Triangle { v0: a.into(), v1: b.into(), v2: c.into() }
}

fn reference(b: &Aabb, id: u32) -> Reference {
    Reference::new(b.min.to_array(), b.max.to_array(), id)
}

/// One box for each triangle.
fn whole(corners: &[[[f32; 3]; 3]]) -> Vec<Reference> {
    corners.par_iter().enumerate().map(|(i, t)| reference(&triangle(t).aabb(), i as u32)).collect()
}

/// One box or several for each triangle: those with a box far above the average are cut where that leaves less.
fn split(corners: &[[[f32; 3]; 3]]) -> Vec<Reference> {
    let area = |chunk: &[[[f32; 3]; 3]]| {
        let areas = chunk.iter().map(|t| triangle(t).aabb().half_area());
        areas.fold((0.0, 0.0f32), |(sum, most), a| (sum + f64::from(a), most.max(a)))
    };
    let areas: Vec<(f64, f32)> = corners.par_chunks(CHUNK).map(area).collect();
    let mean = (areas.iter().map(|a| a.0).sum::<f64>() / corners.len() as f64) as f32;
    let most = areas.iter().map(|a| a.1).fold(0.0, f32::max);
    let split_chunk = |k: usize, chunk: &[[[f32; 3]; 3]]| {
        let triangles: Vec<Triangle> = chunk.iter().map(triangle).collect();
        let mut boxes: Vec<Aabb> = triangles.iter().map(Triangle::aabb).collect();
        let mut ids: Vec<u32> = (0..chunk.len() as u32).collect();
        split_aabbs_preset(&mut boxes, &mut ids, &triangles, mean, most);
        let first = (k * CHUNK) as u32;
        boxes.into_iter().zip(ids).map(move |(b, id)| reference(&b, first + id)).collect::<Vec<_>>()
    };
    let parts: Vec<Vec<Reference>> =
        corners.par_chunks(CHUNK).enumerate().map(|(k, chunk)| split_chunk(k, chunk)).collect();
    parts.concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_meets_boxes_as_often_as_their_areas_say() {
        // Boxes of 1 x 1 x 1 and 2 x 3 x 4, at the ends of one of 10 x 3 x 4.
        let corners =
            [[[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[8.0, 0.0, 0.0], [10.0, 3.0, 0.0], [8.0, 0.0, 4.0]]];
        let met = |corners: &[_]| boxes_met(&binary_tree(corners, Quality::Fast, false));
        assert_eq!(met(&corners[..1]), 1.0);
        let [one, two, both] =
            [[1.0, 1.0, 1.0], [2.0, 3.0, 4.0], [10.0, 3.0, 4.0]].map(|[x, y, z]| x * y + y * z + z * x);
        assert!((met(&corners) - (one + two + both) / both).abs() < 1e-6, "{}", met(&corners));
    }
}
