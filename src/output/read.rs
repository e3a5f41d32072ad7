//! Reading: what an image file holds, whoever wrote it. The format is told by the first bytes, not by the name.
//!
//! Nothing is believed that the file cannot hold: memory is taken in proportion to its length, and sides and pixels are
//! limited as those of a render are. Compressed files of some kilobytes can hold gigabytes of one colour: they are refused.

use std::{
    fs::{self, File},
    io::Read,
    path::Path,
};

use super::{Format, Image, Metadata, exr, hdr, png, ppm};
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::input::MAX_STREAM;

/// Bytes by which formats are told apart.
const HEAD: usize = 16;
/// Most pixels for each byte of a file. Renders have less than one, but where nearly all of an image is empty.
const PIXELS_PER_BYTE: u64 = 8;
/// Shorter files may have as many pixels as one of this length: 2^23, more than 3840x2160.
const SMALL_FILE: u64 = 1 << 20;
const FORMATS: &str = "a PNG, PPM (P3 or P6), OpenEXR or Radiance HDR image";

/// What an image file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageFile {
    /// Its format. Values of PNG and PPM are limited to [0, 1].
    pub format: Format,
    /// Its pixels, linear RGB. Alpha is left out, grey becomes three equal channels.
    pub image: Image,
    /// Variances of the pixels' means, `image`'s pixels in number and order, where the file has the EXR channels
    /// `variance.R`, `variance.G` and `variance.B`.
    pub variance: Option<Vec<[f32; 3]>>,
    /// Its text entries, in the file's order; EXR attributes by name.
    pub metadata: Metadata,
    /// What the file says and is not heeded, such as a colour profile: whole clauses, for people.
    pub remarks: Vec<String>,
}

/// Reads an image file.
///
/// # Errors
/// [`Error::Io`] where the system refuses; [`Error::Decode`] for a folder, an empty or truncated file, an unknown format or
/// a feature of a format that is not read, sides or pixel counts above those of [`Camera::MAX_SIDE`] and
/// [`Camera::MAX_PIXELS`], more than 8 pixels for each byte of the file, or 2^23 of a file below 1 MiB, and more than 256 MiB
/// from a pipe or a device.
pub fn read(path: &Path) -> Result<ImageFile> {
    let failed = |source| Error::Io { file: path.to_owned(), action: "read", source };
    let refused = |DecodeError { found, expected }| Error::Decode { file: path.to_owned(), found, expected };
    let kind = fs::metadata(path).map_err(failed)?;
    if kind.is_dir() {
        return Err(refused(DecodeError::new("a folder", FORMATS)));
    }
    let mut file = File::open(path).map_err(failed)?;
    // A device without an end is told by its first bytes too.
    let mut bytes = Vec::new();
    file.by_ref().take(HEAD as u64).read_to_end(&mut bytes).map_err(failed)?;
    let decode = decoder(&bytes).map_err(refused)?;
    let most = if kind.is_file() { u64::MAX } else { MAX_STREAM };
    file.take(most).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > most {
        return Err(refused(DecodeError::new("a stream without an end", format!("at most {MAX_STREAM} bytes"))));
    }
    decode(&bytes).map_err(refused)
}

/// What a decoder gives.
pub(super) type Decoded = std::result::Result<ImageFile, DecodeError>;
type Decoder = fn(&[u8]) -> Decoded;

/// What reads a file that begins like this.
fn decoder(head: &[u8]) -> std::result::Result<Decoder, DecodeError> {
    let is = |magic: &[u8]| head.starts_with(magic);
    let netpbm = |kinds: &[u8]| matches!(head, [b'P', kind, next, ..] if kinds.contains(kind) && (next.is_ascii_whitespace() || *next == b'#'));
    let found = match head {
        _ if is(b"\x89PNG\r\n\x1a\n") => return Ok(png::decode),
        _ if is(b"\x76\x2f\x31\x01") => return Ok(exr::decode),
        _ if is(b"#?") => return Ok(hdr::decode),
        _ if netpbm(b"36") => return Ok(ppm::decode),
        [] => "an empty file",
        _ if netpbm(b"12457Ff") => "a Netpbm or PFM image of another kind",
        _ if is(b"\xff\xd8\xff") => "a JPEG image",
        _ if is(b"GIF8") => "a GIF image",
        _ if is(b"BM") => "a BMP image",
        _ if is(b"II*\0") || is(b"MM\0*") => "a TIFF image",
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => "a WebP image",
        _ => {
            let start: String =
                head.iter().take(8).flat_map(|&byte| std::ascii::escape_default(byte)).map(char::from).collect();
            return Err(DecodeError::new(format!("a file that begins with \"{start}\""), FORMATS));
        }
    };
    Err(DecodeError::new(found, FORMATS))
}

/// A decoder's failure, which does not know the file's name.
#[derive(Debug)]
pub(super) struct DecodeError {
    found: String,
    expected: String,
}

impl DecodeError {
    pub(super) fn new(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { found: found.into(), expected: expected.into() }
    }

    /// The file ends before its image does.
    pub(super) fn truncated(format: &str) -> Self {
        Self::new("a file that ends early", format!("a whole {format} image"))
    }
}

/// Sides of an image that may be read from a file of `length` bytes.
pub(super) fn check_size(width: u64, height: u64, length: usize) -> std::result::Result<(u32, u32), DecodeError> {
    let (side, pixels) = (Camera::MAX_SIDE, Camera::MAX_PIXELS);
    let (w, h) = match (u32::try_from(width), u32::try_from(height)) {
        (Ok(w @ 1..), Ok(h @ 1..)) if w <= side && h <= side && width * height <= pixels => (w, h),
        _ => {
            return Err(DecodeError::new(
                format!("an image of {width}x{height} pixels"),
                format!("1 to {side} each way and at most {pixels} in all"),
            ));
        }
    };
    let most = most_pixels(length);
    if width * height > most {
        return Err(DecodeError::new(
            format!("an image of {width}x{height} pixels in {length} bytes"),
            format!(
                "at most {most}: {PIXELS_PER_BYTE} for each byte, or {} of a small file (large images of little else than one \
                 colour can be read as PPM or flat HDR)",
                PIXELS_PER_BYTE * SMALL_FILE
            ),
        ));
    }
    Ok((w, h))
}

/// Most pixels of a file of `length` bytes.
pub(super) fn most_pixels(length: usize) -> u64 {
    PIXELS_PER_BYTE * SMALL_FILE.max(length as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_image_is_is_named() {
        let found = |head: &[u8]| decoder(head).unwrap_err().found;
        assert_eq!(found(b""), "an empty file");
        assert_eq!(found(b"\xff\xd8\xff\xe0"), "a JPEG image");
        assert_eq!(found(b"P5\n1 1\n255\n"), "a Netpbm or PFM image of another kind");
        assert_eq!(found(b"RIFF\0\0\0\0WEBPVP8 "), "a WebP image");
        assert_eq!(found(b"{\n \"a\": \xe91"), r#"a file that begins with "{\n \"a\": ""#);
        assert_eq!(found(b"P3"), r#"a file that begins with "P3""#);
        assert_eq!(found(b"\x89PN"), r#"a file that begins with "\x89PN""#);
    }

    #[test]
    fn sizes_are_limited() {
        let long = 1 << 30;
        assert_eq!(check_size(65536, 4096, long).unwrap(), (65536, 4096));
        for (w, h) in [(0, 1), (1, 0), (65537, 1), (16384, 16385), (u64::MAX, u64::MAX), (1 << 32, 1)] {
            assert!(check_size(w, h, long).unwrap_err().found.contains(&format!("{w}x{h}")));
        }
    }
    #[test]
    fn pixels_are_limited_by_the_length_of_the_file() {
        assert!(check_size(4096, 2048, 100).is_ok());
        let error = check_size(4096, 2049, 1 << 20).unwrap_err();
        assert_eq!(error.found, "an image of 4096x2049 pixels in 1048576 bytes");
        assert!(error.expected.starts_with("at most 8388608: 8 for each byte"), "{}", error.expected);
        assert!(check_size(4096, 2049, (1 << 20) + 512).is_ok());
        assert!(check_size(16384, 16384, 1 << 25).is_ok());
    }
}
