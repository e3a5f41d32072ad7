//! PNG as bytes, for where it stands within another file.

use super::{Image, Metadata, Tone, png};
use crate::error::{Error, Result};
use std::path::Path;

/// What a PNG that goes to no file is called in messages.
const IN_MEMORY: &str = "PNG in memory";

/// An image as the bytes of a PNG file, for where it stands within another.
///
/// # Errors
/// [`Error::Output`] for an image whose pixels do not match its size, [`Error::Setting`] for an exposure that is not
/// finite.
pub fn png_bytes(image: &Image, metadata: &Metadata, tone: &Tone) -> Result<Vec<u8>> {
    tone.check()?;
    if let Some(reason) = image.flaw() {
        return Err(Error::Output { file: IN_MEMORY.into(), reason });
    }
    png_of_rgb8(image.width, image.height, &tone.to_srgb8(image), metadata)
}

/// Pixels of 8-bit sRGB, three bytes each, row by row from the top left, as the bytes of a PNG file.
///
/// # Errors
/// [`Error::Output`] where there are no pixels, or not `width * height` of them.
pub fn png_of_rgb8(width: u32, height: u32, pixels: &[u8], metadata: &Metadata) -> Result<Vec<u8>> {
    let expected = u64::from(width) * u64::from(height);
    if pixels.len() as u128 != u128::from(expected) * 3 {
        let reason = format!("found {} bytes, expected 3 for each of {width}x{height} pixels", pixels.len());
        return Err(Error::Output { file: IN_MEMORY.into(), reason });
    }
    let mut bytes = Vec::new();
    let encoded = png::encode_rgb8([width, height], pixels, metadata, &mut bytes);
    encoded.map(|()| bytes).map_err(|error| error.of(Path::new(IN_MEMORY)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::write;
    use std::io::Cursor;

    fn decoded(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
        let mut reader = ::png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        (reader.info().width, reader.info().height, pixels)
    }

    #[test]
    fn a_png_in_memory_is_that_of_a_file() {
        let image = Image { width: 2, height: 1, pixels: vec![[0.0, 0.5, 2.0], [1.0, 0.25, 0.125]] };
        let tone = Tone::default();
        let bytes = png_bytes(&image, &Metadata::default(), &tone).unwrap();
        assert_eq!(decoded(&bytes), (2, 1, tone.to_srgb8(&image)));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write(&path, &image, &Metadata::default(), &tone).unwrap();
        assert_eq!(std::fs::read(path).unwrap(), bytes);
        assert_eq!(
            decoded(&png_of_rgb8(1, 2, &[1, 2, 3, 4, 5, 6], &Metadata::default()).unwrap()).2,
            [1, 2, 3, 4, 5, 6]
        );
    }

    #[test]
    fn pixels_that_do_not_fit_are_an_error() {
        for (width, height) in [(0, 1), (1, 0), (2, 2), (u32::MAX, u32::MAX)] {
            assert!(png_of_rgb8(width, height, &[0; 3], &Metadata::default()).is_err(), "{width}x{height}");
            let image = Image { width, height, pixels: vec![[0.0; 3]] };
            assert!(png_bytes(&image, &Metadata::default(), &Tone::default()).is_err(), "{width}x{height}");
        }
    }
}
