//! Many rays in flight (kernel B): what a batch knows and a single ray does not. Each of a few rays has a small stack;
//! all that stand at an inner node take one step, then all that stand at a leaf. Steps of different rays do not wait for
//! each other, so that the latency of memory and of the sorting network is hidden behind the others.

use super::boxes::{distances, enter, keys, nearest, order};
use super::ray::{Prepared, Prepared8, RaySource};
use super::triangle::{any_in_leaf, closest_in_leaf};
use super::{Bvh, Hit, Ray, STACK, Tree};
use crate::columns::Rows;
use crate::lanes::{Kernel, LanesU32, MAX_LANES, Mask, Wide, WideU32, dispatch};
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
struct Slot {
    prepared: Prepared,
    hit: Hit,
    /// Where the ray stands: a child code.
    at: u32,
    /// Number of the ray in the batch.
    ray: u32,
    /// First free entry of the stack.
    top: usize,
    keys: [u32; STACK],
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
            at: DONE,
            ray: 0,
            top: BOTTOM,
            keys: [0; STACK],
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

    /// Calls `found(i, hit)` with the nearest hit of each of `count` rays, in any order.
    pub fn closest<R: RaySource + ?Sized>(&mut self, bvh: &Bvh, count: usize, rays: &R, found: impl FnMut(usize, Hit)) {
        dispatch(Batch::<_, _, _, false> { tracer: self, bvh, count, rays, found });
    }

    /// Calls `found(i, hit)` with whether each of `count` rays hits anything, in any order.
    pub fn any<R: RaySource + ?Sized>(
        &mut self,
        bvh: &Bvh,
        count: usize,
        rays: &R,
        mut found: impl FnMut(usize, bool),
    ) {
        let found = |i, hit: Hit| found(i, hit.is_some());
        dispatch(Batch::<_, _, _, true> { tracer: self, bvh, count, rays, found });
    }

    /// [`Self::closest`], or [`Self::any`] with a hit of any kind, in lanes of form `W`.
    #[inline(always)]
    pub(crate) fn trace<W: Wide, const ANY: bool>(
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
        if bvh.bytes() > LARGE_BYTES {
            self.fly::<W, ANY, true>(bvh.tree(), count, rays, found);
        } else {
            self.fly::<W, ANY, false>(bvh.tree(), count, rays, found);
        }
    }

    #[inline(always)]
    fn fly<W: Wide, const ANY: bool, const LARGE: bool>(
        &mut self,
        tree: Tree,
        count: usize,
        rays: &(impl RaySource + ?Sized),
        mut found: impl FnMut(usize, Hit),
    ) {
        let Self { slots, ready } = self;
        let mut next = 0;
        let (mut inner, mut leaf, mut waiting, mut idle): (Set, Set, Set, Set) =
            (0, 0, 0, ((1u64 << SLOTS) - 1) as Set);
        loop {
            // Refill, then step all rays at inner nodes, then all at leaves.
            while idle != 0 && next < count {
                if next % MAX_LANES == 0 {
                    ready.fill::<W>(&rays.rays(&Rows::range(next, MAX_LANES.min(count - next))));
                }
                let s = take(&mut idle);
                slots[s].start(ready, next);
                inner |= 1 << s;
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

/// A batch of rays for a kernel.
pub(super) struct Batch<'a, T, R: ?Sized, F, const ANY: bool> {
    pub tracer: &'a mut T,
    pub bvh: &'a Bvh,
    pub count: usize,
    pub rays: &'a R,
    pub found: F,
}

impl<R: RaySource + ?Sized, F: FnMut(usize, Hit), const ANY: bool> Kernel for Batch<'_, Many, R, F, ANY> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        self.tracer.trace::<W, ANY>(self.bvh, self.count, self.rays, self.found);
    }
}

impl Slot {
    #[inline(always)]
    fn start(&mut self, ready: &Prepared8, number: usize) {
        ready.copy_to(number % MAX_LANES, &mut self.prepared);
        self.hit = Hit::miss(self.prepared.t_max());
        self.at = 0;
        self.top = BOTTOM;
        self.ray = number as u32;
    }

    /// Enters a node: pushes the children that the ray meets, nearest on top, and goes to what is on top then.
    #[inline(always)]
    fn step_inner<W: Wide, const ANY: bool, const LARGE: bool>(&mut self, tree: Tree) -> u32 {
        let node = tree.node(self.at);
        let (hit, near) = enter::<W>(node, &self.prepared, self.hit.t);
        let (bits, top, child) = (hit.bits(), self.top, node.children::<W>());
        // What will be on top is found beside the sort, not read back from the stack, which would wait for it.
        let below = self.codes[top - 1];
        let first = if ANY {
            child.pack(bits).store(&mut self.codes[top..]);
            bits.checked_ilog2().unwrap_or(0)
        } else {
            let keys = keys::<W>(hit, near);
            let first = nearest::<W>(hit, keys);
            let sorted = order(keys, bits);
            sorted.store(&mut self.keys[top..]);
            child.permute(sorted).store(&mut self.codes[top..]);
            first
        };
        let first = node.child(first as usize);
        self.top = top + bits.count_ones() as usize - 1;
        self.at = select_unpredictable(bits == 0, below, first);
        if LARGE {
            tree.prefetch(self.at);
        }
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
            let t = W::splat(self.hit.t);
            loop {
                let from = self.top - MAX_LANES;
                // Not behind, rather than before: an end that is not a number leaves the bottom of the stack where it is.
                let live = !t.lt(distances::<W>(W::Uint::load(&self.keys[from..]))).bits() & 255;
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
