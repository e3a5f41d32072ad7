//! From the binary tree to the 8-wide one of least expected cost: a dynamic programme over the ways to cover a subtree
//! with one to eight roots (in the manner of Ylitie, Karras and Laine 2017, section 3).

use super::arena::{Arena, Block};
use super::bounds::largest_extent;
use super::build::BinaryNode;
use super::layout::{Leaf, Node};
use super::parallel::*;
use super::{Bvh, DISTANCE_ERROR, LEAF, MAX_LEAF};
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering::Relaxed};

const WIDTH: usize = 8;
/// Cost of a node step per unit of surface. That of a leaf is [`LeafCost`].
const NODE_COST: f32 = 1.0;
/// Boxes of triangles up to which time goes into arithmetic; in larger trees, which leave the cache of a core, into
/// fetching blocks.
const SMALL: usize = 1 << 16;
/// Bytes of the tree for each triangle at most, where leaves could be less full than they are,
const MOST_BYTES: usize = 100;
/// and those that a tree of any number of triangles may have.
const ANY_BYTES: usize = 1 << 16;
/// Subtrees that are planned in parallel, at least, where the tree is large.
const PARTS: usize = 256;

/// What a leaf of n triangles costs: `visit + n * each` per unit of its surface, and `room` for the memory.
#[derive(Clone, Copy, Debug)]
struct LeafCost {
    visit: f32,
    each: f32,
    room: f32,
}

impl LeafCost {
    /// Where blocks are fetched: a leaf is as much as a node, however many triangles it holds.
    const FETCHED: Self = Self { visit: 1.0, each: 0.0, room: 0.0 };

    /// Where they are at hand: streams and tiles test one triangle after the other, for eight rays each.
    const fn at_hand(room: f32) -> Self {
        Self { visit: 0.7, each: 0.13, room }
    }
    fn of(&self, area: f32, triangles: usize) -> f32 {
        area * (self.visit + self.each * triangles as f32) + self.room
    }
}

/// What the dynamic programme knows of each binary node, written once per node, children first. Atomic because the
/// subtrees of different tasks lie mixed.
struct Plan<'a> {
    tree: &'a [BinaryNode],
    /// `cost[n][k - 1]`: least cost of covering the subtree of node n with at most k roots.
    cost: Vec<[AtomicU32; WIDTH]>,
    /// Triangles below, where they fit in a leaf, else one more than that.
    triangles: Vec<AtomicU8>,
    /// Triangles of a leaf at most.
    leaf: usize,
    leaf_cost: LeafCost,
}

impl<'a> Plan<'a> {
    fn new(tree: &'a [BinaryNode], leaf: usize, leaf_cost: LeafCost) -> Self {
        let empty = tree.par_iter().map(|_| (Default::default(), AtomicU8::new(1)));
        let (cost, triangles) = empty.unzip();
        let plan = Self { tree, cost, triangles, leaf: leaf.clamp(1, MAX_LEAF), leaf_cost };
        let (top, parts) = cut(tree);
        parts.par_iter().for_each(|&n| preorder(tree, n).into_iter().rev().for_each(|n| plan.solve(n)));
        top.into_iter().rev().for_each(|n| plan.solve(n));
        plan
    }
    /// Costs of node `n`; those of its children are known.
    fn solve(&self, n: usize) {
        let area = self.area(n);
        let mut costs = [self.leaf_cost.of(area, 1); WIDTH];
        if !self.tree[n].is_leaf() {
            let first = self.tree[n].first_index as usize;
            let below = [first, first + 1].map(|child| self.triangles[child].load(Relaxed));
            self.triangles[n].store((below[0] + below[1]).min(WIDTH as u8 + 1), Relaxed);
            let children = [first, first + 1].map(|child| self.costs(child));
            let shared: [f32; WIDTH] = std::array::from_fn(|k| best_split(&children, k + 1).0);
            let mut best = self.leaf_cost(n).min(area * NODE_COST + shared[WIDTH - 1]);
            for (cost, with_k) in costs.iter_mut().zip(shared) {
                best = best.min(with_k);
                *cost = best;
            }
        }
        self.cost[n].iter().zip(costs).for_each(|(to, cost)| to.store(cost.to_bits(), Relaxed));
    }
    fn area(&self, n: usize) -> f32 {
        self.tree[n].aabb().half_area()
    }
    fn costs(&self, n: usize) -> [f32; WIDTH] {
        self.cost[n].each_ref().map(|cost| f32::from_bits(cost.load(Relaxed)))
    }
    fn leaf_cost(&self, n: usize) -> f32 {
        let triangles = self.triangles[n].load(Relaxed) as usize;
        if triangles <= self.leaf { self.leaf_cost.of(self.area(n), triangles) } else { f32::INFINITY }
    }
    /// (cost, roots for the left child) of covering inner node `n` by covering its children with `k` >= 2 roots.
    fn split(&self, n: usize, k: usize) -> (f32, usize) {
        let first = self.tree[n].first_index as usize;
        best_split(&[self.costs(first), self.costs(first + 1)], k)
    }
    /// Adds the at most `k` roots of the best cover of `n`.
    fn roots(&self, n: usize, k: usize, out: &mut Wide) {
        let mut todo = vec![(n, k)];
        while let Some((n, mut k)) = todo.pop() {
            let cost = self.costs(n);
            while k > 1 && cost[k - 2] <= cost[k - 1] {
                k -= 1;
            }
            if k == 1 || self.tree[n].is_leaf() {
                out.push(n);
            } else {
                let (left, first) = (self.split(n, k).1, self.tree[n].first_index as usize);
                todo.push((first + 1, k - left));
                todo.push((first, left));
            }
        }
    }
    fn is_leaf(&self, n: usize) -> bool {
        self.tree[n].is_leaf() || self.leaf_cost(n) <= self.area(n) * NODE_COST + self.split(n, WIDTH).0
    }
    /// The children of the wide node at `n`.
    fn wide(&self, n: usize) -> Wide {
        let mut wide = Wide { roots: [0; WIDTH], codes: [0; WIDTH], len: 0 };
        if self.is_leaf(n) {
            wide.push(n);
        } else {
            let (left, first) = (self.split(n, WIDTH).1, self.tree[n].first_index as usize);
            self.roots(first, left, &mut wide);
            self.roots(first + 1, WIDTH - left, &mut wide);
        }
        wide
    }
    /// The distinct triangles below `n`, which holds at most eight.
    fn ids(&self, n: usize) -> Vec<u32> {
        let below = preorder(self.tree, n).into_iter().map(|n| &self.tree[n]).filter(|node| node.is_leaf());
        let mut ids: Vec<u32> = below.map(|node| node.first_index).collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    }
}

/// (cost, roots for the left child) of covering two children with `k` roots in all; infinite for fewer than 2.
fn best_split([left, right]: &[[f32; WIDTH]; 2], k: usize) -> (f32, usize) {
    (1..k).map(|l| (left[l - 1] + right[k - l - 1], l)).fold((f32::INFINITY, 1), |a, b| if b.0 < a.0 { b } else { a })
}

/// Nodes of the subtree of `root`, parents before children.
fn preorder(tree: &[BinaryNode], root: usize) -> Vec<usize> {
    let (mut order, mut todo) = (Vec::new(), vec![root]);
    while let Some(n) = todo.pop() {
        order.push(n);
        if !tree[n].is_leaf() {
            todo.extend([tree[n].first_index as usize + 1, tree[n].first_index as usize]);
        }
    }
    order
}

/// Nodes at the top, parents before children, and the roots of the subtrees below them.
fn cut(tree: &[BinaryNode]) -> (Vec<usize>, Vec<usize>) {
    let (mut top, mut parts) = (Vec::new(), vec![0]);
    while parts.len() < PARTS && parts.iter().any(|&n| !tree[n].is_leaf()) {
        let (leaves, inner): (Vec<_>, Vec<_>) = parts.into_iter().partition(|&n| tree[n].is_leaf());
        parts = leaves;
        parts.extend(inner.iter().flat_map(|&n| [0, 1].map(|side| tree[n].first_index as usize + side)));
        top.extend(inner);
    }
    (top, parts)
}

/// An inner node of the wide tree: the binary nodes that are its children, and their codes.
struct Wide {
    roots: [u32; WIDTH],
    codes: [u32; WIDTH],
    len: usize,
}

impl Wide {
    fn push(&mut self, n: usize) {
        self.roots[self.len] = n as u32;
        self.len += 1;
    }
    fn blocks(&self) -> usize {
        let leaves = self.codes[..self.len].iter().filter(|&code| code & LEAF != 0).count();
        Node::BLOCKS + leaves * Leaf::BLOCKS
    }
}

/// Where everything of a wide tree is.
struct Outline {
    /// Inner nodes in depth-first order; each is followed by its leaves.
    wides: Vec<Wide>,
    /// Blocks in all.
    blocks: usize,
    /// Nodes on the longest way from the root.
    deepest: usize,
}

fn outline(plan: &Plan<'_>) -> Outline {
    let (mut wides, mut blocks, mut deepest) = (Vec::<Wide>::new(), 0, 0);
    // Each entry: a binary node that becomes an inner node, the lane that leads to it, its depth.
    let mut todo = vec![(0, None::<(usize, usize)>, 1)];
    while let Some((n, parent, depth)) = todo.pop() {
        if let Some((wide, lane)) = parent {
            wides[wide].codes[lane] = blocks as u32;
        }
        deepest = deepest.max(depth);
        let mut wide = plan.wide(n);
        blocks += Node::BLOCKS;
        for lane in (0..wide.len).rev() {
            let root = wide.roots[lane] as usize;
            if !plan.is_leaf(root) {
                todo.push((root, Some((wides.len(), lane)), depth + 1));
            }
        }
        for lane in 0..wide.len {
            if plan.is_leaf(wide.roots[lane] as usize) {
                wide.codes[lane] = LEAF | blocks as u32;
                blocks += Leaf::BLOCKS;
            }
        }
        wides.push(wide);
    }
    Outline { wides, blocks, deepest }
}

/// The cheapest wide tree that takes no more than its memory. Leaves that are seldom met are filled first.
fn cheapest(tree: &[BinaryNode], leaf: usize, triangles: usize) -> (Plan<'_>, Outline) {
    let boxes = tree.len().div_ceil(2);
    if boxes <= SMALL {
        let area: f32 = tree.iter().filter(|node| node.is_leaf()).map(|node| node.aabb().half_area()).sum();
        let most = ANY_BYTES.max(MOST_BYTES * triangles) / size_of::<Block>();
        for room in [0.0, 0.25, 0.5, 1.0, 2.0] {
            let plan = Plan::new(tree, leaf, LeafCost::at_hand(room * area / boxes as f32));
            let outline = outline(&plan);
            if outline.blocks <= most {
                return (plan, outline);
            }
        }
    }
    let plan = Plan::new(tree, leaf, LeafCost::FETCHED);
    let outline = outline(&plan);
    (plan, outline)
}

/// Writes a node and its leaves.
fn fill(plan: &Plan<'_>, wide: &Wide, mut out: &mut [Block], corners: &[[[f32; 3]; 3]]) {
    let mut node = Node::empty();
    for (lane, &root) in wide.roots[..wide.len].iter().enumerate() {
        let bounds = plan.tree[root as usize].aabb();
        node.set(lane, bounds.min.to_array(), bounds.max.to_array(), wide.codes[lane]);
    }
    node.set_orders();
    out = node.write(out);
    for (&root, &code) in wide.roots.iter().zip(&wide.codes[..wide.len]) {
        if code & LEAF != 0 {
            out = Leaf::new(&plan.ids(root as usize), corners).write(out);
        }
    }
}

/// Entries of a traversal stack that are used at most where `depth` nodes are on the longest way: each leaves at most
/// seven, eight are written at a time, and there may be eight below all.
fn stack_bound(depth: usize) -> usize {
    7 * depth + 2 * WIDTH
}

/// The 8-wide tree: nodes in depth-first order, the leaves of each right behind it.
pub(super) fn collapse(tree: &[BinaryNode], corners: &[[[f32; 3]; 3]], leaf: usize) -> Bvh {
    if tree.is_empty() {
        return Bvh { arena: Arena::new(0), nodes: 0, leaves: 0, slack: 0.0, stack_bound: stack_bound(1) };
    }
    let (plan, Outline { wides, blocks, deepest }) = cheapest(tree, leaf, corners.len());
    let mut arena = Arena::new(blocks);
    let mut rest = arena.blocks_mut();
    let mut tasks = Vec::with_capacity(wides.len());
    for wide in &wides {
        let (own, behind) = rest.split_at_mut(wide.blocks());
        tasks.push((wide, own));
        rest = behind;
    }
    tasks.into_par_iter().for_each(|(wide, own)| fill(&plan, wide, own, corners));
    let leaves = (blocks - wides.len() * Node::BLOCKS) / Leaf::BLOCKS;
    let slack = DISTANCE_ERROR * largest_extent(corners);
    Bvh { arena, nodes: wides.len(), leaves, slack, stack_bound: stack_bound(deepest) }
}

#[cfg(test)]
mod tests {
    use super::super::bounds::Reference;
    use super::super::build::binary_tree;
    use super::super::sah::DEPTH;
    use super::super::{BuildOptions, Quality, STACK};
    use super::*;
    use crate::lanes::{F32x8, Lanes, LanesU32};
    use std::collections::HashMap;

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
            let bvh = collapse(&binary_tree(&corners, Quality::Best, true), &corners, MAX_LEAF);
            let mut seen = vec![false; count];
            let mut todo: Vec<u32> = if bvh.is_empty() { vec![] } else { vec![0] };
            while let Some(n) = todo.pop() {
                let node = bvh.tree().node(n);
                let planes = |row| node.row::<F32x8>(row).array();
                let (low, high, child) = (planes(0), planes(3), node.children::<F32x8>().array());
                for lane in (0..8).filter(|&l| low[l] <= high[l]) {
                    if child[lane] & LEAF == 0 {
                        todo.push(child[lane]);
                    } else {
                        (0..8).for_each(|i| seen[bvh.tree().leaf(child[lane]).id(i) as usize] = true);
                    }
                }
            }
            assert!(seen.iter().all(|&s| s), "{count} triangles");
        }
    }

    /// Least cost of covering the subtree of `n` with at most `k` roots, tried in all ways.
    fn least(plan: &Plan<'_>, n: usize, k: usize, known: &mut HashMap<(usize, usize), f32>) -> f32 {
        if let Some(&cost) = known.get(&(n, k)) {
            return cost;
        }
        let (tree, area) = (plan.tree, plan.area(n));
        let triangles = preorder(tree, n).into_iter().filter(|&n| tree[n].is_leaf()).count();
        let mut cost = if triangles <= plan.leaf { plan.leaf_cost.of(area, triangles) } else { f32::INFINITY };
        if !tree[n].is_leaf() {
            let first = tree[n].first_index as usize;
            let mut split = |k: usize| {
                (1..k)
                    .map(|left| least(plan, first, left, known) + least(plan, first + 1, k - left, known))
                    .fold(f32::INFINITY, f32::min)
            };
            cost = cost.min(area * NODE_COST + split(WIDTH));
            cost = (2..=k).map(split).fold(cost, f32::min);
        }
        known.insert((n, k), cost);
        cost
    }

    /// No way to make wide nodes of a binary tree is cheaper, and the tree that is made costs what is planned.
    #[test]
    fn the_wide_tree_is_the_cheapest() {
        let costs = [LeafCost::FETCHED, LeafCost::at_hand(0.0), LeafCost::at_hand(0.1)];
        let cases = [(5, 8), (12, 1), (14, 3), (14, 8), (90, 1), (90, 8)];
        for ((count, leaf), leaf_cost) in cases.into_iter().flat_map(|case| costs.map(|cost| (case, cost))) {
            let name = format!("{count} boxes, leaves of {leaf}, {leaf_cost:?}");
            let refs = super::super::bounds::tests::references(count);
            let tree = super::super::sah::tree::<16>(refs);
            let plan = Plan::new(&tree, leaf, leaf_cost);
            let mut known = HashMap::new();
            for k in 1..=WIDTH {
                assert_eq!(plan.costs(0)[k - 1], least(&plan, 0, k, &mut known), "{name}, {k} roots");
            }
            let Outline { wides, blocks, deepest } = outline(&plan);
            let mut seen = Vec::new();
            let (mut cost, mut leaves) = (if plan.is_leaf(0) { 0.0 } else { plan.area(0) * NODE_COST }, 0);
            for wide in &wides {
                for (&root, &code) in wide.roots.iter().zip(&wide.codes[..wide.len]) {
                    let area = plan.area(root as usize);
                    if code & LEAF == 0 {
                        cost += area * NODE_COST;
                    } else {
                        let ids = plan.ids(root as usize);
                        assert!((1..=leaf).contains(&ids.len()), "{name}: {} triangles in a leaf", ids.len());
                        cost += leaf_cost.of(area, ids.len());
                        seen.extend(ids);
                        leaves += 1;
                    }
                }
            }
            let planned = plan.costs(0)[0];
            assert!((cost - planned).abs() < 1e-4 * planned, "{name}: {cost} instead of {planned}");
            seen.sort_unstable();
            assert_eq!(seen, (0..count).collect::<Vec<_>>());
            assert_eq!(blocks, wides.len() * Node::BLOCKS + leaves * Leaf::BLOCKS);
            assert!((1..=wides.len()).contains(&deepest));
        }
    }

    /// Triangles of a leaf cost in small trees, and its memory where a tree of a fine floor would else be too large.
    #[test]
    fn leaves_of_small_trees_are_less_full_as_far_as_memory_allows() {
        let floor = |count: usize| {
            let square = |i: usize| [(i / 2 % 64) as f32, (i / 128) as f32];
            let reference =
                |(i, [x, y]): (usize, [f32; 2])| Reference::new([x, y, 0.0], [x + 1.0, y + 1.0, 0.0], i as u32);
            (0..count).map(square).enumerate().map(reference).collect::<Vec<_>>()
        };
        let soup = |count: usize| super::super::bounds::tests::references(count as u32);
        let cases = [soup(100), soup(3000), floor(50), floor(8000), floor(SMALL), floor(SMALL + 1)];
        let of = |refs: Vec<Reference>| {
            let count = refs.len();
            let tree = super::super::sah::tree::<16>(refs);
            let (plan, Outline { blocks, .. }) = cheapest(&tree, MAX_LEAF, count);
            let most = (100 * count).max(1 << 16) / size_of::<Block>();
            let free = outline(&Plan::new(&tree, MAX_LEAF, LeafCost::at_hand(0.0))).blocks;
            let LeafCost { each, room, .. } = plan.leaf_cost;
            assert!(blocks <= most, "{count}: {blocks} blocks");
            assert_eq!(each > 0.0, count <= SMALL, "{count}");
            assert_eq!(room > 0.0, count <= SMALL && free > most, "{count}: {free} blocks");
            room > 0.0
        };
        assert_eq!(cases.map(of)[..3], [false, true, false]);
    }

    fn shells(count: usize) -> Vec<[[f32; 3]; 3]> {
        (1..=count).map(|i| i as f32).map(|s| [[-s, -s, -s], [s, s, -s], [0.0, 0.0, s]]).collect()
    }

    /// The same bytes on any number of threads.
    #[test]
    fn does_not_depend_on_threads() {
        let cloud: Vec<[[f32; 3]; 3]> = (0..60_000)
            .map(|i| {
                let p = [(i as f32 * 0.37).sin(), (i as f32 * 0.73).cos(), (i as f32 * 0.11).sin()];
                let size = if i % 100 == 0 { 0.3 } else { 0.01 };
                [p, [p[0] + size, p[1], p[2]], [p[0], p[1] + size, p[2] + size]]
            })
            .collect();
        for corners in [cloud, shells(5000)] {
            for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
                let [one, two, five] = [1, 2, 5].map(|threads| {
                    Bvh::build_with(&corners, &BuildOptions { quality, threads, ..BuildOptions::default() }).unwrap()
                });
                let bytes = |bvh: &Bvh| bytemuck::cast_slice::<Block, u8>(bvh.arena.blocks()).to_vec();
                assert!(bytes(&one) == bytes(&two) && bytes(&one) == bytes(&five), "{quality:?}");
            }
        }
    }

    /// Nodes on the longest way through a binary tree.
    fn depth(tree: &[BinaryNode]) -> usize {
        let (mut deepest, mut todo) = (0, vec![(0, 1)]);
        while let Some((n, depth)) = todo.pop() {
            deepest = deepest.max(depth);
            if !tree[n].is_leaf() {
                let first = tree[n].first_index as usize;
                todo.extend([(first, depth + 1), (first + 1, depth + 1)]);
            }
        }
        deepest
    }

    /// No input makes a way longer than the traversal stacks are made for.
    #[test]
    fn depth_is_bounded() {
        let line = |x: f32| [[x, 0.0, 0.0], [x + 0.5, 0.0, 0.0], [x, 0.5, 0.0]];
        let scaled = |s: f32| [[s, s, s], [s * 1.1, s, s], [s, s * 1.1, s]];
        let cases = [
            ("coincident", vec![line(0.0); 100_000]),
            ("nested", shells(100_000)),
            ("evenly spaced", (0..100_000).map(|i| line(i as f32)).collect()),
            ("farther and farther apart", (0..100_000).map(|i| line(i as f32 * i as f32)).collect()),
            ("growing exponentially", (0..20_000).map(|i| scaled((2.0f32).powf(i as f32 * 0.012 - 120.0))).collect()),
            ("exponentially apart", (0..20_000).map(|i| line((1.9f32).powi(i / 200 - 40))).collect()),
            (
                "the same, nested",
                (0..100).map(|i| 2.0f32.powi(i - 70)).flat_map(|s| [[[-s; 3], [s; 3], [s, 0.0, -s]]; 99]).collect(),
            ),
        ];
        let mut deepest = 0;
        for (name, corners) in cases {
            for quality in [Quality::Fast, Quality::Balanced] {
                let found = depth(&binary_tree(&corners, quality, false));
                assert!(found <= DEPTH as usize, "{name}, {quality:?}: {found}");
                deepest = deepest.max(found);
            }
            for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
                let bvh = Bvh::build_with(&corners, &BuildOptions { quality, threads: 2, ..BuildOptions::default() })
                    .unwrap();
                assert!(bvh.stack_bound <= STACK, "{name}, {quality:?}: {}", bvh.stack_bound);
            }
        }
        assert!(stack_bound(DEPTH as usize) <= STACK);
        // Seven of each node on the way, eight below the last, and eight that are written beyond.
        assert_eq!([1, 2, 64].map(stack_bound), [7 + 8 + 8, 2 * 7 + 8 + 8, 64 * 7 + 8 + 8]);
        assert!(deepest > 40, "only {deepest}: nothing here comes near the bound");
    }
}
