//! Do two images differ by more than their noise? Welch's t-test in every pixel and channel, and of them all together.
//!
//! Pixels must be independent of each other, and the images too: renders with seeds of their own and a box filter are. The
//! means of a few samples with a skewed distribution are no normal ones: where the skewness of both images does not cancel
//! out, which it does for as many samples of the same method, pixels are to be taken together in squares ([`side_for`]).

use super::errors;
use super::student::{Estimate, Outcome, Sums, chi_squared};
use crate::error::{Error, Result};

/// Chance that images of the same mean are said to differ.
pub const ALPHA: f64 = 1e-3;
/// Bins of the histogram of p-values.
pub const BINS: usize = 20;
/// Families of tests: pixels, means, histograms.
const FAMILIES: usize = 3;
/// Fewer p-values than that give no histogram to judge: five in each bin.
const FEWEST: usize = 5 * BINS;
/// Samples of a square of pixels whose mean is taken for normal.
const MANY: u64 = 1 << 16;

/// An image, and how well it is known.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Linear RGB, row by row from the top left.
    pub pixels: &'a [[f32; 3]],
    /// Variances of the pixels' means; without them the image is taken as exact.
    pub variance: Option<&'a [[f32; 3]]>,
    /// Samples per pixel behind each variance; without them it is taken as that of a normal distribution.
    pub samples: Option<u64>,
}

impl Measured<'_> {
    fn estimate(&self, pixel: usize, channel: usize) -> Estimate {
        Estimate {
            mean: f64::from(self.pixels[pixel][channel]),
            variance: self.variance.map_or(0.0, |variance| f64::from(variance[pixel][channel])),
            freedom: self.samples.map_or(f64::INFINITY, |samples| samples.saturating_sub(1).max(1) as f64),
        }
    }
}

/// What the tests say of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// Squares of pixels tested.
    pub tests: usize,
    /// p-value of the means over all their pixels being equal; 1 where there are none.
    pub mean: f64,
    /// p-value of the squares' p-values being uniform: chi-squared over 20 bins. None of fewer than 100.
    pub uniformity: Option<f64>,
    /// How many p-values fall into each of 20 equal bins, the smallest first.
    pub histogram: [usize; BINS],
}

/// What the tests say of two images.
#[derive(Clone, Debug, PartialEq)]
pub struct Welch {
    /// Pixels across and down the squares that were tested: 1 for single pixels.
    pub side: usize,
    /// Red, green, blue.
    pub channels: [Channel; 3],
    /// Pixels and channels without variance in either image, and of one value: not tested.
    pub exact: usize,
    /// Pixels and channels without variance in either image, and of two values: they differ, unless few samples may have missed
    /// one of the two, as they do along an edge.
    pub unequal: usize,
    /// Pixels and channels whose value or variance is not finite in either image: not tested.
    pub unknown: usize,
    /// Level of each test of a square and channel: [`ALPHA`] by Sidak's correction, over three families of tests and then over
    /// the tests of this one.
    pub level: f64,
    /// Squares with a channel, or a pixel of `unequal`, below that level.
    pub rejected: usize,
    /// The smallest p-value of a square, and its top left pixel; none where nothing was tested.
    pub smallest: Option<(f64, [usize; 2])>,
}

impl Welch {
    /// Tests of squares and channels.
    #[must_use]
    pub fn tests(&self) -> usize {
        self.channels.iter().map(|channel| channel.tests).sum()
    }

    /// All channels' histograms in one.
    #[must_use]
    pub fn histogram(&self) -> [usize; BINS] {
        std::array::from_fn(|bin| self.channels.iter().map(|channel| channel.histogram[bin]).sum())
    }

    /// Level of the tests of means and of histograms, three each.
    #[must_use]
    pub fn channel_level(&self) -> f64 {
        sidak(sidak(ALPHA, FAMILIES), 3)
    }

    /// Whether anything was tested or found exact.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.tests() + self.exact + self.unequal > 0
    }

    /// Whether the p-values are small more often than chance would have it: not uniform, and more than a twentieth of
    /// them in the first bin. That there are fewer small ones, as in pixels with heavy tails or in images that depend on each
    /// other, says nothing against equal means.
    #[must_use]
    pub fn too_many_small(&self) -> [bool; 3] {
        let level = self.channel_level();
        self.channels
            .map(|channel| channel.uniformity.is_some_and(|p| p < level) && channel.histogram[0] * BINS > channel.tests)
    }

    /// Whether the images differ, at the significance [`ALPHA`]: any square, the mean of a channel, or too many small p-values.
    #[must_use]
    pub fn differ(&self) -> bool {
        let means = self.channels.iter().any(|channel| channel.mean < self.channel_level());
        self.rejected > 0 || means || self.too_many_small().contains(&true)
    }
}

/// Pixels across and down the squares to take together where both images do not have as many samples of the same method: a
/// power of two, so that each square has 65536 samples in either image. Without a number of samples, 1.
#[must_use]
pub fn side_for(samples: [Option<u64>; 2]) -> usize {
    let fewest = samples.into_iter().flatten().min().unwrap_or(MANY).max(1);
    let sides = (0..).map(|power| 1_u64 << power);
    sides.take(16).find(|side| side * side * fewest.min(MANY) >= MANY).unwrap_or(1) as usize
}

/// Tests whether two images of `width` pixels across have the same mean in every square of `side` pixels and channel: Welch's
/// t-test (1947) with the degrees of freedom of Satterthwaite (1946).
///
/// # Errors
/// [`Error::Images`] if the numbers of pixels or variances differ, or are 0, or are no whole number of rows;
/// [`Error::Setting`] if `side` is 0.
pub fn welch(image: Measured<'_>, reference: Measured<'_>, width: usize, side: usize) -> Result<Welch> {
    errors::check(image.pixels, reference.pixels)?;
    errors::check_rows(image.pixels, width)?;
    for side in [image, reference] {
        if let Some(found) = side.variance.map(<[_]>::len).filter(|&found| found != side.pixels.len()) {
            let expected = format!("one for each of {} pixels", side.pixels.len());
            return Err(Error::Images { found: format!("{found} variances"), expected });
        }
    }
    if side == 0 {
        return Err(Error::Setting { setting: "--block", found: "0".to_owned(), expected: "at least 1".to_owned() });
    }
    let height = image.pixels.len() / width;
    let mut whole = [(Sums::default(), [0; BINS]); 3];
    let mut found = Welch::new(side);
    let mut chances = Vec::new();
    for (top, left) in (0..height).step_by(side).flat_map(|y| (0..width).step_by(side).map(move |x| (y, x))) {
        let mut smallest = f64::INFINITY;
        for (k, (all, histogram)) in whole.iter_mut().enumerate() {
            let mut sums = Sums::default();
            for y in top..height.min(top + side) {
                for i in (left..width.min(left + side)).map(|x| y * width + x) {
                    match image.estimate(i, k).compare(&reference.estimate(i, k)) {
                        Outcome::Unknown => found.unknown += 1,
                        Outcome::Equal => found.exact += 1,
                        Outcome::Unequal(p) => {
                            found.unequal += 1;
                            smallest = smallest.min(p);
                        }
                        Outcome::Noisy(pixel) => sums.merge(&pixel),
                    }
                }
            }
            if sums.pixels > 0 {
                let p = sums.chance();
                histogram[((p * BINS as f64) as usize).min(BINS - 1)] += 1;
                all.merge(&sums);
                smallest = smallest.min(p);
            }
        }
        if smallest.is_finite() {
            chances.push((smallest, [left, top]));
        }
    }
    found.channels = whole.map(|(sums, histogram)| Channel::new(&sums, histogram));
    found.level = sidak(sidak(ALPHA, FAMILIES), found.tests());
    found.rejected = chances.iter().filter(|chance| chance.0 < found.level).count();
    found.smallest = chances.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(found)
}

/// Level of each of `tests` tests, so that the chance of any false alarm is `alpha` (Sidak 1967).
#[must_use]
pub fn sidak(alpha: f64, tests: usize) -> f64 {
    -f64::exp_m1(f64::ln_1p(-alpha) / tests.max(1) as f64)
}

impl Welch {
    fn new(side: usize) -> Self {
        let channels = [Channel::new(&Sums::default(), [0; BINS]); 3];
        Self { side, channels, exact: 0, unequal: 0, unknown: 0, level: ALPHA, rejected: 0, smallest: None }
    }
}

impl Channel {
    fn new(sums: &Sums, histogram: [usize; BINS]) -> Self {
        let tests: usize = histogram.iter().sum();
        let mean = if tests == 0 { 1.0 } else { sums.chance() };
        let uniformity = if tests < FEWEST { None } else { chi_squared(&histogram) };
        Self { tests, mean, uniformity, histogram }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::function::erf::erfc;

    /// SplitMix64 (Steele, Lea and Flood 2014), and two normal numbers of it by Box and Muller (1958).
    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        }
        fn normal(&mut self) -> f64 {
            let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
            radius * (std::f64::consts::TAU * self.unit()).cos()
        }
        /// Means and their variances of `samples` normal numbers for each pixel and channel, with mean and deviation.
        fn image(
            &mut self,
            pixels: usize,
            samples: usize,
            mean: f64,
            deviation: f64,
        ) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
            let mut one = || {
                let values: Vec<f64> = (0..samples).map(|_| mean + deviation * self.normal()).collect();
                let n = samples as f64;
                let mean = values.iter().sum::<f64>() / n;
                let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n;
                (mean as f32, variance as f32)
            };
            let both: Vec<[(f32, f32); 3]> = (0..pixels).map(|_| [one(), one(), one()]).collect();
            both.iter().map(|p| (p.map(|c| c.0), p.map(|c| c.1))).unzip()
        }
    }

    fn measured<'a>(image: &'a (Vec<[f32; 3]>, Vec<[f32; 3]>), samples: usize) -> Measured<'a> {
        Measured { pixels: &image.0, variance: Some(&image.1), samples: Some(samples as u64) }
    }

    fn one(a: (f32, f32, Option<u64>), b: (f32, f32, Option<u64>)) -> Welch {
        let (pixels, variances) = ([[a.0; 3]], [[a.1; 3]]);
        let (others, other_variances) = ([[b.0; 3]], [[b.1; 3]]);
        let image = Measured { pixels: &pixels, variance: Some(&variances), samples: a.2 };
        welch(image, Measured { pixels: &others, variance: Some(&other_variances), samples: b.2 }, 1, 1).unwrap()
    }

    #[test]
    fn p_values_are_those_of_tables() {
        let near = |found: Welch, expected: f64| {
            let p = found.smallest.unwrap().0;
            assert!((p / expected - 1.0).abs() < 2e-4, "found {p}, expected {expected}");
        };
        // Quantiles as printed in tables: of Student's distribution, and of the normal one.
        for (t, freedom, expected) in [
            (2.228_139, 10, 0.05),
            (3.169_273, 10, 0.01),
            (2.085_963, 20, 0.05),
            (3.849_516, 20, 0.001),
            (12.706_205, 1, 0.05),
        ] {
            near(one((1.0 + t, 1.0, Some(freedom + 1)), (1.0, 0.0, None)), expected);
        }
        near(one((2.959_964, 1.0, None), (1.0, 0.0, None)), 0.05);
        near(one((1.0, 0.25, None), (4.290_527, 0.75, None)), 0.001);
        // Equal variances of 6 samples each have 10 degrees of freedom; 1 and 3 have (1 + 3)^2 / (1 / 5 + 9 / 5) = 8.
        near(one((3.228_139, 0.5, Some(6)), (1.0, 0.5, Some(6))), 0.05);
        near(one((1.0 + 2.0 * 2.306_004, 1.0, Some(6)), (1.0, 3.0, Some(6))), 0.05);
    }

    #[test]
    fn the_level_is_that_of_sidak() {
        assert!((sidak(0.05, 1) - 0.05).abs() < 1e-15);
        assert!((1.0 - (1.0 - sidak(1e-3, 1000)).powi(1000) - 1e-3).abs() < 1e-12);
        assert!(sidak(1e-3, 0) == sidak(1e-3, 1));
        let found = one((1.0, 1.0, None), (1.0, 1.0, None));
        assert!((found.level - sidak(1e-3, 9)).abs() < 1e-12 && (found.channel_level() - sidak(1e-3, 9)).abs() < 1e-12);
    }

    #[test]
    fn without_variance_values_are_equal_or_not() {
        let found = one((1.0, 0.0, None), (1.0 + f32::EPSILON, 0.0, None));
        assert_eq!((found.exact, found.unequal, found.tests(), found.smallest), (3, 0, 0, None));
        assert!(!found.differ());
        let found = one((1.0, 0.0, None), (1.0 + 4.0 * f32::EPSILON, 0.0, None));
        assert_eq!((found.exact, found.unequal, found.rejected, found.smallest), (0, 3, 1, Some((0.0, [0, 0]))));
        assert!(found.differ());
        // Few samples may have missed one of two values: 16 and 16 are 2 / 4^16, 2 and 4 are 2 (2/6)^2 (4/6)^4.
        let found = one((1.0, 0.0, Some(16)), (0.0, 0.0, Some(16)));
        assert!(found.differ() && (found.smallest.unwrap().0 * 4_f64.powi(16) - 2.0).abs() < 1e-9);
        let found = one((1.0, 0.0, Some(2)), (0.0, 0.0, Some(4)));
        assert!(!found.differ() && (found.smallest.unwrap().0 - 32.0 / 729.0).abs() < 1e-12);
        let found = welch(
            Measured { pixels: &[[0.5; 3]], variance: None, samples: None },
            Measured { pixels: &[[0.5; 3]], variance: None, samples: None },
            1,
            1,
        );
        assert_eq!(found.unwrap().exact, 3);
    }

    #[test]
    fn what_is_not_finite_is_not_tested() {
        for (mean, variance) in
            [(f32::NAN, 1.0), (f32::INFINITY, 1.0), (1.0, f32::INFINITY), (1.0, f32::NAN), (1.0, -1.0)]
        {
            for found in [one((mean, variance, None), (1.0, 1.0, None)), one((1.0, 1.0, None), (mean, variance, None))]
            {
                assert_eq!((found.unknown, found.tests(), found.differ()), (3, 0, false), "{mean} {variance}");
            }
        }
        // The largest numbers and the smallest.
        for (mean, variance) in [(f32::MAX, f32::MAX), (f32::MAX, f32::from_bits(1)), (0.0, f32::from_bits(1))] {
            for samples in [None, Some(0), Some(2), Some(u64::MAX)] {
                let found = one((mean, variance, samples), (-mean, variance, samples));
                assert!(found.smallest.is_some_and(|(p, _)| (0.0..=1.0).contains(&p)), "{mean} {variance} {found:?}");
            }
        }
    }

    #[test]
    fn sizes_must_agree() {
        let bare = |pixels| Measured { pixels, variance: None, samples: None };
        assert!(welch(bare(&[[0.0; 3]; 2]), bare(&[[0.0; 3]; 3]), 1, 1).is_err());
        assert!(welch(bare(&[[0.0; 3]; 3]), bare(&[[0.0; 3]; 3]), 2, 1).is_err());
        assert!(welch(bare(&[[0.0; 3]; 3]), bare(&[[0.0; 3]; 3]), 3, 0).is_err());
        let uneven = Measured { variance: Some(&[[0.0; 3]; 1]), ..bare(&[[0.0; 3]; 2]) };
        let error = welch(bare(&[[0.0; 3]; 2]), uneven, 1, 1).unwrap_err().to_string();
        assert_eq!(error, "images: found 1 variances, expected one for each of 2 pixels");
    }

    #[test]
    fn squares_are_made_of_pixels() {
        let sides = [1, 4, 16, 512, 65_535, 65_536, u64::MAX].map(|n| side_for([Some(n), None]));
        assert_eq!(sides, [256, 128, 64, 16, 2, 1, 1]);
        assert_eq!((side_for([None, None]), side_for([Some(0), Some(5)])), (1, 256));
        // 5 x 3 pixels in squares of 2: the edge has what is left. Differences of 1 and of -1 cancel out.
        let pixels: Vec<[f32; 3]> = (0..15).map(|i| [if i % 5 % 2 == 0 { 2.0 } else { 0.0 }, 1.0, 1.5]).collect();
        let (ones, variance) = ([[1.0; 3]; 15], [[0.25; 3]; 15]);
        let image = Measured { pixels: &pixels, variance: Some(&variance), samples: None };
        let reference = Measured { pixels: &ones, variance: None, samples: None };
        let found = welch(image, reference, 5, 2).unwrap();
        assert_eq!((found.side, found.channels.map(|c| c.tests)), (2, [6; 3]));
        // Red: four whole squares without a difference, two columns of 2 and of 1 pixels that are 1 and 2 standard errors off.
        let p = |z: f64| erfc(z / std::f64::consts::SQRT_2);
        let bin = |p: f64| (p * BINS as f64) as usize;
        let red = found.channels[0].histogram;
        assert_eq!((red[BINS - 1], red[bin(p(2.0 * 2.0_f64.sqrt()))], red[bin(p(2.0))]), (4, 2, 2));
        // Blue: 0.5 off everywhere, which is one standard error of a pixel and two of a square.
        assert!((found.channels[2].mean - p(15.0_f64.sqrt())).abs() < 1e-6);
        // Of the squares, green alone is right.
        assert!((found.smallest.unwrap().0 - p(2.0 * 2.0_f64.sqrt())).abs() < 1e-6 && found.channels[1].mean == 1.0);
        assert_eq!(found.smallest.unwrap().1, [4, 0]);
    }

    /// 300 pairs of images of one mean, 4 to 64 samples a pixel: at 10^-3, 0.3 false alarms are expected, and more than 4 come
    /// with a probability below 10^-4. p-values are uniform.
    #[test]
    fn equal_means_agree() {
        let mut random = Random(5);
        let mut alarms = 0;
        let mut histogram = [0; BINS];
        for round in 0..300 {
            let samples = [4, 16, 64][round % 3];
            let (a, b) = (random.image(60, samples, 1.0, 0.3), random.image(60, 2 * samples, 1.0, 0.6));
            let found = welch(measured(&a, samples), measured(&b, 2 * samples), 10, 1 + round % 2).unwrap();
            alarms += usize::from(found.differ());
            histogram.iter_mut().zip(found.histogram()).for_each(|(sum, bin)| *sum += bin);
        }
        assert!(alarms <= 4, "{alarms} false alarms");
        // 60 pixels, or 15 squares of 2 x 2, in three channels.
        let expected = 150.0 * (180.0 + 45.0) / BINS as f64;
        let chi2: f64 = histogram.iter().map(|&n| (n as f64 - expected).powi(2) / expected).sum();
        // The 10^-4 quantile of chi-squared with 19 degrees of freedom is 50.8.
        assert!(chi2 < 50.8, "chi-squared {chi2}: {histogram:?}");
    }

    /// Faults that are put in are found: a bias that only all pixels show together, one pixel that is off, noise that is
    /// more than it says.
    #[test]
    fn faults_are_found() {
        let mut random = Random(6);
        let a = random.image(4000, 16, 1.0, 0.5);
        let sound = random.image(4000, 16, 1.0, 0.5);
        let test = |b: &(Vec<[f32; 3]>, Vec<[f32; 3]>)| welch(measured(&a, 16), measured(b, 16), 80, 1).unwrap();
        assert!(!test(&sound).differ());
        // The standard error of the difference of means is 0.5 / sqrt(16 * 4000) * sqrt(2) = 0.28 %.
        let mut bright = sound.clone();
        bright.0.iter_mut().for_each(|pixel| *pixel = pixel.map(|c| 1.02 * c));
        let found = test(&bright);
        assert!(found.differ() && found.rejected == 0 && found.channels.iter().all(|c| c.mean < found.channel_level()));
        let mut spot = sound.clone();
        spot.0[1234][1] += 5.0;
        let found = test(&spot);
        assert!(found.differ() && found.rejected == 1 && found.smallest.unwrap().1 == [1234 % 80, 1234 / 80]);
        let mut sure = sound.clone();
        sure.1.iter_mut().for_each(|variance| *variance = variance.map(|v| 0.5 * v));
        let found = test(&sure);
        assert!(found.differ() && found.too_many_small() == [true; 3]);
        // Less noise than stated is no difference, however little the p-values are uniform.
        let mut unsure = sound.clone();
        unsure.1.iter_mut().for_each(|variance| *variance = variance.map(|v| 8.0 * v));
        let found = test(&unsure);
        assert!(!found.differ() && found.channels[0].uniformity.unwrap() < 1e-6);
        let found = test(&a);
        assert!(!found.differ() && found.histogram()[BINS - 1] == 12_000);
    }
}
