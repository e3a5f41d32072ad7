//! Closest hits of all rays of a wave.

use super::queues::{HitRow, Queues};
use crate::accel::{Bvh, Many, RayLanes};
use crate::columns::Rows;
use crate::lanes::{F32x8, Lanes};

/// Fills the hit column of every path.
pub fn intersect(q: &mut Queues, bvh: &Bvh, tracer: &mut Many) {
    let (paths, hits) = (&q.paths, &mut q.hits);
    let rays = |rows: &Rows| RayLanes {
        origin: paths.origin(rows),
        direction: paths.direction(rows),
        t_max: F32x8::splat(f32::INFINITY),
    };
    tracer.closest(bvh, paths.len(), rays, |row, hit| {
        hits.scatter::<f32>(&Rows::range(row, 1), HitRow { u: hit.u, v: hit.v, triangle: hit.triangle });
    });
}
