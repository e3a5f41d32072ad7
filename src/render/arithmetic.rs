//! How much arithmetic the stages do for a row, on average: some of a render's paths are followed by themselves, in a lane that
//! counts.

use super::{Renderer, Settings};
use crate::accel::{Ray, Scalar};
use crate::error::Result;
use crate::lanes::{Counting, Lanes, Vec3, counting};
use crate::light::Spots;
use crate::material::{Kind, for_kind};
use crate::probe::Stage;
use crate::sampling::{Screen, Sobol};
use crate::wave::{
    Context, First, Focused, HitRow, Job, Path, Shaded, background_radiance, camera_paths, emitted_radiance,
    shade_rows, shadow_rays,
};

/// Paths that are followed, across the image and down.
const SIDE: u64 = 16;
/// Bounces that are followed: what lies beyond is like what lies before, and lossless rooms have thousands.
const BOUNCES: u32 = 64;
/// What is found is added to a sample.
const ADD: u64 = 3;
/// Three sums and sums of squares of a pixel.
const ACCUMULATE: f64 = 9.0;

/// Floating-point operations of stages.
#[derive(Clone, Debug, Default)]
pub struct Arithmetic {
    operations: [u64; Stage::ALL.len()],
    rows: [u64; Stage::ALL.len()],
}

impl Arithmetic {
    /// Operations for a row of a stage, a fused product and sum as two; none where no path that was followed came to it, and for
    /// the stages of light paths and paths that look for focused light.
    pub fn per_row(&self, stage: Stage) -> Option<f64> {
        let (operations, rows) = (self.operations[stage as usize], self.rows[stage as usize]);
        match stage {
            Stage::Route | Stage::Compact => Some(0.0),
            Stage::Accumulate => Some(ACCUMULATE),
            _ => (rows > 0).then(|| operations as f64 / rows as f64),
        }
    }

    fn count<T>(&mut self, stage: Stage, run: impl FnOnce() -> T) -> T {
        let (out, operations) = counting(run);
        self.operations[stage as usize] += operations;
        self.rows[stage as usize] += 1;
        out
    }

    fn follow(&mut self, cx: &Context<'_>, tracer: &mut Scalar, mut path: Path<Counting>) {
        let Context { world, bvh, plan, spots, .. } = *cx;
        let (mut scale, mut first, mut normal) = (Counting::splat(1.0), First::none(), Vec3::splat([0.0; 3]));
        loop {
            let ray = ray_of(path.origin, path.direction, f32::INFINITY);
            let hit = self.count(Stage::Intersect, || tracer.trace::<Counting, false>(bvh, &ray));
            let row = HitRow { u: Counting::splat(hit.u), v: Counting::splat(hit.v), triangle: hit.triangle };
            let Some(lobe) = world.lobes.get(hit.triangle as usize) else {
                if let Some(background) = world.background {
                    self.count(Stage::Escape, || background_radiance(background, &path));
                    self.operations[Stage::Escape as usize] += ADD;
                }
                return;
            };
            let Some(&kind) = Kind::SCATTERING.get(lobe.kind()) else {
                self.count(Stage::Emit, || emitted_radiance(world, plan, &path, normal, &first, &row));
                self.operations[Stage::Emit as usize] += ADD;
                return;
            };
            if path.depth >= plan.max_depth.min(BOUNCES) {
                return;
            }
            let mut out: Option<Shaded<Counting>> = None;
            for_kind!(kind, M => {
                let run = || shade_rows::<M, Sobol, Counting, Focused>(world, plan, spots, path, scale, first, &row);
                out = Some(self.count(Stage::Shade, run));
            });
            let Some(out) = out else { return };
            if out.connected {
                let rays = shadow_rays(out.shadow.origin, out.shadow.direction);
                let ray = ray_of(rays.origin, rays.direction, 1.0);
                self.count(Stage::Connect, || tracer.trace::<Counting, true>(bvh, &ray));
                self.operations[Stage::Connect as usize] += ADD;
            }
            if !out.alive {
                return;
            }
            (path, scale, first, normal) = (out.path, out.scale, out.first, out.normal);
        }
    }
}

fn ray_of(origin: Vec3<Counting>, direction: Vec3<Counting>, t_max: f32) -> Ray {
    Ray { origin: origin.lane(0), direction: direction.lane(0), t_max }
}

impl Renderer {
    /// What the stages compute in a render with these settings, by 256 paths over the image and 64 bounces of each. Boxes and
    /// triangles are counted as a ray by itself meets them; random numbers, of integers but for the last step, as those of Sobol points.
    ///
    /// # Errors
    /// [`Error::Setting`](crate::Error::Setting) if a setting is out of its range.
    pub fn arithmetic(&self, settings: &Settings) -> Result<Arithmetic> {
        let (plan, spots) = (self.plan(settings)?, Spots::default());
        let [width, height] = [self.world.width(), self.world.height()];
        let cx = self.context(&plan, &spots, settings.seed, Screen::new(width, settings.spp));
        let at = |i: u64, size: u32| (i * u64::from(size) / SIDE) as u32;
        let pixels = (0..SIDE * SIDE).map(|i| [at(i % SIDE, width), at(i / SIDE, height)]).collect();
        let job = Job { pixels, samples: 1, ..Job::default() };
        let (mut all, mut tracer) = (Arithmetic::default(), Scalar::new(&self.bvh));
        for slot in 0..job.paths() {
            let path = all.count(Stage::Generate, || camera_paths::<Sobol, Counting>(&cx, &job, slot, slot));
            all.follow(&cx, &mut tracer, path);
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::super::closed_forms::{floor, lamp, patch, seen};
    use super::*;

    #[test]
    fn stages_compute_what_their_formulas_say() {
        let light = patch([0.4, 0.0, 0.6], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0]);
        let lit = (light.mesh(), [0.4, 0.0, 0.6].into(), lamp(5.0));
        let renderer = seen(&[lit, floor(0.7)], [0.1, 0.2, 0.0].into(), 0.5);
        let of = |settings: &Settings| renderer.arithmetic(settings).unwrap();
        let (all, direct) = (of(&Settings::default()), of(&Settings { max_depth: Some(0), ..Settings::default() }));
        // The pixel's place (2 sums), the view's ray, made unit.
        let generate = all.per_row(Stage::Generate).unwrap();
        assert!((20.0..40.0).contains(&generate) && direct.per_row(Stage::Generate) == Some(generate));
        // One node of eight boxes, 24 operations each, and a leaf with four triangles or fewer.
        let intersect = direct.per_row(Stage::Intersect).unwrap();
        assert!((8.0 * 24.0..8.0 * 24.0 + 4.0 * 60.0).contains(&intersect), "{intersect}");
        let of = |stage| all.per_row(stage).unwrap();
        assert!(of(Stage::Shade) > 100.0 && of(Stage::Shade) < 500.0, "{}", of(Stage::Shade));
        assert!(of(Stage::Connect) > 8.0 * 24.0 && of(Stage::Connect) < 8.0 * 24.0 + 4.0 * 60.0 + 3.0);
        assert_eq!((of(Stage::Compact), of(Stage::Accumulate)), (0.0, 9.0));
        // Nothing is shaded at depth 0, no ray leaves for a background, no light path is followed.
        assert_eq!([Stage::Shade, Stage::Connect].map(|stage| direct.per_row(stage)), [None; 2]);
        assert_eq!([Stage::Escape, Stage::Scatter].map(|stage| all.per_row(stage)), [None; 2]);
        assert!(renderer.arithmetic(&Settings { wave_size: 0, ..Settings::default() }).is_err());
    }
}
