//! Light paths: light that mirrors and glass focus, followed from the lamps and connected to the camera, in waves of their
//! own.
//!
//! They give the paths that next-event estimation cannot: those on which light leaves a lamp towards a delta lobe, ends a
//! chain of such lobes on another surface, and reaches the camera from a surface that is none. Camera paths find the same
//! light where they hit a lamp by chance; both are weighted by the power heuristic. What the weights need is short because
//! all finite lobes here are reciprocal and sampled exactly by value times cosine. For a path x0 (camera), x1, ..., xk
//! (light) the ratio of both densities is then, all distances and inner cosines cancelling,
//!
//! p(light path) / p(camera path) = density of (xk, direction) per area and projected solid angle
//!     / (density of x1 per area x density of the direction from x1 to x2 per projected solid angle),
//!
//! a number of each end alone. (Veach 1997, section 9.2 and 10.2, with the reversed densities written out.)
//!
//! What is left, focused light seen in mirrors and through glass, is looked for by [paths that are aimed](aim).

pub(super) mod aim;
mod camera;
pub(super) mod first;
mod scatter;
mod start;
mod survey;

pub use camera::{Splat, Splats};
pub use scatter::{Reversed, scatter_rows};
pub use start::light_paths;
pub use survey::survey;

use super::{Context, Counts, Intersect, Plan, Queues, Route};
use crate::accel::Tiles;
use crate::lanes::dispatch;
use crate::material::for_kind;
use crate::probe::{Probe, Stage};
use crate::sampling::Sampler;
use camera::{Expose, SplatQueue};
use scatter::Scatter;
use start::Start;
use std::marker::PhantomData;

/// Light paths of a job: enough to fill a wave.
pub const JOB: u64 = 8192;

/// The light paths of one worker.
#[derive(Clone, Debug)]
pub struct LightWave<S> {
    plan: Plan,
    queues: Queues,
    to_camera: SplatQueue,
    tracer: Tiles,
    splats: Splats,
    sampler: PhantomData<S>,
}

impl<S: Sampler> LightWave<S> {
    /// A wave for what the plan of camera paths needs.
    pub fn new(cx: &Context<'_>) -> Self {
        let plan = cx.plan.of_light_paths();
        let mut tracer = Tiles::new();
        tracer.loose().allow(plan.tuning.streams);
        Self {
            queues: Queues::new(&plan),
            to_camera: SplatQueue::with_capacity(plan.wave_size),
            plan,
            tracer,
            splats: Splats::default(),
            sampler: PhantomData,
        }
    }
    /// Bytes that the wave holds.
    pub fn bytes(&self) -> usize {
        self.plan.wave_size * (self.plan.path_bytes() + SplatQueue::ROW_BYTES) + self.splats.bytes()
    }

    /// Traces the light paths from number `first` on, `count` of them, and returns what they bring to pixels, in an order
    /// that depends on the paths alone.
    pub fn run(
        &mut self,
        cx: &Context<'_>,
        first: u64,
        count: usize,
        probe: &mut impl Probe,
        counts: &mut Counts,
    ) -> &[Splat] {
        let Context { world, bvh, seed, .. } = *cx;
        let Self { plan, queues: q, to_camera, tracer, splats, .. } = self;
        splats.clear();
        tracer.restart();
        let mut cut = Counts::default();
        let mut next = 0;
        loop {
            let going = q.paths.len();
            let fresh = (plan.wave_size - going).min(count - next);
            probe.stage(Stage::Start, fresh, || {
                let sampler = PhantomData::<S>;
                dispatch(Start { q, world, sampler, seed, first, next, count: fresh });
            });
            next += fresh;
            let n = q.paths.len();
            if n == 0 {
                return splats.sorted();
            }
            counts.light += n as u64;
            probe.wave(q.paths.depths(), fresh);
            // Paths into one cone are no tiles: all are traced as rays that go anywhere.
            probe.stage(Stage::Intersect, n, || dispatch(Intersect { q, bvh, tracer, fresh: n }));
            probe.stage(Stage::Route, n, || dispatch(Route { q, world, plan, counts: &mut cut }));
            for &kind in &plan.kinds {
                let hits = q.by_kind[kind as usize].len();
                for_kind!(kind, M => {
                    let of = PhantomData::<(M, S)>;
                    probe.stage(Stage::Scatter, hits, || dispatch(Scatter { q, to_camera, of, kind, world, plan: cx.plan }))
                });
            }
            let connections = to_camera.len();
            counts.shadow += connections as u64;
            probe.stage(Stage::Expose, connections, || {
                dispatch(Expose { to_camera, bvh, tracer: tracer.loose(), splats })
            });
            probe.stage(Stage::Compact, n, || dispatch(super::compact::Compact { q, shaded: true }));
        }
    }
}
