//! The pinhole camera: from a pixel position to a ray.

use glam::DVec3;

/// A pinhole camera, as the user states it.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Origin of all rays, in scene units.
    pub focal_point: DVec3,
    /// Direction of view; not zero, any length.
    pub direction: DVec3,
    /// Pixels across, at least 1.
    pub width: u32,
    /// Pixels down, at least 1.
    pub height: u32,
    /// Full field of view across the width in degrees, in (0, 180).
    pub x_angle: f64,
    /// Full field of view across the height in degrees, in (0, 180).
    pub y_angle: f64,
}
