//! What the kernels for batches of rays have in common: rays in, hits out, in any order.

use super::ray::RaySource;
use super::{Bvh, Hit};
use crate::lanes::{Kernel, Wide, dispatch};

/// A kernel for batches; it holds its stacks and lists between batches.
pub trait BatchTracer {
    /// Calls `found(i, hit)` with the nearest hit of each of `count` rays or, if `ANY`, with one of triangle 0 where
    /// anything is hit, in lanes of form `W`. All that this calls with lanes is inlined, as it is itself.
    fn trace<W: Wide, const ANY: bool>(
        &mut self,
        bvh: &Bvh,
        count: usize,
        rays: &(impl RaySource + ?Sized),
        found: impl FnMut(usize, Hit),
    );

    /// Calls `found(i, hit)` with the nearest hit of each of `count` rays, in any order.
    fn closest<R: RaySource + ?Sized>(&mut self, bvh: &Bvh, count: usize, rays: &R, found: impl FnMut(usize, Hit)) {
        dispatch(Batch::<_, _, _, false> { tracer: self, bvh, count, rays, found });
    }

    /// Calls `found(i, hit)` with whether each of `count` rays hits anything, in any order.
    fn any<R: RaySource + ?Sized>(&mut self, bvh: &Bvh, count: usize, rays: &R, mut found: impl FnMut(usize, bool)) {
        let found = |i, hit: Hit| found(i, hit.is_some());
        dispatch(Batch::<_, _, _, true> { tracer: self, bvh, count, rays, found });
    }
}

/// A batch of rays for a kernel.
struct Batch<'a, T: ?Sized, R: ?Sized, F, const ANY: bool> {
    tracer: &'a mut T,
    bvh: &'a Bvh,
    count: usize,
    rays: &'a R,
    found: F,
}

impl<T: BatchTracer + ?Sized, R: RaySource + ?Sized, F: FnMut(usize, Hit), const ANY: bool> Kernel
    for Batch<'_, T, R, F, ANY>
{
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        self.tracer.trace::<W, ANY>(self.bvh, self.count, self.rays, self.found);
    }
}
