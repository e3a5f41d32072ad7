//! Rendering a world: settings, jobs, workers, results.

mod reference;
mod schedule;

use crate::accel::{BuildOptions, Bvh};
use crate::error::{Error, Result};
use crate::film::{BadSample, Film};
use crate::probe::{NoProbe, StageRow, StageTimes};
use crate::sampling::{Sobol, Xoshiro};
use crate::wave::{Context, Counts, Method, Plan};
use crate::world::World;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Where random numbers come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent streams.
    #[default]
    Xoshiro,
    /// Owen-scrambled Sobol points.
    Sobol,
}

/// Which integrator runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Waves of paths through batched stages.
    #[default]
    Wavefront,
    /// One path after the other, one lane, but eight boxes or triangles of the tree at once: the oracle.
    Reference,
    /// The same with one box and one triangle at a time: scalar throughout, the baseline.
    Scalar,
}

/// What to render with.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Samples per pixel, at least 1.
    pub spp: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Threads; 0 for all cores.
    pub threads: usize,
    /// Bounces at most; `None` leaves it to roulette.
    pub max_depth: Option<u32>,
    /// How light is found.
    pub method: Method,
    /// Where random numbers come from.
    pub sampler: SamplerKind,
    /// Paths in flight per worker, at least 1.
    pub wave_size: usize,
    /// Light paths per camera path, where mirrors or glass can focus light; 0 for none, at most [`MAX_LIGHT_PATHS`].
    pub light_paths: f32,
    /// Which integrator runs.
    pub integrator: Integrator,
    /// Whether the stages are timed.
    pub time_stages: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            spp: 1,
            seed: 0,
            threads: 0,
            max_depth: None,
            method: Method::Mis,
            sampler: SamplerKind::Xoshiro,
            wave_size: DEFAULT_WAVE,
            light_paths: DEFAULT_LIGHT_PATHS,
            integrator: Integrator::Wavefront,
            time_stages: false,
        }
    }
}

/// Paths in flight per worker unless set: their queues fit a core's own cache.
pub const DEFAULT_WAVE: usize = 2048;
/// Paths in flight per worker at most.
pub const MAX_WAVE: usize = 1 << 22;
/// Light paths per camera path unless set, where the scene needs any.
pub const DEFAULT_LIGHT_PATHS: f32 = 0.1;
/// Light paths per camera path at most.
pub const MAX_LIGHT_PATHS: f32 = 1000.0;
/// Threads at most.
pub const MAX_THREADS: usize = 1024;

impl Settings {
    fn check(&self) -> Result<()> {
        let wrong = |setting, found: usize, expected: String| {
            Err(Error::Setting { setting, found: found.to_string(), expected })
        };
        match self {
            Self { spp: 0, .. } => wrong("--spp", 0, "at least 1".into()),
            Self { wave_size, .. } if !(1..=MAX_WAVE).contains(wave_size) => {
                wrong("--wave", *wave_size, format!("1 to {MAX_WAVE}"))
            }
            Self { threads, .. } if *threads > MAX_THREADS => {
                wrong("--threads", *threads, format!("at most {MAX_THREADS}"))
            }
            Self { light_paths, .. } if !(0.0..=MAX_LIGHT_PATHS).contains(light_paths) => Err(Error::Setting {
                setting: "--light-paths",
                found: light_paths.to_string(),
                expected: format!("0 to {MAX_LIGHT_PATHS}"),
            }),
            _ => Ok(()),
        }
    }
}

/// What another thread sees of a render, and how it stops it. Workers write to it once per job: it has cache lines of its
/// own.
#[derive(Debug, Default)]
#[repr(align(128))]
pub struct Control {
    stop: AtomicBool,
    samples: AtomicU64,
    rays: AtomicU64,
}

impl Control {
    /// Asks the render to end after the jobs under way.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
    /// Whether [`Self::stop`] was called.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
    /// Samples finished so far, over all pixels.
    pub fn samples(&self) -> u64 {
        self.samples.load(Ordering::Relaxed)
    }
    /// Rays traced so far.
    pub fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }
    fn advance(&self, samples: u64, rays: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }
}

/// What a render gave.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The image in the making.
    pub film: Film,
    /// What was traced.
    pub counts: Counts,
    /// Samples that were not finite.
    pub bad: Vec<BadSample>,
    /// Wall time.
    pub time: Duration,
    /// Threads that worked.
    pub threads: usize,
    /// Times of the stages, summed over threads; empty unless asked for.
    pub stages: Vec<StageRow>,
    /// Bytes of all workers' queues.
    pub wave_bytes: usize,
    /// Whether it was stopped before all samples were done.
    pub partial: bool,
}

/// A world with its tree, ready to render any number of times.
#[derive(Clone, Debug)]
pub struct Renderer {
    world: World,
    bvh: Bvh,
}

impl Renderer {
    /// Builds the tree of a world, on all cores.
    pub fn new(world: World) -> Self {
        let bvh = Bvh::build(&world.corners);
        Self { world, bvh }
    }
    /// Builds the tree of a world as told. Options and threads change the time that it takes and that rays take, not
    /// the image.
    ///
    /// # Errors
    /// [`Error::Setting`] if there are more than [`MAX_THREADS`] threads, or the system cannot start them.
    pub fn with_options(world: World, options: &BuildOptions) -> Result<Self> {
        Settings { threads: options.threads, ..Settings::default() }.check()?;
        let bvh = Bvh::build_with(&world.corners, options)?;
        Ok(Self { world, bvh })
    }
    /// The world.
    pub fn world(&self) -> &World {
        &self.world
    }
    /// The tree.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }
    /// Which stages these settings run.
    ///
    /// # Errors
    /// [`Error::Setting`] if a setting is out of its range.
    pub fn plan(&self, settings: &Settings) -> Result<Plan> {
        settings.check()?;
        Ok(Plan::new(&self.world, settings.method, settings.max_depth, settings.wave_size, settings.light_paths))
    }
    /// Renders. The image depends on the settings' seed, not on threads or wave size, to the bit.
    ///
    /// # Errors
    /// [`Error::Setting`] if a setting is out of its range.
    pub fn render(&self, settings: &Settings, control: &Control) -> Result<Rendered> {
        let plan = self.plan(settings)?;
        let cx = Context { world: &self.world, bvh: &self.bvh, plan: &plan, seed: settings.seed };
        let start = Instant::now();
        if self.world.is_dark() {
            return Ok(self.black(settings, start));
        }
        let mut rendered = match (settings.sampler, settings.time_stages) {
            (SamplerKind::Xoshiro, false) => schedule::run::<Xoshiro, NoProbe>(&cx, settings, control),
            (SamplerKind::Xoshiro, true) => schedule::run::<Xoshiro, StageTimes>(&cx, settings, control),
            (SamplerKind::Sobol, false) => schedule::run::<Sobol, NoProbe>(&cx, settings, control),
            (SamplerKind::Sobol, true) => schedule::run::<Sobol, StageTimes>(&cx, settings, control),
        }?;
        rendered.time = start.elapsed();
        Ok(rendered)
    }
    /// Where nothing gives light, every sample is known to be black without a ray.
    fn black(&self, settings: &Settings, start: Instant) -> Rendered {
        let (width, height) = (self.world.width(), self.world.height());
        let mut film = Film::new(width, height);
        for y in 0..height {
            for x in 0..width {
                film.pixel_mut([x, y]).count = u64::from(settings.spp);
            }
        }
        Rendered {
            film,
            counts: Counts::default(),
            bad: Vec::new(),
            time: start.elapsed(),
            threads: 1,
            stages: Vec::new(),
            wave_bytes: 0,
            partial: false,
        }
    }
}
