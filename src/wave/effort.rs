//! Where samples go: the same number everywhere, or more on tiles where there is more error.
//!
//! If a tile's samples leave the variance v / n^p after n, the sum over tiles is least where n is proportional to v^(1 / (1 +
//! p)): the root for independent samples (Neyman 1934). With Sobol points p is larger, up to 3 where what they sample is smooth
//! (Owen 1997), and 2 is taken here. Numbers are powers of two times those of the image, as such points want them.

use crate::film::{Film, RELATIVE_OFFSET};
use std::ops::Range;

/// From the fewest samples of a tile to those of the image, and on to the most, as powers of two.
const REACH: i8 = 3;

/// What two small renders tell of a tile.
struct Tile {
    pixels: f64,
    /// Of a pixel's mean, relative to what is seen there: the mean over pixels and channels.
    variance: f64,
}

impl Tile {
    fn new(a: &Film, b: &Film, [x, y]: [u32; 2]) -> Self {
        let [width, height] = [a.width(), a.height()];
        let mut tile = Self { pixels: 0.0, variance: 0.0 };
        let step = Efforts::BLOCK;
        let within = |from: u32, side: u32, whole: u32| from..(from + side).min(whole);
        for y in within(y, Efforts::SIDE, height).step_by(step as usize) {
            for x in within(x, Efforts::SIDE, width).step_by(step as usize) {
                let pixels = within(y, step, height).flat_map(|y| within(x, step, width).map(move |x| y * width + x));
                let (mut error, mut square, mut count) = ([0.0; 3], [0.0; 3], 0.0);
                for pixel in pixels {
                    let (a, b) = (a.mean(pixel as usize), b.mean(pixel as usize));
                    for k in 0..3 {
                        error[k] += ((a[k] - b[k]) / 2.0).powi(2);
                        square[k] += a[k] * b[k];
                    }
                    count += 1.0;
                }
                let relative = |k: usize| error[k] / (square[k].max(0.0) / count + RELATIVE_OFFSET);
                tile.variance += (0..3).map(relative).sum::<f64>() / 3.0;
                tile.pixels += count;
            }
        }
        tile.variance /= tile.pixels;
        tile
    }
}

/// How many samples each tile gets, relative to the image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Efforts {
    /// Tiles across.
    across: u32,
    /// By tile, row by row: the power of two by which its samples are multiplied. Empty where all are alike.
    exponents: Vec<i8>,
}

impl Efforts {
    /// Pixels of a tile across and down: enough that their mean variance is known after a few samples.
    pub const SIDE: u32 = 32;

    /// Pixels across and down that are held against their common radiance: that of one pixel is not known after a few samples.
    const BLOCK: u32 = 8;

    /// From two independent small renders of an image: in all about as many samples as if all tiles were alike.
    pub fn new(a: &Film, b: &Film) -> Self {
        let [across, down] = [a.width(), a.height()].map(|side| side.div_ceil(Self::SIDE));
        let of_tile = |i| Tile::new(a, b, [i % across * Self::SIDE, i / across * Self::SIDE]);
        let tiles: Vec<Tile> = (0..across * down).map(of_tile).collect();
        let exponents = |scale: f64| tiles.iter().map(move |tile| exponent(scale * tile.variance.cbrt()));
        let samples = |scale: f64| -> f64 {
            exponents(scale).zip(&tiles).map(|(exponent, tile)| f64::from(exponent).exp2() * tile.pixels).sum()
        };
        let least = tiles.iter().map(|tile| tile.variance).filter(|&v| v > 0.0).fold(f64::INFINITY, f64::min);
        let all = tiles.iter().map(|tile| tile.pixels).sum::<f64>();
        if !least.is_finite() || tiles.iter().any(|tile| !tile.variance.is_finite()) {
            return Self::default();
        }
        // Between these scales all tiles go from the fewest samples to the most.
        let (mut low, mut high) = (0.0, f64::from(REACH + 1).exp2() / least.cbrt());
        for _ in 0..64 {
            let middle = (low + high) / 2.0;
            if samples(middle) > all { high = middle } else { low = middle }
        }
        Self { across, exponents: exponents(low).collect() }
    }
    /// Whether all tiles are alike.
    pub fn is_even(&self) -> bool {
        self.exponents.is_empty()
    }
    /// Which samples the pixels about (x, y) get where those of the image are `samples`.
    pub fn samples(&self, [x, y]: [u32; 2], samples: &Range<u32>) -> Range<u32> {
        match self.exponents.get((y / Self::SIDE * self.across + x / Self::SIDE) as usize) {
            None => samples.clone(),
            Some(&exponent) => scaled(samples.start, exponent)..scaled(samples.end, exponent),
        }
    }
    /// The most samples that a pixel gets where the image gets `samples`.
    pub fn most(&self, samples: u32) -> u32 {
        self.exponents.iter().max().map_or(samples, |&exponent| scaled(samples, exponent))
    }
}

/// The nearest power of two within reach.
fn exponent(effort: f64) -> i8 {
    effort.log2().round().clamp(f64::from(-REACH), f64::from(REACH)) as i8
}

/// `samples * 2^exponent`, rounded up, so that the first sample of an image is one of each pixel.
fn scaled(samples: u32, exponent: i8) -> u32 {
    let scaled = (u64::from(samples) << REACH << (exponent + REACH)).div_ceil(1 << (2 * REACH));
    scaled.min(u64::from(u32::MAX)) as u32
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    const SIZE: [u32; 2] = [128, 80];

    /// Two renders whose pixels have a radiance of 1 and these relative variances.
    pub fn of([width, height]: [u32; 2], variance: impl Fn(u32, u32) -> f64) -> Efforts {
        let mut films = [Film::new(width, height), Film::new(width, height)];
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            for (film, sign) in films.iter_mut().zip([1.0, -1.0]) {
                film.pixel_mut([x, y]).add([(1.0 + sign * variance(x, y).sqrt()) as f32; 3]);
            }
        }
        Efforts::new(&films[0], &films[1])
    }

    fn all(efforts: &Efforts, samples: u32) -> u64 {
        let of = |i| efforts.samples([i % SIZE[0], i / SIZE[0]], &(0..samples)).len() as u64;
        (0..SIZE[0] * SIZE[1]).map(of).sum()
    }

    #[test]
    fn samples_are_as_a_root_of_the_variance_and_no_more_in_all() {
        // Left half, right half: 64 times the variance.
        let efforts = of(SIZE, |x, _| if x < 64 { 0.001 } else { 0.064 });
        let at = |x| efforts.samples([x, 40], &(0..64)).end;
        assert_eq!(at(70), 4 * at(10), "{efforts:?}");
        let even = 64 * u64::from(SIZE[0] * SIZE[1]);
        assert!(all(&efforts, 64) <= even && all(&efforts, 64) > even / 2, "{}", all(&efforts, 64));
        // All sorts, from 10^-12 to 1: as many as there may be, but for the step of the tiles of one variance.
        let efforts = of(SIZE, |x, y| 100f64.powi(-(((x / 32 + 5 * (y / 32)) * 7 % 13 / 2) as i32)));
        let whole = all(&efforts, 64);
        assert!(whole <= even && whole > even / 2, "{whole} of {even}");
    }

    #[test]
    fn without_error_or_with_it_everywhere_all_tiles_are_alike() {
        assert!(of(SIZE, |_, _| 0.0).is_even());
        let same = of(SIZE, |_, _| 0.3);
        assert_eq!(same.samples([0, 0], &(3..9)), 3..9);
        assert_eq!(Efforts::default().samples([900, 900], &(3..9)), 3..9);
    }

    #[test]
    fn every_pixel_gets_a_first_sample_and_ranges_join() {
        let efforts = of(SIZE, |x, _| if x < 32 { 0.0 } else { 0.5 });
        assert_eq!(efforts.samples([0, 0], &(0..1)), 0..1);
        let parts = [0..1, 1..2, 2..8, 8..16, 16..33].map(|r| efforts.samples([0, 0], &r));
        assert_eq!(parts, [0..1, 1..1, 1..1, 1..2, 2..5]);
        assert_eq!((scaled(u32::MAX, 3), scaled(u32::MAX, 0), scaled(0, -3)), (u32::MAX, u32::MAX, 0));
    }
}
