//! Shadow rays: direct light, where nothing is in between.

use super::Samples;
use super::queues::{Queues, Shadow};
use crate::accel::{Bvh, Many, Ray};
use crate::columns::Rows;
use crate::lanes::Lanes;

/// The segment of a connection: its end lies off the light, so that it may be tested in full.
#[inline(always)]
pub fn shadow_ray<L: Lanes>(shadow: &Shadow<L>, lane: usize) -> Ray {
    Ray { origin: shadow.origin.lane(lane), direction: shadow.direction.lane(lane), t_max: 1.0 }
}

/// Adds the radiance of all connections that nothing blocks.
pub fn connect(q: &mut Queues, bvh: &Bvh, tracer: &mut Many, samples: &mut Samples) {
    let shadows = &q.shadows;
    let ray = |row: usize| shadow_ray::<f32>(&shadows.gather(&Rows::range(row, 1)), 0);
    tracer.any(bvh, shadows.len(), ray, |row, blocked| {
        if !blocked {
            let shadow = shadows.gather::<f32>(&Rows::range(row, 1));
            samples.add::<f32>(1, shadow.slot, shadow.radiance);
        }
    });
    q.shadows.clear();
}
