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
    /// Where the rays start.
    pub fn origin(&self) -> [f32; 3] {
        self.origin
    }
    /// One over the solid angle of a pixel seen in a unit direction from the camera: 1 / (its area at distance 1 along the
    /// axis, times the cubed cosine with the axis).
    #[inline(always)]
    pub fn pixel_density<L: Lanes>(&self, direction: Vec3<L>) -> L {
        let length = |v: [f32; 3]| v.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
        let area = 4.0 * length(self.right) * length(self.up) / (f64::from(self.size[0]) * f64::from(self.size[1]));
        let cos = direction.dot(Vec3::splat(self.forward)).max(L::splat(f32::MIN_POSITIVE));
        L::splat((1.0 / area) as f32) / (cos * cos * cos)
    }
    /// Pixel across and down through which a direction from the camera passes, and whether there is one.
    #[inline(always)]
    pub fn pixel<L: Lanes>(&self, direction: Vec3<L>) -> ([L; 2], L::Mask) {
        let one = L::splat(1.0);
        let depth = direction.dot(Vec3::splat(self.forward));
        let inverse = one / depth.max(L::splat(f32::MIN_POSITIVE));
        // `right` and `up` are as long as half the image is wide and high at distance 1.
        let at = direction * inverse;
        let [width, height] = self.size.map(|side| side as f32);
        let x = (share(at, self.right) + one) * L::splat(0.5 * width);
        let y = (one - share(at, self.up)) * L::splat(0.5 * height);
        ([x, y], within(x, width) & within(y, height) & depth.gt(L::splat(0.0)))
    }
}

/// Component of a point along an axis, in lengths of the axis.
#[inline(always)]
fn share<L: Lanes>(point: Vec3<L>, axis: [f32; 3]) -> L {
    let length2: f32 = axis.iter().map(|c| c * c).sum();
    point.dot(Vec3::splat(axis)) * L::splat(1.0 / length2)
}

/// Whether a number lies in [0, `size`).
#[inline(always)]
fn within<L: Lanes>(v: L, size: f32) -> L::Mask {
    L::splat(0.0).le(v) & v.lt(L::splat(size))
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
    fn directions_lead_back_to_their_pixels() {
        let v = view(DVec3::new(0.3, 5.0, -0.7));
        for (x, y) in [(0.5, 0.5), (199.5, 99.5), (100.0, 3.25), (17.75, 60.5)] {
            let direction = v.ray(x, y).1;
            let ([px, py], inside) = v.pixel(direction * 3.0);
            assert!(inside && (px - x).abs() < 1e-3 && (py - y).abs() < 1e-3, "({x}, {y}): ({px}, {py})");
            // The solid angle of a small square about the point, by its corners.
            let h = 0.05;
            let [a, b, c] = [(x - h, y - h), (x + h, y - h), (x - h, y + h)].map(|(x, y)| v.ray(x, y).1);
            let solid = f64::from((b - a).cross(c - a).length2()).sqrt() / f64::from(4.0 * h * h);
            let density = f64::from(v.pixel_density(direction));
            assert!((solid * density - 1.0).abs() < 1e-2, "({x}, {y}): {solid} and {density}");
        }
        for outside in [v.ray(-1.0, 50.0).1, v.ray(100.0, 101.0).1, -v.ray(100.0, 50.0).1] {
            assert!(!v.pixel(outside).1);
        }
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
