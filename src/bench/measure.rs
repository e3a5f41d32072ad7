//! The clock: rays per second of a tracer on sets of rays.

use super::cpu;
use super::files::HitRecord;
use super::kernel::Tracer;
use super::sets::{RaySet, SetKind};
use std::time::{Duration, Instant};

/// Shortest time that is measured: small sets are traced several times in it.
const SHORTEST: Duration = Duration::from_millis(100);
/// Passes that are not timed, at most: a pass that takes long enough to be timed alone is the only one.
const WARM_UPS: usize = 3;

/// What was measured on a set.
#[derive(Clone, Debug)]
pub struct Timing {
    /// Which set.
    pub kind: SetKind,
    /// Number of its rays.
    pub rays: usize,
    /// How many of them hit something.
    pub hits: usize,
    /// Rays per second of each repeat, in 10^6; empty of a set without rays.
    pub mrays_per_s: Vec<f64>,
    /// CPUs that were busy with this program in the mean, where the system tells: less than the threads where other
    /// programs took their share.
    pub busy: Option<f64>,
}

impl Timing {
    /// The median of the repeats, 0 of a set without rays.
    pub fn median(&self) -> f64 {
        let mut sorted = self.mrays_per_s.clone();
        sorted.sort_by(f64::total_cmp);
        let at = |i: usize| sorted.get(i).copied().unwrap_or(0.0);
        match sorted.len() {
            0 => 0.0,
            n => (at(n / 2) + at((n - 1) / 2)) / 2.0,
        }
    }
    /// The fastest repeat.
    pub fn best(&self) -> f64 {
        self.mrays_per_s.iter().copied().fold(0.0, f64::max)
    }
    /// From the slowest repeat to the fastest, over the median.
    pub fn spread(&self) -> f64 {
        let slowest = self.mrays_per_s.iter().copied().fold(f64::INFINITY, f64::min);
        let median = self.median();
        if median > 0.0 { (self.best() - slowest) / median } else { 0.0 }
    }
}

/// Times a tracer on each set, `repeats` times after a pass that is not timed; returns the timings and the hits of each.
///
/// A time is that from the first ray read to the last hit written, with the start and the end of all threads. A repeat
/// goes once through all sets, so that a slow moment of the machine touches one repeat of each.
pub fn measure(tracer: &Tracer<'_>, sets: &[RaySet], repeats: usize) -> Vec<(Timing, Vec<HitRecord>)> {
    let mut results: Vec<(Timing, Vec<HitRecord>)> = Vec::with_capacity(sets.len());
    let mut passes = Vec::with_capacity(sets.len());
    for set in sets {
        let mut hits = vec![HitRecord::MISS; set.rays.len()];
        // A slow moment in a short pass would tell too little of the next ones: the best of some.
        let mut seconds = f64::INFINITY;
        for _ in 0..WARM_UPS {
            let start = Instant::now();
            tracer.trace(&set.rays, &mut hits, set.kind.query(), 1);
            seconds = seconds.min(start.elapsed().as_secs_f64().max(1e-9));
            if seconds >= SHORTEST.as_secs_f64() {
                break;
            }
        }
        passes.push((SHORTEST.as_secs_f64() / seconds).ceil().max(1.0) as usize);
        let found = hits.iter().filter(|hit| hit.is_some()).count();
        let timing = Timing { kind: set.kind, rays: set.rays.len(), hits: found, mrays_per_s: Vec::new(), busy: None };
        results.push((timing, hits));
    }
    let mut spent = vec![(Duration::ZERO, Some(Duration::ZERO)); sets.len()];
    for _ in 0..repeats {
        for ((set, &passes), ((timing, hits), spent)) in
            sets.iter().zip(&passes).zip(results.iter_mut().zip(&mut spent))
        {
            if set.rays.is_empty() {
                continue;
            }
            let (cpu, start) = (cpu::time(), Instant::now());
            tracer.trace(&set.rays, hits, set.kind.query(), passes);
            let wall = start.elapsed();
            let worked = cpu::time().zip(cpu).map(|(after, before)| after.saturating_sub(before));
            *spent = (spent.0 + wall, spent.1.zip(worked).map(|(sum, worked)| sum + worked));
            timing.mrays_per_s.push(set.rays.len() as f64 * passes as f64 / wall.as_secs_f64().max(1e-9) * 1e-6);
        }
    }
    for ((timing, _), (wall, worked)) in results.iter_mut().zip(spent) {
        timing.busy = worked.filter(|_| !wall.is_zero()).map(|worked| worked.as_secs_f64() / wall.as_secs_f64());
    }
    results
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_best_and_spread() {
        let timing = |v: &[f64]| Timing { kind: SetKind::Deep, rays: 1, hits: 0, mrays_per_s: v.to_vec(), busy: None };
        let odd = timing(&[4.0, 1.0, 2.0]);
        assert_eq!((odd.median(), odd.best(), odd.spread()), (2.0, 4.0, 1.5));
        assert_eq!(timing(&[4.0, 1.0, 2.0, 3.0]).median(), 2.5);
        let none = timing(&[]);
        assert_eq!((none.median(), none.best(), none.spread()), (0.0, 0.0, 0.0));
    }
}
