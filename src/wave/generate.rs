//! Camera rays into the free rows of a wave.

use super::Context;
use super::job::{Job, Place};
use super::queues::{First, Normal, Path, Queues, Scale};
use crate::columns::Rows;
use crate::lanes::{Kernel, Lanes, LanesU32, MAX_LANES, Vec3, Wide};
use crate::sampling::{Decision, Sampler};
use std::marker::PhantomData;

/// The paths of `L::N` samples of a job, from number `slot` on; numbers past `last` repeat it.
#[inline(always)]
pub fn camera_paths<S: Sampler, L: Lanes>(cx: &Context<'_>, job: &Job, slot: usize, last: usize) -> Path<L> {
    let (mut x, mut y, mut sample, mut number) = ([0; MAX_LANES], [0; MAX_LANES], [0; MAX_LANES], [0; MAX_LANES]);
    let mut place = Place::default();
    let mut next = job.places(slot).take(last + 1 - slot);
    for i in 0..L::N {
        place = next.next().unwrap_or(place);
        [x[i], y[i]] = place.pixel;
        sample[i] = place.sample;
        number[i] = (slot + i).min(last) as u32;
    }
    let (x, y) = (L::Uint::load(&x), L::Uint::load(&y));
    let mut rng = S::on_screen::<L>(&cx.screen, cx.seed, [x, y], L::Uint::load(&sample));
    let depth = L::Uint::splat(0);
    let [ux, uy] = S::draw::<L, 2>(&mut rng, Decision::Pixel, depth);
    let x = L::from_u24(x) + ux;
    let y = L::from_u24(y) + uy;
    let (origin, direction) = cx.world.view.ray(x, y);
    Path {
        origin,
        direction,
        throughput: Vec3::splat([1.0; 3]),
        prev_pdf: L::splat(f32::INFINITY),
        slot: L::Uint::load(&number),
        depth,
        rng,
    }
}

/// Appends the paths of the next samples of the job.
pub struct Generate<'a, S> {
    pub q: &'a mut Queues,
    pub cx: &'a Context<'a>,
    pub sampler: PhantomData<S>,
    pub job: &'a Job,
    /// Number of the first sample that was not made yet.
    pub next: usize,
    /// How many.
    pub count: usize,
}

impl<S: Sampler> Kernel for Generate<'_, S> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, cx, job, next, count, .. } = self;
        // A loop by hand: as one over groups it takes 1.16 times as long.
        let mut made = 0;
        while made < count {
            let n = MAX_LANES.min(count - made);
            q.paths.append(Rows::range(0, n).live(), camera_paths::<S, W>(cx, job, next + made, next + count - 1));
            made += n;
        }
        let groups = || (0..count).step_by(MAX_LANES).map(|first| Rows::range(0, MAX_LANES.min(count - first)).live());
        // Each in a pass of its own: scenes without them ask once.
        if let Some(scales) = &mut q.scales {
            for live in groups() {
                scales.append(live, Scale { scale: W::splat(1.0) });
            }
        }
        if let Some(firsts) = &mut q.firsts {
            for live in groups() {
                firsts.append(live, First::<W>::none());
            }
        }
        if let Some(normals) = &mut q.normals {
            for live in groups() {
                normals.append(live, Normal { normal: Vec3::<W>::splat([0.0; 3]) });
            }
        }
    }
}
