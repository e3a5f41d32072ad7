//! The film: per pixel the sum of its samples, the sum of their squares and their count, in f64.

mod picture;

pub use picture::Image;

/// A sample that was not a number or infinite: counted, kept out of the image, and named so that it can be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct BadSample {
    /// Pixel across and down.
    pub pixel: [u32; 2],
    /// Number of the sample.
    pub sample: u32,
}

/// Sums of some pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Sum of the samples, linear RGB.
    pub sum: [f64; 3],
    /// Sum of their squares.
    pub sum2: [f64; 3],
    /// Number of samples.
    pub count: u64,
}

impl Pixel {
    /// Adds a sample; false if it is not finite, and then nothing is added.
    pub fn add(&mut self, sample: [f32; 3]) -> bool {
        let good = sample.iter().all(|c| c.is_finite());
        if good {
            for (k, &c) in sample.iter().enumerate() {
                self.sum[k] += f64::from(c);
                self.sum2[k] += f64::from(c) * f64::from(c);
            }
            self.count += 1;
        }
        good
    }
    /// Adds another's sums.
    pub fn merge(&mut self, other: &Self) {
        for k in 0..3 {
            self.sum[k] += other.sum[k];
            self.sum2[k] += other.sum2[k];
        }
        self.count += other.count;
    }
    /// Mean of the samples; black without any.
    pub fn mean(&self) -> [f64; 3] {
        self.sum.map(|s| if self.count == 0 { 0.0 } else { s / self.count as f64 })
    }
    /// Variance of the mean, from the spread of the samples; infinite below two. Of independent samples only.
    pub fn variance_of_mean(&self) -> [f64; 3] {
        let n = self.count as f64;
        std::array::from_fn(|k| {
            if self.count < 2 {
                return f64::INFINITY;
            }
            ((self.sum2[k] - self.sum[k] * self.sum[k] / n) / (n - 1.0) / n).max(0.0)
        })
    }
}

/// An image in the making.
///
/// What light paths bring lies beside the samples of the pixels: its sums are over light paths, which are common to all.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<Pixel>,
    /// Sums over light paths, with their number; no pixels where there are none.
    splats: Vec<Pixel>,
    light_paths: u64,
}

impl Film {
    /// A film without samples.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = vec![Pixel::default(); width as usize * height as usize];
        Self { width, height, pixels, splats: Vec::new(), light_paths: 0 }
    }
    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }
    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }
    /// All pixels, row by row from the top left.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }
    /// The sums of a pixel.
    pub fn pixel_mut(&mut self, [x, y]: [u32; 2]) -> &mut Pixel {
        &mut self.pixels[y as usize * self.width as usize + x as usize]
    }
    /// Adds what one light path brought to a pixel; false if it is not finite, and then nothing is added.
    pub fn splat(&mut self, [x, y]: [u32; 2], radiance: [f32; 3]) -> bool {
        if self.splats.is_empty() {
            self.splats.resize(self.pixels.len(), Pixel::default());
        }
        self.splats[y as usize * self.width as usize + x as usize].add(radiance)
    }
    /// Counts light paths, whatever they brought.
    pub fn count_light_paths(&mut self, count: u64) {
        self.light_paths += count;
    }
    /// Estimate of a pixel, by its index: the mean of its samples and what light paths add.
    pub fn mean(&self, pixel: usize) -> [f64; 3] {
        let mean = self.pixels[pixel].mean();
        let Some(light) = self.splats.get(pixel).filter(|_| self.light_paths > 0) else { return mean };
        std::array::from_fn(|k| mean[k] + light.sum[k] / self.light_paths as f64)
    }
    /// Variance of [`Self::mean`], from the spread of the samples and of what light paths brought; infinite below two
    /// samples. Of independent samples only.
    pub fn variance(&self, pixel: usize) -> [f64; 3] {
        let variance = self.pixels[pixel].variance_of_mean();
        let Some(light) = self.splats.get(pixel).filter(|_| self.light_paths > 1) else { return variance };
        let all = Pixel { count: self.light_paths, ..*light }.variance_of_mean();
        std::array::from_fn(|k| variance[k] + all[k])
    }
    /// The estimates as an image in linear RGB.
    pub fn image(&self) -> Image {
        let pixels = (0..self.pixels.len()).map(|i| self.mean(i).map(|c| c as f32)).collect();
        Image { width: self.width, height: self.height, pixels }
    }
    /// Variances of the estimates, in the order of the image's pixels; see [`Self::variance`].
    pub fn variances(&self) -> Vec<[f32; 3]> {
        (0..self.pixels.len()).map(|i| self.variance(i).map(|c| c as f32)).collect()
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        (self.pixels.len() + self.splats.len()) * size_of::<Pixel>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_variances_are_those_of_the_samples_and_bad_ones_stay_out() {
        let mut p = Pixel::default();
        for v in [1.0, 2.0, 4.0] {
            assert!(p.add([v, 0.5, 0.0]));
        }
        assert!(!p.add([1.0, f32::NAN, 0.0]) && !p.add([f32::INFINITY, 0.0, 0.0]));
        assert_eq!((p.count, p.mean()), (3, [7.0 / 3.0, 0.5, 0.0]));
        // Sample variance of 1, 2, 4 is 7/3; of the mean a third of it.
        assert!((p.variance_of_mean()[0] - 7.0 / 9.0).abs() < 1e-12);
        let mut q = Pixel::default();
        q.merge(&p);
        assert_eq!(q, p);
    }
}
