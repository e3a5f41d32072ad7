//! Radiance HDR: linear, 8-bit mantissas with a shared exponent (RGBE), metadata as header variables.
//!
//! The header and the rounding are written here because encoders at hand can do neither: they offer no variables, and
//! cut mantissas off instead of rounding them. Pixels are stored flat: radiance is noise to a run-length code.

use std::io::Write;

use super::{Image, Metadata, format::EncodeError};

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
