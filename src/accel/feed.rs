//! What kernel B is fed with.

use super::many::Slot;
use super::ray::{Prepared8, RaySource};
use crate::columns::Rows;
use crate::lanes::{MAX_LANES, Wide};

/// Where rays come from, and where in the tree they start.
pub(super) trait Feed {
    /// Number of rays.
    fn count(&self) -> usize;
    /// Prepares the rays from `first` on, eight if there are as many.
    fn fill<W: Wide>(&self, ready: &mut Prepared8, first: usize);
    /// Sets a slot, which holds ray `i` at the root, to where it starts; returns that.
    fn start<W: Wide, const ANY: bool>(&self, slot: &mut Slot, i: usize) -> u32;
}

/// Rays that start at the root.
pub(super) struct FromRoot<'a, R: ?Sized> {
    pub rays: &'a R,
    pub count: usize,
}

impl<R: RaySource + ?Sized> Feed for FromRoot<'_, R> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }
    #[inline(always)]
    fn fill<W: Wide>(&self, ready: &mut Prepared8, first: usize) {
        ready.fill::<W>(&self.rays.rays(&Rows::range(first, MAX_LANES.min(self.count - first))));
    }
    #[inline(always)]
    fn start<W: Wide, const ANY: bool>(&self, slot: &mut Slot, _: usize) -> u32 {
        slot.at
    }
}
