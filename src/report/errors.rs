//! Errors of an image against a reference, in linear radiance: relMSE, MSE, PSNR, means.
//!
//! Each figure comes twice: over all pixels, and without the worst 0.1 % of them. Where the two differ much, a few pixels
//! decide, as they do in images with caustics, and more samples may make the figure of all pixels worse.

use crate::error::{Error, Result};
pub use crate::film::RELATIVE_OFFSET;

/// Of so many pixels the worst one is left out of trimmed figures.
pub const TRIM: usize = 1000;

/// Luminance of linear RGB with Rec. 709 primaries.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// One figure, with and without the worst pixels. NaN where there is no pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figure {
    /// Of all pixels that are finite in both images.
    pub raw: f64,
    /// Without the worst `floor(n / 1000)` of these n pixels: none of fewer than 1000.
    pub trimmed: f64,
}

impl Figure {
    /// The same function of both numbers.
    #[must_use]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self { raw: f(self.raw), trimmed: f(self.trimmed) }
    }
}

/// Pixels that are no colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flaws {
    /// Pixels with a component that is not a number.
    pub nan: usize,
    /// Other pixels with a component that is infinite.
    pub infinite: usize,
}

impl Flaws {
    /// Counts them in an image.
    #[must_use]
    pub fn of(pixels: &[[f32; 3]]) -> Self {
        let mut flaws = Self::default();
        for pixel in pixels {
            if pixel.iter().any(|c| c.is_nan()) {
                flaws.nan += 1;
            } else if pixel.iter().any(|c| c.is_infinite()) {
                flaws.infinite += 1;
            }
        }
        flaws
    }
}

/// Mean radiance of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Means {
    /// Per channel: red, green, blue. Trimmed figures leave out the pixels that MSE leaves out.
    pub rgb: [Figure; 3],
    /// Luminance: 0.2126 R + 0.7152 G + 0.0722 B.
    pub luminance: Figure,
}

/// How far an image is from a reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Pixels that are finite in both images; all figures are theirs.
    pub pixels: usize,
    /// How many of them trimmed figures leave out.
    pub trimmed: usize,
    /// Pixels without a colour, in the image and in the reference.
    pub flaws: [Flaws; 2],
    /// Mean over pixels and channels of (A - B)^2 / (B^2 + 0.01).
    pub rel_mse: Figure,
    /// Mean over pixels and channels of (A - B)^2.
    pub mse: Figure,
    /// -10 log10(MSE), in decibels: the peak is 1, which 8-bit images show as white. Infinite where MSE is 0.
    pub psnr: Figure,
    /// Of the image and of the reference.
    pub means: [Means; 2],
}

/// Compares an image with a reference.
///
/// # Errors
/// [`Error::Images`] if the numbers of pixels differ, or are 0.
pub fn errors(image: &[[f32; 3]], reference: &[[f32; 3]]) -> Result<Errors> {
    check(image, reference)?;
    let pairs = finite([image, reference]);
    let square: Vec<f64> = pairs.iter().map(|&[a, b]| squared_error(a, b)).collect();
    let worst_square = worst(&square);
    let relative: Vec<f64> = pairs.iter().map(|&[a, b]| relative_squared_error(a, b)).collect();
    let mse = mean(square.iter().copied(), &worst_square);
    let means = [0, 1].map(|which| {
        let channel = |k: usize| mean(pairs.iter().map(|pair| f64::from(pair[which][k])), &worst_square);
        let rgb = [channel(0), channel(1), channel(2)];
        let luminance = |of: fn(&Figure) -> f64| LUMINANCE.iter().zip(&rgb).map(|(w, c)| w * of(c)).sum();
        Means { rgb, luminance: Figure { raw: luminance(|c| c.raw), trimmed: luminance(|c| c.trimmed) } }
    });
    Ok(Errors {
        pixels: pairs.len(),
        trimmed: pairs.len() / TRIM,
        flaws: [Flaws::of(image), Flaws::of(reference)],
        rel_mse: mean(relative.iter().copied(), &worst(&relative)),
        mse,
        psnr: mse.map(|mse| -10.0 * mse.log10()),
        means,
    })
}

/// relMSE of an image against the mean of two independent halves of a reference, less what the reference's own noise adds
/// to it: the mean over pixels and channels of ((a - b) / 2)^2 / (R^2 + 0.01), with halves a and b of as many samples
/// each, and R their mean. ((a - b) / 2)^2 is an unbiased estimate of R's variance from two halves.
///
/// The trimmed figure leaves out the pixels that are worst before the correction. By chance the result can be negative.
///
/// # Errors
/// [`Error::Images`] if the numbers of pixels differ, or are 0.
pub fn rel_mse_of_noisy_reference(image: &[[f32; 3]], halves: [&[[f32; 3]]; 2]) -> Result<Figure> {
    check(image, halves[0])?;
    check(image, halves[1])?;
    Ok(less_noise(finite([image, halves[0], halves[1]]).into_iter().map(|[pixel, a, b]| {
        let [pixel, a, b] = [pixel, a, b].map(|pixel| pixel.map(f64::from));
        let reference = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        (pixel, reference, std::array::from_fn(|k| (0.5 * (a[k] - b[k])).powi(2)))
    })))
}

/// The same against a reference whose pixels' means have known variances.
///
/// # Errors
/// [`Error::Images`] if the numbers of pixels or variances differ, or are 0.
pub fn rel_mse_less_variance(image: &[[f32; 3]], reference: &[[f32; 3]], variance: &[[f32; 3]]) -> Result<Figure> {
    check(image, reference)?;
    check(image, variance)?;
    let all = finite([image, reference, variance]).into_iter().map(|all| all.map(|pixel| pixel.map(f64::from)));
    Ok(less_noise(all.map(|[pixel, reference, variance]| (pixel, reference, variance))))
}

/// Of pixels, their references, and the variances of these.
fn less_noise(pixels: impl Iterator<Item = ([f64; 3], [f64; 3], [f64; 3])>) -> Figure {
    let (mut relative, mut corrected) = (Vec::new(), Vec::new());
    for (pixel, reference, variance) in pixels {
        let over = |k: usize, square: f64| square / (reference[k] * reference[k] + RELATIVE_OFFSET);
        let error = mean_over_channels(|k| over(k, (pixel[k] - reference[k]).powi(2)));
        relative.push(error);
        corrected.push(error - mean_over_channels(|k| over(k, variance[k])));
    }
    mean(corrected.into_iter(), &worst(&relative))
}

/// Mean over the channels of (a - b)^2.
#[must_use]
pub fn squared_error(a: [f32; 3], b: [f32; 3]) -> f64 {
    mean_over_channels(|k| (f64::from(a[k]) - f64::from(b[k])).powi(2))
}

/// Mean over the channels of (a - b)^2 / (b^2 + 0.01).
#[must_use]
pub fn relative_squared_error(a: [f32; 3], b: [f32; 3]) -> f64 {
    mean_over_channels(|k| (f64::from(a[k]) - f64::from(b[k])).powi(2) / (f64::from(b[k]).powi(2) + RELATIVE_OFFSET))
}

fn mean_over_channels(value: impl Fn(usize) -> f64) -> f64 {
    (value(0) + value(1) + value(2)) / 3.0
}

/// Images that are compared have equally many pixels, and some.
pub(super) fn check(image: &[[f32; 3]], reference: &[[f32; 3]]) -> Result<()> {
    if image.len() == reference.len() && !image.is_empty() {
        return Ok(());
    }
    let found = format!("{} and {} pixels", image.len(), reference.len());
    Err(Error::Images { found, expected: "as many in both, and at least one".to_owned() })
}

/// An image is whole rows of some pixels.
pub(super) fn check_rows(image: &[[f32; 3]], width: usize) -> Result<()> {
    if width > 0 && image.len().is_multiple_of(width) {
        return Ok(());
    }
    Err(Error::Images { found: format!("{} pixels", image.len()), expected: format!("whole rows of {width}") })
}

/// The pixels that are finite in all images.
fn finite<const N: usize>(images: [&[[f32; 3]]; N]) -> Vec<[[f32; 3]; N]> {
    let pixels = images.iter().map(|image| image.len()).min().unwrap_or(0);
    let all = (0..pixels).map(|i| images.map(|image| image[i]));
    all.filter(|pixels| pixels.as_flattened().iter().all(|c| c.is_finite())).collect()
}

/// Marks the `floor(n / 1000)` largest of n values; of equal ones the first. No value is NaN.
pub(super) fn worst(values: &[f64]) -> Vec<bool> {
    let mut left = values.len() / TRIM;
    let mut marks = vec![false; values.len()];
    if left == 0 {
        return marks;
    }
    let mut sorted = values.to_vec();
    let (larger, &mut least, _) = sorted.select_nth_unstable_by(left - 1, |a, b| b.total_cmp(a));
    left -= larger.iter().filter(|&&value| value > least).count();
    for (mark, &value) in marks.iter_mut().zip(values) {
        let chosen = value > least || (value == least && left > 0);
        left -= usize::from(chosen && value == least);
        *mark = chosen;
    }
    marks
}

/// Mean of all values, and of those that are not marked.
pub(super) fn mean(values: impl Iterator<Item = f64>, worst: &[bool]) -> Figure {
    let (mut sum, mut kept, mut out) = (0.0, 0.0, 0_usize);
    for (value, &worst) in values.zip(worst) {
        sum += value;
        if worst {
            out += 1;
        } else {
            kept += value;
        }
    }
    Figure { raw: sum / worst.len() as f64, trimmed: kept / (worst.len() - out) as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLOSE: f64 = 1e-12;

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() <= CLOSE * expected.abs().max(1.0), "found {found}, expected {expected}");
    }

    #[test]
    fn closed_forms() {
        // Errors of 0.25, 0.5 and 1, all exact in f32.
        let (a, b) = ([[1.25, 0.5, 0.0]; 7], [[1.0, 1.0, 1.0]; 7]);
        let found = errors(&a, &b).unwrap();
        let square = (0.0625 + 0.25 + 1.0) / 3.0;
        near(found.mse.raw, square);
        near(found.rel_mse.raw, square / 1.01);
        near(found.psnr.raw, -10.0 * f64::log10(square));
        near(found.means[0].rgb[0].raw, 1.25);
        near(found.means[0].luminance.raw, 1.25 * 0.2126 + 0.5 * 0.7152);
        near(found.means[1].luminance.raw, 1.0);
        assert_eq!((found.pixels, found.trimmed, found.flaws), (7, 0, [Flaws::default(); 2]));
        assert_eq!(found.mse.raw, found.mse.trimmed);
        // The image is measured by the reference, not the other way round.
        let [forth, back] = [errors(&[[0.0; 3]], &[[1.0; 3]]), errors(&[[1.0; 3]], &[[0.0; 3]])];
        near(forth.unwrap().rel_mse.raw, 1.0 / 1.01);
        near(back.unwrap().rel_mse.raw, 100.0);
    }

    #[test]
    fn an_image_does_not_differ_from_itself() {
        let image: Vec<[f32; 3]> = (0..5000).map(|i| [i as f32, -0.5, 1e30]).collect();
        let found = errors(&image, &image).unwrap();
        assert_eq!((found.mse.raw, found.rel_mse.raw, found.psnr.raw), (0.0, 0.0, f64::INFINITY));
        assert_eq!(found.means[0], found.means[1]);
    }

    #[test]
    fn the_worst_pixels_are_left_out() {
        let reference = vec![[1.0; 3]; 2500];
        let mut image = vec![[1.5; 3]; 2500];
        (image[7], image[2400], image[9]) = ([101.0; 3], [11.0; 3], [3.0; 3]);
        let found = errors(&image, &reference).unwrap();
        assert_eq!(found.trimmed, 2);
        near(found.mse.raw, (1e4 + 1e2 + 4.0 + 2497.0 * 0.25) / 2500.0);
        near(found.mse.trimmed, (4.0 + 2497.0 * 0.25) / 2498.0);
        near(found.rel_mse.trimmed, found.mse.trimmed / 1.01);
        near(found.psnr.trimmed, -10.0 * found.mse.trimmed.log10());
        near(found.means[0].rgb[1].trimmed, (3.0 + 2497.0 * 1.5) / 2498.0);
        near(found.means[1].luminance.trimmed, 1.0);
        // Each figure has its own worst pixels: this one is worst by its relative error alone.
        let (mut image, mut reference) = (vec![[1.0; 3]; 1000], vec![[1.0; 3]; 1000]);
        (image[0], reference[0]) = ([1000.0; 3], [990.0; 3]);
        (image[1], reference[1]) = ([0.5; 3], [0.0; 3]);
        let found = errors(&image, &reference).unwrap();
        near(found.mse.trimmed, 0.25 / 999.0);
        near(found.rel_mse.trimmed, 100.0 / 990.0_f64.powi(2) / (1.0 + 0.01 / 990.0_f64.powi(2)) / 999.0);
    }

    #[test]
    fn equal_errors_are_left_out_by_number() {
        let marks = worst(&[vec![2.0; 1500], vec![3.0; 1], vec![2.0; 1500]].concat());
        let marked: Vec<usize> = (0..marks.len()).filter(|&i| marks[i]).collect();
        assert_eq!(marked, [0, 1, 1500]);
        assert_eq!(worst(&[1.0; 999]), [false; 999]);
    }

    #[test]
    fn what_is_no_colour_is_counted_and_left_out() {
        let mut image = vec![[1.0_f32; 3]; 10];
        let mut reference = vec![[1.0_f32; 3]; 10];
        image[1][2] = f32::NAN;
        image[2] = [f32::INFINITY, f32::NAN, 0.0];
        image[3] = [f32::NEG_INFINITY, 0.0, 0.0];
        reference[3][0] = f32::NAN;
        reference[4][1] = f32::INFINITY;
        image[5] = [2.0; 3];
        let found = errors(&image, &reference).unwrap();
        assert_eq!(found.flaws, [Flaws { nan: 2, infinite: 1 }, Flaws { nan: 1, infinite: 1 }]);
        assert_eq!(found.pixels, 6);
        near(found.mse.raw, 1.0 / 6.0);
        near(found.means[1].luminance.raw, 1.0);
        let none = errors(&[[f32::NAN; 3]], &[[0.0; 3]]).unwrap();
        assert!(none.pixels == 0 && none.mse.raw.is_nan() && none.rel_mse.trimmed.is_nan());
    }

    #[test]
    fn the_largest_numbers_do_not_overflow() {
        let found = errors(&[[f32::MAX; 3]; 3], &[[f32::MIN; 3]; 3]).unwrap();
        near(found.mse.raw / (2.0 * f64::from(f32::MAX)).powi(2), 1.0);
        near(found.rel_mse.raw, 4.0);
    }

    #[test]
    fn sizes_must_agree() {
        let fails = |a: usize, b: usize| errors(&vec![[0.0; 3]; a], &vec![[0.0; 3]; b]).unwrap_err().to_string();
        assert_eq!(fails(3, 4), "images: found 3 and 4 pixels, expected as many in both, and at least one");
        assert!(fails(0, 0).contains("0 and 0 pixels"));
        assert!(rel_mse_of_noisy_reference(&[[0.0; 3]; 2], [&[[0.0; 3]; 2], &[[0.0; 3]; 1]]).is_err());
        assert!(rel_mse_less_variance(&[[0.0; 3]; 2], &[[0.0; 3]; 2], &[[0.0; 3]; 1]).is_err());
    }

    #[test]
    fn noise_of_the_reference_is_taken_out() {
        // Exactly: halves 0.5 and 1.5 have the mean 1 and the estimated variance 0.25.
        let found = rel_mse_of_noisy_reference(&[[2.0; 3]; 5], [&[[0.5; 3]; 5], &[[1.5; 3]; 5]]).unwrap();
        near(found.raw, (1.0 - 0.25) / 1.01);
        let known = rel_mse_less_variance(&[[2.0; 3]; 5], &[[1.0; 3]; 5], &[[0.25; 3]; 5]).unwrap();
        assert_eq!(found, known);
        let unknown = [[0.25; 3], [f32::INFINITY; 3], [0.25; 3], [f32::NAN; 3], [0.25; 3]];
        near(rel_mse_less_variance(&[[2.0; 3]; 5], &[[1.0; 3]; 5], &unknown).unwrap().raw, (1.0 - 0.25) / 1.01);
        // In the mean: an image without error has none by a reference with noise. Uniform noise of +-0.1 about 1 in each
        // half: the variance of the halves' mean is 0.01 / 3 / 2, that of the estimate less than twice its square.
        let mut state = 1_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            1.0 + 0.2 * ((state >> 40) as f32 / (1 << 24) as f32 - 0.5)
        };
        let n = 40_000;
        let mut half = || (0..n).map(|_| [noise(), noise(), noise()]).collect::<Vec<_>>();
        let (a, b) = (half(), half());
        let image = vec![[1.0; 3]; n];
        let found = rel_mse_of_noisy_reference(&image, [&a, &b]).unwrap().raw;
        let variance = 0.01 / 6.0 / 1.01;
        // Error less noise is (r - 1)^2 - d^2 with r and d of that variance and uncorrelated. Five standard errors, which
        // chance exceeds in 6 of 10^7 seeds; the second term leaves room for the noise in the denominator.
        let allowed = 5.0 * 2.0 * variance / (3.0 * n as f64).sqrt() + 4.0 * variance * variance;
        assert!(found.abs() < allowed, "{found} is beyond {allowed}");
        let uncorrected = errors(&image, &a).unwrap().rel_mse.raw;
        assert!(uncorrected > 20.0 * allowed, "the test would not notice: {uncorrected}");
    }
}
