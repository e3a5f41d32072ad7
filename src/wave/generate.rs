//! Camera rays into the free rows of a wave.

use super::job::Job;
use super::queues::{Path, Queues, Scale};
use crate::camera::View;
use crate::columns::Rows;
use crate::lanes::{F32x8, Lanes, LanesU32, MAX_LANES, Vec3};
use crate::sampling::{Decision, Sampler};

/// The paths of `L::N` samples of a job, from number `slot` on; numbers past `last` repeat it.
#[inline(always)]
pub fn camera_paths<S: Sampler, L: Lanes>(view: &View, seed: u64, job: &Job, slot: usize, last: usize) -> Path<L> {
    let mut places = [([0u32; 2], 0u32); MAX_LANES];
    for (i, place) in places.iter_mut().enumerate().take(L::N) {
        *place = job.place((slot + i).min(last));
    }
    let pixel = L::Uint::from_fn(|i| places[i].0[1] * job.width + places[i].0[0]);
    let mut rng = S::start::<L>(seed, pixel, L::Uint::from_fn(|i| places[i].1));
    let depth = L::Uint::splat(0);
    let [ux, uy] = S::draw::<L, 2>(&mut rng, Decision::Pixel, depth);
    let x = L::from_u24(L::Uint::from_fn(|i| places[i].0[0])) + ux;
    let y = L::from_u24(L::Uint::from_fn(|i| places[i].0[1])) + uy;
    let (origin, direction) = view.ray(x, y);
    Path {
        origin,
        direction,
        throughput: Vec3::splat([1.0; 3]),
        prev_pdf: L::splat(f32::INFINITY),
        slot: L::Uint::from_fn(|i| (slot + i).min(last) as u32),
        depth,
        rng,
    }
}

/// Fills the free rows with the next samples of the job, and returns how many were made.
pub fn generate<S: Sampler>(q: &mut Queues, view: &View, seed: u64, job: &Job, next: usize, capacity: usize) -> usize {
    let count = (capacity - q.paths.len()).min(job.paths() - next);
    let mut made = 0;
    while made < count {
        let n = MAX_LANES.min(count - made);
        let live = Rows::range(0, n).live();
        q.paths.append(live, camera_paths::<S, F32x8>(view, seed, job, next + made, next + count - 1));
        if let Some(scales) = &mut q.scales {
            scales.append(live, Scale { scale: F32x8::splat(1.0) });
        }
        made += n;
    }
    count
}
