//! When a render ends: after a number of samples, when a time is spent, or once the error is small. Samples come in rounds
//! over the whole image.
//!
//! **Error.** Four replicates of the image are rendered, each with random numbers of its own, in two halves of two. What two
//! independent images of as many samples differ by tells the variance of their mean, with any sampler. One half's number of
//! samples is decided by the error of the *other* half alone, and the image is the mean of both halves: given how many
//! samples it has, each half is then an unbiased estimate of the image, and so is the mean. Had both halves' own samples
//! decided, images without a rare bright sample would end early and dark. Rounds are the same for all renders, so that when
//! errors are looked at does not depend on them either.

use super::schedule::Round;
use super::{Control, Effort, Rendered, Renderer, Settings};
use crate::error::Result;
use crate::film::Film;
use crate::light::Spots;
use crate::sampling::Screen;
use crate::wave::{Efforts, Plan};
use std::time::{Duration, Instant};

/// Images that a render is made of, where its error is estimated.
pub(super) const REPLICATES: u32 = 4;
/// From one seed to the next replicate's.
const SEED_STEP: u64 = 0xd134_2543_de82_ef95;
/// Samples of each pixel of a render that tells where the error is.
const TRIAL: u32 = 4;
/// Seeds of the two.
const TRIAL_SEEDS: [u64; 2] = [0x9e6c_63d0_876a_68ee, 0xd1b5_4a32_d192_ed03];
/// A round of more samples than these is of multiples of it: jobs are then whole.
const WHOLE: u32 = 64;

/// What all rounds of a render have in common.
pub(super) struct Rounds<'a> {
    pub renderer: &'a Renderer,
    pub plan: &'a Plan,
    pub spots: &'a Spots,
    pub efforts: &'a Efforts,
    pub settings: &'a Settings,
    pub control: &'a Control,
    pub start: Instant,
}

/// Two replicates, and what became of them once the other half's error was small enough.
struct Half {
    films: [Film; 2],
    done: Option<Film>,
}

impl Half {
    fn new(film: &Film) -> Self {
        Self { films: [film.clone(), film.clone()], done: None }
    }
    /// By this half's samples alone.
    fn own_error(&self) -> f64 {
        self.films[0].rel_mse_of_mean(&self.films[1])
    }
    /// Relative to the other half's image.
    fn error(&self, other: &Self) -> f64 {
        let [a, b] = &other.films;
        self.films[0].rel_mse_of_mean_to(&self.films[1], [a, b])
    }
    fn mean(&self) -> Film {
        let mut film = self.films[0].clone();
        film.merge(&self.films[1]);
        film
    }
}

impl Rounds<'_> {
    /// How tiles share out the samples, and what it took to find out: two small renders, whose samples are no part of the
    /// image, so that no sample decides how much it counts. Without either if they are not done in time.
    pub fn efforts(&self) -> Result<(Efforts, Rendered)> {
        let mut all = Rendered::of(Film::new(0, 0));
        if self.settings.effort == Effort::Even {
            return Ok((Efforts::default(), all));
        }
        let [width, height] = [self.renderer.world.width(), self.renderer.world.height()];
        let deadline = self.start.checked_add(self.settings.time / 4);
        let mut films = Vec::new();
        for seed in TRIAL_SEEDS {
            let round = Round { samples: 0..TRIAL, efforts: self.efforts, counts: false, deadline };
            films.push(all.add(self.trace(seed, TRIAL, &round, Film::new(width, height))?));
        }
        if std::mem::take(&mut all.partial) {
            return Ok((Efforts::default(), all));
        }
        Ok((Efforts::new(&films[0], &films[1]), all))
    }

    /// One round of all samples.
    pub fn all(&self, film: Film) -> Result<Rendered> {
        self.round(self.settings.seed, 0, self.settings.spp, film, None)
    }

    /// Rounds until the time is spent, or all samples are done. Each but the first two doubles the samples at most, and takes
    /// half of the time left at most, so that the pixels of a render that ends within a round differ by few samples.
    pub fn until_time(&self, mut film: Film) -> Result<Rendered> {
        let mut all = Rendered::of(Film::new(0, 0));
        let mut done = 0;
        while !self.is_over(done) {
            let next = self.next(done);
            let round = self.round(self.settings.seed, done, next, film, self.deadline().filter(|_| done > 0))?;
            film = all.add(round);
            done = next;
        }
        all.partial = self.control.is_stopped();
        all.film = film;
        Ok(all)
    }

    /// Rounds until each half of the image is good enough by the other's error, or the time is spent, or the samples are done.
    pub fn until_error(&self, film: Film, target: f64) -> Result<Rendered> {
        let mut all = Rendered::of(Film::new(0, 0));
        let mut halves = [Half::new(&film), Half::new(&film)];
        let (mut done, most) = (0, self.settings.spp / REPLICATES);
        while done < most && !self.is_over(0) && halves.iter().any(|half| half.done.is_none()) {
            let next = step(done).min(most);
            for (k, film) in halves.iter_mut().flat_map(|half| &mut half.films).enumerate() {
                let seed = self.settings.seed.wrapping_add((k as u64).wrapping_mul(SEED_STEP));
                let before = std::mem::replace(film, Film::new(0, 0));
                *film = all.add(self.round(seed, done, next, before, self.deadline().filter(|_| done > 0))?);
            }
            done = next;
            // Of the mean of both halves, if the other is as good.
            let own = [halves[0].own_error() / 2.0, halves[1].own_error() / 2.0];
            let error = (halves[0].error(&halves[1]) + halves[1].error(&halves[0])) / 4.0;
            self.control.set_error(error);
            if all.partial {
                break;
            }
            all.error = Some(error);
            for (half, error) in halves.iter_mut().zip([own[1], own[0]]) {
                if half.done.is_none() && error <= target {
                    half.done = Some(half.mean());
                }
            }
        }
        all.partial = self.control.is_stopped();
        let [a, b] = halves.map(|half| half.done.clone().unwrap_or_else(|| half.mean()));
        all.film = a;
        all.film.average(&b);
        Ok(all)
    }

    fn round(&self, seed: u64, from: u32, to: u32, film: Film, deadline: Option<Instant>) -> Result<Rendered> {
        let Self { efforts, settings, .. } = *self;
        self.trace(
            seed,
            efforts.most(settings.spp),
            &Round { samples: from..to, efforts, counts: true, deadline },
            film,
        )
    }
    /// A round of an image of which no pixel gets more than `most` samples.
    fn trace(&self, seed: u64, most: u32, round: &Round<'_>, film: Film) -> Result<Rendered> {
        let Self { renderer, plan, spots, settings, control, .. } = *self;
        let cx = renderer.context(plan, spots, seed, Screen::new(renderer.world.width(), most));
        renderer.round(&cx, settings, round, film, control)
    }
    fn deadline(&self) -> Option<Instant> {
        self.start.checked_add(self.settings.time)
    }
    fn is_over(&self, done: u32) -> bool {
        done >= self.settings.spp
            || self.control.is_stopped()
            || (done > 0 && self.start.elapsed() >= self.settings.time)
    }
    fn next(&self, done: u32) -> u32 {
        let spent = self.start.elapsed();
        let left = self.settings.time.saturating_sub(spent);
        done.saturating_add(length(done, spent, left)).min(self.settings.spp)
    }
}

/// Samples of the next round, after `done` samples in the time `spent`, where so much time is left.
fn length(done: u32, spent: Duration, left: Duration) -> u32 {
    let fit = left.as_secs_f64() / spent.as_secs_f64().max(1e-9) * f64::from(done);
    let most = done.min((fit / 2.0) as u32).max(1);
    if most < WHOLE { 1 << most.ilog2() } else { most / WHOLE * WHOLE }
}

/// Samples of a replicate when its error is looked at next: 1, 2, 3, 4, 6, 8, 12, 16, ...
fn step(done: u32) -> u32 {
    match done {
        0..4 => done + 1,
        _ if done.is_power_of_two() => done.saturating_add(done / 2),
        _ => done.saturating_add(done / 3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_double_and_halve_the_time_left() {
        let of = |done, spent, left| length(done, Duration::from_millis(spent), Duration::from_millis(left));
        assert_eq!((of(0, 0, 1000), of(1, 10, 990), of(4, 40, 960)), (1, 1, 4));
        // 16 fit: half of them, then one after the other.
        assert_eq!((of(64, 40, 10), of(79, 50, 1), of(79, 50, 0)), (8, 1, 1));
        // Whole jobs.
        assert_eq!(of(1000, 1000, 300), 128);
        assert_eq!(of(1000, 1000, u64::MAX), 960);
        assert_eq!(of(u32::MAX / 2, 1000, 100_000), u32::MAX / 2 / 64 * 64);
    }

    #[test]
    fn steps_rise_by_half_at_most() {
        let mut steps = vec![0];
        while steps.len() < 12 {
            steps.push(step(steps[steps.len() - 1]));
        }
        assert_eq!(steps, [0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48]);
    }
}
