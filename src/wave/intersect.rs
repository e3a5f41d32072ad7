//! Closest hits of all rays of a wave.

use super::queues::{HitRow, PathQueue, Queues};
use crate::accel::{BatchTracer, Bvh, Hit, RayLanes, RaySource, RaysFrom, Tiles};
use crate::columns::Rows;
use crate::lanes::{Kernel, Lanes, Wide};

/// The current rays of all paths.
impl RaySource for PathQueue {
    #[inline(always)]
    fn rays<L: Lanes>(&self, rows: &Rows) -> RayLanes<L> {
        RayLanes { origin: self.origin(rows), direction: self.direction(rows), t_max: L::splat(f32::INFINITY) }
    }
}

/// Fills the hit column of every path.
pub struct Intersect<'a> {
    pub q: &'a mut Queues,
    pub bvh: &'a Bvh,
    /// For camera rays, whose neighbours run the same way, and for those that run anywhere.
    pub tracer: &'a mut Tiles,
    /// The first row with a camera ray; all from there on have one.
    pub fresh: usize,
}

impl Kernel for Intersect<'_> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, bvh, tracer, fresh } = self;
        let (paths, hits) = (&q.paths, &mut q.hits);
        let mut found = |row: usize, hit: Hit| {
            hits.scatter::<f32>(&Rows::range(row, 1), HitRow { u: hit.u, v: hit.v, triangle: hit.triangle });
        };
        tracer.loose().trace::<W, false>(bvh, fresh, paths, &mut found);
        let camera = RaysFrom { rays: paths, first: fresh };
        tracer.trace::<W, false>(bvh, paths.len() - fresh, &camera, |i, hit| found(fresh + i, hit));
    }
}
