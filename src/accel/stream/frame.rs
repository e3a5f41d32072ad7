//! A node that a stream is at: for each child the list of rays that meet it, and the order of the children.

use super::super::boxes::Order;
use super::super::layout::Node;
use super::super::ray::OFF_ERROR;
use super::super::way::Way;
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
    order: Order,
    /// Children of the order that have not been visited.
    left: u32,
    pub lists: [List; MAX_LANES],
}

/// What boxes need of eight rays.
pub struct Slabs<W> {
    inv: [W; 3],
    near_off: [W; 3],
    far_off: [W; 3],
    /// Where nothing is looked for any more.
    end: W,
}

impl<W: Wide> Slabs<W> {
    /// Of rays with these reciprocals of directions and origins, up to `end`.
    #[inline(always)]
    pub fn new(inv: [W; 3], origin: [W; 3], end: W) -> Self {
        let (mut near_off, mut far_off) = (inv, inv);
        for axis in 0..3 {
            let off = origin[axis] * inv[axis];
            let pad = off.abs() * W::splat(OFF_ERROR);
            (near_off[axis], far_off[axis]) = (off + pad, off - pad);
        }
        Self { inv, near_off, far_off, end }
    }
}

impl Frame {
    pub fn empty() -> Self {
        let list = || List { rays: [0; STREAM + MAX_LANES], near: [0.0; STREAM + MAX_LANES], len: 0 };
        Self { code: 0, order: Order::ASCENDING, left: 0, lists: std::array::from_fn(|_| list()) }
    }

    /// Empties the lists for a node, whose children are visited in this order.
    #[inline(always)]
    pub fn start(&mut self, code: u32, order: Order) {
        (self.code, self.order, self.left) = (code, order, MAX_LANES as u32);
        self.lists.iter_mut().for_each(|list| list.len = 0);
    }

    /// Appends eight rays to the lists of the children that they meet.
    #[inline(always)]
    pub fn enter<W: Wide>(&mut self, node: &Node, way: &Way, rays: &Slabs<W>, numbers: W::Uint, live: u32) {
        for (lane, list) in self.lists.iter_mut().enumerate() {
            let (mut near, mut far) = (W::splat(0.0), rays.end);
            for axis in 0..3 {
                let plane = |row: u32| W::splat(node.plane(row, lane));
                near = near.max(plane(way.near_row(axis)).mul_add(rays.inv[axis], -rays.near_off[axis]));
                far = far.min(plane(way.far_row(axis)).mul_add(rays.inv[axis], -rays.far_off[axis]));
            }
            let bits = near.le(far).bits() & live;
            numbers.pack(bits).store(&mut list.rays[list.len..]);
            near.pack(bits).store(&mut list.near[list.len..]);
            list.len += bits.count_ones() as usize;
        }
    }

    /// The next child whose list is not empty.
    #[inline(always)]
    pub fn turn(&mut self) -> Option<usize> {
        while self.left > 0 {
            self.left -= 1;
            let lane = self.order.lane(self.left);
            if self.lists[lane].len > 0 {
                return Some(lane);
            }
        }
        None
    }
}
