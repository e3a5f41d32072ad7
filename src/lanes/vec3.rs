//! Three components in lanes, and frames about a normal.

use super::Lanes;
use std::ops::{Add, Mul, Neg, Sub};

/// Three-component vector, each component in lanes.
#[derive(Clone, Copy, Debug)]
pub struct Vec3<L> {
    /// First component.
    pub x: L,
    /// Second component.
    pub y: L,
    /// Third component.
    pub z: L,
}

impl<L: Lanes> Vec3<L> {
    /// The vector (x, y, z).
    #[inline(always)]
    pub fn new(x: L, y: L, z: L) -> Self {
        Self { x, y, z }
    }
    /// All lanes set to `v`.
    #[inline(always)]
    pub fn splat(v: [f32; 3]) -> Self {
        Self::new(L::splat(v[0]), L::splat(v[1]), L::splat(v[2]))
    }
    /// Lane i is `f(i)`.
    #[inline(always)]
    pub fn from_fn(f: impl Fn(usize) -> [f32; 3]) -> Self {
        Self::new(L::from_fn(|i| f(i)[0]), L::from_fn(|i| f(i)[1]), L::from_fn(|i| f(i)[2]))
    }
    /// Three vectors from a row of nine numbers per lane.
    #[inline(always)]
    pub fn triple<'a>(row: impl Fn(usize) -> &'a [[f32; 3]; 3]) -> [Self; 3] {
        let [ax, ay, az, bx, by, bz, cx, cy] =
            L::columns8(|i| row(i).as_flattened().first_chunk().expect("nine numbers hold eight"));
        let cz = L::from_fn(|i| row(i)[2][2]);
        [Self::new(ax, ay, az), Self::new(bx, by, bz), Self::new(cx, cy, cz)]
    }
    /// Dot product.
    #[inline(always)]
    pub fn dot(self, o: Self) -> L {
        self.x.mul_add(o.x, self.y.mul_add(o.y, self.z * o.z))
    }
    /// Cross product; the difference of products is not fused, so that it is exactly antisymmetric.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(self.y * o.z - self.z * o.y, self.z * o.x - self.x * o.z, self.x * o.y - self.y * o.x)
    }
    /// Squared length.
    #[inline(always)]
    pub fn length2(self) -> L {
        self.dot(self)
    }
    /// The vector at length 1.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * (L::splat(1.0) / self.length2().sqrt())
    }
    /// The vector at length 1, where rounding alone has made it other than that: a Newton step, without a root or division.
    #[inline(always)]
    pub fn renormalize(self) -> Self {
        self * self.length2().mul_add(L::splat(-0.5), L::splat(1.5))
    }
    /// Product component by component.
    #[inline(always)]
    pub fn scale(self, o: Self) -> Self {
        Self::new(self.x * o.x, self.y * o.y, self.z * o.z)
    }
    /// Absolute values.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }
    /// `self * s + o`.
    #[inline(always)]
    pub fn mul_add(self, s: L, o: Self) -> Self {
        Self::new(self.x.mul_add(s, o.x), self.y.mul_add(s, o.y), self.z.mul_add(s, o.z))
    }
    /// The largest component.
    #[inline(always)]
    pub fn max_component(self) -> L {
        self.x.max(self.y).max(self.z)
    }
    /// One lane as an array.
    #[inline(always)]
    pub fn lane(self, i: usize) -> [f32; 3] {
        [self.x.array().as_ref()[i], self.y.array().as_ref()[i], self.z.array().as_ref()[i]]
    }
}

impl<L: Lanes> Add for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}
impl<L: Lanes> Sub for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}
impl<L: Lanes> Mul<L> for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: L) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}
impl<L: Lanes> Neg for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

/// `yes` in the lanes where the mask is set, else `no`.
#[inline(always)]
pub fn select3<L: Lanes>(mask: L::Mask, yes: Vec3<L>, no: Vec3<L>) -> Vec3<L> {
    Vec3::new(L::select(mask, yes.x, no.x), L::select(mask, yes.y, no.y), L::select(mask, yes.z, no.z))
}

/// The largest magnitude among the coordinates of three points.
#[inline(always)]
pub fn largest_coordinate<L: Lanes>([a, b, c]: [Vec3<L>; 3]) -> L {
    let (a, b, c) = (a.abs(), b.abs(), c.abs());
    let largest = |p: L, q: L, r: L| p.max(q).max(r);
    largest(largest(a.x, b.x, c.x), largest(a.y, b.y, c.y), largest(a.z, b.z, c.z))
}

/// Right-handed orthonormal frame; its third axis is a given unit normal.
#[derive(Clone, Copy, Debug)]
pub struct Frame<L> {
    /// First tangent.
    pub s: Vec3<L>,
    /// Second tangent.
    pub t: Vec3<L>,
    /// The normal.
    pub n: Vec3<L>,
}

impl<L: Lanes> Frame<L> {
    /// Frame about the unit vector `n`, without a branch: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    #[inline(always)]
    pub fn about(n: Vec3<L>) -> Self {
        let one = L::splat(1.0);
        let sign = one.copysign(n.z);
        let a = -(one / (sign + n.z));
        let b = n.x * n.y * a;
        let s = Vec3::new(one + sign * n.x * n.x * a, sign * b, -(sign * n.x));
        let t = Vec3::new(b, sign + n.y * n.y * a, -n.y);
        Self { s, t, n }
    }
    /// From world to local components.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<L>) -> Vec3<L> {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }
    /// From local components to world.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<L>) -> Vec3<L> {
        self.s.mul_add(v.x, self.t.mul_add(v.y, self.n * v.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_is_orthonormal_at_the_poles_too() {
        for n in
            [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [1e-4, 1e-4, -1.0], [0.267_261, 0.534_522, 0.801_784]]
        {
            let n = Vec3::<f32>::splat(n).normalize();
            let f = Frame::about(n);
            for (a, b, expected) in [
                (f.s, f.s, 1.0),
                (f.t, f.t, 1.0),
                (f.s, f.t, 0.0),
                (f.s, f.n, 0.0),
                (f.t, f.n, 0.0),
                (f.s.cross(f.t), f.n, 1.0),
            ] {
                assert!((a.dot(b) - expected).abs() < 1e-6, "{n:?}: {a:?} . {b:?}");
            }
        }
    }
}
