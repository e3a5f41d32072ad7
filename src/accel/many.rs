//! Many rays in flight (kernel B): what a batch knows and a single ray does not. Each of a few rays has a small stack;
//! all that stand at an inner node take one step, then all that stand at a leaf. Steps of different rays do not wait for
//! each other, so that the latency of memory and of the sorting network is hidden behind the others.

use super::layout::Node;
use super::ray::{Prepared, Prepared8, RayLanes};
use super::single::{boxes, distances, keys, sort};
use super::triangle::{any_in_leaf, closest_in_leaf};
use super::{Bvh, Hit, LEAF, Ray};
use crate::columns::Rows;
use crate::lanes::{F32x8, Lanes, LanesU32, MAX_LANES, Mask, U32x8, Vec3};

/// Rays in flight.
const SLOTS: usize = 16;
/// Bottom of every stack: the ray is done.
const DONE: u32 = LEAF - 1;

#[derive(Clone, Copy, Debug)]
struct Slot {
    prepared: Prepared,
    hit: Hit,
    /// Where the ray stands: a child code.
    at: u32,
    /// First free entry of its stack.
    top: usize,
    /// Number of the ray in the batch.
    ray: usize,
}

/// Slots that stand at the same sort of place.
#[derive(Clone, Copy, Debug, Default)]
struct List {
    slots: [u8; SLOTS],
    len: usize,
}

impl List {
    #[inline(always)]
    fn push_if(&mut self, slot: usize, condition: bool) {
        self.slots[self.len & (SLOTS - 1)] = slot as u8;
        self.len += usize::from(condition);
    }
}

/// Slots by where they stand.
#[derive(Clone, Copy, Debug, Default)]
struct Work {
    inner: List,
    leaf: List,
    done: List,
}

impl Work {
    /// Files a slot by its code, without a branch.
    #[inline(always)]
    fn file(&mut self, slot: usize, code: u32) {
        let leaf = code & LEAF != 0;
        let done = code == DONE;
        self.leaf.push_if(slot, leaf);
        self.done.push_if(slot, done);
        self.inner.push_if(slot, !leaf & !done);
    }
}

/// Traces batches of rays; holds its stacks between batches.
#[derive(Clone, Debug)]
pub struct Many {
    slots: Vec<Slot>,
    keys: Vec<u32>,
    codes: Vec<u32>,
    stride: usize,
    /// The next rays of the batch.
    ready: Prepared8,
}

/// Rays of a slice, as a batch wants them.
pub fn from_slice(rays: &[Ray]) -> impl Fn(&Rows) -> RayLanes<F32x8> {
    |rows| RayLanes {
        origin: Vec3::from_fn(|i| rays[rows.at(i)].origin),
        direction: Vec3::from_fn(|i| rays[rows.at(i)].direction),
        t_max: F32x8::from_fn(|i| rays[rows.at(i)].t_max),
    }
}

impl Many {
    /// Room for any batch on `bvh`.
    pub fn new(bvh: &Bvh) -> Self {
        let ray = Ray { origin: [0.0; 3], direction: [1.0; 3], t_max: 0.0 };
        let slot = Slot { prepared: Prepared::new(&ray), hit: Hit::miss(0.0), at: 0, top: 0, ray: 0 };
        let stride = bvh.stack_bound + 1;
        Self {
            slots: vec![slot; SLOTS],
            keys: vec![0; SLOTS * stride],
            codes: vec![DONE; SLOTS * stride],
            stride,
            ready: Prepared8::empty(),
        }
    }

    /// Calls `found(i, hit)` with the nearest hit of each of `count` rays, in any order; `rays` gives them by rows.
    pub fn closest(
        &mut self,
        bvh: &Bvh,
        count: usize,
        rays: impl Fn(&Rows) -> RayLanes<F32x8>,
        found: impl FnMut(usize, Hit),
    ) {
        self.trace::<false>(bvh, count, rays, found);
    }

    /// Calls `found(i, hit)` with whether each of `count` rays hits anything, in any order; `rays` gives them by rows.
    pub fn any(
        &mut self,
        bvh: &Bvh,
        count: usize,
        rays: impl Fn(&Rows) -> RayLanes<F32x8>,
        mut found: impl FnMut(usize, bool),
    ) {
        self.trace::<true>(bvh, count, rays, |i, hit| found(i, hit.is_some()));
    }

    fn trace<const ANY: bool>(
        &mut self,
        bvh: &Bvh,
        count: usize,
        rays: impl Fn(&Rows) -> RayLanes<F32x8>,
        mut found: impl FnMut(usize, Hit),
    ) {
        if bvh.nodes.is_empty() {
            (0..count).for_each(|i| found(i, Hit::miss(rays(&Rows::range(i, 1)).t_max.array()[0])));
            return;
        }
        let mut work = Work::default();
        let mut next = 0;
        (0..SLOTS).for_each(|s| work.done.push_if(s, true));
        let mut idle = std::mem::take(&mut work.done);
        loop {
            // Refill, then step all rays at inner nodes, then all at leaves.
            for k in 0..idle.len {
                if next < count {
                    let s = idle.slots[k] as usize;
                    if next % MAX_LANES == 0 {
                        self.ready.fill(&rays(&Rows::range(next, MAX_LANES.min(count - next))));
                    }
                    self.start(s, next);
                    work.inner.push_if(s, true);
                    next += 1;
                }
            }
            let (inner, leaf) = (work.inner, work.leaf);
            if inner.len + leaf.len == 0 {
                return;
            }
            work = Work::default();
            for k in 0..inner.len {
                let s = inner.slots[k] as usize;
                let at = self.step_inner::<ANY>(bvh, s);
                work.file(s, at);
            }
            for k in 0..leaf.len {
                let s = leaf.slots[k] as usize;
                let at = self.step_leaf::<ANY>(bvh, s);
                work.file(s, at);
            }
            for k in 0..work.done.len {
                let slot = &self.slots[work.done.slots[k] as usize];
                found(slot.ray, slot.hit);
            }
            idle = work.done;
        }
    }

    #[inline(always)]
    fn start(&mut self, s: usize, number: usize) {
        let slot = &mut self.slots[s];
        self.ready.copy_to(number % MAX_LANES, &mut slot.prepared);
        slot.hit = Hit::miss(slot.prepared.t_max);
        slot.at = 0;
        // The stack's first entry says that the ray is done, and stays.
        slot.top = s * self.stride + 1;
        slot.ray = number;
    }

    /// Enters a node: pushes the children that the ray meets, nearest on top, and goes to what is on top then.
    #[inline(always)]
    fn step_inner<const ANY: bool>(&mut self, bvh: &Bvh, s: usize) -> u32 {
        let slot = &mut self.slots[s];
        let node: &Node = &bvh.nodes[slot.at as usize];
        let (mask, near) = boxes(node, &slot.prepared, slot.hit.t);
        let bits = mask.bits();
        let child = node.children();
        if ANY {
            child.pack(bits).store(&mut self.codes[slot.top..]);
        } else {
            let sorted = sort(keys(mask, near));
            sorted.store(&mut self.keys[slot.top..]);
            child.permute(sorted).store(&mut self.codes[slot.top..]);
        }
        slot.top = slot.top + bits.count_ones() as usize - 1;
        slot.at = self.codes[slot.top];
        slot.at
    }

    /// Tests a leaf; on a hit, drops what lies behind it from the stack.
    #[inline(always)]
    fn step_leaf<const ANY: bool>(&mut self, bvh: &Bvh, s: usize) -> u32 {
        let slot = &mut self.slots[s];
        let leaf = &bvh.leaves[(slot.at & !LEAF) as usize];
        let bottom = s * self.stride + 1;
        if ANY {
            if any_in_leaf(leaf, &slot.prepared, slot.hit.t) {
                slot.hit.triangle = 0;
                slot.top = bottom;
            }
        } else if closest_in_leaf(leaf, &slot.prepared, &mut slot.hit) {
            // Eight entries at a time: a loop over single ones ends at a different place each time.
            let mut kept = bottom;
            for i in (bottom..slot.top).step_by(MAX_LANES) {
                let (keys, codes) = (U32x8::load(&self.keys[i..]), U32x8::load(&self.codes[i..]));
                let live = (1u32 << MAX_LANES.min(slot.top - i)) - 1;
                let near = distances(keys).le(F32x8::splat(slot.hit.t)).bits() & live;
                keys.pack(near).store(&mut self.keys[kept..]);
                codes.pack(near).store(&mut self.codes[kept..]);
                kept += near.count_ones() as usize;
            }
            slot.top = kept;
        }
        slot.top -= 1;
        slot.at = self.codes[slot.top];
        slot.at
    }
}
