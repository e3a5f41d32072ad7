//! A node that a stream is at: for each child the list of rays that meet it, and the order of the children.

use super::super::boxes::LEAST;
use super::super::layout::Node;
use super::super::ray::{Prepared, SLAB_SLACK};
use super::STREAM;
use crate::lanes::{LanesU32, MAX_LANES, Mask, Wide};

/// Rays that meet a child, and where they enter it.
#[derive(Clone, Debug)]
pub struct List {
    pub rays: [u32; STREAM + MAX_LANES],
    pub near: [f32; STREAM + MAX_LANES],
    pub len: usize,
}

/// A node whose lists are filled, and the order in which its children are visited.
#[derive(Clone, Debug)]
pub struct Frame {
    pub code: u32,
    /// The next child is at this place of the order.
    next: usize,
    order: [u32; MAX_LANES],
    pub lists: [List; MAX_LANES],
}

/// What boxes need of eight rays.
pub struct Slabs<W> {
    pub inv: [W; 3],
    pub near_off: [W; 3],
    pub far_off: [W; 3],
    /// Where nothing is looked for any more.
    pub end: W,
}

impl Frame {
    pub fn empty() -> Self {
        let list = || List { rays: [0; STREAM + MAX_LANES], near: [0.0; STREAM + MAX_LANES], len: 0 };
        Self { code: 0, next: 0, order: [u32::MAX; MAX_LANES], lists: std::array::from_fn(|_| list()) }
    }

    /// Empties the lists for a node.
    #[inline(always)]
    pub fn start(&mut self, code: u32) {
        (self.code, self.next) = (code, 0);
        self.lists.iter_mut().for_each(|list| list.len = 0);
    }

    /// Appends eight rays to the lists of the children that they meet; adds the distances at which they enter to `sums`.
    #[inline(always)]
    pub fn enter<W: Wide>(
        &mut self,
        node: &Node,
        like: &Prepared,
        rays: &Slabs<W>,
        numbers: W::Uint,
        live: u32,
        sums: &mut [W; MAX_LANES],
    ) {
        for (lane, (list, sum)) in self.lists.iter_mut().zip(sums).enumerate() {
            let (mut near, mut far) = (W::splat(LEAST), rays.end);
            for axis in 0..3 {
                let plane = |row: u32| W::splat(node.plane(row, lane));
                near = near.max(plane(like.near_row(axis)).mul_add(rays.inv[axis], -rays.near_off[axis]));
                far = far.min(plane(like.far_row(axis)).mul_add(rays.inv[axis], -rays.far_off[axis]));
            }
            let met = near.le(far * W::splat(SLAB_SLACK));
            let bits = met.bits() & live;
            numbers.pack(bits).store(&mut list.rays[list.len..]);
            near.pack(bits).store(&mut list.near[list.len..]);
            *sum = *sum + W::select(met, near, W::splat(0.0));
            list.len += bits.count_ones() as usize;
        }
    }

    /// Orders the children by the mean distance at which their rays enter.
    #[inline(always)]
    pub fn sort<W: Wide>(&mut self, sums: &[W; MAX_LANES]) {
        let mut keys = [u32::MAX; MAX_LANES];
        for (lane, key) in keys.iter_mut().enumerate() {
            let len = self.lists[lane].len;
            if len > 0 {
                let sum: f32 = sums[lane].array().iter().sum();
                *key = (sum / len as f32).max(0.0).to_bits() & !7 | lane as u32;
            }
        }
        keys.sort_unstable();
        self.order = keys;
    }

    /// The next child whose list is not empty.
    #[inline(always)]
    pub fn turn(&mut self) -> Option<usize> {
        let key = *self.order.get(self.next)?;
        self.next += 1;
        if key == u32::MAX { None } else { Some((key & 7) as usize) }
    }
}
