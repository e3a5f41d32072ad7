//! Heat maps: the squared relative error of each pixel as a colour, on one logarithmic scale for all images of a scene.

use super::gallery::Scale;
use super::number::tick;
use crate::error::Result;
use crate::film::Image;
use crate::output::{self, Metadata};
use crate::report::errors::relative_squared_error;

/// Decades from the darkest to the brightest colour.
const DECADES: i32 = 5;
/// So large a share of the pixels is not brighter than the brightest colour, in the worst image.
const SHOWN: f64 = 0.995;
/// Pixels across the scale.
const SCALE_WIDTH: u32 = 256;

/// The range of errors that colours stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heat {
    /// Power of ten of the brightest colour.
    high: i32,
}

impl Heat {
    /// The range that suits these images. Pixels that are not finite, in an image or in the reference, do not count.
    pub fn of<'a>(images: impl IntoIterator<Item = &'a Image>, reference: &Image) -> Self {
        let largest = images.into_iter().map(|image| {
            let mut sorted: Vec<f64> = squared(image, reference).filter(|error| error.is_finite()).collect();
            sorted.sort_by(f64::total_cmp);
            sorted.get((sorted.len() as f64 * SHOWN) as usize).copied().unwrap_or(0.0)
        });
        let largest = largest.fold(0.0, f64::max);
        // Where nothing differs, any range will do.
        let high = if largest > 0.0 { largest.log10().ceil() as i32 } else { 0 };
        Self { high }
    }
    /// The heat map of an image as PNG.
    ///
    /// # Errors
    /// [`Error::Output`](crate::Error::Output) for an image whose pixels do not match its size.
    pub fn map(&self, image: &Image, reference: &Image) -> Result<Vec<u8>> {
        let bytes: Vec<u8> = squared(image, reference).flat_map(|error| self.colour(error)).collect();
        output::png_of_rgb8(image.width, image.height, &bytes, &Metadata::default())
    }
    /// What the colours stand for.
    ///
    /// # Errors
    /// None that comes of any input.
    pub fn scale(&self) -> Result<Scale> {
        let at = |x: u32| f64::from(x) / f64::from(SCALE_WIDTH - 1);
        let bytes: Vec<u8> = (0..SCALE_WIDTH).flat_map(|x| colour(at(x))).collect();
        let colours = output::png_of_rgb8(SCALE_WIDTH, 1, &bytes, &Metadata::default())?;
        let label = |power: i32| tick(1, power, (-3..=3).contains(&power));
        Ok(Scale { colours, low: label(self.high - DECADES), high: label(self.high) })
    }
    /// The colours of the ends beyond the range; white where there is no number.
    fn colour(&self, error: f64) -> [u8; 3] {
        if error.is_nan() {
            return [255; 3];
        }
        colour((error.log10() - f64::from(self.high - DECADES)) / f64::from(DECADES))
    }
}

/// Squared relative errors, pixel by pixel.
fn squared<'a>(image: &'a Image, reference: &'a Image) -> impl Iterator<Item = f64> + 'a {
    image.pixels.iter().zip(&reference.pixels).map(|(&pixel, &truth)| relative_squared_error(pixel, truth))
}

fn colour(share: f64) -> [u8; 3] {
    [(share.clamp(0.0, 1.0) * 255.0) as u8; 3]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(values: &[f32]) -> Image {
        Image { width: values.len() as u32, height: 1, pixels: values.iter().map(|&v| [v; 3]).collect() }
    }

    #[test]
    fn the_range_fits_the_worst_image() {
        let reference = row(&[1.0; 1000]);
        let (good, bad) = (row(&[1.01; 1000]), row(&[1.5; 1000]));
        // 0.25 / 1.01 is below 1, 0.0001 / 1.01 below 10^-4.
        assert_eq!(Heat::of([&good, &bad], &reference), Heat { high: 0 });
        assert_eq!(Heat::of([&good], &reference), Heat { high: -4 });
        // A few bright pixels do not darken all others.
        let mut spotted = good.clone();
        spotted.pixels[..3].fill([1e6; 3]);
        spotted.pixels[3] = [f32::NAN; 3];
        assert_eq!(Heat::of([&spotted], &reference), Heat { high: -4 });
        assert_eq!(Heat::of([&reference], &reference), Heat { high: 0 });
        assert_eq!(Heat::of([], &reference), Heat { high: 0 });
        let scale = Heat { high: -1 }.scale().unwrap();
        assert_eq!((scale.low.as_str(), scale.high.as_str()), ("10⁻⁶", "0.1"));
    }

    #[test]
    fn larger_errors_are_brighter() {
        let heat = Heat { high: 0 };
        let light = |error: f64| heat.colour(error).iter().map(|&c| u32::from(c)).sum::<u32>();
        let lights: Vec<u32> = [0.0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0].map(light).to_vec();
        assert!(lights[1..].windows(2).all(|pair| pair[0] < pair[1]) && lights[0] <= lights[1], "{lights:?}");
        assert_eq!(heat.colour(1e9), heat.colour(1.0));
        assert_eq!(heat.colour(f64::INFINITY), heat.colour(1.0));
        assert_eq!(heat.colour(f64::NAN), [255; 3]);
        assert!(heat.map(&row(&[1.0, 2.0]), &row(&[1.0, 1.0])).unwrap().starts_with(b"\x89PNG"));
    }
}
