//! Eight rays against one box or one triangle at a time.

use super::Hit;
use super::layout::{Leaf, Node};
use super::triangle::Sheared;
use super::way::Way;
use crate::lanes::{LanesU32, Mask, Wide};

/// Eight rays and what they have hit.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Group {
    /// As in [`super::ray::Prepared`].
    pub numbers: [[f32; 8]; 16],
    /// Distances of the hits; before all where any hit was looked for and found.
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

    /// Distances to a plane of a box, which is in row `row` of the node.
    #[inline(always)]
    fn slab<W: Wide>(&self, node: &Node, lane: usize, axis: usize, row: u32) -> W {
        W::splat(node.plane(row, lane)).mul_add(self.number(axis), -self.number::<W>(3 + row as usize))
    }

    /// Whether any ray meets a box of a node before what it has hit.
    #[inline(always)]
    pub fn meets<W: Wide>(&self, node: &Node, lane: usize, way: &Way, slack: f32) -> bool {
        let pad = self.number::<W>(11).abs() * W::splat(slack);
        let (mut near, mut far) = (W::splat(0.0), W::load(&self.t) + pad);
        for axis in 0..3 {
            near = near.max(self.slab(node, lane, axis, way.near_row(axis)));
            far = far.min(self.slab(node, lane, axis, way.far_row(axis)));
        }
        near.le(far).any()
    }

    /// Takes what is nearer in a leaf, as single rays do; tells whether anything was.
    #[inline(always)]
    pub fn closest<W: Wide>(&mut self, leaf: &Leaf, way: &Way) -> bool {
        let mut hits = self.hits::<W>();
        self.keep(hits.closest::<true>(leaf, way, self.three(12), self.three(9)), hits)
    }

    /// Ends the rays that hit anything in a leaf; tells whether any did.
    #[inline(always)]
    pub fn any<W: Wide>(&mut self, leaf: &Leaf, way: &Way) -> bool {
        let mut hits = self.hits::<W>();
        self.keep(hits.any::<true>(leaf, way, self.three(12), self.three(9)), hits)
    }

    #[inline(always)]
    fn hits<W: Wide>(&self) -> RayHits<W> {
        let triangle = W::Uint::load(&self.triangle);
        RayHits { t: W::load(&self.t), u: W::load(&self.u), v: W::load(&self.v), triangle }
    }

    #[inline(always)]
    fn keep<W: Wide>(&mut self, changed: W::Mask, hits: RayHits<W>) -> bool {
        let any = changed.any();
        if any {
            hits.t.store(&mut self.t);
            hits.u.store(&mut self.u);
            hits.v.store(&mut self.v);
            hits.triangle.store(&mut self.triangle);
        }
        any
    }
}

/// What eight rays have hit.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayHits<W: Wide> {
    /// Distances; before all where any hit was looked for and found.
    pub t: W,
    pub u: W,
    pub v: W,
    pub triangle: W::Uint,
}

impl<W: Wide> RayHits<W> {
    /// Takes what is nearer in a leaf, as single rays do; tells of which rays. `origin` and `shear` are as in
    /// [`Sheared`].
    #[inline(always)]
    pub fn closest<const TIGHT: bool>(&mut self, leaf: &Leaf, way: &Way, origin: [W; 3], shear: [W; 3]) -> W::Mask {
        let mut changed = W::Mask::splat(false);
        for (lane, id) in leaf.distinct() {
            let rays = Sheared { origin, shear, t_max: self.t };
            let corner = |k, axis| W::splat(leaf.coordinate(k, way.axis(axis), lane));
            let (e, inside) = rays.lines(corner);
            if TIGHT && !inside.any() {
                continue;
            }
            let (met, t, u, v) = rays.distances(&e, inside);
            if TIGHT && !met.any() {
                continue;
            }
            let mut take = met;
            let tie = met & t.eq(self.t);
            if tie.any() {
                // Of equally near triangles, the one with the smallest id.
                let ids = self.triangle.array();
                let larger = |i: usize| ids[i] != Hit::NONE && ids[i] > id;
                let larger = W::from_fn(|i| f32::from(u8::from(larger(i)))).gt(W::splat(0.5));
                take = met & (!tie | larger);
            }
            changed = changed | take;
            self.t = W::select(take, t, self.t);
            self.u = W::select(take, u, self.u);
            self.v = W::select(take, v, self.v);
            self.triangle = W::select_u32(take, W::Uint::splat(id), self.triangle);
        }
        changed
    }

    /// Ends the rays that hit anything in a leaf; tells which.
    #[inline(always)]
    pub fn any<const TIGHT: bool>(&mut self, leaf: &Leaf, way: &Way, origin: [W; 3], shear: [W; 3]) -> W::Mask {
        let mut changed = W::Mask::splat(false);
        for (lane, _) in leaf.distinct() {
            let rays = Sheared { origin, shear, t_max: self.t };
            let corner = |k, axis| W::splat(leaf.coordinate(k, way.axis(axis), lane));
            let (e, inside) = rays.lines(corner);
            if TIGHT && !inside.any() {
                continue;
            }
            let (met, t, ..) = rays.distances(&e, inside);
            let take = met & t.lt(self.t);
            changed = changed | take;
            self.t = W::select(take, W::splat(f32::NEG_INFINITY), self.t);
            self.triangle = W::select_u32(take, W::Uint::splat(0), self.triangle);
        }
        changed
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
