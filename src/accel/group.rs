//! Eight rays against one box or one triangle at a time.

use super::Hit;
use super::layout::{Leaf, Node};
use super::ray::{Prepared, SLAB_SLACK};
use super::triangle::Sheared;
use crate::lanes::{LanesU32, Mask, Wide};

/// Eight rays and what they have hit.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Group {
    /// As in [`Prepared`].
    pub numbers: [[f32; 8]; 16],
    /// Distances of the hits; -1 where any hit was looked for and found.
    pub t: [f32; 8],
    u: [f32; 8],
    v: [f32; 8],
    triangle: [u32; 8],
}

impl Group {
    /// No rays.
    pub fn empty() -> Self {
        Self { numbers: [[0.0; 8]; 16], t: [0.0; 8], u: [0.0; 8], v: [0.0; 8], triangle: [0; 8] }
    }
    /// Takes rays that have hit nothing up to `t_max`.
    #[inline(always)]
    pub fn start<W: Wide>(&mut self, numbers: [W; 16], t_max: W) {
        for (x, to) in numbers.into_iter().zip(&mut self.numbers) {
            x.store(to);
        }
        t_max.store(&mut self.t);
        W::splat(0.0).store(&mut self.u);
        W::splat(0.0).store(&mut self.v);
        W::Uint::splat(Hit::NONE).store(&mut self.triangle);
    }
    /// What ray `i` has hit.
    #[inline(always)]
    pub fn hit(&self, i: usize) -> Hit {
        Hit { t: self.t[i], u: self.u[i], v: self.v[i], triangle: self.triangle[i] }
    }
    #[inline(always)]
    fn number<W: Wide>(&self, k: usize) -> W {
        W::load(&self.numbers[k])
    }
    #[inline(always)]
    fn three<W: Wide>(&self, k: usize) -> [W; 3] {
        [self.number(k), self.number(k + 1), self.number(k + 2)]
    }

    /// Whether any ray meets a box of a node before what it has hit.
    #[inline(always)]
    pub fn meets<W: Wide>(&self, node: &Node, lane: usize, like: &Prepared) -> bool {
        let (mut near, mut far) = (W::splat(0.0), W::load(&self.t));
        let (inv, near_off, far_off) = (self.three::<W>(0), self.three::<W>(3), self.three::<W>(6));
        for axis in 0..3 {
            let plane = |row: u32| W::splat(node.plane(row, lane));
            near = near.max(plane(like.near_row(axis)).mul_add(inv[axis], -near_off[axis]));
            far = far.min(plane(like.far_row(axis)).mul_add(inv[axis], -far_off[axis]));
        }
        near.le(far * W::splat(SLAB_SLACK)).any()
    }

    /// Takes what is nearer in a leaf, as single rays do; tells whether anything was.
    #[inline(always)]
    pub fn closest<W: Wide>(&mut self, leaf: &Leaf, like: &Prepared) -> bool {
        let mut any = false;
        for (lane, id) in leaf.distinct() {
            let rays = Sheared { origin: self.three(12), shear: self.three(9), t_max: W::load(&self.t) };
            let corner = |k, axis| W::splat(leaf.coordinate(k, like.axis(axis), lane));
            let Some((met, t, u, v)) = rays.test(corner) else { continue };
            if !met.any() {
                continue;
            }
            let mut take = met;
            let tie = met & t.eq(rays.t_max);
            if tie.any() {
                // Of equally near triangles, the one with the smallest id.
                let larger = |i: usize| self.triangle[i] != Hit::NONE && self.triangle[i] > id;
                let larger = W::from_fn(|i| f32::from(u8::from(larger(i)))).gt(W::splat(0.5));
                take = met & (!tie | larger);
            }
            any = true;
            W::select(take, t, rays.t_max).store(&mut self.t);
            W::select(take, u, W::load(&self.u)).store(&mut self.u);
            W::select(take, v, W::load(&self.v)).store(&mut self.v);
            W::select_u32(take, W::Uint::splat(id), W::Uint::load(&self.triangle)).store(&mut self.triangle);
        }
        any
    }

    /// Ends the rays that hit anything in a leaf; tells whether any did.
    #[inline(always)]
    pub fn any<W: Wide>(&mut self, leaf: &Leaf, like: &Prepared) -> bool {
        let mut any = false;
        for (lane, _) in leaf.distinct() {
            let rays = Sheared { origin: self.three(12), shear: self.three(9), t_max: W::load(&self.t) };
            let corner = |k, axis| W::splat(leaf.coordinate(k, like.axis(axis), lane));
            let Some((met, t, ..)) = rays.test(corner) else { continue };
            let take = met & t.lt(rays.t_max);
            if take.any() {
                any = true;
                W::select(take, W::splat(-1.0), rays.t_max).store(&mut self.t);
                W::select_u32(take, W::Uint::splat(0), W::Uint::load(&self.triangle)).store(&mut self.triangle);
            }
        }
        any
    }
}

/// The largest distance that any ray still looks at.
#[inline(always)]
pub(super) fn farthest<W: Wide>(groups: &[Group]) -> f32 {
    let mut t = W::splat(f32::NEG_INFINITY);
    for group in groups {
        t = t.max(W::load(&group.t));
    }
    -(-t).min_lane()
}
