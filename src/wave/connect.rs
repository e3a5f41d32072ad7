//! Shadow rays: direct light, where nothing is in between.

use super::Samples;
use super::queues::Queues;
use crate::accel::{Bvh, Many, RayLanes};
use crate::columns::Rows;
use crate::lanes::{Lanes, Vec3};

/// The segments of connections: their ends lie off the light, so that they may be tested in full.
#[inline(always)]
pub fn shadow_rays<L: Lanes>(origin: Vec3<L>, direction: Vec3<L>) -> RayLanes<L> {
    RayLanes { origin, direction, t_max: L::splat(1.0) }
}

/// Adds the radiance of all connections that nothing blocks.
pub fn connect(q: &mut Queues, bvh: &Bvh, tracer: &mut Many, samples: &mut Samples) {
    let shadows = &q.shadows;
    let rays = |rows: &Rows| shadow_rays(shadows.origin(rows), shadows.direction(rows));
    tracer.any(bvh, shadows.len(), rays, |row, blocked| {
        if !blocked {
            let shadow = shadows.gather::<f32>(&Rows::range(row, 1));
            samples.add::<f32>(1, shadow.slot, shadow.radiance);
        }
    });
    q.shadows.clear();
}
