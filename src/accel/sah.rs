//! The binary tree, top down: each set of boxes is cut where the surface area heuristic is least (Wald 2007, "On fast
//! Construction of SAH-based Bounding Volume Hierarchies": binned; exactly where few boxes are left).
//!
//! The tree depends on the boxes and their order alone, not on the number of threads.

use super::bounds::{Bounds, Extent, Reference, SHARED_BINS, centre, half_area, nothing};
use super::build::BinaryNode;
use super::parallel::join;
use crate::lanes::{F32x8, Lanes, LanesU32, Mask, U32x8, WideU32};

/// Nodes on the longest way from the root to a leaf, at most: sets are halved by number from where their size leaves
/// no other choice.
pub(super) const DEPTH: u32 = 70;

/// Sets up to this size are cut at the best of all places.
const EXACT: usize = 8;
/// Sets from this size on are handed to other threads.
const SHARED: usize = 8192;

/// Where a set is cut.
#[derive(Clone, Copy, Debug)]
struct Cut {
    cost: f32,
    axis: usize,
    /// The last bin of the left side, or the number of boxes on it.
    at: usize,
}

const NO_CUT: Cut = Cut { cost: f32::INFINITY, axis: 0, at: 0 };

/// Maps centres to bins: the nearest of equally spaced places.
#[derive(Clone, Copy, Debug)]
struct Binning<const BINS: usize> {
    lo: F32x8,
    scale: F32x8,
}

impl<const BINS: usize> Binning<BINS> {
    fn new(centres: Bounds) -> Self {
        let c = centres.array();
        let scale = |i: usize| {
            let extent = -c[i + 4] - c[i];
            let scale = (BINS - 1) as f32 / extent;
            if scale.is_finite() { scale } else { 0.0 }
        };
        Self { lo: centres, scale: F32x8::from_fn(|i| if i < 3 { scale(i) } else { 0.0 }) }
    }
    /// The bins of a box, by axis in the first three lanes.
    #[inline(always)]
    fn bins(&self, b: F32x8) -> U32x8 {
        // Adding 2^23 rounds, and leaves the integer in the low bits.
        let place = (centre(b) - self.lo) * self.scale + F32x8::splat(8_388_608.0);
        place.to_bits().and(U32x8::splat(BINS as u32 - 1))
    }
}

/// Boxes and their number by axis and bin.
#[derive(Clone)]
struct Histogram<const BINS: usize> {
    bounds: [[Bounds; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl<const BINS: usize> Histogram<BINS> {
    fn of(refs: &[Reference], binning: &Binning<BINS>) -> Self {
        if refs.len() >= SHARED_BINS {
            let (left, right) = refs.split_at(refs.len() / 2);
            let (a, b) = join(|| Self::of(left, binning), || Self::of(right, binning));
            return a.join(&b);
        }
        let mut h = Self { bounds: [[nothing(); BINS]; 3], counts: [[0; BINS]; 3] };
        for r in refs {
            let b = r.lanes();
            let bins = binning.bins(b).array();
            for (axis, bin) in bins.into_iter().enumerate().take(3) {
                let bin = bin as usize % BINS;
                h.bounds[axis][bin] = h.bounds[axis][bin].min(b);
                h.counts[axis][bin] += 1;
            }
        }
        h
    }
    fn join(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.bounds[axis][bin] = self.bounds[axis][bin].min(other.bounds[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }
    fn best(&self) -> Cut {
        let mut best = NO_CUT;
        for axis in 0..3 {
            let (bounds, counts) = (&self.bounds[axis], &self.counts[axis]);
            let mut right = [f32::INFINITY; BINS];
            let (mut all, mut n) = (nothing(), 0);
            for bin in (1..BINS).rev() {
                (all, n) = (all.min(bounds[bin]), n + counts[bin]);
                if n > 0 {
                    right[bin] = half_area(all) * n as f32;
                }
            }
            let (mut all, mut n) = (nothing(), 0);
            for bin in 0..BINS - 1 {
                (all, n) = (all.min(bounds[bin]), n + counts[bin]);
                if n > 0 {
                    let cost = half_area(all) * n as f32 + right[bin + 1];
                    if cost < best.cost {
                        best = Cut { cost, axis, at: bin };
                    }
                }
            }
        }
        best
    }
}

/// The places of up to eight keys in ascending order, equal ones in their own: which key is first, second and so on.
/// Lanes behind the keys hold infinity.
#[inline(always)]
fn order(keys: F32x8) -> [u8; EXACT] {
    let mut order = [0; EXACT];
    let each = keys.array();
    for (i, &key) in each.iter().enumerate() {
        let key = F32x8::splat(key);
        let before = keys.lt(key).bits().count_ones() + (keys.eq(key).bits() & ((1 << i) - 1)).count_ones();
        order[before as usize % EXACT] = i as u8;
    }
    order
}

/// The best of all cuts of two to eight boxes, along whose axis they are left sorted.
fn cut_exactly(refs: &mut [Reference]) -> usize {
    let n = refs.len();
    if n == 2 {
        return 1;
    }
    let boxes: [F32x8; EXACT] = std::array::from_fn(|i| if i < n { refs[i].lanes() } else { nothing() });
    let centres = boxes.map(|b| centre(b).array());
    let keys = |axis: usize| F32x8::from_fn(|i| if i < n { centres[i][axis] } else { f32::INFINITY });
    let (mut best, mut sorted) = (NO_CUT, [0, 1, 2, 3, 4, 5, 6, 7]);
    for (axis, keys) in [keys(0), keys(1), keys(2)].into_iter().enumerate() {
        let order = order(keys);
        let at = |i: usize| boxes[order[i % EXACT] as usize % EXACT];
        let mut right = [0.0; EXACT];
        let mut all = nothing();
        for i in (1..n).rev() {
            all = all.min(at(i));
            right[i % EXACT] = half_area(all) * (n - i) as f32;
        }
        let (mut all, before) = (nothing(), best.cost);
        for i in 1..n {
            all = all.min(at(i - 1));
            let cost = half_area(all) * i as f32 + right[i % EXACT];
            if cost < best.cost {
                best = Cut { cost, axis, at: i };
            }
        }
        if best.cost < before {
            sorted = order;
        }
    }
    for (r, i) in refs.iter_mut().zip(sorted) {
        boxes[i as usize % EXACT].store(&mut r.0);
    }
    if best.at == 0 { n / 2 } else { best.at }
}

/// Moves the boxes of the left side to the front; how many these are, and both extents.
fn partition<const BINS: usize>(refs: &mut [Reference], binning: &Binning<BINS>, cut: Cut) -> (usize, [Extent; 2]) {
    let lane = U32x8::splat(cut.axis as u32);
    let last = F32x8::splat(cut.at as f32);
    let none = Extent { bounds: nothing(), centres: nothing() };
    let (mut l, mut r) = (none, none);
    let mut left = 0;
    for i in 0..refs.len() {
        let b = refs[i].lanes();
        let goes_left = F32x8::from_u24(binning.bins(b).permute(lane)).le(last);
        let (c, off) = (centre(b), nothing());
        l.bounds = l.bounds.min(F32x8::select(goes_left, b, off));
        r.bounds = r.bounds.min(F32x8::select(goes_left, off, b));
        l.centres = l.centres.min(F32x8::select(goes_left, c, off));
        r.centres = r.centres.min(F32x8::select(goes_left, off, c));
        refs.swap(i, left);
        left += (goes_left.bits() & 1) as usize;
    }
    (left, [l, r])
}

/// Moves boxes so that the first, at least one and not all, are the left side; how many these are, and both extents.
fn cut<const BINS: usize>(refs: &mut [Reference], extent: &Extent, depth: u32) -> (usize, [Extent; 2]) {
    let whole = |refs: &[Reference], left: usize| (left, [Extent::of(&refs[..left]), Extent::of(&refs[left..])]);
    // Halving from here on takes as many levels as the logarithm of the size, rounded up.
    if depth + refs.len().next_power_of_two().ilog2() + 1 >= DEPTH {
        return whole(refs, refs.len() / 2);
    }
    if refs.len() <= EXACT {
        let left = cut_exactly(refs);
        return whole(refs, left);
    }
    let binning = Binning::<BINS>::new(extent.centres);
    let best = Histogram::of(refs, &binning).best();
    if best.cost == f32::INFINITY {
        return whole(refs, refs.len() / 2);
    }
    partition(refs, &binning, best)
}

/// Writes the subtree of `refs`: its root to `slot`, the rest to `below`, which begins at `base` in the whole.
fn fill<const BINS: usize>(
    refs: &mut [Reference],
    extent: &Extent,
    slot: &mut BinaryNode,
    below: &mut [BinaryNode],
    at: (u32, u32),
) {
    let (base, depth) = at;
    if let [only] = refs {
        *slot = BinaryNode::new(extent.aabb(), 1, only.id());
        return;
    }
    *slot = BinaryNode::new(extent.aabb(), 0, base);
    let (left, [extent_l, extent_r]) = cut::<BINS>(refs, extent, depth);
    let shared = refs.len() >= SHARED;
    let (l, r) = refs.split_at_mut(left);
    let (pair, below) = below.split_at_mut(2);
    let (below_l, below_r) = below.split_at_mut(2 * (left - 1));
    let (first, second) = pair.split_at_mut(1);
    let base_r = base + 2 * left as u32;
    let mut do_left = || fill::<BINS>(l, &extent_l, &mut first[0], below_l, (base + 2, depth + 1));
    let mut do_right = || fill::<BINS>(r, &extent_r, &mut second[0], below_r, (base_r, depth + 1));
    if shared {
        join(do_left, do_right);
    } else {
        do_left();
        do_right();
    }
}

/// The tree over these boxes, root first, children in pairs behind their parents. At least one box; bins per axis are a
/// power of two.
pub(super) fn tree<const BINS: usize>(mut refs: Vec<Reference>) -> Vec<BinaryNode> {
    let mut nodes = vec![BinaryNode::default(); 2 * refs.len() - 1];
    let (root, below) = nodes.split_at_mut(1);
    let extent = Extent::of(&refs);
    fill::<BINS>(&mut refs, &extent, &mut root[0], below, (1, 0));
    nodes
}

#[cfg(test)]
mod tests {
    use super::super::bounds::tests::references;
    use super::*;

    /// What the heuristic says of two sets; infinite where one is empty.
    fn cost(left: &[Reference], right: &[Reference]) -> f32 {
        let of = |refs: &[Reference]| half_area(Extent::of(refs).bounds) * refs.len() as f32;
        if left.is_empty() || right.is_empty() { f32::INFINITY } else { of(left) + of(right) }
    }

    fn ids(refs: &[Reference]) -> Vec<u32> {
        let mut ids: Vec<u32> = refs.iter().map(Reference::id).collect();
        ids.sort_unstable();
        ids
    }

    /// No way to cut few boxes in the order of their centres is better.
    #[test]
    fn few_boxes_are_cut_at_the_best_place() {
        let all = references(400);
        for (k, n) in (0..390).zip([3, 4, 5, 6, 7, 8].into_iter().cycle()) {
            let mut refs = all[k..k + n].to_vec();
            let best = (0..3)
                .flat_map(|axis| {
                    let mut sorted = refs.clone();
                    sorted.sort_by(|a, b| centre(a.lanes()).array()[axis].total_cmp(&centre(b.lanes()).array()[axis]));
                    (1..n).map(move |at| cost(&sorted[..at], &sorted[at..]))
                })
                .fold(f32::INFINITY, f32::min);
            let before = ids(&refs);
            let left = cut_exactly(&mut refs);
            assert_eq!(cost(&refs[..left], &refs[left..]), best, "boxes {k} to {}", k + n);
            assert_eq!(ids(&refs), before);
        }
        assert_eq!(cut_exactly(&mut all[..2].to_vec()), 1);
        // Nothing tells boxes apart that are all the same: they are halved, or cut anywhere but at an end.
        let left = cut_exactly(&mut [all[0]; 6]);
        assert!((1..6).contains(&left), "{left}");
    }

    /// Centres fall into the nearest of equally spaced bins.
    #[test]
    fn bins_are_the_nearest() {
        const BINS: usize = 16;
        let refs = references(1000);
        let extent = Extent::of(&refs);
        let binning = Binning::<BINS>::new(extent.centres);
        for r in &refs {
            let (c, all) = (centre(r.lanes()).array(), extent.centres.array());
            for axis in 0..3 {
                let (lo, hi) = (f64::from(all[axis]), -f64::from(all[axis + 4]));
                let place = (f64::from(c[axis]) - lo) / (hi - lo) * (BINS - 1) as f64;
                let bin = f64::from(binning.bins(r.lanes()).array()[axis]);
                assert!((place - bin).abs() < 0.5 + 1e-4, "{place} in bin {bin}");
            }
        }
    }

    /// Of all cuts between bins the best is taken, and boxes are moved to the side of their bin.
    #[test]
    fn many_boxes_are_cut_between_the_best_bins() {
        const BINS: usize = 16;
        for (count, first) in [(9, 0), (20, 40), (300, 100), (5000, 0)] {
            let mut refs = references(first + count)[first as usize..].to_vec();
            let binning = Binning::<BINS>::new(Extent::of(&refs).centres);
            let bin = |r: &Reference, axis: usize| binning.bins(r.lanes()).array()[axis] as usize;
            let sides = |axis: usize, at: usize| refs.iter().partition::<Vec<Reference>, _>(|r| bin(r, axis) <= at);
            let cuts = (0..3).flat_map(|axis| (0..BINS - 1).map(move |at| (axis, at)));
            let least = cuts.map(|(axis, at)| sides(axis, at)).map(|(l, r)| cost(&l, &r)).fold(f32::INFINITY, f32::min);
            let best = Histogram::of(&refs, &binning).best();
            assert_eq!(best.cost, least);
            let (expected, other) = sides(best.axis, best.at);
            let (left, extents) = partition(&mut refs, &binning, best);
            assert_eq!((ids(&refs[..left]), ids(&refs[left..])), (ids(&expected), ids(&other)));
            for (found, part) in extents.iter().zip([&refs[..left], &refs[left..]]) {
                let whole = Extent::of(part);
                assert_eq!(found.bounds.array()[..3], whole.bounds.array()[..3]);
                assert_eq!(found.bounds.array()[4..7], whole.bounds.array()[4..7]);
                assert_eq!(found.centres.array()[..3], whole.centres.array()[..3]);
            }
        }
    }

    /// Halves that threads share, joined, are the whole.
    #[test]
    fn shared_histograms_are_those_of_the_whole() {
        const BINS: usize = 16;
        let refs = references(SHARED_BINS as u32 + 5);
        let binning = Binning::<BINS>::new(Extent::of(&refs).centres);
        let whole = Histogram::of(&refs, &binning);
        let mut counts = [[0; BINS]; 3];
        for r in &refs {
            let bins = binning.bins(r.lanes()).array();
            (0..3).for_each(|axis| counts[axis][bins[axis] as usize] += 1);
        }
        assert_eq!(whole.counts, counts);
    }
}
