//! A job: some samples of the pixels of a tile. Jobs depend on the image alone, never on the number of threads.

/// How an image is cut into jobs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    size: [u32; 2],
    spp: u32,
    /// Pixels of a tile across and down.
    side: u32,
}

impl Grid {
    /// Samples per pixel of a job at most: their radiance stays in cache.
    const SAMPLES: u32 = 64;
    /// Paths of a job, if the image allows: enough to fill a wave.
    const PATHS: u32 = 4096;

    /// Cuts an image of `width` x `height` pixels and `spp` samples per pixel.
    pub fn new(size: [u32; 2], spp: u32) -> Self {
        let samples = spp.clamp(1, Self::SAMPLES);
        let side = [16, 32, 64].into_iter().find(|s| s * s * samples >= Self::PATHS).unwrap_or(64);
        Self { size, spp, side }
    }
    /// Number of tiles.
    pub fn tiles(&self) -> usize {
        self.size[0].div_ceil(self.side) as usize * self.size[1].div_ceil(self.side) as usize
    }
    /// How often each tile is visited.
    pub fn passes(&self) -> u32 {
        self.spp.div_ceil(Self::SAMPLES)
    }
    /// The job of a tile and pass.
    pub fn job(&self, tile: usize, pass: u32) -> Job {
        let ([width, height], side) = (self.size, self.side);
        let across = width.div_ceil(side) as usize;
        let (x0, y0) = ((tile % across) as u32 * side, (tile / across) as u32 * side);
        // Blocks of 4 x 2 fill the lanes with neighbours.
        let pixels = (0..side * side)
            .map(|i| {
                let (block, within) = (i / 8, i % 8);
                [x0 + block % (side / 4) * 4 + within % 4, y0 + block / (side / 4) * 2 + within / 4]
            })
            .filter(|&[x, y]| x < width && y < height)
            .collect();
        let first_sample = pass * Self::SAMPLES;
        Job { tile, pixels, width, first_sample, samples: Self::SAMPLES.min(self.spp - first_sample) }
    }
}

/// Some samples of a tile's pixels, for one worker.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Number of the tile.
    pub tile: usize,
    /// Pixels (x, y), in the order in which they are traced: neighbours follow each other.
    pub pixels: Vec<[u32; 2]>,
    /// Width of the image, which numbers the pixels.
    pub width: u32,
    /// First sample of each pixel.
    pub first_sample: u32,
    /// Samples of each pixel.
    pub samples: u32,
}

impl Job {
    /// Number of paths.
    pub fn paths(&self) -> usize {
        self.pixels.len() * self.samples as usize
    }
    /// (pixel, sample) of path number `slot`: all pixels once, then all once more.
    #[inline(always)]
    pub fn place(&self, slot: usize) -> ([u32; 2], u32) {
        (self.pixels[slot % self.pixels.len()], self.first_sample + (slot / self.pixels.len()) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_cover_all_samples_once() {
        for spp in [1, 5, 64, 130] {
            let grid = Grid::new([77, 41], spp);
            let mut seen = vec![0u32; 77 * 41];
            for (tile, pass) in (0..grid.tiles()).flat_map(|t| (0..grid.passes()).map(move |p| (t, p))) {
                let job = grid.job(tile, pass);
                for slot in 0..job.paths() {
                    let ([x, y], sample) = job.place(slot);
                    assert_eq!(seen[(y * 77 + x) as usize], sample, "samples of a pixel come in order");
                    seen[(y * 77 + x) as usize] += 1;
                }
            }
            assert!(seen.iter().all(|&n| n == spp));
        }
    }
}
