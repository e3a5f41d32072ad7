//! Radiance of the background, brought by rays that hit nothing.

use super::Samples;
use super::queues::{Path, Queues};
use crate::columns::Rows;
use crate::lanes::{Kernel, Lanes, MAX_LANES, Vec3, Wide};

/// What a path that leaves the scene adds to its sample. Nothing else samples the background: its weight is 1.
#[inline(always)]
pub fn background_radiance<L: Lanes>(background: [f32; 3], path: &Path<L>) -> Vec3<L> {
    path.throughput.scale(Vec3::splat(background))
}

/// Adds the background to the samples of all escaped paths.
pub struct Escape<'a> {
    pub q: &'a Queues,
    pub background: [f32; 3],
    pub samples: &'a mut Samples,
}

impl Kernel for Escape<'_> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, background, samples } = self;
        for chunk in q.escaped.rows().chunks(MAX_LANES) {
            let rows = Rows::listed(chunk);
            let path = q.paths.gather::<W>(&rows);
            samples.add(rows.live(), path.slot, background_radiance(background, &path));
        }
    }
}
