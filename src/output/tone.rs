//! From linear radiance to 8-bit sRGB and back, for PNG and PPM.

use super::Image;
use crate::error::{Error, Result};

/// How radiance is brought into [0, 1]. EXR and HDR hold radiance as it is and take no part in this.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tone {
    /// Exposure in stops: radiance is multiplied by 2^EV. Finite. Cancels out under [`ToneMap::Max`].
    pub exposure_ev: f32,
    /// What becomes of values above 1.
    pub map: ToneMap,
}

/// What becomes of values above 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneMap {
    /// They become 1.
    #[default]
    Clamp,
    /// The whole image is divided by its largest component. A pixel that is not finite does not count.
    Max,
}

impl Tone {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`Error::Setting`] where the exposure is not finite.
    pub fn check(&self) -> Result<()> {
        if self.exposure_ev.is_finite() {
            return Ok(());
        }
        Err(Error::Setting {
            setting: "--exposure",
            found: self.exposure_ev.to_string(),
            expected: "a finite number of stops".to_owned(),
        })
    }

    /// The image as 8-bit sRGB, three bytes per pixel in the image's order. NaN gives 0, +infinity 255.
    #[must_use]
    pub fn to_srgb8(&self, image: &Image) -> Vec<u8> {
        let scale = self.scale(image);
        image.pixels.as_flattened().iter().map(|&radiance| quantize(f64::from(radiance), scale)).collect()
    }

    fn scale(&self, image: &Image) -> f64 {
        match self.map {
            ToneMap::Clamp => f64::from(self.exposure_ev).exp2(),
            ToneMap::Max => {
                let finite = image.pixels.iter().filter(|pixel| pixel.iter().all(|value| value.is_finite()));
                let largest = finite.flatten().copied().fold(0.0, f32::max);
                if largest > 0.0 { f64::from(largest).recip() } else { 1.0 }
            }
        }
    }
}

fn quantize(radiance: f64, scale: f64) -> u8 {
    // Infinity times a scale that underflowed to 0 would be NaN.
    let linear = if radiance == f64::INFINITY { 1.0 } else { radiance * scale };
    // The cast turns NaN to 0; clamp keeps it.
    (srgb(linear.clamp(0.0, 1.0)) * 255.0).round() as u8
}

/// The image that [`Tone::to_srgb8`] shows by these codes: 8-bit sRGB, row by row from the top left.
#[must_use]
pub fn from_srgb8(width: u32, height: u32, codes: &[[u8; 3]]) -> Image {
    let light = |code: u8| linear(f64::from(code) / 255.0) as f32;
    Image { width, height, pixels: codes.iter().map(|pixel| pixel.map(light)).collect() }
}

/// The transfer function of IEC 61966-2-1, from linear in [0, 1] to encoded in [0, 1].
fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The same backwards: from encoded to linear, both in [0, 1].
pub(super) fn linear(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(values: &[f32], tone: Tone) -> Vec<u8> {
        let pixels: Vec<[f32; 3]> = values.iter().map(|&v| [v; 3]).collect();
        let image = Image { width: values.len() as u32, height: 1, pixels };
        tone.to_srgb8(&image).chunks(3).map(|pixel| pixel[0]).collect()
    }

    fn tone(exposure_ev: f32, map: ToneMap) -> Tone {
        Tone { exposure_ev, map }
    }

    #[test]
    fn what_is_no_colour_is_shown_somehow() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, -0.0, f32::MAX, f32::MIN_POSITIVE];
        for exposure in [0.0, -1e4, 1e4] {
            let shown = bytes(&odd, tone(exposure, ToneMap::Clamp));
            assert_eq!(shown[..5], [0, 255, 0, 0, 0], "{exposure} EV");
        }
        assert_eq!(bytes(&odd, Tone::default())[5..], [255, 0]);
    }

    #[test]
    fn exposure_is_in_stops() {
        assert_eq!(bytes(&[0.5, 1.0, 2.0, 4.0], tone(-2.0, ToneMap::Clamp)), [99, 137, 188, 255]);
        assert_eq!(bytes(&[0.125, 0.25], tone(2.0, ToneMap::Clamp)), [188, 255]);
    }

    #[test]
    fn max_divides_by_the_largest_finite_component() {
        let shown = bytes(&[10.0, 5.0, f32::NAN, f32::INFINITY, -3.0], tone(0.0, ToneMap::Max));
        assert_eq!(shown, [255, 188, 0, 255, 0]);
        assert_eq!(bytes(&[1e-42, 0.0], tone(0.0, ToneMap::Max)), [255, 0]);
        assert_eq!(bytes(&[10.0, 5.0], tone(-3.0, ToneMap::Max)), [255, 188], "exposure cancels out");
    }

    #[test]
    fn max_leaves_black_black() {
        assert_eq!(bytes(&[0.0, -0.0, -1.0, f32::NAN], tone(0.0, ToneMap::Max)), [0; 4]);
    }

    #[test]
    fn max_ignores_all_of_a_broken_pixel() {
        let image = Image { width: 2, height: 1, pixels: vec![[f32::NAN, 1e9, 0.0], [1.0, 0.5, 0.0]] };
        assert_eq!(tone(0.0, ToneMap::Max).to_srgb8(&image), [0, 255, 0, 255, 188, 0]);
    }

    #[test]
    fn what_was_shown_is_read_back() {
        for code in 0..=255_u8 {
            assert_eq!(quantize(linear(f64::from(code) / 255.0), 1.0), code);
            assert_eq!(Tone::default().to_srgb8(&from_srgb8(1, 1, &[[code, 7, 255]])), [code, 7, 255]);
        }
        // The two branches meet where the standard's rounded numbers let them.
        assert!((linear(0.040_45) - linear(0.040_450_001)).abs() < 1e-7);
    }

    #[test]
    fn exposure_must_be_finite() {
        assert!(tone(-3.5, ToneMap::Max).check().is_ok());
        for exposure in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let found = tone(exposure, ToneMap::Clamp).check();
            assert!(matches!(found, Err(Error::Setting { setting: "--exposure", .. })), "{found:?}");
        }
    }
}
