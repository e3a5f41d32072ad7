//! Heat maps: the squared relative error of each pixel as a colour, on the same logarithmic scale everywhere.

use super::gallery::Scale;
use super::number::tick;
use crate::error::Result;
use crate::film::Image;
use crate::output::{self, Metadata};
use crate::report::errors::relative_squared_error;
use crate::report::heatmap;

const COLOURS: heatmap::Scale = heatmap::Scale::RelativeError;
/// Pixels across the scale.
const SCALE_WIDTH: u32 = 256;

/// The heat map of an image as PNG: dark where it is like the reference. A pixel without a number in either is green.
///
/// # Errors
/// [`Error::Output`](crate::Error::Output) where an image's pixels do not match its size.
pub fn map(image: &Image, reference: &Image) -> Result<Vec<u8>> {
    let pixels = image.pixels.iter().zip(&reference.pixels);
    let colours = pixels.flat_map(|(&pixel, &truth)| COLOURS.colour(relative_squared_error(pixel, truth)));
    output::png_of_rgb8(image.width, image.height, &colours.collect::<Vec<_>>(), &Metadata::default())
}

/// What the colours stand for.
///
/// # Errors
/// None that any input causes.
pub fn scale() -> Result<Scale> {
    let [low, high] = COLOURS.range();
    let at = |x: u32| low * (high / low).powf(f64::from(x) / f64::from(SCALE_WIDTH - 1));
    let colours: Vec<u8> = (0..SCALE_WIDTH).flat_map(|x| COLOURS.colour(at(x))).collect();
    let colours = output::png_of_rgb8(SCALE_WIDTH, 1, &colours, &Metadata::default())?;
    let label = |value: f64| {
        let power = value.log10().round() as i32;
        tick(1, power, (-3..=3).contains(&power))
    };
    Ok(Scale { colours, low: label(low), high: label(high) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn row(values: &[f32]) -> Image {
        Image { width: values.len() as u32, height: 1, pixels: values.iter().map(|&v| [v; 3]).collect() }
    }

    fn pixels(png: &[u8]) -> Vec<[u8; 3]> {
        let mut reader = png::Decoder::new(Cursor::new(png)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        bytes.chunks(3).map(|p| [p[0], p[1], p[2]]).collect()
    }

    #[test]
    fn colours_are_those_of_the_scale() {
        // Errors of 0, 10^-4 / 1.01 and far above 1, and none.
        let found = pixels(&map(&row(&[1.0, 1.01, 100.0, f32::NAN]), &row(&[1.0; 4])).unwrap());
        let colours = pixels(&scale().unwrap().colours);
        assert_eq!((colours.len(), found[0], found[2]), (256, colours[0], colours[255]));
        // Four decades below the end of five, a fifth of the way.
        let near = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).all(|(&a, b)| a.abs_diff(b) <= 2);
        assert!(near(found[1], colours[51]), "{:?} {:?}", found[1], colours[51]);
        assert!(!colours.contains(&found[3]));
        assert_eq!((scale().unwrap().low.as_str(), scale().unwrap().high.as_str()), ("10⁻⁵", "1"));
        assert!(map(&row(&[1.0; 2]), &row(&[1.0; 3])).is_ok() && map(&row(&[1.0; 3]), &row(&[1.0; 2])).is_err());
    }
}
