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
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let mut b = Self::default();
        for a in 0..3 {
            let d = ray.direction[a];
            let inv = 1.0 / d.abs().max(TINY).copysign(d);
            let off = ray.origin[a] * inv;
            let pad = off.abs() * (2.0 * f32::EPSILON);
            let backwards = 3 * (inv.to_bits() >> 31) as usize;
            b.inv[a] = inv;
            b.near_off[a] = off + pad;
            b.far_off[a] = off - pad;
            b.near_row[a] = a + backwards;
            b.far_row[a] = a + 3 - backwards;
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

/// Axes for each largest component, upwards and downwards: the handedness of the triangle stays.
const AXES: [[usize; 3]; 6] = [[1, 2, 0], [2, 0, 1], [0, 1, 2], [2, 1, 0], [0, 2, 1], [1, 0, 2]];

impl ShearRay {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let a = d.map(f32::abs);
        // Selections in place of branches: which axis is the largest is anyone's guess.
        let first = usize::from(a[0] <= a[1]);
        let z = if a[2] >= a[0].max(a[1]) { 2 } else { first };
        let axis = AXES[z + 3 * (d[z].to_bits() >> 31) as usize];
        let inv = 1.0 / d[z];
        Self { origin: ray.origin, axis, shear: [d[axis[0]] * inv, d[axis[1]] * inv, inv] }
    }
}
