//! Values of options that take more than a number.

use wavetrace::camera::Camera;
use wavetrace::render::MAX_LIGHT_PATHS;

/// `WxH` within the limits of an image.
pub fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse::<u64>().ok()?, h.parse::<u64>().ok()?)));
    let (width, height) = sides.ok_or("expected width x height in pixels, such as 640x480")?;
    let (side, pixels) = (Camera::MAX_SIDE, Camera::MAX_PIXELS);
    let fits = |side_given| (1..=u64::from(side)).contains(&side_given);
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(w), Ok(h)) if fits(width) && fits(height) && width * height <= pixels => Ok((w, h)),
        _ => Err(format!("expected 1 to {side} pixels each way and at most {pixels} in all")),
    }
}

/// Light paths per camera path.
pub fn light_paths(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(share) if (0.0..=MAX_LIGHT_PATHS).contains(&share) => Ok(share),
        _ => Err(format!("expected a number from 0 to {MAX_LIGHT_PATHS}")),
    }
}

/// A number of seconds.
pub fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= 1e6 => Ok(seconds),
        _ => Err("expected seconds, more than 0 and at most 1000000".to_owned()),
    }
}

/// An error that an image may have.
pub fn error(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(error) if error > 0.0 && error.is_finite() => Ok(error),
        _ => Err("expected a relMSE above 0, such as 0.001".to_owned()),
    }
}

/// A finite number of stops.
pub fn exposure(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(stops) if stops.is_finite() => Ok(stops),
        _ => Err("expected a finite number of stops, such as -1.5".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("640x480"), Ok((640, 480)));
        assert_eq!(size("1X65536"), Ok((1, 65536)));
        assert_eq!(size("16384x16384"), Ok((16384, 16384)));
        for wrong in ["0x5", "5x0", "16384x16385", "65537x1", "18446744073709551616x1"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "x", "5", "5x", "x5", "-1x5", "5x5x5", "5 x 5", "5.0x5", "1e3x5"] {
            assert!(size(wrong).unwrap_err().contains("such as 640x480"), "{wrong}");
        }
    }

    #[test]
    fn seconds_and_errors() {
        assert_eq!((seconds("0.5"), seconds("1e6"), error("1e-3")), (Ok(0.5), Ok(1e6), Ok(0.001)));
        for wrong in ["", "0", "-1", "nan", "inf", "x"] {
            assert!(seconds(wrong).is_err() && error(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn shares_of_light_paths() {
        assert_eq!((light_paths("0"), light_paths("0.25"), light_paths("1000")), (Ok(0.0), Ok(0.25), Ok(1000.0)));
        for wrong in ["", "-0.1", "1001", "nan", "inf", "x"] {
            assert!(light_paths(wrong).is_err(), "{wrong}");
        }
    }
}
