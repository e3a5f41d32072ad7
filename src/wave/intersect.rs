//! Closest hits of all rays of a wave.

use super::queues::{HitRow, PathQueue, Queues};
use crate::accel::{Bvh, Hit, Many, RayLanes, RaySource, Tiles};
use crate::columns::Rows;
use crate::lanes::{Kernel, Lanes, Wide};

/// The current rays of all paths.
impl RaySource for PathQueue {
    #[inline(always)]
    fn rays<L: Lanes>(&self, rows: &Rows) -> RayLanes<L> {
        RayLanes { origin: self.origin(rows), direction: self.direction(rows), t_max: L::splat(f32::INFINITY) }
    }
}

/// The rays of a queue from row `first` on.
struct From<'a, Q> {
    rays: &'a Q,
    first: usize,
}

impl<Q: RaySource> RaySource for From<'_, Q> {
    #[inline(always)]
    fn rays<L: Lanes>(&self, rows: &Rows) -> RayLanes<L> {
        self.rays.rays(&rows.shifted(self.first))
    }
}

/// Fills the hit column of every path.
pub struct Intersect<'a> {
    pub q: &'a mut Queues,
    pub bvh: &'a Bvh,
    /// For rays that run anywhere.
    pub many: &'a mut Many,
    /// For camera rays, whose neighbours run the same way.
    pub tiles: &'a mut Tiles,
    /// The first row with a camera ray; all from there on have one.
    pub fresh: usize,
}

impl Kernel for Intersect<'_> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, bvh, many, tiles, fresh } = self;
        let (paths, hits) = (&q.paths, &mut q.hits);
        let mut found = |row: usize, hit: Hit| {
            hits.scatter::<f32>(&Rows::range(row, 1), HitRow { u: hit.u, v: hit.v, triangle: hit.triangle });
        };
        many.trace::<W, false>(bvh, fresh, paths, &mut found);
        let camera = From { rays: paths, first: fresh };
        tiles.trace::<W, false>(bvh, paths.len() - fresh, &camera, |i, hit| found(fresh + i, hit));
    }
}
