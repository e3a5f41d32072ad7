//! Reads the `camera` of a scene.

use crate::linear::DVec3;

use super::fields::{self, Fields, Range};
use super::json::Node;
use super::problems::Problems;
use crate::camera::Camera;

const KEYS: &[&str] = &["focalPoint", "direction", "xReso", "yReso", "xAngle", "yAngle", "comment"];

/// Pixels across and down where the scene is silent.
const DEFAULT_PIXELS: u32 = 1000;
/// Field of view across the width where the scene states none, in degrees.
const DEFAULT_X_ANGLE: f64 = 45.0;

/// Most pixels across, and most down.
pub const MAX_SIDE: u32 = Camera::MAX_SIDE;
/// Most pixels of an image.
pub const MAX_PIXELS: u64 = Camera::MAX_PIXELS;

/// Which fields of view the scene states; the other follows by square pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GivenAngles {
    /// Both: pixels need not be square.
    Both,
    /// The one across the width, or none.
    X,
    /// The one across the height.
    Y,
}

impl GivenAngles {
    /// Derives the angle that is not given from the one that is, for the camera's pixels; false where it would round
    /// to 0 or 180 degrees.
    pub(super) fn complete(self, camera: &mut Camera) -> bool {
        let (width, height) = (f64::from(camera.width), f64::from(camera.height));
        match self {
            Self::Both => {}
            Self::X => camera.y_angle = scaled_angle(camera.x_angle, height / width),
            Self::Y => camera.x_angle = scaled_angle(camera.y_angle, width / height),
        }
        [camera.x_angle, camera.y_angle].iter().all(|&angle| angle > 0.0 && angle < 180.0)
    }
}

/// The field of view, in degrees, of an image `ratio` times as large as one that spans `angle`.
fn scaled_angle(angle: f64, ratio: f64) -> f64 {
    2.0 * ((angle.to_radians() / 2.0).tan() * ratio).atan().to_degrees()
}

/// Reads the camera at `node`.
pub(super) fn read(node: &Node, problems: &mut Problems) -> Option<(Camera, GivenAngles)> {
    let fields = Fields::open(node, "camera", KEYS, problems)?;
    fields.comment(problems);
    let focal_point = fields
        .require("focalPoint", "the origin of the rays as x, y and z", problems)
        .and_then(|node| fields::vector(node, &fields.path("focalPoint"), problems));
    let direction = fields
        .require("direction", "the direction of view as x, y and z", problems)
        .and_then(|node| direction(node, &fields.path("direction"), problems));
    let width = side(&fields, "xReso", problems);
    let height = side(&fields, "yReso", problems);
    let x_angle = fields.number("xAngle", &Range::ANGLE, DEFAULT_X_ANGLE, problems);
    let y_angle = fields.number("yAngle", &Range::ANGLE, 0.0, problems);
    let given = match (fields.get("xAngle"), fields.get("yAngle")) {
        (Some(_), Some(_)) => GivenAngles::Both,
        (None, Some(_)) => GivenAngles::Y,
        _ => GivenAngles::X,
    };
    let (width, height) = (width?, height?);
    if !pixels_fit(width, height) {
        let found = format!("{width} x {height} pixels");
        problems.error(node.at, "camera", found, format!("at most {MAX_PIXELS} pixels (2^28) in all"));
        return None;
    }
    let mut camera = Camera {
        focal_point: focal_point?,
        direction: direction?,
        width,
        height,
        x_angle: x_angle?,
        y_angle: y_angle?,
    };
    if !given.complete(&mut camera) {
        let found =
            format!("one angle of {} degrees", if given == GivenAngles::X { camera.x_angle } else { camera.y_angle });
        let expected = "an angle from which square pixels give the other above 0 and below 180";
        problems.error(node.at, "camera", found, expected);
        return None;
    }
    Some((camera, given))
}

/// Whether an image of this size is within [`MAX_SIDE`] and [`MAX_PIXELS`].
pub(super) fn pixels_fit(width: u32, height: u32) -> bool {
    width.max(height) <= MAX_SIDE && u64::from(width) * u64::from(height) <= MAX_PIXELS
}

fn side(fields: &Fields, key: &str, problems: &mut Problems) -> Option<u32> {
    let Some(node) = fields.get(key) else { return Some(DEFAULT_PIXELS) };
    let path = fields.path(key);
    let expected = format!("a whole number of pixels from 1 to {MAX_SIDE}");
    let pixels = fields::whole(node, &path, 1, &expected, problems)?;
    let fitting = u32::try_from(pixels).ok().filter(|&pixels| pixels <= MAX_SIDE);
    if fitting.is_none() {
        problems.error(node.at, &path, node.describe(), expected);
    }
    fitting
}

fn direction(node: &Node, path: &str, problems: &mut Problems) -> Option<DVec3> {
    let direction = fields::vector(node, path, problems)?;
    let largest = direction.abs().max_element();
    if largest == 0.0 {
        problems.error(node.at, path, "a vector of length 0", "a direction: any vector but 0");
        return None;
    }
    // The square of so short a vector would round to 0 wherever it is normalised.
    Some(if largest < 1e-100 { direction / largest } else { direction })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::json;
    use super::*;

    fn camera(rest: &str) -> Result<(Camera, GivenAngles), Vec<String>> {
        let text =
            format!(r#"{{"focalPoint": {{"x": 1, "y": 2, "z": 3}}, "direction": {{"x": 0, "y": 4, "z": 0}}{rest}}}"#);
        let mut problems = Problems::new(Path::new("s"), &text);
        let node = json::parse(&text, &mut problems).expect("valid JSON");
        let camera = read(&node, &mut problems);
        camera.ok_or_else(|| problems.into_parts().0.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn defaults() {
        let (camera, given) = camera("").unwrap();
        assert_eq!(camera.focal_point, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(camera.direction, DVec3::new(0.0, 4.0, 0.0), "kept as given");
        assert_eq!((camera.width, camera.height), (1000, 1000));
        assert_eq!(given, GivenAngles::X);
        assert_eq!(camera.x_angle, 45.0);
        assert!((camera.y_angle - 45.0).abs() < 1e-12);
    }

    #[test]
    fn one_angle_gives_the_other_by_square_pixels() {
        // tan(45 deg) * 480/640 = 3/4, and 2 atan(3/4) = 73.7397952917 deg.
        let (wide, given) = camera(r#", "xReso": 640, "yReso": 480, "xAngle": 90"#).unwrap();
        assert_eq!(given, GivenAngles::X);
        assert!((wide.y_angle - 73.739_795_291_688).abs() < 1e-9, "{}", wide.y_angle);
        let (tall, given) = camera(r#", "xReso": 480, "yReso": 640, "yAngle": 90"#).unwrap();
        assert_eq!(given, GivenAngles::Y);
        assert!((tall.x_angle - 73.739_795_291_688).abs() < 1e-9, "{}", tall.x_angle);
        let (both, given) = camera(r#", "xReso": 640, "yReso": 480, "xAngle": 90, "yAngle": 10"#).unwrap();
        assert_eq!((both.x_angle, both.y_angle, given), (90.0, 10.0, GivenAngles::Both));
    }

    #[test]
    fn an_angle_that_rounds_to_180_or_0_is_a_mistake() {
        assert!(camera(r#", "xReso": 1, "yReso": 65536, "xAngle": 179.99999999999"#).is_err());
        assert!(camera(r#", "xReso": 65536, "yReso": 1, "xAngle": 5e-324"#).is_err());
    }

    #[test]
    fn a_tiny_direction_is_a_direction() {
        let text = r#"{"x": 0, "y": 0, "z": -1e-300}"#;
        let mut problems = Problems::new(Path::new("s"), text);
        let node = json::parse(text, &mut problems).expect("valid JSON");
        assert_eq!(direction(&node, "d", &mut problems), Some(DVec3::NEG_Z));
    }

    #[test]
    fn the_largest_images() {
        assert!(camera(r#", "xReso": 65536, "yReso": 4096"#).is_ok());
        let errors = camera(r#", "xReso": 65536, "yReso": 4097"#).unwrap_err();
        assert!(errors[0].contains("found 65536 x 4097 pixels, expected at most 268435456 pixels"), "{errors:?}");
        let errors = camera(r#", "xReso": 65537"#).unwrap_err();
        assert!(
            errors[0].contains("xReso: found 65537, expected a whole number of pixels from 1 to 65536"),
            "{errors:?}"
        );
    }
}
