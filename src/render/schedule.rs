//! Jobs onto threads; with `accel/parallel.rs` the only file that names rayon.
//!
//! Visits of tiles, of one job or a few, are taken off one counter. Their sums reach each pixel in the order of the samples,
//! whichever thread is first: what arrives early waits.

use super::merge::{Merge, Sums};
use super::{Control, Integrator, Rendered, Settings, reference};
use crate::error::{Error, Result};
use crate::film::Film;
use crate::light::Arrival;
use crate::probe::{Probe, Seen, Stage, What};
use crate::sampling::{Sampler, Sobol};
use crate::wave::{Context, Counts, Efforts, Grid, Job, LIGHT_JOB, LightWave, Wave};
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// What workers write to, once per visit of a tile, on cache lines apart from all that they read.
#[repr(align(128))]
struct Shared {
    /// Number of the next visit.
    next: AtomicUsize,
    merge: Mutex<Merge>,
}

/// All that there is to do, in order: visits of tiles, and between them jobs of light paths, evenly.
struct Order {
    tiles: usize,
    visits: usize,
    /// Which light paths.
    lights: Range<u64>,
}

/// A piece of it.
enum Piece {
    Visit { tile: usize, visit: u32 },
    Light { number: usize },
}

impl Order {
    fn light_jobs(&self) -> usize {
        (self.lights.end - self.lights.start).div_ceil(LIGHT_JOB) as usize
    }
    /// First light path and number of them in a job.
    fn light_paths(&self, job: usize) -> (u64, usize) {
        let first = self.lights.start + job as u64 * LIGHT_JOB;
        (first, (self.lights.end - first).min(LIGHT_JOB) as usize)
    }
    fn piece(&self, number: usize) -> Option<Piece> {
        let (visits, lights) = (self.tiles * self.visits, self.light_jobs());
        let before = |n: usize| (n as u128 * lights as u128 / (visits + lights) as u128) as usize;
        if number >= visits + lights {
            return None;
        }
        let light = before(number);
        Some(if before(number + 1) > light {
            Piece::Light { number: light }
        } else {
            let number = number - light;
            Piece::Visit { tile: number % self.tiles, visit: (number / self.tiles) as u32 }
        })
    }
}

/// What a worker brings home.
struct Work {
    counts: Counts,
    seen: Seen,
    wave_bytes: usize,
}

/// Some samples of every pixel.
#[derive(Clone, Debug)]
pub(super) struct Round<'a> {
    /// Which samples.
    pub samples: Range<u32>,
    /// How tiles share them out.
    pub efforts: &'a Efforts,
    /// Whether light paths are traced, too, and what is done is counted.
    pub counts: bool,
    /// When to end, done or not.
    pub deadline: Option<Instant>,
}

impl Round<'_> {
    fn is_over(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}

fn pool(settings: &Settings) -> Result<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build().map_err(|e| Error::Setting {
        setting: "--threads",
        found: settings.threads.to_string(),
        expected: format!("as many as the system can start ({e})"),
    })
}

/// Light paths that show where focused light arrives, over [`Settings::looks`]: one for a pixel, but no more than this.
/// However many samples are asked for, so that a longer render begins like a shorter one.
const SURVEY: u64 = 65_536;
/// More of them for a pixel show little more.
const MOST_PER_PIXEL: f32 = 2.0;
/// Light paths of a job of these, one job at least.
const SURVEY_JOB: u64 = 2048;

/// Where focused light arrives, in an order that the number of threads does not change, seen by probe `P`.
pub(super) fn survey<P: Probe>(cx: &Context<'_>, settings: &Settings) -> Result<(Vec<Arrival>, Rendered)> {
    let pixels = u64::from(cx.world.width()) * u64::from(cx.world.height());
    let count = (pixels.min(SURVEY) as f64 * f64::from(settings.looks().min(MOST_PER_PIXEL))) as u64;
    let count = count.max(SURVEY_JOB);
    let next = AtomicUsize::new(0);
    let work = pool(settings)?.broadcast(|_| {
        let (mut probe, mut counts, mut found) = (P::new(settings.asked()), Counts::default(), Vec::new());
        loop {
            let job = next.fetch_add(1, Ordering::Relaxed) as u64;
            let first = job * SURVEY_JOB;
            if first >= count {
                return (found, counts, probe.seen());
            }
            let paths = (count - first).min(SURVEY_JOB) as usize;
            let arrivals =
                probe.span(What::Survey, |probe| crate::wave::survey::<Sobol>(cx, first, paths, probe, &mut counts));
            found.push((job, arrivals));
        }
    });
    let mut all = Rendered::of(Film::new(0, 0));
    let mut jobs = Vec::new();
    for (found, counts, seen) in work {
        jobs.extend(found);
        all.counts.add(&counts);
        all.add_stages(seen.stages);
        all.timeline.push(seen.events);
    }
    jobs.sort_unstable_by_key(|(job, _)| *job);
    Ok((jobs.into_iter().flat_map(|(_, arrivals)| arrivals).collect(), all))
}

/// Renders with sampler `S`, seen by probe `P`, and adds it to a film.
pub(super) fn run<S: Sampler, P: Probe>(
    cx: &Context<'_>,
    settings: &Settings,
    round: &Round<'_>,
    film: Film,
    control: &Control,
) -> Result<Rendered> {
    let pool = pool(settings)?;
    let size = [cx.world.width(), cx.world.height()];
    let grid = Grid::new(size, round.samples.clone(), round.efforts, settings.tuning.job);
    let lights = |samples: u32| (f64::from(cx.plan.light_paths) * f64::from(samples)).round() as u64;
    let lights = if round.counts { lights(round.samples.start)..lights(round.samples.end) } else { 0..0 };
    let order = Order { tiles: grid.tiles(), visits: grid.visits() as usize, lights };
    let shared = Shared { next: AtomicUsize::new(0), merge: Mutex::new(Merge::new(film, order.tiles)) };
    let work = pool.broadcast(|_| {
        let mut probe = P::new(settings.asked());
        let mut counts = Counts::default();
        let mut wave = (settings.integrator == Integrator::Wavefront).then(|| Wave::<S>::new(cx));
        let mut light = (wave.is_some() && cx.plan.caustics()).then(|| LightWave::<S>::new(cx));
        let mut reference = reference::Reference::new(cx);
        let (mut job, mut sums) = (Job::default(), Sums::default());
        while !control.is_stopped() && !round.is_over() {
            let number = shared.next.fetch_add(1, Ordering::Relaxed);
            let (tile, visit) = match order.piece(number) {
                None => break,
                Some(Piece::Visit { tile, visit }) => (tile, visit),
                Some(Piece::Light { number }) => {
                    let (first, count) = order.light_paths(number);
                    let before = counts.rays();
                    let splats = probe.span(What::Light, |probe| match &mut light {
                        Some(light) => light.run(cx, first, count, probe, &mut counts),
                        None => reference.light::<S>(cx, first, count, &mut counts),
                    });
                    control.advance(0, counts.rays() - before);
                    probe.span(What::Merge, |_| {
                        let mut merge = shared.merge.lock().unwrap_or_else(|e| e.into_inner());
                        merge.add_light(number, |number| order.light_paths(number).1, splats);
                    });
                    continue;
                }
            };
            sums.clear();
            job.rest(tile);
            for pass in grid.passes(tile, visit) {
                grid.job(tile, pass, &mut job);
                let before = counts.rays();
                probe.span(What::Visit, |probe| {
                    let samples = match &mut wave {
                        Some(wave) => wave.run(cx, &job, probe, &mut counts),
                        None if settings.integrator == Integrator::Scalar => {
                            reference.run::<S, true>(cx, &job, &mut counts)
                        }
                        None => reference.run::<S, false>(cx, &job, &mut counts),
                    };
                    probe.stage(Stage::Accumulate, samples.len(), || sums.accumulate(&job, samples));
                });
                if round.counts {
                    control.advance(job.paths() as u64, counts.rays() - before);
                }
            }
            probe.span(What::Merge, |_| {
                shared.merge.lock().unwrap_or_else(|e| e.into_inner()).add(visit, &mut job, &mut sums);
            });
        }
        let wave_bytes = wave.as_ref().map_or(0, |w| w.bytes(cx.plan)) + light.as_ref().map_or(0, |w| w.bytes());
        Work { counts, seen: probe.seen(), wave_bytes }
    });
    let Merge { film, mut bad, next_visit, next_light, .. } =
        shared.merge.into_inner().unwrap_or_else(|e| e.into_inner());
    bad.sort_unstable();
    let partial = next_light < order.light_jobs() || next_visit.iter().any(|&v| (v as usize) < order.visits);
    let mut rendered = Rendered { bad, threads: work.len(), partial, ..Rendered::of(film) };
    for w in work {
        rendered.counts.add(&w.counts);
        rendered.wave_bytes += w.wave_bytes;
        rendered.add_stages(w.seen.stages);
        rendered.timeline.push(w.seen.events);
    }
    Ok(rendered)
}
