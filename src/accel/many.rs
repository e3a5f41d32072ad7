//! Many rays, one batch: what a wave has to trace.

use super::{Bvh, Hit, Ray, Single};

/// Traces batches of rays; holds its stacks between batches.
#[derive(Clone, Debug)]
pub struct Many {
    single: Single,
}

impl Many {
    /// Room for any batch on `bvh`.
    pub fn new(bvh: &Bvh) -> Self {
        Self { single: Single::new(bvh) }
    }
    /// Calls `found(i, hit)` with the nearest hit of each of the `count` rays `ray(i)`, in any order.
    pub fn closest(&mut self, bvh: &Bvh, count: usize, ray: impl Fn(usize) -> Ray, mut found: impl FnMut(usize, Hit)) {
        for i in 0..count {
            found(i, self.single.closest(bvh, &ray(i)));
        }
    }
    /// Calls `found(i, hit)` with whether each of the `count` rays `ray(i)` hits anything, in any order.
    pub fn any(&mut self, bvh: &Bvh, count: usize, ray: impl Fn(usize) -> Ray, mut found: impl FnMut(usize, bool)) {
        for i in 0..count {
            found(i, self.single.any(bvh, &ray(i)));
        }
    }
}
