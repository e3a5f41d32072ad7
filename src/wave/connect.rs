//! Shadow rays: direct light, where nothing is in between.

use super::Samples;
use super::queues::{Queues, ShadowQueue};
use crate::accel::{BatchTracer, Bvh, RayLanes, RaySource, Streams};
use crate::columns::Rows;
use crate::lanes::{Kernel, Lanes, Vec3, Wide};

/// The segments of connections: their ends lie off the light, so that they may be tested in full.
#[inline(always)]
pub fn shadow_rays<L: Lanes>(origin: Vec3<L>, direction: Vec3<L>) -> RayLanes<L> {
    RayLanes { origin, direction, t_max: L::splat(1.0) }
}

/// The segments of all connections.
impl RaySource for ShadowQueue {
    #[inline(always)]
    fn rays<L: Lanes>(&self, rows: &Rows) -> RayLanes<L> {
        shadow_rays(self.origin(rows), self.direction(rows))
    }
}

/// Adds the radiance of all connections that nothing blocks.
pub struct Connect<'a> {
    pub q: &'a mut Queues,
    pub bvh: &'a Bvh,
    pub tracer: &'a mut Streams,
    pub samples: &'a mut Samples,
}

impl Kernel for Connect<'_> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, bvh, tracer, samples } = self;
        let shadows = &q.shadows;
        tracer.trace::<W, true>(bvh, shadows.len(), shadows, |row, hit| {
            if !hit.is_some() {
                let at = Rows::range(row, 1);
                samples.add::<f32>(1, shadows.slot::<f32>(&at), shadows.radiance(&at));
            }
        });
        q.shadows.clear();
    }
}
