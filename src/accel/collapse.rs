//! From the binary tree to the 8-wide one of least expected cost: a dynamic programme over the ways to cover a subtree
//! with one to eight roots (in the manner of Ylitie, Karras and Laine 2017, section 3).

use super::build::BinaryNode;
use super::layout::{Leaf, Node};
use super::{Bvh, LEAF};

const WIDTH: usize = 8;
/// Cost of a node step, and of a leaf block, per unit of surface.
const NODE_COST: f32 = 1.0;
const LEAF_COST: f32 = 1.0;

/// `cost[n][k - 1]`: least cost of covering the subtree of node n with at most k roots.
struct Plan<'a> {
    tree: &'a [BinaryNode],
    cost: Vec<[f32; WIDTH]>,
    triangles: Vec<u32>,
}

fn half_area(n: &BinaryNode) -> f32 {
    let [x, y, z] = std::array::from_fn(|a| n.hi[a] - n.lo[a]);
    x * y + y * z + z * x
}

impl<'a> Plan<'a> {
    fn new(tree: &'a [BinaryNode]) -> Self {
        let mut plan = Self { tree, cost: vec![[0.0; WIDTH]; tree.len()], triangles: vec![1; tree.len()] };
        for n in preorder(tree).into_iter().rev() {
            let node = &tree[n];
            let area = half_area(node);
            if node.is_leaf {
                plan.cost[n] = [area * LEAF_COST; WIDTH];
                continue;
            }
            let (l, r) = (node.first as usize, node.first as usize + 1);
            plan.triangles[n] = plan.triangles[l].saturating_add(plan.triangles[r]);
            let shared: [f32; WIDTH] =
                std::array::from_fn(|k| if k == 0 { f32::INFINITY } else { plan.split(n, k + 1).0 });
            let mut best = plan.leaf_cost(n).min(area * NODE_COST + shared[WIDTH - 1]);
            for (cost, with_k) in plan.cost[n].iter_mut().zip(shared) {
                best = best.min(with_k);
                *cost = best;
            }
        }
        plan
    }
    fn leaf_cost(&self, n: usize) -> f32 {
        if self.triangles[n] as usize <= WIDTH { half_area(&self.tree[n]) * LEAF_COST } else { f32::INFINITY }
    }
    /// (cost, roots for the left child) of covering inner node `n` by covering its children with `k` >= 2 roots.
    fn split(&self, n: usize, k: usize) -> (f32, usize) {
        let first = self.tree[n].first as usize;
        (1..k)
            .map(|left| (self.cost[first][left - 1] + self.cost[first + 1][k - left - 1], left))
            .fold((f32::INFINITY, 1), |best, c| if c.0 < best.0 { c } else { best })
    }
    /// Collects the at most `k` roots of the best cover of `n`.
    fn roots(&self, n: usize, k: usize, out: &mut Vec<usize>) {
        let mut todo = vec![(n, k)];
        while let Some((n, mut k)) = todo.pop() {
            while k > 1 && self.cost[n][k - 2] <= self.cost[n][k - 1] {
                k -= 1;
            }
            if k == 1 || self.tree[n].is_leaf {
                out.push(n);
            } else {
                let (left, first) = (self.split(n, k).1, self.tree[n].first as usize);
                todo.push((first + 1, k - left));
                todo.push((first, left));
            }
        }
    }
    fn is_leaf(&self, n: usize) -> bool {
        self.tree[n].is_leaf || self.leaf_cost(n) <= half_area(&self.tree[n]) * NODE_COST + self.split(n, WIDTH).0
    }
    /// The distinct triangles below `n`, which holds at most eight.
    fn ids(&self, n: usize) -> Vec<u32> {
        let (mut ids, mut todo) = (Vec::with_capacity(WIDTH), vec![n]);
        while let Some(n) = todo.pop() {
            let node = &self.tree[n];
            if node.is_leaf {
                ids.push(node.first);
            } else {
                todo.extend([node.first as usize + 1, node.first as usize]);
            }
        }
        ids.sort_unstable();
        ids.dedup();
        ids
    }
}

/// Node indices, parents before children.
fn preorder(tree: &[BinaryNode]) -> Vec<usize> {
    let mut order = Vec::with_capacity(tree.len());
    let mut todo = if tree.is_empty() { Vec::new() } else { vec![0] };
    while let Some(n) = todo.pop() {
        order.push(n);
        if !tree[n].is_leaf {
            todo.extend([tree[n].first as usize + 1, tree[n].first as usize]);
        }
    }
    order
}

/// The 8-wide tree, nodes in depth-first order.
pub(super) fn collapse(tree: &[BinaryNode], corners: &[[[f32; 3]; 3]]) -> Bvh {
    let mut bvh = Bvh { nodes: Vec::new(), leaves: Vec::new(), stack_bound: 2 * WIDTH };
    if tree.is_empty() {
        return bvh;
    }
    let plan = Plan::new(tree);
    // Each entry: a binary node that becomes an inner node, the lane that leads to it, its depth.
    let mut todo = vec![(0usize, None::<(usize, usize)>, 1usize)];
    let mut roots = Vec::with_capacity(WIDTH);
    while let Some((n, parent, depth)) = todo.pop() {
        let index = bvh.nodes.len();
        if let Some((node, lane)) = parent {
            bvh.nodes[node].set_child(lane, index as u32);
        }
        bvh.stack_bound = bvh.stack_bound.max((depth + 2) * WIDTH);
        roots.clear();
        if plan.is_leaf(n) {
            roots.push(n);
        } else {
            let (left, first) = (plan.split(n, WIDTH).1, tree[n].first as usize);
            plan.roots(first, left, &mut roots);
            plan.roots(first + 1, WIDTH - left, &mut roots);
        }
        let mut node = Node::empty();
        let inner_from = todo.len();
        for (lane, &root) in roots.iter().enumerate() {
            let code = if plan.is_leaf(root) {
                bvh.leaves.push(Leaf::new(&plan.ids(root), corners));
                LEAF | (bvh.leaves.len() - 1) as u32
            } else {
                todo.push((root, Some((index, lane)), depth + 1));
                0
            };
            node.set(lane, tree[root].lo, tree[root].hi, code);
        }
        todo[inner_from..].reverse();
        bvh.nodes.push(node);
    }
    bvh
}

#[cfg(test)]
mod tests {
    use super::super::build::binary_tree;
    use super::*;
    use crate::lanes::{Lanes, LanesU32};

    /// Every triangle is reached, within its boxes, and no leaf or node is larger than its lanes.
    #[test]
    fn covers_every_triangle() {
        for count in [0usize, 1, 2, 7, 9, 100, 5000] {
            let corners: Vec<[[f32; 3]; 3]> = (0..count)
                .map(|i| {
                    let f = i as f32;
                    let p = [(f * 0.37).sin(), (f * 0.73).cos(), (f * 0.11).sin()];
                    [p, [p[0] + 0.02, p[1], p[2]], [p[0], p[1] + 0.03, p[2] + 0.01]]
                })
                .collect();
            let bvh = collapse(&binary_tree(&corners), &corners);
            let mut seen = vec![false; count];
            let mut todo: Vec<u32> = if bvh.nodes.is_empty() { vec![] } else { vec![0] };
            while let Some(n) = todo.pop() {
                let node = &bvh.nodes[n as usize];
                let (low, high, child) = (node.planes(0).array(), node.planes(3).array(), node.children().array());
                for lane in (0..8).filter(|&l| low[l] <= high[l]) {
                    if child[lane] & LEAF == 0 {
                        todo.push(child[lane]);
                    } else {
                        let leaf = &bvh.leaves[(child[lane] & !LEAF) as usize];
                        leaf.id.iter().for_each(|&id| seen[id as usize] = true);
                    }
                }
            }
            assert!(seen.iter().all(|&s| s), "{count} triangles");
        }
    }
}
