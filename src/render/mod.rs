//! Rendering a world: settings, jobs, workers, results.

mod arithmetic;
#[cfg(test)]
mod closed_forms;
mod merge;
mod reference;
mod replay;
mod rounds;
mod schedule;
mod settings;

pub use arithmetic::Arithmetic;
pub use settings::{
    DEFAULT_LIGHT_PATHS, DEFAULT_WAVE, Effort, Integrator, MAX_LIGHT_PATHS, MAX_THREADS, MAX_WAVE, SamplerKind,
    Settings,
};

use crate::accel::{BuildOptions, Bvh};
use crate::error::Result;
use crate::film::{BadSample, Film};
use crate::light::Spots;
use crate::probe::{Clock, Event, NoProbe, Probe, StageRow};
use crate::sampling::{Screen, Sobol, Xoshiro};
use crate::wave::{Context, Counts, Efforts, Plan};
use crate::world::World;
use rounds::Rounds;
use schedule::Round;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What another thread sees of a render, and how it stops it. Workers write to it once per job: it has cache lines of its
/// own.
#[derive(Debug, Default)]
#[repr(align(128))]
pub struct Control {
    stop: AtomicBool,
    samples: AtomicU64,
    rays: AtomicU64,
    /// Bits of an f64, 0 before there is one.
    error: AtomicU64,
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
    /// Estimated relMSE of the image so far, where the render estimates it.
    pub fn error(&self) -> Option<f64> {
        let bits = self.error.load(Ordering::Relaxed);
        (bits != 0).then(|| f64::from_bits(bits))
    }
    fn set_error(&self, error: f64) {
        self.error.store(error.to_bits(), Ordering::Relaxed);
    }
    fn advance(&self, samples: u64, rays: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }
}

/// Seed of the light paths that show where focused light arrives: the same in all renders, so that what is looked for does not
/// depend on what is found.
const SURVEY_SEED: u64 = 0x5bd1_e995_85eb_ca6b;

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
    /// What each worker did when, in its order; empty unless asked for.
    pub timeline: Vec<Vec<Event>>,
    /// Bytes of all workers' queues.
    pub wave_bytes: usize,
    /// Estimated relMSE of the image, where it was asked for.
    pub error: Option<f64>,
    /// Whether it was stopped before all was done that was asked for.
    pub partial: bool,
    /// Of the camera rays, those that only told where samples should go.
    trial: u64,
}

impl Rendered {
    /// Nothing yet.
    fn of(film: Film) -> Self {
        Self {
            film,
            counts: Counts::default(),
            bad: Vec::new(),
            time: Duration::ZERO,
            threads: 1,
            stages: Vec::new(),
            timeline: Vec::new(),
            wave_bytes: 0,
            error: None,
            partial: false,
            trial: 0,
        }
    }
    /// Samples per pixel that were traced for the image, on average.
    pub fn mean_spp(&self) -> f64 {
        let samples = self.counts.camera - self.trial;
        samples as f64 / (f64::from(self.film.width()) * f64::from(self.film.height()))
    }
    fn add_stages(&mut self, stages: Vec<StageRow>) {
        if self.stages.is_empty() {
            self.stages = stages;
            return;
        }
        self.stages.iter_mut().zip(stages).for_each(|(sum, row)| sum.add(&row));
    }
    /// Adds the events of a round, worker by worker.
    fn add_timeline(&mut self, timeline: Vec<Vec<Event>>) {
        self.timeline.resize(self.timeline.len().max(timeline.len()), Vec::new());
        self.timeline.iter_mut().zip(timeline).for_each(|(all, events)| all.extend(events));
    }
    /// Adds the figures of a round, and returns its film.
    fn add(&mut self, round: Self) -> Film {
        self.counts.add(&round.counts);
        self.bad.extend(round.bad);
        self.threads = round.threads;
        self.wave_bytes = round.wave_bytes;
        self.partial |= round.partial;
        self.add_stages(round.stages);
        self.add_timeline(round.timeline);
        round.film
    }
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
    /// [`Error::Setting`](crate::Error::Setting) if there are more than [`MAX_THREADS`] threads, or the system cannot start them.
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
    /// [`Error::Setting`](crate::Error::Setting) if a setting is out of its range.
    pub fn plan(&self, settings: &Settings) -> Result<Plan> {
        settings.check()?;
        let mut plan =
            Plan::new(&self.world, settings.method, settings.max_depth, settings.wave_size, settings.light_paths);
        plan.tuning = settings.tuning;
        Ok(plan)
    }
    /// Renders. The image depends on the settings' seed, not on threads or wave size, to the bit; where the time decides, on
    /// how many samples it allows.
    ///
    /// # Errors
    /// [`Error::Setting`](crate::Error::Setting) if a setting is out of its range.
    pub fn render(&self, settings: &Settings, control: &Control) -> Result<Rendered> {
        let plan = self.plan(settings)?;
        let start = Instant::now();
        let film = Film::new(self.world.width(), self.world.height());
        let mut rendered = if self.world.is_dark() {
            Rendered { error: settings.target_error.map(|_| 0.0), ..Rendered::of(black(film, settings)) }
        } else {
            let (spots, survey) = self.survey(&plan, settings)?;
            let even = Efforts::default();
            let rounds =
                Rounds { renderer: self, plan: &plan, spots: &spots, efforts: &even, settings, control, start };
            let (efforts, trial) = rounds.efforts()?;
            let rounds = Rounds { efforts: &efforts, ..rounds };
            let mut rendered = match settings.target_error {
                Some(target) => rounds.until_error(film, target),
                None if settings.time < Duration::MAX => rounds.until_time(film),
                None => rounds.all(film),
            }?;
            rendered.trial = trial.counts.camera;
            for before in [survey, trial] {
                rendered.counts.add(&before.counts);
                rendered.add_stages(before.stages);
                rendered.add_timeline(before.timeline);
            }
            rendered
        };
        rendered.time = start.elapsed();
        Ok(rendered)
    }
    /// Finds out where focused light comes from, if the plan has paths that look for it.
    fn survey(&self, plan: &Plan, settings: &Settings) -> Result<(Spots, Rendered)> {
        let (spots, all) = (Spots::default(), Rendered::of(Film::new(0, 0)));
        if !plan.caustics() {
            return Ok((spots, all));
        }
        let cx = self.context(plan, &spots, SURVEY_SEED, Screen::default());
        let (arrivals, all) = match settings.is_timed() {
            true => schedule::survey::<Clock>(&cx, settings),
            false => schedule::survey::<NoProbe>(&cx, settings),
        }?;
        Ok((Spots::new(&arrivals, settings.looks()), all))
    }
    /// What the waves of a render read.
    fn context<'a>(&'a self, plan: &'a Plan, spots: &'a Spots, seed: u64, screen: Screen) -> Context<'a> {
        Context { world: &self.world, bvh: &self.bvh, plan, spots, seed, screen }
    }
    /// Adds a round of samples to a film.
    fn round(
        &self,
        cx: &Context<'_>,
        settings: &Settings,
        round: &Round<'_>,
        film: Film,
        control: &Control,
    ) -> Result<Rendered> {
        match settings.is_timed() {
            true => seen_by::<Clock>(cx, settings, round, film, control),
            false => seen_by::<NoProbe>(cx, settings, round, film, control),
        }
    }
}

/// A round with the sampler of the settings.
fn seen_by<P: Probe>(
    cx: &Context<'_>,
    settings: &Settings,
    round: &Round<'_>,
    film: Film,
    control: &Control,
) -> Result<Rendered> {
    match settings.sampler {
        SamplerKind::Xoshiro => schedule::run::<Xoshiro, P>(cx, settings, round, film, control),
        SamplerKind::Sobol => schedule::run::<Sobol, P>(cx, settings, round, film, control),
    }
}

/// Where nothing gives light, every sample is known to be black without a ray.
fn black(mut film: Film, settings: &Settings) -> Film {
    for y in 0..film.height() {
        for x in 0..film.width() {
            film.pixel_mut([x, y]).count = u64::from(settings.spp);
        }
    }
    film
}
