//! Closest hits of all rays of a wave.

use super::queues::{HitRow, Queues};
use crate::accel::{Bvh, Many, Ray};
use crate::columns::Rows;

/// Fills the hit column of every path.
pub fn intersect(q: &mut Queues, bvh: &Bvh, tracer: &mut Many) {
    let (paths, hits) = (&q.paths, &mut q.hits);
    let ray = |row: usize| {
        let at = Rows::range(row, 1);
        Ray {
            origin: paths.origin::<f32>(&at).lane(0),
            direction: paths.direction::<f32>(&at).lane(0),
            t_max: f32::INFINITY,
        }
    };
    tracer.closest(bvh, paths.len(), ray, |row, hit| {
        hits.scatter::<f32>(&Rows::range(row, 1), HitRow { u: hit.u, v: hit.v, triangle: hit.triangle });
    });
}
