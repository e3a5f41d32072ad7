//! Tiles of neighbouring rays (kernel C): one test of a node serves 64 rays that run the same way, by intervals that
//! hold all of them; in a leaf, eight rays meet one triangle at a time.
//!
//! A tile whose rays run apart, or whose intervals let too much through, is handed to kernel D. Where tile after tile lets too much
//! through, as where triangles are as small as pixels, the next ones are not tried: twice as many each time.

use super::batch::BatchTracer;
use super::boxes::Met;
use super::group::{Group, farthest};
use super::layout::Node;
use super::ray::{RayLanes, RaySource, RaysFrom, prepare};
use super::stream::Streams;
use super::way::Way;
use super::{Bvh, Hit, LEAF, STACK};
use crate::columns::Rows;
use crate::lanes::{LanesU32, MAX_LANES, Mask, Wide};

/// Rays of a tile.
pub const TILE: usize = 64;
const GROUPS: usize = TILE / MAX_LANES;
/// Work after which a tile is loose: in node tests, which cost about as much as a leaf's test of two groups.
const LOOSE: usize = 640;
/// Most doubt, which a loose tile adds to and another takes back: tries pay where half of them are none. So many times the number of tiles
/// that are left out after a loose one has doubled.
const DOUBT: u32 = 6;
/// Relative error of an interval's ends against the distances of single rays, with room.
const INTERVAL_SLACK: f32 = 1.0 + 32.0 * f32::EPSILON;

/// What holds all rays of a tile.
#[derive(Clone, Copy, Debug)]
struct Interval {
    inv: [[f32; 2]; 3],
    /// The largest of the shears along the main axis.
    shear: f32,
    /// The origin that gives the least distance to near planes, and the largest to far ones.
    near_origin: [f32; 3],
    far_origin: [f32; 3],
}

impl Interval {
    /// Where the first of the rays may enter the boxes of a node and the last may leave them, before `t_max`.
    #[inline(always)]
    fn enter<W: Wide>(&self, node: &Node, way: &Way, t_max: f32) -> (W, W) {
        let (mut near, mut far) = (W::splat(0.0), W::splat(t_max));
        for axis in 0..3 {
            let (lo, hi) = (W::splat(self.inv[axis][0]), W::splat(self.inv[axis][1]));
            let n = node.row::<W>(way.near_row(axis)) - W::splat(self.near_origin[axis]);
            let f = node.row::<W>(way.far_row(axis)) - W::splat(self.far_origin[axis]);
            near = near.max((n * lo).min(n * hi));
            far = far.min((f * lo).max(f * hi));
        }
        (near * W::splat(2.0 - INTERVAL_SLACK), far * W::splat(INTERVAL_SLACK))
    }
}

/// Traces tiles of rays; holds its stack between batches.
#[derive(Clone, Debug)]
pub struct Tiles {
    groups: Box<[Group; GROUPS]>,
    near: Box<[f32; STACK]>,
    codes: Box<[u32; STACK]>,
    parents: Box<[u32; STACK]>,
    lanes: Box<[u32; STACK]>,
    loose: Streams,
    /// How often tiles were loose lately, and how many of the next are not tried.
    doubt: u32,
    left_out: u32,
}

impl Default for Tiles {
    fn default() -> Self {
        let stack = || Box::new([0; STACK]);
        let (groups, near) = (Box::new([Group::empty(); GROUPS]), Box::new([0.0; STACK]));
        Self {
            groups,
            near,
            codes: stack(),
            parents: stack(),
            lanes: stack(),
            loose: Streams::new(),
            doubt: 0,
            left_out: 0,
        }
    }
}

impl Tiles {
    /// Room for any batch.
    pub fn new() -> Self {
        Self::default()
    }
}

impl BatchTracer for Tiles {
    #[inline(always)]
    fn trace<W: Wide, const ANY: bool>(
        &mut self,
        bvh: &Bvh,
        count: usize,
        rays: &(impl RaySource + ?Sized),
        mut found: impl FnMut(usize, Hit),
    ) {
        // Loose tiles wait for each other, so that the other kernel gets long batches.
        let mut loose_from = 0;
        for first in (0..=count).step_by(TILE) {
            let n = TILE.min(count - first);
            let done = n > 0 && !bvh.is_empty() && self.tries() && self.tile::<W, ANY>(bvh, rays, first, n);
            if done || n < TILE {
                let end = if done { first } else { count };
                if loose_from < end {
                    let part = RaysFrom { rays, first: loose_from };
                    self.loose.trace::<W, ANY>(bvh, end - loose_from, &part, |i, hit| found(loose_from + i, hit));
                }
                loose_from = end.max(first + n);
            }
            if done {
                for i in 0..n {
                    found(first + i, self.groups[i / MAX_LANES].hit(i % MAX_LANES));
                }
            }
        }
    }
}

impl Tiles {
    /// Forgets what earlier batches showed, so that a job's hits are found the same way on any worker.
    pub fn restart(&mut self) {
        self.loose.restart();
        (self.doubt, self.left_out) = (0, 0);
    }

    /// Whether the next tile is worth a try.
    #[inline(always)]
    fn tries(&mut self) -> bool {
        let tries = self.left_out == 0;
        self.left_out = self.left_out.saturating_sub(1);
        tries
    }

    /// The kernel for rays that are no tiles.
    pub fn loose(&mut self) -> &mut Streams {
        &mut self.loose
    }

    /// Traces a tile; false if it is not one for this kernel.
    #[inline(always)]
    fn tile<W: Wide, const ANY: bool>(
        &mut self,
        bvh: &Bvh,
        rays: &(impl RaySource + ?Sized),
        first: usize,
        n: usize,
    ) -> bool {
        let Some((way, interval)) = self.load::<W>(rays, first, n) else { return false };
        let (tree, groups) = (bvh.tree_for::<ANY>(), n.div_ceil(MAX_LANES));
        let Self { groups: all, near, codes, parents, lanes, doubt, left_out, .. } = self;
        let groups = &mut all[..groups];
        let pad = interval.shear * tree.slack;
        let mut t_max = farthest::<W>(groups) + pad;
        (near[0], codes[0]) = (0.0, 0);
        let (mut top, mut work) = (1, 0);
        while top > 0 {
            top -= 1;
            let code = codes[top];
            if near[top] > t_max {
                continue;
            }
            work += 1;
            if code & LEAF == 0 {
                let node = tree.node(code);
                let met = Met::new(interval.enter::<W>(node, &way, t_max), node.order(way.octant()));
                met.near().store(&mut near[top..]);
                met.codes(node.children::<W>()).store(&mut codes[top..]);
                met.lanes().store(&mut lanes[top..]);
                W::Uint::splat(code).store(&mut parents[top..]);
                top += met.count();
                continue;
            }
            let (leaf, parent, lane) = (tree.leaf(code), tree.node(parents[top]), (lanes[top] & 7) as usize);
            let mut any = false;
            for group in groups.iter_mut() {
                if group.meets::<W>(parent, lane, &way, tree.slack) {
                    work += 2;
                    any |= if ANY { group.any::<W>(leaf, &way) } else { group.closest::<W>(leaf, &way) };
                }
            }
            work += 2;
            if any {
                t_max = farthest::<W>(groups) + pad;
            }
            if work > LOOSE {
                *left_out = (1 << *doubt) - 1;
                *doubt = DOUBT.min(*doubt + 1);
                return false;
            }
        }
        *doubt = doubt.saturating_sub(1);
        true
    }

    /// Sets the rays up, and finds what holds them; `None` if they do not run the same way.
    #[inline(always)]
    fn load<W: Wide>(&mut self, rays: &(impl RaySource + ?Sized), first: usize, n: usize) -> Option<(Way, Interval)> {
        let mut differ = W::Uint::splat(0);
        let mut ways = W::Uint::splat(0);
        let mut least = [W::splat(f32::INFINITY); 6];
        let mut largest = [W::splat(f32::NEG_INFINITY); 6];
        let mut shear = W::splat(0.0);
        let mut sum = W::splat(0.0);
        for (g, group) in self.groups[..n.div_ceil(MAX_LANES)].iter_mut().enumerate() {
            let at = g * MAX_LANES;
            let batch: RayLanes<W> = rays.rays(&Rows::range(first + at, MAX_LANES.min(n - at)));
            let (numbers, octant, permutation) = prepare(&batch);
            let way = octant.or(permutation.shl(3));
            if g == 0 {
                ways = W::Uint::splat(way.array()[0]);
            }
            differ = differ.or(way.xor(ways));
            let spread = [numbers[0], numbers[1], numbers[2], batch.origin.x, batch.origin.y, batch.origin.z];
            for (k, x) in spread.into_iter().enumerate() {
                least[k] = least[k].min(x);
                largest[k] = largest[k].max(x);
                sum = sum + x;
            }
            shear = shear.max(numbers[11].abs());
            sum = sum + batch.t_max;
            group.start(numbers, batch.t_max);
        }
        // A minimum forgets what stands before what is not a number.
        if differ.array() != [0; 8] || sum.eq(sum).bits() != 255 {
            return None;
        }
        let way = ways.array()[0];
        let mut range = [[0.0; 2]; 6];
        for (k, range) in range.iter_mut().enumerate() {
            *range = [least[k].min_lane(), -(-largest[k]).min_lane()];
        }
        let [inv_x, inv_y, inv_z, origin @ ..] = range;
        let inv = [inv_x, inv_y, inv_z];
        let up = |axis: usize| usize::from(way >> axis & 1 == 0);
        let near_origin = std::array::from_fn(|axis| origin[axis][up(axis)]);
        let far_origin = std::array::from_fn(|axis| origin[axis][1 - up(axis)]);
        Some((Way::new(way), Interval { inv, shear: -(-shear).min_lane(), near_origin, far_origin }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::work::visits;
    use super::super::{Many, Ray};
    use super::*;
    use crate::lanes::F32x8;

    /// A square of so many cells across, each of two triangles, before the origin.
    fn wall(cells: usize) -> Bvh {
        let step = 1.0 / cells as f32;
        let at = |i: usize, k: usize| [i as f32 * step - 0.5, k as f32 * step - 0.5, 2.0];
        let cell = |i: usize, k: usize| {
            [[at(i, k), at(i + 1, k), at(i, k + 1)], [at(i + 1, k + 1), at(i, k + 1), at(i + 1, k)]]
        };
        let corners: Vec<_> = (0..cells).flat_map(|i| (0..cells).flat_map(move |k| cell(i, k))).collect();
        Bvh::build(&corners)
    }

    /// What a tile is for runs as one; what runs apart, or meets everything, is left to the other kernel.
    #[test]
    fn tiles_take_what_runs_together() {
        let bvh = wall(16);
        let fan = |spread: f32, turn: f32| -> Vec<Ray> {
            let direction = |i: usize| [(i % 8) as f32 * spread + turn, (i / 8) as f32 * spread + turn, 2.0];
            (0..TILE).map(|i| Ray { origin: [0.0; 3], direction: direction(i), t_max: f32::INFINITY }).collect()
        };
        let mut tiles = Tiles::new();
        let mut taken = |rays: &[Ray]| tiles.tile::<F32x8, false>(&bvh, rays, 0, TILE);
        assert!(taken(&fan(0.01, 0.02)), "neighbouring pixels");
        assert!(!taken(&fan(0.01, -0.035)), "to both sides of two axes");
        assert!(!taken(&fan(0.6, 0.02)), "with different longest axes");
    }

    /// Where all tiles are loose, fewer and fewer are tried, until a job begins.
    #[test]
    fn loose_tiles_are_left_out() {
        const COUNT: usize = 64 * TILE;
        let (bvh, mut tiles) = (wall(128), Tiles::new());
        let direction = |i: usize| [(i % 8) as f32 / 17.0 + 0.01, (i / 8 % 8) as f32 / 17.0 + 0.01, 2.0];
        let ray = |i| Ray { origin: [0.0; 3], direction: direction(i), t_max: f32::INFINITY };
        let rays: Vec<Ray> = (0..COUNT).map(ray).collect();
        fn cost(kernel: &mut impl BatchTracer, bvh: &Bvh, rays: &[Ray]) -> [u64; 2] {
            let mut found = 0;
            let cost = visits(|| kernel.closest(bvh, COUNT, rays, |_, hit| found += usize::from(hit.is_some())));
            assert_eq!(found, COUNT);
            cost
        }
        let one = visits(|| assert!(!tiles.tile::<F32x8, false>(&bvh, rays.as_slice(), 0, TILE)));
        let many = cost(&mut Many::new(), &bvh, &rays);
        let tries = |n: u64| [0, 1].map(|k| many[k] + n * one[k]);
        tiles.loose().allow(false);
        tiles.restart();
        // The first two, and one after leaving out 1, 3, 7, 15 and 31.
        assert_eq!(cost(&mut tiles, &bvh, &rays), tries(7));
        assert_eq!(cost(&mut tiles, &bvh, &rays), tries(1));
        tiles.restart();
        assert_eq!(cost(&mut tiles, &bvh, &rays), tries(7));
        // One that is none lets more be tried.
        tiles.restart();
        tiles.doubt = 2;
        let straight = vec![rays[9]; TILE];
        assert!(tiles.tile::<F32x8, false>(&bvh, straight.as_slice(), 0, TILE));
        assert_eq!((tiles.doubt, tiles.left_out), (1, 0));
    }

    /// Boxes are padded in proportion to how far a ray gets along its main axis: for all rays of a tile as for the one that needs most.
    #[test]
    fn tiles_are_padded_for_all_of_their_rays() {
        let ray = |i: usize| Ray { origin: [0.0; 3], direction: [0.1, 0.1, 1.0 + i as f32], t_max: f32::INFINITY };
        let rays: Vec<Ray> = (0..TILE).map(ray).collect();
        let (_, interval) = Tiles::new().load::<F32x8>(rays.as_slice(), 0, TILE).unwrap();
        assert_eq!(interval.shear, 1.0);
    }
}
