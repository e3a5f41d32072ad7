//! Radiance HDR: linear, 8-bit mantissas with a shared exponent (RGBE), metadata as header variables.
//!
//! The header and the rounding are written here because encoders at hand can do neither: they offer no variables, and
//! cut mantissas off instead of rounding them. Pixels are stored flat: radiance is noise to a run-length code. Both
//! run-length codes are read.

use std::io::Write;

use super::read::{DecodeError, Decoded, ImageFile, check_size};
use super::{Format, Image, Metadata, format::EncodeError};

/// Variables that change how a reader takes the pixels.
const RESERVED: [&str; 7] = ["FORMAT", "EXPOSURE", "GAMMA", "COLORCORR", "PIXASPECT", "PRIMARIES", "VIEW"];

/// Rec. 709 with D65; Radiance assumes other primaries where none are stated.
const PRIMARIES: &str = "0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.3290";

pub(super) fn encode(image: &Image, metadata: &Metadata, sink: &mut impl Write) -> Result<(), EncodeError> {
    sink.write_all(b"#?RADIANCE\n")?;
    for line in metadata.lines(|key| RESERVED.iter().any(|name| name.eq_ignore_ascii_case(key))) {
        writeln!(sink, "{line}")?;
    }
    // FORMAT comes last: some readers take it for the end of the header.
    write!(sink, "PRIMARIES={PRIMARIES}\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width)?;
    for &pixel in &image.pixels {
        sink.write_all(&rgbe(pixel))?;
    }
    Ok(())
}

/// Red, green and blue as multiples of 2^(E - 136), rounded to nearest. The largest mantissa of a pixel is at least
/// 128, so that flat pixels are never taken for a run-length marker. Negative values and NaN become 0; what exceeds
/// the largest value, 255/256 * 2^127, becomes it; a pixel below 2^-128 becomes black.
fn rgbe(pixel: [f32; 3]) -> [u8; 4] {
    // max returns the other operand where one is NaN.
    let pixel = pixel.map(|value| f64::from(value.max(0.0)).min(255.0 * 2f64.powi(119)));
    let largest = pixel.into_iter().fold(0.0, f64::max);
    let mut exponent = exponent(largest);
    // 255.5 and above would round to a mantissa of 256.
    if largest * 2f64.powi(8 - exponent) >= 255.5 {
        exponent += 1;
    }
    if largest == 0.0 || exponent < -127 {
        return [0; 4];
    }
    let [red, green, blue] = pixel.map(|value| (value * 2f64.powi(8 - exponent)).round() as u8);
    [red, green, blue, (exponent + 128) as u8]
}

/// The e for which `value` is in [2^(e-1), 2^e), for a positive normal `value`.
fn exponent(value: f64) -> i32 {
    (value.to_bits() >> 52) as i32 - 1022
}

/// Reads rows from the top, left to right. Values are divided by the EXPOSURE and COLORCORR of the header, so that they are
/// radiance; a mantissa m stands for m itself, as other programs write it, not for Radiance's own m + 1/2.
pub(super) fn decode(bytes: &[u8]) -> Decoded {
    let mut rest = bytes;
    let mut line = || {
        let end = rest.iter().position(|&byte| byte == b'\n').ok_or_else(|| DecodeError::truncated("HDR"))?;
        let (line, more) = (&rest[..end], &rest[end + 1..]);
        rest = more;
        Ok::<_, DecodeError>(line.trim_ascii_end())
    };
    let mut variables = Vec::new();
    loop {
        match line()? {
            [] => break,
            // The first line, and comments.
            [b'#', ..] => {}
            variable => variables.push(variable),
        }
    }
    let (width, height) = resolution(&String::from_utf8_lossy(line()?), bytes.len())?;
    let mut metadata = Metadata::from_lines(variables);
    let (scale, remarks) = heed(&metadata)?;
    metadata.entries.retain(|(key, _)| !RESERVED.contains(&key.as_str()));
    // A row takes four bytes at least, whatever its code.
    if rest.len() < 4 * height as usize {
        return Err(DecodeError::truncated("HDR"));
    }
    let mut pixels = Vec::new();
    let mut row = vec![[0; 4]; width as usize];
    for _ in 0..height {
        rest = read_row(rest, &mut row)?;
        pixels.extend(row.iter().map(|&rgbe| radiance(rgbe, scale)));
    }
    let image = Image { width, height, pixels };
    Ok(ImageFile { format: Format::Hdr, image, variance: None, metadata, remarks })
}

/// `-Y height +X width`, of a file of `length` bytes.
fn resolution(line: &str, length: usize) -> Result<(u32, u32), DecodeError> {
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let side = |word: &str| word.parse::<u64>().ok();
    match words[..] {
        ["-Y", height, "+X", width] if side(height).is_some() && side(width).is_some() => {
            check_size(side(width).unwrap_or(0), side(height).unwrap_or(0), length)
        }
        _ => Err(DecodeError::new(format!("the resolution \"{line}\""), "-Y height +X width")),
    }
}

/// What the variables ask for: a factor for each channel; and what is not done.
fn heed(metadata: &Metadata) -> Result<([f64; 3], Vec<String>), DecodeError> {
    let (mut scale, mut remarks) = ([1.0; 3], Vec::new());
    for (key, value) in &metadata.entries {
        let numbers: Vec<f64> = value.split_ascii_whitespace().map_while(|word| word.parse().ok()).collect();
        let factors = match (key.as_str(), &numbers[..]) {
            ("EXPOSURE", &[exposure]) => [exposure; 3],
            ("COLORCORR", &[r, g, b]) => [r, g, b],
            ("FORMAT", _) if value.trim() != "32-bit_rle_rgbe" => {
                return Err(DecodeError::new(format!("pixels of the format {value}"), "32-bit_rle_rgbe"));
            }
            ("PRIMARIES", found) if !are_rec_709(found) => {
                remarks.push("its primaries are taken as Rec. 709".to_owned());
                continue;
            }
            ("EXPOSURE" | "COLORCORR", _) => [f64::NAN; 3],
            _ => continue,
        };
        for (scale, factor) in scale.iter_mut().zip(factors) {
            *scale /= factor;
            if !(*scale > 0.0 && scale.is_finite()) {
                return Err(DecodeError::new(
                    format!("{key}={value}"),
                    "positive numbers, one for EXPOSURE, three for COLORCORR",
                ));
            }
        }
    }
    Ok((scale, remarks))
}

fn are_rec_709(numbers: &[f64]) -> bool {
    let own = PRIMARIES.split(' ').map(|word| word.parse().unwrap_or(f64::NAN));
    numbers.len() == 8 && numbers.iter().zip(own).all(|(found, own): (_, f64)| (found - own).abs() < 0.005)
}

/// Fills `row` from the start of `bytes`, and returns the rest of them.
fn read_row<'a>(bytes: &'a [u8], row: &mut [[u8; 4]]) -> Result<&'a [u8], DecodeError> {
    let (first, rest) = bytes.split_first_chunk::<4>().ok_or_else(|| DecodeError::truncated("HDR"))?;
    match first {
        // Channel by channel; only such rows begin so, because a largest mantissa below 128 is not normal.
        &[2, 2, high @ ..128, low] if (8..0x8000).contains(&row.len()) => {
            let width = usize::from(high) << 8 | usize::from(low);
            if width != row.len() {
                return Err(DecodeError::new(format!("a row of {width} pixels"), format!("{} pixels", row.len())));
            }
            (0..4).try_fold(rest, |rest, channel| read_channel(rest, row, channel))
        }
        _ => read_pixels(bytes, row),
    }
}

/// Runs of one channel: a length above 128 repeats one byte, another is followed by as many.
fn read_channel<'a>(mut bytes: &'a [u8], row: &mut [[u8; 4]], channel: usize) -> Result<&'a [u8], DecodeError> {
    let mut at = 0;
    while at < row.len() {
        let (&code, rest) = bytes.split_first().ok_or_else(|| DecodeError::truncated("HDR"))?;
        let (length, taken) =
            if code > 128 { (usize::from(code) - 128, 1) } else { (usize::from(code), usize::from(code)) };
        let values = rest.get(..taken).ok_or_else(|| DecodeError::truncated("HDR"))?;
        let Some(pixels) = row.get_mut(at..at + length).filter(|pixels| !pixels.is_empty()) else {
            return Err(DecodeError::new(format!("a run of {length} pixels"), format!("1 to {}", row.len() - at)));
        };
        for (i, pixel) in pixels.iter_mut().enumerate() {
            pixel[channel] = if code > 128 { values[0] } else { values[i] };
        }
        at += length;
        bytes = &rest[taken..];
    }
    Ok(bytes)
}

/// Whole pixels. 1, 1, 1, n repeats the last one n times; such runs in a row are the digits of one number, the lowest
/// first, to the base of 256.
fn read_pixels<'a>(bytes: &'a [u8], row: &mut [[u8; 4]]) -> Result<&'a [u8], DecodeError> {
    let (mut at, mut shift, mut taken) = (0, 0, 0);
    let (pixels, _) = bytes.as_chunks::<4>();
    while at < row.len() {
        let &pixel = pixels.get(taken).ok_or_else(|| DecodeError::truncated("HDR"))?;
        taken += 1;
        let (value, length) = match pixel {
            [1, 1, 1, count] if at > 0 => {
                let length = usize::from(count).checked_shl(shift).unwrap_or(usize::MAX);
                shift = (shift + 8).min(32);
                (row[at - 1], length)
            }
            _ => {
                shift = 0;
                (pixel, 1)
            }
        };
        let left = row.len() - at;
        if length > left {
            return Err(DecodeError::new(format!("a run of {length} pixels"), format!("at most {left}")));
        }
        row[at..at + length].fill(value);
        at += length;
    }
    Ok(&bytes[4 * taken..])
}

fn radiance([red, green, blue, exponent]: [u8; 4], scale: [f64; 3]) -> [f32; 3] {
    let unit = if exponent == 0 { 0.0 } else { 2f64.powi(i32::from(exponent) - 136) };
    let mantissas = [red, green, blue];
    std::array::from_fn(|k| (f64::from(mantissas[k]) * unit * scale[k]) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        assert_eq!(rgbe([1.0, 0.5, 0.25]), [128, 64, 32, 129]);
        assert_eq!(rgbe([0.0, 0.0, 1.0]), [0, 0, 128, 129]);
        assert_eq!(rgbe([255.0, 1.0, 0.49]), [255, 1, 0, 136]);
        assert_eq!(rgbe([255.5, 1.0, 0.0]), [128, 1, 0, 137], "rounds up into the next exponent");
    }

    #[test]
    fn out_of_range_values() {
        let top = 255.0 * 2f32.powi(119);
        assert_eq!(rgbe([top, 0.0, 0.0]), [255, 0, 0, 255]);
        assert_eq!(rgbe([f32::MAX, f32::INFINITY, 1.0]), [255, 255, 0, 255]);
        assert_eq!(rgbe([f32::NAN, -1.0, 1.0]), [0, 0, 128, 129]);
        assert_eq!(rgbe([f32::NEG_INFINITY, -0.0, f32::NAN]), [0; 4]);
        assert_eq!(rgbe([2f32.powi(-128), 0.0, 0.0]), [128, 0, 0, 1]);
        assert_eq!(rgbe([2f32.powi(-129), 0.0, 0.0]), [0; 4]);
        assert_eq!(rgbe([f32::from_bits(1); 3]), [0; 4]);
    }

    #[test]
    fn largest_mantissa_is_normalised() {
        let mut value = 2e-38f32;
        while value < 1e38 {
            let [red, ..] = rgbe([value, 0.0, 0.0]);
            assert!(red >= 128, "{value:e}: {red}");
            value *= 1.003;
        }
    }
}
