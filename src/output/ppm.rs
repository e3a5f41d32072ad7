//! PPM: binary (P6), 8-bit sRGB, metadata as comments. 16 bits and plain text (P3) are read, too.

use std::io::Write;

use super::read::{DecodeError, Decoded, ImageFile, check_size};
use super::tone::linear;
use super::{Format, Image, Metadata, Tone, format::EncodeError};

pub(super) fn encode(
    image: &Image,
    metadata: &Metadata,
    tone: &Tone,
    sink: &mut impl Write,
) -> Result<(), EncodeError> {
    sink.write_all(b"P6\n")?;
    for line in metadata.lines(|_| false) {
        writeln!(sink, "# {line}")?;
    }
    write!(sink, "{} {}\n255\n", image.width, image.height)?;
    sink.write_all(&tone.to_srgb8(image))?;
    Ok(())
}

/// Reads P3 and P6, taken as sRGB, as other programs do. What stands behind the first image is left alone.
pub(super) fn decode(bytes: &[u8]) -> Decoded {
    let plain = bytes.get(1) == Some(&b'3');
    let mut words = Words { bytes, at: 2, comments: Vec::new() };
    let [width, height]: [u32; 2] = [words.number("the width")?, words.number("the height")?];
    let (width, height) = check_size(width.into(), height.into(), bytes.len())?;
    let top: u32 = words.number("the largest value")?;
    let top = u16::try_from(top)
        .ok()
        .filter(|&top| top > 0)
        .ok_or_else(|| DecodeError::new(format!("the largest value {top}"), "1 to 65535"))?;
    let samples = 3 * width as usize * height as usize;
    // One byte of white space ends the header of a binary file.
    words.at += usize::from(!plain);
    // Plain numbers are one digit at least, and a space between two.
    let (size, least) = match (plain, top) {
        (true, _) => (0, 2 * samples - 1),
        (false, ..256) => (1, samples),
        (false, _) => (2, 2 * samples),
    };
    let rest = bytes.get(words.at..).unwrap_or_default();
    if rest.len() < least {
        let found = format!("{} bytes of pixels", rest.len());
        return Err(DecodeError::new(found, format!("at least {least} for {width}x{height} pixels")));
    }
    let table: Vec<f32> = (0..=top).map(|code| linear(f64::from(code) / f64::from(top)) as f32).collect();
    let light = |code: u16| {
        let beyond = || DecodeError::new(format!("a sample of {code}"), format!("at most {top}"));
        table.get(usize::from(code)).copied().ok_or_else(beyond)
    };
    let light: Vec<f32> = match size {
        0 => (0..samples).map(|_| light(words.number("a sample")?)).collect::<Result<_, _>>()?,
        1 => rest[..least].iter().map(|&code| light(code.into())).collect::<Result<_, _>>()?,
        _ => {
            rest[..least].as_chunks().0.iter().map(|&pair| light(u16::from_be_bytes(pair))).collect::<Result<_, _>>()?
        }
    };
    let image = Image { width, height, pixels: light.as_chunks().0.to_vec() };
    let metadata = Metadata::from_lines(words.comments);
    Ok(ImageFile { format: Format::Ppm, image, variance: None, metadata, remarks: Vec::new() })
}

/// The words of a header, and the comments between them.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    comments: Vec<&'a [u8]>,
}

impl Words<'_> {
    /// The next number, behind white space and comments.
    fn number<T: TryFrom<u32>>(&mut self, what: &str) -> Result<T, DecodeError> {
        loop {
            match self.bytes.get(self.at) {
                Some(b'#') => {
                    let rest = &self.bytes[self.at + 1..];
                    let line = rest.split(|&byte| byte == b'\n').next().unwrap_or_default();
                    self.comments.push(line.trim_ascii());
                    self.at += 1 + line.len();
                }
                Some(byte) if byte.is_ascii_whitespace() => self.at += 1,
                Some(_) => break,
                None => return Err(DecodeError::truncated("PPM")),
            }
        }
        let rest = &self.bytes[self.at..];
        let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        self.at += digits;
        let text = str::from_utf8(&rest[..digits]).unwrap_or_default();
        let number = text.parse::<u32>().ok().and_then(|number| T::try_from(number).ok());
        number.ok_or_else(|| {
            let word: String =
                rest.iter().take(20).take_while(|b| b.is_ascii_graphic()).map(|&b| char::from(b)).collect();
            DecodeError::new(format!("{what} \"{word}\""), "a whole number")
        })
    }
}
