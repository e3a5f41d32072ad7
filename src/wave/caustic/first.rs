//! What the weight of focused light needs to know of a path's first bounce.

use crate::camera::View;
use crate::lanes::{Lanes, Mask, Vec3};
use crate::wave::surface::Surface;

/// Density of a path's first bounce as [`First`](crate::wave::queues::First) has it: `pdf` that of the direction of scattering at
/// `surface`, `wi`, per solid angle, `way` the camera ray.
#[inline(always)]
pub fn first_density<L: Lanes>(view: &View, surface: &Surface<L>, way: Vec3<L>, wi: Vec3<L>, pdf: L) -> L {
    let distance2 = way.length2();
    let direction = way * (L::splat(1.0) / distance2.sqrt());
    let cos = surface.ng.dot(direction).abs();
    pdf / surface.ng.dot(wi).abs() * view.pixel_density(direction) * cos / distance2
}

/// Whether light that is scattered between two directions could come the other way with the same lobe: see
/// [`Surface::regular`].
#[inline(always)]
pub fn reversible<L: Lanes>(surface: &Surface<L>, seen: Vec3<L>, other: Vec3<L>, through: L::Mask) -> L::Mask {
    surface.regular(seen, L::Mask::splat(false)) & surface.regular(other, through)
}
