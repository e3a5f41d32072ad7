//! What a ray carries through the tree: reciprocals for boxes, a shear for triangles.

use super::Ray;

/// A ray, ready for box tests: slab distances are `plane * inv - off`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BoxRay {
    pub inv: [f32; 3],
    /// Padded so that distances to near planes come out too small ...
    pub near_off: [f32; 3],
    /// ... and to far planes too large.
    pub far_off: [f32; 3],
    /// Row of [`super::layout::Node::bounds`] with the near plane of each axis.
    pub near_row: [usize; 3],
    /// Row with the far plane.
    pub far_row: [usize; 3],
}

/// Relative error of a slab distance, with room: the reciprocal, its product, the fused sum (Ize 2013).
pub(super) const SLAB_SLACK: f32 = 1.0 + 4.0 * f32::EPSILON;
/// Direction components below this are taken as this in box tests, so that no 0 x infinity arises.
const TINY: f32 = 1e-20;

impl BoxRay {
    pub fn new(ray: &Ray) -> Self {
        let mut b = Self::default();
        for a in 0..3 {
            let d = ray.direction[a];
            let inv = 1.0 / if d.abs() < TINY { TINY.copysign(d) } else { d };
            let off = ray.origin[a] * inv;
            let pad = off.abs() * (2.0 * f32::EPSILON);
            b.inv[a] = inv;
            b.near_off[a] = off + pad;
            b.far_off[a] = off - pad;
            b.near_row[a] = if inv < 0.0 { a + 3 } else { a };
            b.far_row[a] = if inv < 0.0 { a } else { a + 3 };
        }
        b
    }
}

/// A ray, ready for the watertight triangle test: axes permuted so that the direction's largest component is last, and
/// the shear that turns the direction onto that axis (Woop, Benthin and Wald 2013).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShearRay {
    pub origin: [f32; 3],
    /// The permuted axes.
    pub axis: [usize; 3],
    pub shear: [f32; 3],
}

impl ShearRay {
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let a = d.map(f32::abs);
        let z = if a[0] > a[1] {
            if a[0] > a[2] { 0 } else { 2 }
        } else if a[1] > a[2] {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        Self { origin: ray.origin, axis: [x, y, z], shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]] }
    }
}
