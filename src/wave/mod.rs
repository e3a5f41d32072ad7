//! The wavefront: paths move in batches through the stages, struct-of-arrays between them. One small wave per worker;
//! nothing is shared between workers.

mod caustic;
mod compact;
mod connect;
mod effort;
mod emit;
mod escape;
mod feature;
mod form;
mod generate;
mod intersect;
mod job;
mod plan;
mod queues;
mod roulette;
mod route;
mod shade;
mod surface;
mod traffic;

pub use caustic::aim::{Aimed, aim_rows, aims, ratio};
pub use caustic::{JOB as LIGHT_JOB, LightWave, Reversed, Splat, Splats, light_paths, scatter_rows, survey};
pub use connect::shadow_rays;
pub use effort::Efforts;
pub use emit::emitted_radiance;
pub use escape::background_radiance;
pub use feature::Feature;
pub use form::Focused;
pub use generate::camera_paths;
pub use job::{Grid, Job, Place, Places};
pub use plan::{BOUNCE_LIMIT, DEFAULT_JOB, Method, Plan, PrevPdf, Tuning};
pub use queues::{First, HitRow, Path, Queues};
pub use shade::{Shaded, shade_rows};

use crate::accel::{Bvh, Tiles};
use crate::lanes::{Lanes, LanesU32, Vec3, dispatch};
use crate::light::Spots;
use crate::material::for_kind;
use crate::probe::{Probe, Stage};
use crate::sampling::{Sampler, Screen};
use crate::world::World;
use caustic::aim::follow;
use compact::Compact;
use connect::Connect;
use emit::Emit;
use escape::Escape;
use generate::Generate;
use intersect::Intersect;
use route::Route;
use shade::Shade;
use std::marker::PhantomData;

/// What was traced, and what was cut.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Camera rays.
    pub camera: u64,
    /// Rays after a bounce.
    pub bounce: u64,
    /// Shadow rays, those of light paths included.
    pub shadow: u64,
    /// Rays of light paths.
    pub light: u64,
    /// Paths that were cut at the largest number of bounces.
    pub cut: u64,
    /// Their throughput without the scale of refraction, averaged over the channels, summed: the share of energy that may be
    /// missing.
    pub cut_throughput: f64,
}

impl Counts {
    /// All rays.
    pub fn rays(&self) -> u64 {
        self.camera + self.bounce + self.shadow + self.light
    }
    /// Notes a path that was cut, with the share of energy that it has left.
    pub fn cut(&mut self, energy: Vec3<f32>) {
        self.cut += 1;
        self.cut_throughput += energy.lane(0).iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0;
    }
    /// Adds another's numbers.
    pub fn add(&mut self, other: &Self) {
        self.camera += other.camera;
        self.bounce += other.bounce;
        self.shadow += other.shadow;
        self.light += other.light;
        self.cut += other.cut;
        self.cut_throughput += other.cut_throughput;
    }
}

/// Radiance of the samples of a job, by slot. A sample's terms arrive in the order of its path's vertices, so that the
/// sum does not depend on what else is in the wave.
#[derive(Clone, Debug, Default)]
pub struct Samples(Vec<[f32; 3]>);

impl Samples {
    /// Starts `count` samples at black.
    pub fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.resize(count, [0.0; 3]);
    }
    /// Adds the lanes whose bit is set to their slots.
    #[inline(always)]
    pub fn add<L: Lanes>(&mut self, mut bits: u32, slot: L::Uint, radiance: Vec3<L>) {
        let slots = slot.array();
        while bits != 0 {
            let i = bits.trailing_zeros() as usize % L::N;
            let sample = &mut self.0[slots.as_ref()[i] as usize];
            let r = radiance.lane(i);
            *sample = [sample[0] + r[0], sample[1] + r[1], sample[2] + r[2]];
            bits &= bits - 1;
        }
    }
    /// The samples, by slot.
    pub fn all(&self) -> &[[f32; 3]] {
        &self.0
    }
}

/// What all waves of a render read.
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// The frozen scene.
    pub world: &'a World,
    /// The tree over its triangles.
    pub bvh: &'a Bvh,
    /// Which stages run.
    pub plan: &'a Plan,
    /// Where focused light comes from.
    pub spots: &'a Spots,
    /// Seed of the random numbers.
    pub seed: u64,
    /// The pixels that it is for.
    pub screen: Screen,
}

/// Rays that are traced together where they run the same way.
const TILE: usize = 64;

/// The paths of one worker.
#[derive(Clone, Debug)]
pub struct Wave<S> {
    queues: Queues,
    /// Of paths that look for focused light.
    aimed: Plan,
    tracer: Tiles,
    samples: Samples,
    sampler: PhantomData<S>,
}

impl<S: Sampler> Wave<S> {
    /// A wave for what the plan needs.
    pub fn new(cx: &Context<'_>) -> Self {
        let mut tracer = Tiles::new();
        tracer.loose().allow(cx.plan.tuning.streams);
        Self {
            queues: Queues::new(cx.plan),
            aimed: cx.plan.of_aimed_paths(),
            tracer,
            samples: Samples::default(),
            sampler: PhantomData,
        }
    }

    /// Bytes that the wave holds.
    pub fn bytes(&self, plan: &Plan) -> usize {
        plan.wave_size * plan.path_bytes() + self.samples.0.capacity() * size_of::<[f32; 3]>()
    }

    /// Traces all samples of a job, and returns their radiance by slot.
    pub fn run(&mut self, cx: &Context<'_>, job: &Job, probe: &mut impl Probe, counts: &mut Counts) -> &[[f32; 3]] {
        let Context { world, bvh, plan, spots, .. } = *cx;
        let Self { queues: q, aimed: of_aimed, tracer, samples, .. } = self;
        samples.reset(job.paths());
        tracer.restart();
        let mut next = 0;
        loop {
            let fresh = q.paths.len();
            let free = if plan.tuning.refill || fresh == 0 { plan.wave_size - fresh } else { 0 };
            let count = refill(free, job.paths() - next, plan.wave_size);
            probe.stage(Stage::Generate, count, || {
                dispatch(Generate { q, cx, sampler: PhantomData::<S>, job, next, count });
            });
            next += count;
            let n = q.paths.len();
            if n == 0 {
                return samples.all();
            }
            counts.camera += count as u64;
            counts.bounce += fresh as u64;
            probe.wave(q.paths.depths(), count);
            let loose = if plan.tuning.tiles { fresh } else { n };
            probe.stage(Stage::Intersect, n, || dispatch(Intersect { q, bvh, tracer, fresh: loose }));
            probe.stage(Stage::Route, n, || dispatch(Route { q, world, plan, counts }));
            if let Some(background) = world.background {
                probe.stage(Stage::Escape, q.escaped.len(), || dispatch(Escape { q, background, samples }));
            }
            if plan.emit {
                let hits = q.by_kind[crate::material::Kind::Luminous as usize].len();
                probe.stage(Stage::Emit, hits, || dispatch(Emit { q, world, plan, samples }));
            }
            if plan.sole_kind() {
                // Without gaps, shading reads whole registers, and closes the gaps that it makes.
                probe.stage(Stage::Compact, n, || dispatch(Compact { q, shaded: false }));
            }
            for &kind in &plan.kinds {
                let hits = if plan.sole_kind() { q.paths.len() } else { q.by_kind[kind as usize].len() };
                for_kind!(kind, M => {
                    let of = PhantomData::<(M, S)>;
                    probe.stage(Stage::Shade, hits, || dispatch(Shade { q, of, kind, world, plan, spots }))
                });
            }
            if plan.connect {
                let shadows = q.shadows.len();
                counts.shadow += shadows as u64;
                probe.stage(Stage::Connect, shadows, || dispatch(Connect { q, bvh, tracer: tracer.loose(), samples }));
            }
            if let Some(aimed) = q.aimed.as_mut().filter(|aimed| !aimed.paths.is_empty()) {
                follow::<S>(cx, of_aimed, aimed, tracer, samples, probe, counts);
            }
            if plan.kinds.is_empty() {
                q.truncate(0);
            } else if !plan.sole_kind() {
                probe.stage(Stage::Compact, q.paths.len(), || dispatch(Compact { q, shaded: true }));
            }
        }
    }
}

/// Paths to make where `free` rows are free and `left` samples are left: whole tiles of rays while there are more to come,
/// so that tiles stay together. Small waves take what they get.
fn refill(free: usize, left: usize, wave_size: usize) -> usize {
    if left <= free || wave_size < 8 * TILE { left.min(free) } else { free - free % TILE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_traced_adds_up() {
        let of =
            |camera, bounce, shadow, light, cut| Counts { camera, bounce, shadow, light, cut, cut_throughput: 0.5 };
        let (mut all, more) = (of(2, 3, 5, 7, 11), of(100, 200, 300, 400, 500));
        assert_eq!((all.rays(), more.rays()), (17, 1000));
        all.add(&more);
        all.cut(Vec3::splat([0.25, 0.5, 0.75]));
        assert_eq!((all.camera, all.bounce, all.shadow, all.light, all.cut), (102, 203, 305, 407, 512));
        assert_eq!(all.cut_throughput, 1.5);
    }

    #[test]
    fn waves_are_filled_in_whole_tiles() {
        assert_eq!(refill(2048, 4096, 2048), 2048);
        assert_eq!(refill(700, 4096, 2048), 640);
        assert_eq!(refill(63, 4096, 2048), 0);
        assert_eq!(refill(700, 65, 2048), 65);
        assert_eq!((refill(63, 4096, 511), refill(63, 4096, 512)), (63, 0));
        assert_eq!(refill(0, 0, 1), 0);
    }
}
