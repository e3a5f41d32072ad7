//! From rays as they are in files to hits as they are in files, by a kernel of choice, on threads.
//!
//! To add a kernel: a variant, its entry in [`Kernel::ALL`], and its arm in `Tracer::share`.

use super::cpu;
use super::files::{HitRecord, RayRecord};
use crate::accel::{BatchTracer, Bvh, Hit, Many, Ray, RayLanes, RaySource, Single, Streams, Tiles};
use crate::columns::Rows;
use crate::lanes::{Lanes, MAX_LANES, Vec3};
use std::thread;

/// How rays are traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// What suits the rays: tiles for those of a camera, and for those to a light unless the tree is large; else streams.
    #[default]
    Auto,
    /// One ray after the other.
    Single,
    /// Many rays in flight per thread.
    Many,
    /// Streams of rays through the top of the tree, and `Many` below; where most would go on below, `Many` alone.
    Stream,
    /// Tiles of rays that run the same way; rays that do not go to `Stream`.
    Tile,
}

impl Kernel {
    /// All kernels and their names.
    pub const ALL: &[(Self, &str)] = &[
        (Self::Auto, "auto"),
        (Self::Single, "single"),
        (Self::Many, "many"),
        (Self::Stream, "stream"),
        (Self::Tile, "tile"),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|k| k.0 == self).map_or("", |k| k.1)
    }
    /// The kernel of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|k| k.1 == name).map(|k| k.0)
    }
}

/// Bytes of a tree up to which tiles of shadow rays are faster: measured at 3 MB and 68 MB.
const TILED_SHADOWS: usize = 16 << 20;

/// Runs that each thread gets, where they are neither too short nor too long.
const RUNS: usize = 16;
/// A shorter run would show how a kernel starts and ends.
const SHORTEST: usize = 1 << 12;
/// A longer one would gain nothing.
const LONGEST: usize = 1 << 16;

/// Rays that are dealt out together, and where their hits go.
type Run<'a> = (&'a [RayRecord], &'a mut [HitRecord]);

/// What is asked of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// The nearest hits of rays through neighbouring pixels.
    Camera,
    /// The nearest hit.
    Closest,
    /// Whether there is any.
    Any,
}

/// Traces sets of rays.
#[derive(Clone, Copy, Debug)]
pub struct Tracer<'a> {
    /// The tree.
    pub bvh: &'a Bvh,
    /// How rays are traced.
    pub kernel: Kernel,
    /// Threads, at least one is used.
    pub threads: usize,
}

impl Tracer<'_> {
    /// Traces all rays `passes` times; the hits, in their order, go to the front of `hits`, which is at least as long.
    ///
    /// Runs of rays are dealt out to the threads in turn, so that each gets a like share of the image. Each is on
    /// a CPU of its own where there are enough of them. Threads start and end within.
    pub fn trace(&self, rays: &[RayRecord], hits: &mut [HitRecord], query: Query, passes: usize) {
        let cpus = cpu::allowed();
        let threads = self.threads.max(1);
        let run = self.run(rays.len());
        let mut shares: Vec<Vec<Run>> = (0..threads).map(|_| Vec::new()).collect();
        for (number, part) in rays.chunks(run).zip(hits.chunks_mut(run)).enumerate() {
            shares[number % threads].push(part);
        }
        thread::scope(|scope| {
            for (k, mut runs) in shares.into_iter().enumerate() {
                let cpu = if threads <= cpus.len() { cpus.get(k).copied() } else { None };
                scope.spawn(move || {
                    if let Some(cpu) = cpu {
                        cpu::pin(cpu);
                    }
                    (0..passes).for_each(|_| self.share(&mut runs, query));
                });
            }
        });
    }

    /// Rays of a run, of a set of so many.
    fn run(&self, rays: usize) -> usize {
        rays.div_ceil(self.threads.max(1) * RUNS).next_multiple_of(MAX_LANES).clamp(SHORTEST, LONGEST)
    }

    /// CPUs that [`trace`](Self::trace) keeps busy with a set of so many rays on a quiet machine: fewer than there are threads where
    /// these get unlike shares of a small set, or where there are fewer CPUs.
    pub fn concurrency(&self, rays: usize) -> f64 {
        let (threads, run) = (self.threads.max(1), self.run(rays));
        // The first thread gets the most runs, or as many as the others.
        let first = (0..rays).step_by(run * threads).map(|start| run.min(rays - start)).sum::<usize>();
        let cpus = thread::available_parallelism().map_or(threads, usize::from);
        (rays as f64 / first.max(1) as f64).clamp(1.0, cpus as f64)
    }

    /// The hits of rays.
    pub fn hits(&self, rays: &[RayRecord], query: Query) -> Vec<HitRecord> {
        let mut hits = vec![HitRecord::MISS; rays.len()];
        self.trace(rays, &mut hits, query, 1);
        hits
    }

    /// What one thread does.
    fn share(&self, runs: &mut [Run], query: Query) {
        let tiles_pay = match query {
            Query::Camera => true,
            Query::Any => self.bvh.bytes() <= TILED_SHADOWS,
            Query::Closest => false,
        };
        match self.kernel {
            Kernel::Single => single(self.bvh, runs, query),
            Kernel::Many => batch(Many::new(), self.bvh, runs, query),
            Kernel::Auto if !tiles_pay => batch(Streams::new(), self.bvh, runs, query),
            Kernel::Stream => batch(Streams::new(), self.bvh, runs, query),
            Kernel::Auto | Kernel::Tile => batch(Tiles::new(), self.bvh, runs, query),
        }
    }
}

/// One ray after the other.
fn single(bvh: &Bvh, runs: &mut [Run], query: Query) {
    let mut kernel = Single::new(bvh);
    let ray = |r: &RayRecord| Ray { origin: r.origin, direction: r.direction, t_max: r.t_max };
    for (rays, hits) in runs {
        let pairs = rays.iter().zip(hits.iter_mut());
        match query {
            Query::Camera | Query::Closest => pairs.for_each(|(r, hit)| *hit = closest(kernel.closest(bvh, &ray(r)))),
            Query::Any => pairs.for_each(|(r, hit)| *hit = any(kernel.any(bvh, &ray(r)))),
        }
    }
}

/// Through a kernel for batches.
fn batch(mut kernel: impl BatchTracer, bvh: &Bvh, runs: &mut [Run], query: Query) {
    for (rays, hits) in runs {
        match query {
            Query::Camera | Query::Closest => {
                kernel.closest(bvh, rays.len(), *rays, |i, hit| put(hits, i, closest(hit)));
            }
            Query::Any => kernel.any(bvh, rays.len(), *rays, |i, hit| put(hits, i, any(hit))),
        }
    }
}

impl RaySource for [RayRecord] {
    /// A record is eight numbers, so that one transposition makes the columns.
    #[inline(always)]
    fn rays<L: Lanes>(&self, rows: &Rows) -> RayLanes<L> {
        let [ox, oy, oz, _, dx, dy, dz, t_max] = L::columns8(|i| bytemuck::cast_ref(&self[rows.at(i)]));
        RayLanes { origin: Vec3::new(ox, oy, oz), direction: Vec3::new(dx, dy, dz), t_max }
    }
}

#[inline(always)]
fn put(hits: &mut [HitRecord], i: usize, hit: HitRecord) {
    if let Some(place) = hits.get_mut(i) {
        *place = hit;
    }
}

#[inline(always)]
fn closest(hit: Hit) -> HitRecord {
    // Kernels leave the end of a ray in the distance of a miss.
    let t = if hit.is_some() { hit.t } else { f32::INFINITY };
    HitRecord { t, u: hit.u, v: hit.v, triangle: hit.triangle }
}

#[inline(always)]
fn any(hit: bool) -> HitRecord {
    if hit { HitRecord::SOME } else { HitRecord::MISS }
}
