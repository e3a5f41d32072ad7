//! The watertight triangle test (Woop, Benthin and Wald 2013), one ray against lanes of triangles, from both sides.

use super::Hit;
use super::layout::Leaf;
use super::ray::Prepared;
use crate::lanes::{Lanes, Mask, Wide};
use std::hint::select_unpredictable;

/// Edge functions of lanes of triangles, and their corners in the ray's frame.
pub(super) struct Edges<L> {
    u: L,
    v: L,
    w: L,
    a: [L; 3],
    b: [L; 3],
    c: [L; 3],
}

/// What the test needs of rays in lanes: one ray in all of them, or one in each.
#[derive(Clone, Copy)]
pub(super) struct Sheared<L> {
    /// The origin, axes permuted.
    pub origin: [L; 3],
    /// The shear that turns the direction onto the last permuted axis.
    pub shear: [L; 3],
    /// Where the rays end.
    pub t_max: L,
}

impl<L: Lanes> Sheared<L> {
    /// One ray in all lanes.
    #[inline(always)]
    pub fn splat(ray: &Prepared, t_max: f32) -> Self {
        Self {
            origin: [L::splat(ray.origin(0)), L::splat(ray.origin(1)), L::splat(ray.origin(2))],
            shear: [L::splat(ray.shear(0)), L::splat(ray.shear(1)), L::splat(ray.shear(2))],
            t_max: L::splat(t_max),
        }
    }
    /// From a corner to the ray, sheared: two coordinates across the ray, one along it. The same corner gives the same
    /// numbers in every triangle, and the edge function below is exactly antisymmetric: so no ray slips between
    /// neighbours.
    #[inline(always)]
    fn to(&self, corner: [L; 3]) -> [L; 3] {
        let (x, y, z) = (self.origin[0] - corner[0], self.origin[1] - corner[1], self.origin[2] - corner[2]);
        [(-self.shear[0]).mul_add(z, x), (-self.shear[1]).mul_add(z, y), z]
    }
    #[inline(always)]
    fn edges(&self, corner: impl Fn(usize, usize) -> L) -> Edges<L> {
        let a = self.to([corner(0, 0), corner(0, 1), corner(0, 2)]);
        let b = self.to([corner(1, 0), corner(1, 1), corner(1, 2)]);
        let c = self.to([corner(2, 0), corner(2, 1), corner(2, 2)]);
        // Not fused: fusing one product would break the antisymmetry.
        Edges { u: edge(&c, &b), v: edge(&a, &c), w: edge(&b, &a), a, b, c }
    }
    /// Edge functions, and the lanes in which they agree in sign: the line of the ray meets the triangle. `corner(k,
    /// axis)` gives corners on permuted axes.
    #[inline(always)]
    pub fn lines(&self, corner: impl Fn(usize, usize) -> L) -> (Edges<L>, L::Mask) {
        let zero = L::splat(0.0);
        let e = self.edges(corner);
        let (least, largest) = e.extremes();
        let sign = least * largest;
        // A triangle is missed whatever the sign of an edge function between two of different signs.
        if sign.eq(zero).any() {
            let e = resolve(e);
            let (least, largest) = e.extremes();
            let inside = !(least.lt(zero) & largest.gt(zero)) & !(e.u + e.v + e.w).eq(zero);
            return (e, inside);
        }
        (e, sign.gt(zero))
    }
    /// (lanes whose triangle is met in (0, `t_max`], t, u, v). The end is included for the sake of ties.
    #[inline(always)]
    pub fn distances(&self, e: &Edges<L>, inside: L::Mask) -> (L::Mask, L, L, L) {
        let inv = L::splat(1.0) / (e.u + e.v + e.w);
        let along = e.u * e.a[2] + e.v * e.b[2] + e.w * e.c[2];
        let t = along * (inv * -self.shear[2]);
        (inside & t.gt(L::splat(0.0)) & t.le(self.t_max), t, e.v * inv, e.w * inv)
    }
    /// (lanes whose triangle is met in (0, `t_max`], t, u, v); `None`, and soon, if no lane's line meets its triangle.
    #[inline(always)]
    pub fn test(&self, corner: impl Fn(usize, usize) -> L) -> Option<(L::Mask, L, L, L)> {
        let (e, inside) = self.lines(corner);
        if inside.any() { Some(self.distances(&e, inside)) } else { None }
    }
}

#[inline(always)]
fn edge<L: Lanes>(p: &[L; 3], q: &[L; 3]) -> L {
    p[0] * q[1] - p[1] * q[0]
}

impl<L: Lanes> Edges<L> {
    /// The least and the largest of the three.
    #[inline(always)]
    fn extremes(&self) -> (L, L) {
        (self.u.min(self.v).min(self.w), self.u.max(self.v).max(self.w))
    }
}

/// `px qy - py qx` by way of f64, which holds the products exactly. Takes lanes one by one: out of line, it is compiled
/// for any machine.
#[cold]
#[inline(never)]
fn exact_edge<A: AsRef<[f32]> + AsMut<[f32]> + Copy>([px, py]: [A; 2], [qx, qy]: [A; 2]) -> A {
    let mut edge = px;
    for (i, e) in edge.as_mut().iter_mut().enumerate() {
        let f = |x: &A| f64::from(x.as_ref()[i]);
        *e = (f(&px) * f(&qy) - f(&py) * f(&qx)) as f32;
    }
    edge
}

/// Where an edge function is exactly 0 its sign is not known from f32 products.
#[inline(always)]
fn resolve<L: Lanes>(e: Edges<L>) -> Edges<L> {
    let exact = |p: &[L; 3], q: &[L; 3]| {
        L::load(exact_edge([p[0].array(), p[1].array()], [q[0].array(), q[1].array()]).as_ref())
    };
    let (u, v, w) = (exact(&e.c, &e.b), exact(&e.a, &e.c), exact(&e.b, &e.a));
    let zero = L::splat(0.0);
    let doubt = e.u.eq(zero) | e.v.eq(zero) | e.w.eq(zero);
    Edges { u: L::select(doubt, u, e.u), v: L::select(doubt, v, e.v), w: L::select(doubt, w, e.w), ..e }
}

/// One ray against the triangles of a leaf, without a branch: whether anything is met is not to be foreseen.
#[inline(always)]
fn meet<W: Wide>(leaf: &Leaf, ray: &Prepared, t_max: f32) -> (W::Mask, W, W, W) {
    let ray_ = Sheared::splat(ray, t_max);
    let (e, inside) = ray_.lines(|k, axis| leaf.corner(k, ray.axis(axis)));
    ray_.distances(&e, inside)
}

/// The nearer of `hit` and what the ray hits in the leaf, of equally near triangles that of the smaller id. One branch
/// only: what it depends on is not to be foreseen.
#[inline(always)]
pub(super) fn closest_in_leaf<W: Wide>(leaf: &Leaf, ray: &Prepared, hit: &Hit) -> Hit {
    let (mask, t, u, v) = meet::<W>(leaf, ray, hit.t);
    if !mask.any() {
        return *hit;
    }
    // Ids ascend within a leaf: the first of equally near lanes has the smallest.
    let t = W::select(mask, t, W::splat(f32::INFINITY));
    let nearest = t.min_lane();
    let i = (t.eq(W::splat(nearest)).bits().trailing_zeros() & 7) as usize;
    let id = leaf.id(i);
    let tie = (nearest == hit.t) & hit.is_some() & (id < hit.triangle);
    let take = (nearest < hit.t) | tie;
    let pick = |new: u32, old: u32| select_unpredictable(take, new, old);
    let float = |new: f32, old: f32| f32::from_bits(pick(new.to_bits(), old.to_bits()));
    Hit {
        t: float(nearest, hit.t),
        u: float(u.array()[i], hit.u),
        v: float(v.array()[i], hit.v),
        triangle: pick(id, hit.triangle),
    }
}

/// Whether the ray hits anything in the leaf nearer than `t_max`.
#[inline(always)]
pub(super) fn any_in_leaf<W: Wide>(leaf: &Leaf, ray: &Prepared, t_max: f32) -> bool {
    let (mask, t, ..) = meet::<W>(leaf, ray, t_max);
    (mask & t.lt(W::splat(t_max))).any()
}

/// The same test on one triangle, for brute force.
pub(super) fn closest_of_one(corners: &[[f32; 3]; 3], id: u32, ray: &Prepared, hit: &mut Hit) {
    let Some((mask, t, u, v)) = Sheared::splat(ray, hit.t).test(|k, axis| corners[k][ray.axis(axis) as usize]) else {
        return;
    };
    if mask && (t < hit.t || (t == hit.t && hit.is_some() && id < hit.triangle)) {
        *hit = Hit { t, u, v, triangle: id };
    }
}
