//! Samples into the film: the sums of each pixel are added in the order of its samples, whichever thread is first.

use crate::film::{BadSample, Film, Pixel};
use crate::wave::{Job, Place, Splat};
use std::collections::BTreeMap;

/// What a visit of a tile gave: sums of its pixels, pass after pass.
#[derive(Clone, Debug, Default)]
pub(super) struct Sums {
    pixels: Vec<Pixel>,
    bad: Vec<BadSample>,
}

impl Sums {
    /// Nothing yet.
    pub fn clear(&mut self) {
        self.pixels.clear();
        self.bad.clear();
    }
    /// Adds a pass.
    pub fn accumulate(&mut self, job: &Job, samples: &[[f32; 3]]) {
        let first = self.pixels.len();
        self.pixels.resize(first + job.pixels.len(), Pixel::default());
        for (Place { index, pixel, sample }, &radiance) in job.places(0).zip(samples) {
            if !self.pixels[first + index].add(radiance) {
                self.bad.push(BadSample { pixel, sample });
            }
        }
    }
}

/// The film, and what has come out of order: by tile and visit, or by number of the job of light paths.
pub(super) struct Merge {
    pub film: Film,
    /// Samples that are no numbers, in any order.
    pub bad: Vec<BadSample>,
    /// By tile, the visit that is next.
    pub next_visit: Vec<u32>,
    early: BTreeMap<(usize, u32), (Job, Sums)>,
    /// The job of light paths that is next.
    pub next_light: usize,
    early_light: BTreeMap<usize, Vec<Splat>>,
}

impl Merge {
    /// Nothing yet, of an image of `tiles` tiles.
    pub fn new(film: Film, tiles: usize) -> Self {
        Self {
            film,
            bad: Vec::new(),
            next_visit: vec![0; tiles],
            early: BTreeMap::new(),
            next_light: 0,
            early_light: BTreeMap::new(),
        }
    }
    /// Adds a visit's sums, or keeps them and the job until it is their turn.
    pub fn add(&mut self, visit: u32, job: &mut Job, sums: &mut Sums) {
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
    /// Adds what a job of light paths brought, or keeps it until it is its turn; `paths` is how many a job has.
    pub fn add_light(&mut self, number: usize, paths: impl Fn(usize) -> usize, splats: &[Splat]) {
        if number != self.next_light {
            self.early_light.insert(number, splats.to_vec());
            return;
        }
        self.merge_light(paths(number), splats);
        while let Some(splats) = self.early_light.remove(&self.next_light) {
            self.merge_light(paths(self.next_light), &splats);
        }
    }
    fn merge_light(&mut self, paths: usize, splats: &[Splat]) {
        for splat in splats {
            if !self.film.splat(splat.pixel, splat.radiance) {
                self.bad.push(BadSample { pixel: splat.pixel, sample: u32::MAX });
            }
        }
        self.film.count_light_paths(paths as u64);
        self.next_light += 1;
    }
}
