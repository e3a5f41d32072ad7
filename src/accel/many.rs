//! Many rays in flight (kernel B): what a batch knows and a single ray does not. Each of a few rays has a small stack;
//! all that stand at an inner node take one step, then all that stand at a leaf. Steps of different rays do not wait for
//! each other, so that the latency of memory and of arithmetic is hidden behind the others.

use super::batch::BatchTracer;
use super::boxes::{Met, Order, enter};
use super::feed::{Feed, FromRoot};
use super::ray::{Prepared, Prepared8, RaySource};
use super::triangle::{any_in_leaf, closest_in_leaf};
use super::{Bvh, Hit, Ray, STACK, Tree};
use crate::columns::Rows;
use crate::lanes::{LanesU32, MAX_LANES, Mask, Wide};
use std::hint::select_unpredictable;

/// Rays in flight; a power of two.
const SLOTS: usize = 16;
/// Trees above this size are not in the nearest cache: steps ask for memory ahead, and do not wait for each other.
const LARGE_BYTES: usize = 1 << 15;
/// Stands at the bottom of every stack: the ray is done.
const DONE: u32 = u32::MAX;
/// First entry of a stack: before it stand as many that say the ray is done as are looked at at a time.
const BOTTOM: usize = MAX_LANES;

/// A ray in flight and its stack of nodes and leaves yet to visit.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Slot {
    prepared: Prepared,
    hit: Hit,
    /// As in [`Prepared::pad`].
    pad: f32,
    /// Behind this distance no box is entered.
    end: f32,
    /// Where the ray stands: a child code.
    pub at: u32,
    /// Number of the ray in the batch.
    ray: u32,
    /// First free entry of the stack.
    top: usize,
    near: [f32; STACK],
    codes: [u32; STACK],
}

/// Slots by bits.
type Set = u32;

/// Takes the first slot out of a set that is not empty.
#[inline(always)]
fn take(set: &mut Set) -> usize {
    let slot = set.trailing_zeros() as usize;
    *set &= *set - 1;
    slot & (SLOTS - 1)
}

/// Traces batches of rays; holds its stacks between batches.
#[derive(Clone, Debug)]
pub struct Many {
    slots: Box<[Slot; SLOTS]>,
    /// The next rays of the batch.
    ready: Prepared8,
}

impl Default for Many {
    fn default() -> Self {
        let ray = Ray { origin: [0.0; 3], direction: [1.0; 3], t_max: 0.0 };
        let slot = Slot {
            prepared: Prepared::new(&ray),
            hit: Hit::miss(0.0),
            pad: 0.0,
            end: 0.0,
            at: DONE,
            ray: 0,
            top: BOTTOM,
            near: [0.0; STACK],
            codes: [DONE; STACK],
        };
        Self { slots: Box::new(std::array::from_fn(|_| slot.clone())), ready: Prepared8::empty() }
    }
}

impl Many {
    /// Room for any batch.
    pub fn new() -> Self {
        Self::default()
    }
}

impl BatchTracer for Many {
    #[inline(always)]
    fn trace<W: Wide, const ANY: bool>(
        &mut self,
        bvh: &Bvh,
        count: usize,
        rays: &(impl RaySource + ?Sized),
        mut found: impl FnMut(usize, Hit),
    ) {
        if bvh.is_empty() {
            (0..count).for_each(|i| found(i, Hit::miss(rays.rays::<f32>(&Rows::range(i, 1)).t_max)));
            return;
        }
        self.feed::<W, ANY>(bvh, &FromRoot { rays, count }, found);
    }
}

impl Many {
    /// Traces what a feed holds.
    #[inline(always)]
    pub(super) fn feed<W: Wide, const ANY: bool>(
        &mut self,
        bvh: &Bvh,
        feed: &impl Feed,
        found: impl FnMut(usize, Hit),
    ) {
        let tree = bvh.tree_for::<ANY>();
        if bvh.bytes() > LARGE_BYTES {
            self.fly::<W, ANY, true>(tree, feed, found);
        } else {
            self.fly::<W, ANY, false>(tree, feed, found);
        }
    }

    #[inline(always)]
    fn fly<W: Wide, const ANY: bool, const LARGE: bool>(
        &mut self,
        tree: Tree,
        feed: &impl Feed,
        mut found: impl FnMut(usize, Hit),
    ) {
        let Self { slots, ready } = self;
        let count = feed.count();
        let mut next = 0;
        let (mut inner, mut leaf, mut waiting, mut idle): (Set, Set, Set, Set) =
            (0, 0, 0, ((1u64 << SLOTS) - 1) as Set);
        loop {
            // Refill, then step all rays at inner nodes, then all at leaves.
            while idle != 0 && next < count {
                if next % MAX_LANES == 0 {
                    feed.fill::<W>(ready, next);
                }
                let s = take(&mut idle);
                slots[s].start(tree, ready, next);
                let at = feed.start::<W, ANY>(&mut slots[s], next);
                inner |= (at >> 31 ^ 1) << s;
                leaf |= (at >> 31) << s;
                next += 1;
            }
            if inner | leaf | waiting == 0 {
                return;
            }
            let (mut todo, mut to_leaf) = (inner, 0);
            while todo != 0 {
                let s = take(&mut todo);
                let at = slots[s].step_inner::<W, ANY, LARGE>(tree);
                to_leaf |= (at >> 31) << s;
            }
            if !LARGE {
                leaf |= to_leaf;
            }
            let (mut todo, mut to_inner) = (leaf, 0);
            while todo != 0 {
                let s = take(&mut todo);
                let slot = &mut slots[s];
                if slot.at == DONE {
                    found(slot.ray as usize, slot.hit);
                    idle |= 1 << s;
                    continue;
                }
                let at = slot.step_leaf::<W, ANY, LARGE>(tree);
                to_inner |= (at >> 31 ^ 1) << s;
            }
            inner &= !to_leaf;
            leaf &= !(to_inner | idle);
            if LARGE {
                // What the last steps found out is used a phase later: to wait for it would leave the processor idle.
                inner |= waiting;
                leaf |= to_leaf;
                waiting = to_inner;
            } else {
                inner |= to_inner;
            }
        }
    }
}

impl Slot {
    #[inline(always)]
    fn start(&mut self, tree: Tree, ready: &Prepared8, number: usize) {
        ready.copy_to(number % MAX_LANES, &mut self.prepared);
        self.hit = Hit::miss(self.prepared.t_max());
        self.pad = self.prepared.pad(tree.slack);
        self.end = self.hit.t + self.pad;
        self.at = 0;
        self.top = BOTTOM;
        self.ray = number as u32;
    }

    /// Enters a node: pushes the children that the ray meets, the first to visit on top, and goes to what is on top then.
    #[inline(always)]
    fn step_inner<W: Wide, const ANY: bool, const LARGE: bool>(&mut self, tree: Tree) -> u32 {
        let node = tree.node(self.at);
        let met = Met::new(enter::<W>(node, &self.prepared, self.end), node.order(self.prepared.octant()));
        self.descend::<W, ANY>(&met, node.children::<W>());
        if LARGE {
            tree.prefetch(self.at);
        }
        self.at
    }

    /// Pushes those of `children` that the ray meets, and goes to what is on top then.
    #[inline(always)]
    fn descend<W: Wide, const ANY: bool>(&mut self, met: &Met<W>, children: W::Uint) {
        if !ANY {
            met.near().store(&mut self.near[self.top..]);
        }
        met.codes(children).store(&mut self.codes[self.top..]);
        self.top = self.top + met.count() - 1;
        self.at = self.codes[self.top];
    }

    /// Goes on with a ray that has hit `hit`, and has yet to visit those of `codes` that it enters, at `near`, before the
    /// hit: a distance that is not a number stands for none.
    #[inline(always)]
    pub(super) fn resume<W: Wide, const ANY: bool>(&mut self, hit: Hit, near: &[f32; 8], codes: &[u32; 8]) -> u32 {
        self.hit = hit;
        self.end = hit.t + self.pad;
        let met = Met::new((W::load(near), W::splat(self.end)), Order::ASCENDING);
        self.descend::<W, ANY>(&met, W::Uint::load(codes));
        self.at
    }

    /// Tests a leaf, and goes to what is on top of the stack and not behind a hit.
    #[inline(always)]
    fn step_leaf<W: Wide, const ANY: bool, const LARGE: bool>(&mut self, tree: Tree) -> u32 {
        let leaf = tree.leaf(self.at);
        if ANY {
            let hit = any_in_leaf::<W>(leaf, &self.prepared, self.hit.t);
            self.hit.triangle = select_unpredictable(hit, 0, self.hit.triangle);
            self.top = select_unpredictable(hit, BOTTOM, self.top) - 1;
        } else {
            self.hit = closest_in_leaf::<W>(leaf, &self.prepared, &self.hit);
            // What lies behind the hit is dropped from the top, up to eight entries at a time.
            self.end = self.hit.t + self.pad;
            let t = W::splat(self.end);
            loop {
                let from = self.top - MAX_LANES;
                // Not behind, rather than before: an end that is not a number leaves the bottom of the stack where it is.
                let live = !t.lt(W::load(&self.near[from..])).bits() & 255;
                self.top = from;
                if live != 0 {
                    self.top += live.ilog2() as usize;
                    break;
                }
            }
        }
        self.at = self.codes[self.top];
        if LARGE {
            tree.prefetch(self.at);
        }
        self.at
    }
}
