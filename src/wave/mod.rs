//! The wavefront: paths move in batches through the stages, struct-of-arrays between them. One small wave per worker;
//! nothing is shared between workers.

mod connect;
mod emit;
mod escape;
mod generate;
mod intersect;
mod job;
mod plan;
mod queues;
mod route;
mod shade;
mod surface;

pub use connect::shadow_rays;
pub use emit::emitted_radiance;
pub use escape::background_radiance;
pub use generate::camera_paths;
pub use job::{Grid, Job};
pub use plan::{BOUNCE_LIMIT, Method, Plan, PrevPdf};
pub use queues::{HitRow, Path, Queues};
pub use shade::{Shaded, shade_rows};

use crate::accel::{Bvh, Many};
use crate::lanes::{Lanes, LanesU32, Vec3};
use crate::material::for_kind;
use crate::probe::{Probe, Stage};
use crate::sampling::Sampler;
use crate::world::World;
use std::marker::PhantomData;

/// What was traced, and what was cut.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Camera rays.
    pub camera: u64,
    /// Rays after a bounce.
    pub bounce: u64,
    /// Shadow rays.
    pub shadow: u64,
    /// Paths that were cut at the largest number of bounces.
    pub cut: u64,
    /// Their throughput, averaged over the channels, summed: the share of energy that may be missing.
    pub cut_throughput: f64,
}

impl Counts {
    /// All rays.
    pub fn rays(&self) -> u64 {
        self.camera + self.bounce + self.shadow
    }
    /// Notes a path that was cut.
    pub fn cut(&mut self, throughput: Vec3<f32>) {
        self.cut += 1;
        self.cut_throughput += throughput.lane(0).iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0;
    }
    /// Adds another's numbers.
    pub fn add(&mut self, other: &Self) {
        self.camera += other.camera;
        self.bounce += other.bounce;
        self.shadow += other.shadow;
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
    /// Adds the first `count` lanes to their slots.
    #[inline(always)]
    pub fn add<L: Lanes>(&mut self, count: usize, slot: L::Uint, radiance: Vec3<L>) {
        let slots = slot.array();
        for i in 0..count {
            let sample = &mut self.0[slots.as_ref()[i] as usize];
            let r = radiance.lane(i);
            *sample = [sample[0] + r[0], sample[1] + r[1], sample[2] + r[2]];
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
    /// Seed of the random numbers.
    pub seed: u64,
}

/// The paths of one worker.
#[derive(Clone, Debug)]
pub struct Wave<S> {
    queues: Queues,
    tracer: Many,
    samples: Samples,
    sampler: PhantomData<S>,
}

impl<S: Sampler> Wave<S> {
    /// A wave for what the plan needs.
    pub fn new(cx: &Context<'_>) -> Self {
        Self {
            queues: Queues::new(cx.plan),
            tracer: Many::new(cx.bvh),
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
        let Context { world, bvh, plan, seed } = *cx;
        let Self { queues: q, tracer, samples, .. } = self;
        samples.reset(job.paths());
        let mut next = 0;
        loop {
            let before = q.paths.len();
            let free = (plan.wave_size - before).min(job.paths() - next);
            let made = probe.stage(Stage::Generate, free, || {
                generate::generate::<S>(q, &world.view, seed, job, next, plan.wave_size)
            });
            next += made;
            let n = q.paths.len();
            if n == 0 {
                return samples.all();
            }
            counts.camera += made as u64;
            counts.bounce += before as u64;
            probe.stage(Stage::Intersect, n, || intersect::intersect(q, bvh, tracer));
            probe.stage(Stage::Route, n, || route::route(q, world, plan, counts));
            if let Some(background) = world.background {
                probe.stage(Stage::Escape, q.escaped.len(), || escape::escape(q, background, samples));
            }
            if plan.emit {
                let hits = q.by_kind[crate::material::Kind::Luminous as usize].len();
                probe.stage(Stage::Emit, hits, || emit::emit(q, world, samples));
            }
            if plan.sole_kind() {
                // With the ended paths out of the way, the rest is without gaps: whole registers move.
                probe.stage(Stage::Compact, n, || compact(q));
            }
            for &kind in &plan.kinds {
                let hits = if plan.sole_kind() { q.paths.len() } else { q.by_kind[kind as usize].len() };
                for_kind!(kind, M => probe.stage(Stage::Shade, hits, || shade::shade::<M, S>(q, kind, world, plan)));
            }
            if plan.connect {
                counts.shadow += q.shadows.len() as u64;
                let shadows = q.shadows.len();
                probe.stage(Stage::Connect, shadows, || connect::connect(q, bvh, tracer, samples));
            }
            probe.stage(Stage::Compact, q.paths.len(), || compact(q));
        }
    }
}

/// Removes the rows whose path has ended; rows from the end take their place.
fn compact(q: &mut Queues) {
    for row in (0..q.paths.len()).rev() {
        if q.ended[row] {
            q.paths.swap_remove(row);
            q.hits.copy_row(q.paths.len(), row);
            q.ended[row] = false;
            if let Some(scales) = &mut q.scales {
                scales.swap_remove(row);
            }
        }
    }
}
