//! Shadow rays: direct light, where nothing is in between.

use super::Samples;
use super::queues::{Queues, ShadowQueue};
use crate::accel::{BatchTracer, Bvh, RayLanes, RaySource, Streams};
use crate::columns::Rows;
use crate::lanes::{Kernel, Lanes, MAX_LANES, Vec3, Wide};

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
        let Queues { shadows, open, .. } = q;
        open.clear();
        open.resize(shadows.len().div_ceil(MAX_LANES), 0);
        // Rays end in any order; samples are added to in theirs.
        tracer.trace::<W, true>(bvh, shadows.len(), &*shadows, |row, hit| {
            open[row / MAX_LANES] |= u8::from(!hit.is_some()) << (row % MAX_LANES);
        });
        for (group, &bits) in open.iter().enumerate() {
            let first = group * MAX_LANES;
            let rows = Rows::range(first, MAX_LANES.min(shadows.len() - first));
            samples.add::<W>(u32::from(bits), shadows.slot::<W>(&rows), shadows.radiance(&rows));
        }
        shadows.clear();
    }
}
