//! Light paths leave the lamps.

use crate::columns::Rows;
use crate::lanes::{Kernel, Lanes, LanesU32, MAX_LANES, Wide};
use crate::sampling::{Decision, Sampler};
use crate::wave::queues::{Path, Queues, Scale};
use crate::wave::surface::off_surface;
use crate::world::World;
use std::marker::PhantomData;

/// The light paths from number `first + slot` on, and the scale of their throughput; slots past `last` repeat it.
/// `prev_pdf` holds the density of their start per area and projected solid angle.
#[inline(always)]
pub fn light_paths<S: Sampler, L: Lanes>(
    world: &World,
    seed: u64,
    first: u64,
    slot: usize,
    last: usize,
) -> (Path<L>, L) {
    let number = |i: usize| first + (slot + i).min(last) as u64;
    // Numbered like samples of pixels that no image has.
    let pixel = L::Uint::from_fn(|i| !((number(i) >> 32) as u32));
    let mut rng = S::start::<L>(seed, pixel, L::Uint::from_fn(|i| number(i) as u32));
    let depth = L::Uint::splat(0);
    let picks = S::draw::<L, 2>(&mut rng, Decision::Pick, depth);
    let at = S::draw::<L, 2>(&mut rng, Decision::Light, depth);
    let towards = S::draw::<L, 2>(&mut rng, Decision::Pixel, depth);
    let light = world.lights.emit(&world.targets, picks, at, towards);
    let throughput = light.radiance * (L::splat(1.0) / light.density);
    let path = Path {
        origin: off_surface(light.point, light.reach, light.normal),
        direction: light.direction,
        throughput,
        prev_pdf: light.density,
        slot: L::Uint::from_fn(|i| (slot + i).min(last) as u32),
        depth,
        rng,
    };
    (path, throughput.max_component())
}

/// Appends the next light paths.
pub struct Start<'a, S> {
    pub q: &'a mut Queues,
    pub world: &'a World,
    pub sampler: PhantomData<S>,
    pub seed: u64,
    /// Number of the job's first path.
    pub first: u64,
    /// Paths of the job that were started before.
    pub next: usize,
    /// How many.
    pub count: usize,
}

impl<S: Sampler> Kernel for Start<'_, S> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, world, seed, first, next, count, .. } = self;
        let mut made = 0;
        while made < count {
            let n = MAX_LANES.min(count - made);
            let live = Rows::range(0, n).live();
            let (path, scale) = light_paths::<S, W>(world, seed, first, next + made, next + count - 1);
            q.paths.append(live, path);
            if let Some(scales) = &mut q.scales {
                scales.append(live, Scale { scale });
            }
            made += n;
        }
    }
}
