//! A job: some samples of the pixels of a tile. Jobs depend on the image alone, never on the number of threads.

use super::effort::Efforts;
use std::ops::Range;

/// How an image is cut into jobs.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<'a> {
    size: [u32; 2],
    /// Which samples of each pixel, before tiles differ.
    samples: Range<u32>,
    efforts: &'a Efforts,
    /// Pixels of a tile across and down.
    side: u32,
}

impl<'a> Grid<'a> {
    /// Samples per pixel of a job at most: their radiance stays in cache.
    const SAMPLES: u32 = 64;
    /// Passes of a visit at most.
    const PASSES: u32 = 4;

    /// Cuts an image of `size` pixels and these samples of each, as tiles share them out, into jobs of `paths` at least, if
    /// tiles of 16 to 128 pixels across allow that.
    pub fn new(size: [u32; 2], samples: Range<u32>, efforts: &'a Efforts, paths: u32) -> Self {
        let most = (samples.len() as u32).clamp(1, Self::SAMPLES);
        let side = [16, 32, 64].into_iter().find(|s| s * s * most >= paths).unwrap_or(128);
        let side = if efforts.is_even() { side } else { side.min(Efforts::SIDE) };
        Self { size, samples, efforts, side }
    }
    /// Number of tiles.
    pub fn tiles(&self) -> usize {
        self.size[0].div_ceil(self.side) as usize * self.size[1].div_ceil(self.side) as usize
    }
    /// First pixel of a tile.
    fn corner(&self, tile: usize) -> [u32; 2] {
        let across = self.size[0].div_ceil(self.side) as usize;
        [(tile % across) as u32 * self.side, (tile / across) as u32 * self.side]
    }
    /// Which samples the pixels of a tile get.
    fn samples(&self, tile: usize) -> Range<u32> {
        self.efforts.samples(self.corner(tile), &self.samples)
    }
    /// Passes over the tiles with the most samples: each is a job per tile.
    fn all_passes(&self) -> u32 {
        self.efforts.most(self.samples.len() as u32).div_ceil(Self::SAMPLES)
    }
    /// Passes that a worker makes over a tile before it adds them to the film: more than one where there are many, so
    /// that the film is read less often.
    fn passes_per_visit(&self) -> u32 {
        (self.all_passes() / 4).clamp(1, Self::PASSES)
    }
    /// How often each tile is visited.
    pub fn visits(&self) -> u32 {
        1 + self.all_passes().saturating_sub(1).div_ceil(self.passes_per_visit())
    }
    /// The passes of a visit of a tile: none where it needs no more. The first is one pass, so that a render that is
    /// interrupted soon leaves few tiles black.
    pub fn passes(&self, tile: usize, visit: u32) -> Range<u32> {
        let all = (self.samples(tile).len() as u32).div_ceil(Self::SAMPLES);
        let begin = |visit: u32| (1 + (visit - 1) * self.passes_per_visit()).min(all);
        if visit == 0 { 0..all.min(1) } else { begin(visit)..begin(visit + 1) }
    }
    /// Makes `job` the one of a tile and pass; it keeps its memory.
    pub fn job(&self, tile: usize, pass: u32, job: &mut Job) {
        let ([width, height], side) = (self.size, self.side);
        let [x0, y0] = self.corner(tile);
        job.pixels.clear();
        for i in 0..side * side {
            // Squares of 8 x 8, made of blocks of 4 x 2.
            let (square, block, within) = (i / 64, i % 64 / 8, i % 8);
            let x = x0 + square % (side / 8) * 8 + block % 2 * 4 + within % 4;
            let y = y0 + square / (side / 8) * 8 + block / 2 * 2 + within / 4;
            if x < width && y < height {
                job.pixels.push([x, y]);
            }
        }
        (job.tile, job.pass) = (tile, pass);
        let samples = self.samples(tile);
        job.first_sample = samples.start + pass * Self::SAMPLES;
        job.samples = Self::SAMPLES.min(samples.end - job.first_sample);
    }
}

/// Some samples of a tile's pixels, for one worker.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Job {
    /// Number of the tile.
    pub tile: usize,
    /// Which of the tile's visits this is.
    pub pass: u32,
    /// Pixels (x, y): neighbours follow each other.
    pub pixels: Vec<[u32; 2]>,
    /// First sample of each pixel.
    pub first_sample: u32,
    /// Samples of each pixel.
    pub samples: u32,
}

impl Job {
    /// A visit of a tile that needs no more samples.
    pub fn rest(&mut self, tile: usize) {
        (self.tile, self.samples) = (tile, 0);
        self.pixels.clear();
    }
    /// Number of paths.
    pub fn paths(&self) -> usize {
        self.pixels.len() * self.samples as usize
    }
    /// Pixels that are traced together: 64 paths in a row are few neighbouring pixels.
    fn block(&self) -> usize {
        if self.samples >= 8 { 8 } else { 64 }
    }
    /// Places of the paths from number `slot` on. A block of pixels comes once for each of its samples, then the next
    /// block: the samples of a pixel come in order.
    #[inline(always)]
    pub fn places(&self, slot: usize) -> Places<'_> {
        if slot >= self.paths() {
            return Places { job: self, first: self.pixels.len(), block: 1, at: 0, sample: 0 };
        }
        let (samples, width) = (self.samples as usize, self.block());
        let first = slot / (width * samples) * width;
        let block = width.min(self.pixels.len() - first);
        let rest = slot - first * samples;
        Places { job: self, first, block, at: rest % block, sample: (rest / block) as u32 }
    }
}

/// What a path is a sample of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Index of the pixel in the job.
    pub index: usize,
    /// The pixel across and down.
    pub pixel: [u32; 2],
    /// Number of the sample.
    pub sample: u32,
}

/// Places of successive paths of a job.
#[derive(Clone, Debug)]
pub struct Places<'a> {
    job: &'a Job,
    /// First pixel of the block, and number of its pixels.
    first: usize,
    block: usize,
    /// Where in the block, and which of the job's samples.
    at: usize,
    sample: u32,
}

impl Iterator for Places<'_> {
    type Item = Place;
    #[inline(always)]
    fn next(&mut self) -> Option<Place> {
        let index = self.first + self.at;
        let &pixel = self.job.pixels.get(index)?;
        let place = Place { index, pixel, sample: self.job.first_sample + self.sample };
        self.at += 1;
        if self.at == self.block {
            (self.at, self.sample) = (0, self.sample + 1);
            if self.sample == self.job.samples {
                (self.first, self.sample) = (self.first + self.block, 0);
                self.block = self.job.block().min(self.job.pixels.len() - self.first);
            }
        }
        Some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::super::DEFAULT_JOB;
    use super::*;

    #[test]
    fn jobs_cover_all_samples_once() {
        let mut job = Job::default();
        let uneven = crate::wave::effort::tests::of([77, 41], |x, _| 1e-8 * f64::from(x + 1).powi(4));
        let even = Efforts::default();
        let ranges = [(0, 1), (3, 5), (0, 64), (100, 130), (u32::MAX - 600, 600)].map(|range| (range, &even));
        for ((first, spp), efforts) in ranges.into_iter().chain([((0, 1), &uneven), ((100, 130), &uneven)]) {
            let range = first..first + spp;
            let grid = Grid::new([77, 41], range.clone(), efforts, DEFAULT_JOB);
            let of = |i: u32| efforts.samples([i % 77, i / 77], &range);
            let mut seen: Vec<u32> = (0..77 * 41).map(|i| of(i).start).collect();
            let visits = (0..grid.tiles()).flat_map(|t| (0..grid.visits()).map(move |v| (t, v)));
            for (tile, pass) in visits.flat_map(|(t, v)| grid.passes(t, v).map(move |p| (t, p))) {
                grid.job(tile, pass, &mut job);
                assert_eq!(job.places(0).count(), job.paths());
                for (slot, place) in job.places(0).enumerate() {
                    assert_eq!(job.places(slot).next(), Some(place));
                    assert_eq!(job.pixels[place.index], place.pixel);
                    let [x, y] = place.pixel;
                    let pixel = (y * 77 + x) as usize;
                    assert_eq!(seen[pixel], place.sample, "samples of a pixel come in order");
                    seen[pixel] += 1;
                }
                assert_eq!(job.places(job.paths()).next(), None);
            }
            assert!((0..).zip(&seen).all(|(i, &n)| n == of(i).end));
        }
    }

    /// One pass first; then as many at once as leave four visits, and no more than are worth it.
    #[test]
    fn passes_are_bundled_where_there_are_many() {
        let even = Efforts::default();
        for passes in 1..40 {
            let grid = Grid::new([16, 16], 0..passes * Grid::SAMPLES, &even, DEFAULT_JOB);
            let visits: Vec<usize> = (0..grid.visits()).map(|visit| grid.passes(0, visit).len()).collect();
            assert_eq!(visits.iter().sum::<usize>(), passes as usize, "{visits:?}");
            assert!(visits[0] == 1 && visits.len() >= passes.min(5) as usize, "{passes} passes: {visits:?}");
            let bundles = &visits[1..visits.len().max(2) - 1];
            let most = Grid::PASSES as usize;
            let expected = (passes as usize / 4).clamp(1, most);
            assert!(bundles.iter().all(|&n| n == expected), "{passes} passes: {visits:?}");
        }
    }

    #[test]
    fn paths_of_a_tile_of_rays_are_neighbours() {
        for (spp, area) in [(64, 8), (8, 8), (1, 64), (4, 64)] {
            let mut job = Job::default();
            Grid::new([128, 128], 0..spp, &Efforts::default(), DEFAULT_JOB).job(0, 0, &mut job);
            for slot in (0..job.paths()).step_by(64) {
                let tile: Vec<_> = job.places(slot).take(64).map(|p| p.pixel).collect();
                let extent = |axis: usize| {
                    let values = tile.iter().map(|p| p[axis]);
                    values.clone().max().unwrap() - values.min().unwrap() + 1
                };
                assert_eq!(extent(0) * extent(1), area, "{spp} samples, path {slot}");
            }
        }
    }
}
