//! Connections of light paths to the camera, and what they bring to pixels.

use crate::accel::{BatchTracer, Bvh, RayLanes, RaySource, Streams};
use crate::columns::{Rows, columns};
use crate::lanes::{Frame, Kernel, Lanes, LanesU32, Mask, Vec3, Wide};
use crate::material::{Lobe, Materials, Table};
use crate::sampling::power_heuristic;
use crate::wave::caustic::first::{first_density, reversible};
use crate::wave::plan::Plan;
use crate::wave::queues::{HitRow, Path};
use crate::wave::shade::eval;
use crate::wave::shadow_rays;
use crate::wave::surface::Surface;
use crate::world::World;

columns! {
    /// Connections to the camera, yet to be tested.
    pub struct SplatQueue of Connection {
        /// A point off the surface.
        origin: V3,
        /// To the camera: the whole way.
        direction: V3,
        /// What the connection adds to the pixel, times the number of light paths, if nothing is in between.
        radiance: V3,
        /// The pixel across.
        x: U,
        /// The pixel down.
        y: U,
        /// Which light path of the job this is.
        slot: U,
        /// At which of its vertices.
        depth: U,
    }
}

impl<L: Lanes> Connection<L> {
    /// One that leads nowhere.
    #[inline(always)]
    pub fn none(path: &Path<L>) -> Self {
        let zero = L::Uint::splat(0);
        let Path { origin, direction, throughput, slot, depth, .. } = *path;
        Self { origin, direction, radiance: throughput, x: zero, y: zero, slot, depth }
    }
}

/// The segments of all connections.
impl RaySource for SplatQueue {
    #[inline(always)]
    fn rays<L: Lanes>(&self, rows: &Rows) -> RayLanes<L> {
        shadow_rays(self.origin(rows), self.direction(rows))
    }
}

/// Connections of light paths to the camera from `surface`, which is seen from where the light comes, and which of them may
/// bring anything.
#[inline(always)]
pub(super) fn connection<M: Lobe, L: Lanes>(
    world: &World,
    plan: &Plan,
    p: &M::Params<L>,
    path: &Path<L>,
    surface: &Surface<L>,
    hit: &HitRow<L>,
) -> (Connection<L>, L::Mask)
where
    Materials: Table<M>,
{
    let zero = L::splat(0.0);
    let view = &world.view;
    let wi = -path.direction;
    let origin = surface.spawn(L::Mask::splat(false));
    let way = Vec3::splat(view.origin()) - surface.point;
    let distance2 = way.length2();
    let wo = way * (L::splat(1.0) / distance2.sqrt());
    let ([x, y], inside) = view.pixel(-wo);
    let cos_wo = surface.ng.dot(wo);
    let seen = Surface::new(world, hit, wo);
    let lobe = eval::<M, L>(world.normals.is_some(), p, &seen, &Frame::about(seen.ns), wo, wi);
    let first = first_density(view, surface, -way, wi, lobe.pdf);
    let weight = power_heuristic(path.prev_pdf * L::splat(plan.light_paths), first);
    // From surface to pixel: cosine over squared distance, per area of the pixel; see `View::pixel_density`.
    let exposure = view.pixel_density(-wo) * cos_wo / (distance2 * surface.ng.dot(wi).abs());
    let radiance = path.throughput.scale(lobe.f_cos) * (weight * exposure);
    let connected = inside
        & cos_wo.gt(zero)
        & lobe.pdf.gt(zero)
        & radiance.max_component().gt(zero)
        & reversible(&seen, wo, wi, L::Mask::splat(false))
        & L::from_u24(path.depth).gt(zero);
    let (px, py) = (x.array(), y.array());
    let whole = |v: &L::Array| L::Uint::from_fn(|i| v.as_ref()[i].max(0.0) as u32);
    let direction = Vec3::splat(view.origin()) - origin;
    let (x, y) = (whole(&px), whole(&py));
    (Connection { origin, direction, radiance, x, y, slot: path.slot, depth: path.depth }, connected)
}

/// What a light path brings to a pixel: to be divided by the number of light paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Pixel across and down.
    pub pixel: [u32; 2],
    /// Linear RGB.
    pub radiance: [f32; 3],
    /// Number of the path in its job, then that of the vertex.
    order: (u32, u32),
}

/// All splats of a job.
#[derive(Clone, Debug, Default)]
pub struct Splats(Vec<Splat>);

impl Splats {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.0.clear();
    }
    /// Adds the first lane of a connection that nothing blocks.
    #[inline(always)]
    pub fn add(&mut self, c: &Connection<f32>) {
        self.0.push(Splat { pixel: [c.x, c.y], radiance: c.radiance.lane(0), order: (c.slot, c.depth) });
    }
    /// All, path by path: whatever the order in which they were found.
    pub fn sorted(&mut self) -> &[Splat] {
        self.0.sort_unstable_by_key(|s| s.order);
        &self.0
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<Splat>()
    }
}

/// Keeps all connections that nothing blocks.
pub struct Expose<'a> {
    pub to_camera: &'a mut SplatQueue,
    pub bvh: &'a Bvh,
    pub tracer: &'a mut Streams,
    pub splats: &'a mut Splats,
}

impl Kernel for Expose<'_> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { to_camera, bvh, tracer, splats } = self;
        let connections = &*to_camera;
        tracer.trace::<W, true>(bvh, connections.len(), connections, |row, hit| {
            if !hit.is_some() {
                splats.add(&connections.gather::<f32>(&Rows::range(row, 1)));
            }
        });
        to_camera.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splats_are_in_the_order_of_paths_and_tell_their_bytes() {
        let mut splats = Splats::default();
        assert_eq!(splats.bytes(), 0);
        for order in [(1, 0), (0, 2), (0, 1)] {
            splats.0.push(Splat { pixel: [order.1; 2], radiance: [0.5; 3], order });
        }
        assert_eq!(splats.sorted().iter().map(|s| s.pixel[0]).collect::<Vec<_>>(), [1, 2, 0]);
        assert!(splats.bytes() >= 3 * 28 && splats.bytes() % 28 == 0);
        splats.clear();
        assert!(splats.sorted().is_empty());
    }
}
