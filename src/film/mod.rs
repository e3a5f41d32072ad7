//! The film: per pixel the sum of its samples, the sum of their squares and their count, in f64.

mod picture;

pub use picture::Image;

/// Added to the squared reference where an error is divided by it, so that black pixels do not decide. The measure, relMSE,
/// is that of Rousselle, Knaus and Zwicker (2011); the constant differs between papers, and figures of another are others.
pub const RELATIVE_OFFSET: f64 = 0.01;

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
    /// Sums whose mean is the mean of both means, whatever the numbers of samples are.
    #[must_use]
    pub fn average(&self, other: &Self) -> Self {
        let mut all = *self;
        all.merge(other);
        if self.count == other.count || self.count == 0 || other.count == 0 {
            return all;
        }
        let (means, variances) = ([self.mean(), other.mean()], [self.variance_of_mean(), other.variance_of_mean()]);
        let n = all.count as f64;
        for k in 0..3 {
            let variance = (variances[0][k] + variances[1][k]) / 4.0;
            all.sum[k] = n * (means[0][k] + means[1][k]) / 2.0;
            all.sum2[k] = all.sum[k] * all.sum[k] / n + variance * n * (n - 1.0);
        }
        all
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
    /// Adds another film's sums.
    pub fn merge(&mut self, other: &Self) {
        self.combine(other, |a, b| a.merge(b));
    }
    /// Makes the estimates the means of this film's and another's, whatever the numbers of samples are.
    pub fn average(&mut self, other: &Self) {
        let mut other = other.clone();
        self.spread_splats();
        other.spread_splats();
        self.combine(&other, |a, b| *a = a.average(b));
    }
    /// Makes what light paths brought to a pixel sums over all light paths, of which most brought nothing.
    fn spread_splats(&mut self) {
        self.splats.resize(if self.light_paths > 0 { self.pixels.len() } else { 0 }, Pixel::default());
        self.splats.iter_mut().for_each(|splat| splat.count = self.light_paths);
    }
    fn combine(&mut self, other: &Self, f: impl Fn(&mut Pixel, &Pixel)) {
        self.splats.resize(self.splats.len().max(other.splats.len()), Pixel::default());
        self.pixels.iter_mut().zip(&other.pixels).for_each(|(a, b)| f(a, b));
        self.splats.iter_mut().zip(&other.splats).for_each(|(a, b)| f(a, b));
        self.light_paths += other.light_paths;
    }
    /// relMSE of the mean of two independent films of as many samples each: the mean over pixels and channels of ((a - b) /
    /// 2)^2 / (R^2 + 0.01), for their estimates a and b. ((a - b) / 2)^2 is unbiased for the variance of the mean, and so is
    /// a b for R^2, which noise would only raise otherwise; where it is negative it counts as 0.
    pub fn rel_mse_of_mean(&self, other: &Self) -> f64 {
        self.rel_mse_by(other, |_, [a, b]| (a * b).max(0.0) + RELATIVE_OFFSET)
    }
    /// The same, relative to the mean m of two further films. A bright pixel raises a b together with (a - b)^2, which
    /// makes their ratio too small; it leaves the other films alone. 1 / (m^2 + 0.01) is on average too large by m's variance
    /// times half its second derivative, which is taken off.
    pub fn rel_mse_of_mean_to(&self, other: &Self, [c, d]: [&Self; 2]) -> f64 {
        self.rel_mse_by(other, |[pixel, k], _| {
            let (c, d) = (c.mean(pixel)[k], d.mean(pixel)[k]);
            let (square, variance) = (((c + d) / 2.0).powi(2), ((c - d) / 2.0).powi(2));
            let plain = square + RELATIVE_OFFSET;
            plain + variance * (3.0 * square - RELATIVE_OFFSET) / plain
        })
    }
    fn rel_mse_by(&self, other: &Self, divisor: impl Fn([usize; 2], [f64; 2]) -> f64) -> f64 {
        let pixels = 0..self.pixels.len();
        let sum: f64 = pixels
            .map(|i| {
                let (a, b) = (self.mean(i), other.mean(i));
                let of = |k: usize| ((a[k] - b[k]) / 2.0).powi(2) / divisor([i, k], [a[k], b[k]]);
                of(0) + of(1) + of(2)
            })
            .sum();
        sum / (3 * self.pixels.len()) as f64
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
