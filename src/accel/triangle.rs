//! The watertight triangle test (Woop, Benthin and Wald 2013), one ray against lanes of triangles, from both sides.

use super::Hit;
use super::layout::Leaf;
use super::ray::{AXES, Prepared};
use crate::lanes::{F32x8, Lanes, Mask};

/// Edge functions and distance of lanes of triangles.
struct Edges<L> {
    u: L,
    v: L,
    w: L,
    a: [L; 3],
    b: [L; 3],
    c: [L; 3],
}

/// Corner relative to the ray, sheared: two coordinates across the ray, one along it. The same corner gives the same
/// numbers in every triangle, and the edge function below is exactly antisymmetric: so no ray slips between neighbours.
#[inline(always)]
fn shear<L: Lanes>(ray: &Prepared, corner: impl Fn(usize) -> L) -> [L; 3] {
    let axes = AXES[(ray.permutation & 7) as usize];
    let [x, y, z] = std::array::from_fn(|k| corner(axes[k]) - L::splat(ray.origin[k]));
    [L::splat(-ray.shear[0]).mul_add(z, x), L::splat(-ray.shear[1]).mul_add(z, y), z * L::splat(ray.shear[2])]
}

#[inline(always)]
fn edges<L: Lanes>(ray: &Prepared, corner: impl Fn(usize, usize) -> L) -> Edges<L> {
    let a = shear(ray, |axis| corner(0, axis));
    let b = shear(ray, |axis| corner(1, axis));
    let c = shear(ray, |axis| corner(2, axis));
    // Not fused: fusing one product would break the antisymmetry.
    let edge = |p: &[L; 3], q: &[L; 3]| p[0] * q[1] - p[1] * q[0];
    Edges { u: edge(&c, &b), v: edge(&a, &c), w: edge(&b, &a), a, b, c }
}

/// (lanes hit in (0, `t_max`], t, u, v): the end is included for the sake of ties.
#[inline(always)]
fn finish<L: Lanes>(e: &Edges<L>, t_max: f32) -> (L::Mask, L, L, L) {
    let zero = L::splat(0.0);
    let some_negative = e.u.min(e.v).min(e.w).lt(zero);
    let some_positive = e.u.max(e.v).max(e.w).gt(zero);
    let det = e.u + e.v + e.w;
    let inv = L::splat(1.0) / det;
    let t = (e.u * e.a[2] + e.v * e.b[2] + e.w * e.c[2]) * inv;
    let hit = !(some_negative & some_positive) & !det.eq(zero) & t.gt(zero) & t.le(L::splat(t_max));
    (hit, t, e.v * inv, e.w * inv)
}

/// Where an edge function is exactly 0 its sign is not known from f32 products: f64 holds them exactly.
#[cold]
fn resolve<L: Lanes>(e: Edges<L>) -> Edges<L> {
    let exact = |p: &[L; 3], q: &[L; 3]| {
        let (px, py, qx, qy) = (p[0].array(), p[1].array(), q[0].array(), q[1].array());
        L::from_fn(|i| {
            let f = |x: &L::Array| f64::from(x.as_ref()[i]);
            (f(&px) * f(&qy) - f(&py) * f(&qx)) as f32
        })
    };
    let (u, v, w) = (exact(&e.c, &e.b), exact(&e.a, &e.c), exact(&e.b, &e.a));
    let zero = L::splat(0.0);
    let doubt = e.u.eq(zero) | e.v.eq(zero) | e.w.eq(zero);
    Edges { u: L::select(doubt, u, e.u), v: L::select(doubt, v, e.v), w: L::select(doubt, w, e.w), ..e }
}

#[inline(always)]
fn test<L: Lanes>(ray: &Prepared, t_max: f32, corner: impl Fn(usize, usize) -> L) -> (L::Mask, L, L, L) {
    let mut e = edges(ray, corner);
    let zero = L::splat(0.0);
    if (e.u.eq(zero) | e.v.eq(zero) | e.w.eq(zero)).any() {
        e = resolve(e);
    }
    finish(&e, t_max)
}

/// Takes the nearer of `hit` and what the ray hits in the leaf, of equally near triangles the smaller id; tells whether
/// it took anything.
#[inline(always)]
pub(super) fn closest_in_leaf(leaf: &Leaf, ray: &Prepared, hit: &mut Hit) -> bool {
    let (mask, t, u, v) = test::<F32x8>(ray, hit.t, |k, axis| F32x8::load(&leaf.corner[k][axis]));
    if mask.bits() == 0 {
        return false;
    }
    // Ids ascend within a leaf: the first of equally near lanes has the smallest.
    let t = F32x8::select(mask, t, F32x8::splat(f32::INFINITY));
    let nearest = t.min_lane();
    let i = (t.eq(F32x8::splat(nearest)).bits().trailing_zeros() & 7) as usize;
    if nearest == hit.t && !(hit.is_some() && leaf.id[i] < hit.triangle) {
        return false;
    }
    *hit = Hit { t: nearest, u: u.array()[i], v: v.array()[i], triangle: leaf.id[i] };
    true
}

/// Whether the ray hits anything in the leaf nearer than `t_max`.
#[inline(always)]
pub(super) fn any_in_leaf(leaf: &Leaf, ray: &Prepared, t_max: f32) -> bool {
    let (mask, t, _, _) = test::<F32x8>(ray, t_max, |k, axis| F32x8::load(&leaf.corner[k][axis]));
    (mask & t.lt(F32x8::splat(t_max))).any()
}

/// The same test on one triangle, for brute force.
pub(super) fn closest_of_one(corners: &[[f32; 3]; 3], id: u32, ray: &Prepared, hit: &mut Hit) {
    let (mask, t, u, v) = test::<f32>(ray, hit.t, |k, axis| corners[k][axis]);
    if mask && (t < hit.t || (t == hit.t && hit.is_some() && id < hit.triangle)) {
        *hit = Hit { t, u, v, triangle: id };
    }
}
