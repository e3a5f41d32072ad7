//! The pinhole camera: from a pixel position to a ray.

use crate::lanes::{Lanes, Vec3};
use crate::linear::DVec3;

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

impl Camera {
    /// Pixels across or down at most.
    pub const MAX_SIDE: u32 = 1 << 16;
    /// Pixels of an image at most.
    pub const MAX_PIXELS: u64 = 1 << 28;
}

/// The camera in world coordinates, ready to make rays.
#[derive(Clone, Debug)]
pub struct View {
    origin: [f32; 3],
    forward: [f32; 3],
    /// Half the image's width at distance 1.
    right: [f32; 3],
    /// Half the image's height at distance 1.
    up: [f32; 3],
    /// Pixels across and down.
    size: [u32; 2],
}

impl View {
    /// The camera in a world whose points are (scene point - `centre`) * `scale`.
    pub fn new(camera: &Camera, centre: DVec3, scale: f64) -> Self {
        let forward = camera.direction.normalize();
        let right = forward.cross(DVec3::Z);
        // Straight up or down there is no "right"; image up is then +y.
        let (right, up) = if right.length() < 1e-9 {
            (DVec3::Y.cross(-forward).normalize(), DVec3::Y)
        } else {
            let right = right.normalize();
            (right, right.cross(forward))
        };
        let half = |degrees: f64| (degrees.to_radians() * 0.5).tan();
        let f32s = |v: DVec3| v.as_vec3().to_array();
        Self {
            origin: f32s((camera.focal_point - centre) * scale),
            forward: f32s(forward),
            right: f32s(right * half(camera.x_angle)),
            up: f32s(up * half(camera.y_angle)),
            size: [camera.width, camera.height],
        }
    }
    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.size[0]
    }
    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.size[1]
    }
    /// Origin and unit direction of the ray through image position (x, y) in pixels, (0, 0) the top left corner.
    #[inline(always)]
    pub fn ray<L: Lanes>(&self, x: L, y: L) -> (Vec3<L>, Vec3<L>) {
        let one = L::splat(1.0);
        let sx = x * L::splat(2.0 / self.size[0] as f32) - one;
        let sy = one - y * L::splat(2.0 / self.size[1] as f32);
        let d = Vec3::splat(self.right).mul_add(sx, Vec3::splat(self.up).mul_add(sy, Vec3::splat(self.forward)));
        (Vec3::splat(self.origin), d.normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(direction: DVec3) -> View {
        let camera = Camera {
            focal_point: DVec3::new(1.0, 2.0, 3.0),
            direction,
            width: 200,
            height: 100,
            x_angle: 90.0,
            y_angle: 60.0,
        };
        View::new(&camera, DVec3::new(1.0, 0.0, 0.0), 2.0)
    }

    fn near(a: Vec3<f32>, b: [f64; 3]) {
        let b = DVec3::from(b).normalize();
        assert!(a.lane(0).iter().zip(b.to_array()).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-6), "{a:?} {b:?}");
    }

    #[test]
    fn corners_follow_the_angles_and_z_is_up() {
        let v = view(DVec3::Y * 5.0);
        assert_eq!(v.ray(0.0f32, 0.0).0.lane(0), [0.0, 4.0, 6.0]);
        near(v.ray(100.0f32, 50.0).1, [0.0, 1.0, 0.0]);
        let tall = 30f64.to_radians().tan();
        near(v.ray(0.0f32, 0.0).1, [-1.0, 1.0, tall]);
        near(v.ray(200.0f32, 100.0).1, [1.0, 1.0, -tall]);
    }

    #[test]
    fn straight_down_and_up_have_y_up() {
        near(view(-DVec3::Z).ray(200.0f32, 50.0).1, [1.0, 0.0, -1.0]);
        let tall = 30f64.to_radians().tan();
        near(view(-DVec3::Z).ray(100.0f32, 0.0).1, [0.0, tall, -1.0]);
        near(view(DVec3::Z).ray(100.0f32, 0.0).1, [0.0, tall, 1.0]);
        near(view(DVec3::Z).ray(200.0f32, 50.0).1, [-1.0, 0.0, 1.0]);
    }
}
