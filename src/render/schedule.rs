//! Jobs onto threads; with `accel/parallel.rs` the only file that names rayon.
//!
//! Visits of tiles, of one job or a few, are taken off one counter. Their sums reach each pixel in the order of the samples,
//! whichever thread is first: what arrives early waits.

use super::{Control, Integrator, Rendered, Settings, reference};
use crate::error::{Error, Result};
use crate::film::{BadSample, Film, Pixel};
use crate::light::Arrival;
use crate::probe::{Probe, Stage, StageRow};
use crate::sampling::{Sampler, Sobol};
use crate::wave::{Context, Counts, Efforts, Grid, Job, LIGHT_JOB, LightWave, Place, Splat, Wave};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// What a visit of a tile gave: sums of its pixels, pass after pass.
#[derive(Clone, Debug, Default)]
struct Sums {
    pixels: Vec<Pixel>,
    bad: Vec<BadSample>,
}

impl Sums {
    fn clear(&mut self) {
        self.pixels.clear();
        self.bad.clear();
    }
    /// Adds a pass.
    fn accumulate(&mut self, job: &Job, samples: &[[f32; 3]]) {
        let first = self.pixels.len();
        self.pixels.resize(first + job.pixels.len(), Pixel::default());
        for (Place { index, pixel, sample }, &radiance) in job.places(0).zip(samples) {
            if !self.pixels[first + index].add(radiance) {
                self.bad.push(BadSample { pixel, sample });
            }
        }
    }
}

/// What workers write to, once per visit of a tile, on cache lines apart from all that they read.
#[repr(align(128))]
struct Shared {
    /// Number of the next visit.
    next: AtomicUsize,
    merge: Mutex<Merge>,
}

/// The film, and what has come out of order: by tile and visit, or by number of the job of light paths.
struct Merge {
    film: Film,
    bad: Vec<BadSample>,
    next_visit: Vec<u32>,
    early: BTreeMap<(usize, u32), (Job, Sums)>,
    next_light: usize,
    early_light: BTreeMap<usize, Vec<Splat>>,
}

impl Merge {
    /// Adds a visit's sums, or keeps them and the job until it is their turn.
    fn add(&mut self, visit: u32, job: &mut Job, sums: &mut Sums) {
        let tile = job.tile;
        if visit != self.next_visit[tile] {
            self.early.insert((tile, visit), (std::mem::take(job), std::mem::take(sums)));
            return;
        }
        self.merge(job, sums);
        while let Some((job, sums)) = self.early.remove(&(tile, self.next_visit[tile])) {
            self.merge(&job, &sums);
        }
    }
    fn merge(&mut self, job: &Job, sums: &Sums) {
        for (index, &pixel) in job.pixels.iter().enumerate() {
            let pixel = self.film.pixel_mut(pixel);
            for pass in sums.pixels.chunks_exact(job.pixels.len()) {
                pixel.merge(&pass[index]);
            }
        }
        self.bad.extend_from_slice(&sums.bad);
        self.next_visit[job.tile] += 1;
    }
    /// Adds what a job of light paths brought, or keeps it until it is its turn.
    fn add_light(&mut self, work: &Order, number: usize, splats: &[Splat]) {
        if number != self.next_light {
            self.early_light.insert(number, splats.to_vec());
            return;
        }
        self.merge_light(work, splats);
        while let Some(splats) = self.early_light.remove(&self.next_light) {
            self.merge_light(work, &splats);
        }
    }
    fn merge_light(&mut self, work: &Order, splats: &[Splat]) {
        for splat in splats {
            if !self.film.splat(splat.pixel, splat.radiance) {
                self.bad.push(BadSample { pixel: splat.pixel, sample: u32::MAX });
            }
        }
        self.film.count_light_paths(work.light_paths(self.next_light).1 as u64);
        self.next_light += 1;
    }
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
    stages: Vec<StageRow>,
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
        let (mut probe, mut counts, mut found) = (P::default(), Counts::default(), Vec::new());
        loop {
            let job = next.fetch_add(1, Ordering::Relaxed) as u64;
            let first = job * SURVEY_JOB;
            if first >= count {
                return (found, counts, probe.rows());
            }
            let paths = (count - first).min(SURVEY_JOB) as usize;
            found.push((job, crate::wave::survey::<Sobol>(cx, first, paths, &mut probe, &mut counts)));
        }
    });
    let mut all = Rendered::of(Film::new(0, 0));
    let mut jobs = Vec::new();
    for (found, counts, stages) in work {
        jobs.extend(found);
        all.counts.add(&counts);
        all.add_stages(stages);
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
    let grid = Grid::new(size, round.samples.clone(), round.efforts);
    let lights = |samples: u32| (f64::from(cx.plan.light_paths) * f64::from(samples)).round() as u64;
    let lights = if round.counts { lights(round.samples.start)..lights(round.samples.end) } else { 0..0 };
    let order = Order { tiles: grid.tiles(), visits: grid.visits() as usize, lights };
    let shared = Shared {
        next: AtomicUsize::new(0),
        merge: Mutex::new(Merge {
            film,
            bad: Vec::new(),
            next_visit: vec![0; order.tiles],
            early: BTreeMap::new(),
            next_light: 0,
            early_light: BTreeMap::new(),
        }),
    };
    let work = pool.broadcast(|_| {
        let mut probe = P::default();
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
                    let splats = match &mut light {
                        Some(light) => light.run(cx, first, count, &mut probe, &mut counts),
                        None => reference.light::<S>(cx, first, count, &mut counts),
                    };
                    control.advance(0, counts.rays() - before);
                    let mut merge = shared.merge.lock().unwrap_or_else(|e| e.into_inner());
                    merge.add_light(&order, number, splats);
                    continue;
                }
            };
            sums.clear();
            job.rest(tile);
            for pass in grid.passes(tile, visit) {
                grid.job(tile, pass, &mut job);
                let before = counts.rays();
                let samples = match &mut wave {
                    Some(wave) => wave.run(cx, &job, &mut probe, &mut counts),
                    None if settings.integrator == Integrator::Scalar => {
                        reference.run::<S, true>(cx, &job, &mut counts)
                    }
                    None => reference.run::<S, false>(cx, &job, &mut counts),
                };
                probe.stage(Stage::Accumulate, samples.len(), || sums.accumulate(&job, samples));
                if round.counts {
                    control.advance(job.paths() as u64, counts.rays() - before);
                }
            }
            shared.merge.lock().unwrap_or_else(|e| e.into_inner()).add(visit, &mut job, &mut sums);
        }
        let wave_bytes = wave.as_ref().map_or(0, |w| w.bytes(cx.plan)) + light.as_ref().map_or(0, |w| w.bytes());
        Work { counts, stages: probe.rows(), wave_bytes }
    });
    let Merge { film, mut bad, next_visit, next_light, .. } =
        shared.merge.into_inner().unwrap_or_else(|e| e.into_inner());
    bad.sort_unstable();
    let partial = next_light < order.light_jobs() || next_visit.iter().any(|&v| (v as usize) < order.visits);
    let mut rendered = Rendered { bad, threads: work.len(), partial, ..Rendered::of(film) };
    for w in work {
        rendered.counts.add(&w.counts);
        rendered.wave_bytes += w.wave_bytes;
        rendered.add_stages(w.stages);
    }
    Ok(rendered)
}
