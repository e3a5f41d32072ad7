//! The reference: one path after the other, depth first, one lane. It makes the same decisions from the same random
//! numbers as the waves, and so gives the same image; it is their oracle and the baseline that they have to beat.

use crate::accel::{Hit, Ray, Scalar, Single};
use crate::lanes::{Kernel, Vec3, Wide, dispatch};
use crate::material::{Kind, Lobe, Materials, Table, for_kind};
use crate::sampling::Sampler;
use crate::wave::{
    Context, Counts, First, Focused, HitRow, Job, Path, Plan, Reversed, Samples, Shaded, Splat, Splats, aim_rows,
    background_radiance, camera_paths, emitted_radiance, light_paths, scatter_rows, shade_rows, shadow_rays,
};
use std::marker::PhantomData;

/// The reference integrator of one worker.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    tracer: Single,
    scalar: Scalar,
    samples: Samples,
    splats: Splats,
    /// Of paths that look for focused light.
    aimed: Plan,
}

impl Reference {
    pub fn new(cx: &Context<'_>) -> Self {
        Self {
            tracer: Single::new(cx.bvh),
            scalar: Scalar::new(cx.bvh),
            samples: Samples::default(),
            splats: Splats::default(),
            aimed: cx.plan.of_aimed_paths(),
        }
    }

    /// Traces all samples of a job, and returns their radiance by slot; with one box and triangle at a time if `SCALAR`.
    pub fn run<S: Sampler, const SCALAR: bool>(
        &mut self,
        cx: &Context<'_>,
        job: &Job,
        counts: &mut Counts,
    ) -> &[[f32; 3]] {
        self.samples.reset(job.paths());
        dispatch(Paths::<S, SCALAR> { reference: self, sampler: PhantomData, cx, job, counts });
        self.samples.all()
    }

    #[inline(always)]
    fn trace<S: Sampler, W: Wide, const SCALAR: bool>(
        &mut self,
        cx: &Context<'_>,
        mut path: Path<f32>,
        counts: &mut Counts,
    ) {
        let Context { world, bvh, plan, spots, .. } = *cx;
        let (mut scale, mut first, mut normal) = (1.0, First::none(), Vec3::splat([0.0; 3]));
        loop {
            let ray = Ray { origin: path.origin.lane(0), direction: path.direction.lane(0), t_max: f32::INFINITY };
            let hit = if SCALAR { self.scalar.closest(bvh, &ray) } else { self.tracer.closest_as::<W>(bvh, &ray) };
            if hit.triangle == Hit::NONE {
                if let Some(background) = world.background {
                    self.add(path.slot, background_radiance(background, &path));
                }
                return;
            }
            let row = HitRow::<f32> { u: hit.u, v: hit.v, triangle: hit.triangle };
            let number = world.lobes[hit.triangle as usize].kind();
            let Some(&kind) = Kind::SCATTERING.get(number) else {
                if plan.emit {
                    self.add(path.slot, emitted_radiance(world, plan, &path, normal, &first, &row));
                }
                return;
            };
            if path.depth >= plan.max_depth {
                counts.cut(path.throughput * (1.0 / scale));
                return;
            }
            let mut out: Option<Shaded<f32>> = None;
            for_kind!(kind, M => out = Some(shade_rows::<M, S, f32, Focused>(world, plan, spots, path, scale, first, &row)));
            let Some(out) = out else { return };
            if out.connected {
                counts.shadow += 1;
                let ray = shadow_rays(out.shadow.origin, out.shadow.direction).into();
                if !(if SCALAR { self.scalar.any(bvh, &ray) } else { self.tracer.any_as::<W>(bvh, &ray) }) {
                    self.add(path.slot, out.shadow.radiance);
                }
            }
            if out.aims.chosen {
                for_kind!(kind, M => self.look::<M, S, W>(cx, Path { rng: out.aims.rng, ..path }, scale, &row, counts));
            }
            if !out.alive {
                return;
            }
            (path, scale, first, normal) = (out.path, out.scale, out.first, out.normal);
            counts.bounce += 1;
        }
    }

    /// Looks for focused light from a surface that a path hit.
    #[inline(always)]
    fn look<M: Lobe, S: Sampler, W: Wide>(
        &mut self,
        cx: &Context<'_>,
        path: Path<f32>,
        scale: f32,
        row: &HitRow<f32>,
        counts: &mut Counts,
    ) where
        Materials: Table<M>,
    {
        let Context { world, bvh, spots, .. } = *cx;
        let sent = aim_rows::<M, S, f32>(world, spots, path, scale, row);
        let (mut path, mut scale, mut goes_on, mut bounced) = (sent.path, sent.scale, sent.worth, false);
        while goes_on {
            counts.bounce += 1;
            let ray = Ray { origin: path.origin.lane(0), direction: path.direction.lane(0), t_max: f32::INFINITY };
            let hit = self.tracer.closest_as::<W>(bvh, &ray);
            let Some(lobe) = world.lobes.get(hit.triangle as usize) else { return };
            let row = HitRow::<f32> { u: hit.u, v: hit.v, triangle: hit.triangle };
            let Some(&kind) = Kind::SCATTERING.get(lobe.kind()) else {
                if bounced {
                    let (normal, first) = (Vec3::splat([0.0; 3]), First::none());
                    self.add(path.slot, emitted_radiance(world, &self.aimed, &path, normal, &first, &row));
                }
                return;
            };
            if !kind.is_delta() || path.depth >= self.aimed.max_depth {
                return;
            }
            let mut out: Option<Shaded<f32>> = None;
            let none = First::none();
            for_kind!(kind, M => {
                out = Some(shade_rows::<M, S, f32, Focused>(world, &self.aimed, spots, path, scale, none, &row));
            });
            let Some(out) = out else { return };
            (path, scale, goes_on, bounced) = (out.path, out.scale, out.alive, true);
        }
    }

    /// Traces the light paths from number `first` on, `count` of them, and returns what they bring to pixels.
    pub fn light<S: Sampler>(&mut self, cx: &Context<'_>, first: u64, count: usize, counts: &mut Counts) -> &[Splat] {
        self.splats.clear();
        let Context { world, bvh, plan, seed, .. } = *cx;
        for slot in 0..count {
            let (mut path, scale) = light_paths::<S, f32>(world, seed, first, slot, slot);
            loop {
                counts.light += 1;
                let ray = Ray { origin: path.origin.lane(0), direction: path.direction.lane(0), t_max: f32::INFINITY };
                let hit = self.tracer.closest(bvh, &ray);
                let kind = world.lobes.get(hit.triangle as usize).and_then(|lobe| Kind::SCATTERING.get(lobe.kind()));
                let Some(&kind) = kind.filter(|_| path.depth < plan.max_depth) else { break };
                let row = HitRow::<f32> { u: hit.u, v: hit.v, triangle: hit.triangle };
                let mut out: Option<Reversed<f32>> = None;
                for_kind!(kind, M => out = Some(scatter_rows::<M, S, f32>(world, plan, path, scale, &row)));
                let Some(out) = out else { break };
                if out.connected {
                    counts.shadow += 1;
                    let ray = shadow_rays(out.connection.origin, out.connection.direction).into();
                    if !self.tracer.any(bvh, &ray) {
                        self.splats.add(&out.connection);
                    }
                }
                if !out.alive {
                    break;
                }
                path = out.path;
            }
        }
        self.splats.sorted()
    }

    fn add(&mut self, slot: u32, radiance: Vec3<f32>) {
        self.samples.add::<f32>(1, slot, radiance);
    }
}

/// All paths of a job. They have one lane; the tree's boxes have eight, or one.
struct Paths<'a, S, const SCALAR: bool> {
    reference: &'a mut Reference,
    sampler: PhantomData<S>,
    cx: &'a Context<'a>,
    job: &'a Job,
    counts: &'a mut Counts,
}

impl<S: Sampler, const SCALAR: bool> Kernel for Paths<'_, S, SCALAR> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { reference, cx, job, counts, .. } = self;
        for slot in 0..job.paths() {
            let path = camera_paths::<S, f32>(cx, job, slot, slot);
            counts.camera += 1;
            reference.trace::<S, W, SCALAR>(cx, path, counts);
        }
    }
}
