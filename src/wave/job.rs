//! A job: some samples of the pixels of a tile. Jobs depend on the image alone, never on the number of threads.

/// Pixels of a tile across and down.
pub const TILE: u32 = 16;

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
    /// Samples of tile number `tile` of an image of `width` x `height` pixels.
    pub fn new(tile: usize, [width, height]: [u32; 2], first_sample: u32, samples: u32) -> Self {
        let across = width.div_ceil(TILE);
        let (x0, y0) = (tile as u32 % across * TILE, tile as u32 / across * TILE);
        // Blocks of 4 x 2 fill the lanes with neighbours.
        let pixels = (0..TILE * TILE)
            .map(|i| {
                let (block, within) = (i / 8, i % 8);
                [x0 + block % (TILE / 4) * 4 + within % 4, y0 + block / (TILE / 4) * 2 + within / 4]
            })
            .filter(|&[x, y]| x < width && y < height)
            .collect();
        Self { tile, pixels, width, first_sample, samples }
    }
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
    fn tiles_cover_the_image_once() {
        let size = [37, 21];
        let mut seen = vec![0; 37 * 21];
        for tile in 0..3 * 2 {
            let job = Job::new(tile, size, 0, 2);
            for slot in 0..job.paths() {
                let ([x, y], sample) = job.place(slot);
                assert!(sample < 2);
                seen[(y * 37 + x) as usize] += 1;
            }
        }
        assert!(seen.iter().all(|&n| n == 2));
    }
}
