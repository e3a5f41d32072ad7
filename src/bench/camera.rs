//! Where primary rays come from, and a choice of a camera for meshes that come without one.

use super::files::RayRecord;
use super::mesh::Bounds;
use crate::error::{Error, Result};
use crate::linear::DVec3;

/// Pixels along a side of a tile: rays go tile by tile.
const TILE: usize = 8;
/// Most pixels along a side of the image.
pub const MAX_RES: u32 = 16384;
/// Pixels along a side of the image by which a camera is chosen.
pub(super) const SMALL_RES: u32 = 64;

/// An axis of the mesh's coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    #[default]
    Y,
    /// The third.
    Z,
}

impl Axis {
    /// This axis, the next and the one after it in the cycle x, y, z, as indices.
    pub fn cycle(self) -> [usize; 3] {
        std::array::from_fn(|k| (self as usize + k) % 3)
    }
    fn unit(self) -> DVec3 {
        DVec3::AXES[self as usize]
    }
}

/// A pinhole camera with a square image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where it stands.
    pub eye: DVec3,
    /// Where it looks; any length, not zero.
    pub direction: DVec3,
    /// Angle across the image in degrees, in (0, 180).
    pub fov: f64,
}

impl View {
    /// Looks whether rays can be made from it.
    ///
    /// # Errors
    /// [`Error::Setting`] of `--camera` where a number is not finite, the direction is zero or the angle out of range.
    pub fn check(&self) -> Result<()> {
        let fault = |found: String, expected: &str| {
            Err(Error::Setting { setting: "--camera", found, expected: expected.to_owned() })
        };
        if !self.eye.is_finite() || self.eye.abs().max_element() > f64::from(f32::MAX) {
            return fault(format!("an eye at {}", self.eye), "an eye within single precision");
        }
        if self.direction.try_normalize().is_none() {
            return fault(format!("the direction {}", self.direction), "a direction with a length");
        }
        if !(self.fov > 0.0 && self.fov < 180.0) {
            return fault(format!("an angle of {} degrees", self.fov), "an angle above 0 and below 180 degrees");
        }
        Ok(())
    }

    /// A ray through the centre of each of `res` x `res` pixels, tile by tile; see [`pixel`]. `res` is a multiple of 8.
    pub fn rays(&self, res: u32, up: Axis) -> Vec<RayRecord> {
        let forward = self.direction.normalize_or_zero();
        let right = forward.cross(up.unit());
        let right = if right.length() < 1e-6 { forward.cross(next(up).unit()) } else { right }.normalize_or_zero();
        let above = right.cross(forward);
        let half = (self.fov.to_radians() * 0.5).tan();
        let origin = self.eye.as_vec3().to_array();
        let count = (res as usize).pow(2);
        let ray = |i: usize| {
            let across = pixel(i, res).map(|p| (f64::from(p) + 0.5) / f64::from(res) * 2.0 - 1.0);
            let direction = forward + right * (across[0] * half) - above * (across[1] * half);
            let direction = direction.normalize_or_zero().as_vec3().to_array();
            RayRecord { origin, t_min: 0.0, direction, t_max: f32::INFINITY }
        };
        (0..count).map(ray).collect()
    }
}

/// Column and row of the pixel of primary ray `i`: tiles of 8 x 8 pixels row by row from the top left; in a tile, blocks
/// of 4 x 2 row by row; in a block, row by row.
pub fn pixel(i: usize, res: u32) -> [u32; 2] {
    let tiles = (res as usize / TILE).max(1);
    let (tile, block, place) = (i / 64, i % 64 / 8, i % 8);
    let x = tile % tiles * TILE + block % 2 * 4 + place % 4;
    let y = tile / tiles * TILE + block / 2 * 2 + place / 4;
    [x as u32, y as u32]
}

fn next(axis: Axis) -> Axis {
    match axis {
        Axis::X => Axis::Y,
        Axis::Y => Axis::Z,
        Axis::Z => Axis::X,
    }
}

/// The eight views from near the corners of the box towards its middle, among which one is chosen.
pub fn candidates(bounds: &Bounds, up: Axis) -> [View; 8] {
    let extent = bounds.extent();
    // A flat mesh is seen from above.
    let half = extent.max(DVec3::splat(0.2 * extent.max_element())) * 0.5;
    std::array::from_fn(|corner| {
        let mut part = DVec3::ZERO;
        for (k, (axis, share)) in up.cycle().into_iter().zip([0.40, 0.86, 0.70]).enumerate() {
            part[axis] = if corner >> k & 1 == 0 { share } else { -share };
        }
        let away = part * half;
        View { eye: bounds.centre() + away, direction: -away, fov: 75.0 }
    })
}

/// The candidate whose small image shows the most distinct triangles, the first of equals. `seen` counts them among
/// what rays hit.
pub(super) fn choose(bounds: &Bounds, up: Axis, seen: impl Fn(&[RayRecord]) -> usize) -> View {
    let views = candidates(bounds, up);
    let counts = views.map(|view| seen(&view.rays(SMALL_RES, up)));
    let mut best = 0;
    for i in 1..views.len() {
        if counts[i] > counts[best] {
            best = i;
        }
    }
    views[best]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn pixels_go_by_tiles_blocks_and_rows() {
        let first: Vec<_> = (0..12).map(|i| pixel(i, 16)).collect();
        let rows = [[0, 0], [1, 0], [2, 0], [3, 0], [0, 1], [1, 1], [2, 1], [3, 1], [4, 0], [5, 0], [6, 0], [7, 0]];
        assert_eq!(first, rows);
        assert_eq!([16, 63, 64, 128].map(|i| pixel(i, 16)), [[0, 2], [7, 7], [8, 0], [0, 8]]);
        let all: HashSet<_> = (0..24 * 24).map(|i| pixel(i, 24)).collect();
        assert_eq!(all.len(), 24 * 24);
        assert!(all.iter().flatten().all(|&p| p < 24));
    }

    /// Corners of the image stand where the angle and the axes say.
    #[test]
    fn the_image_is_upright_and_has_its_angle() {
        let view = View { eye: DVec3::new(1.0, 2.0, 3.0), direction: DVec3::new(0.0, 0.0, -5.0), fov: 90.0 };
        let rays = view.rays(16, Axis::Y);
        assert_eq!((rays.len(), rays[0].origin, rays[0].t_max), (256, [1.0, 2.0, 3.0], f32::INFINITY));
        // The centre of the first pixel is 15/16 of the way to the edge.
        let expected = DVec3::new(-15.0, 15.0, -16.0).normalize().as_vec3().to_array();
        for (found, expected) in rays[0].direction.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{rays:?}");
        }
        // Looking along the up axis still gives an image.
        let down = View { direction: DVec3::new(0.0, -1.0, 0.0), ..view };
        assert!(down.rays(8, Axis::Y).iter().all(|r| r.direction[1] < -0.5));
        assert_ne!(down.rays(8, Axis::Y)[0].direction, down.rays(8, Axis::Y)[63].direction);
    }

    #[test]
    fn candidates_are_the_documented_ones_and_the_first_of_equals_wins() {
        let bounds = Bounds { lo: DVec3::ZERO, hi: DVec3::new(2.0, 4.0, 0.1) };
        let views = candidates(&bounds, Axis::Y);
        // Half extents 1, 2 and, being below 0.2 of 4, 0.4.
        assert!(views[0].eye.abs_diff_eq(DVec3::new(1.70, 2.80, 0.05 + 0.86 * 0.4), 1e-12), "{}", views[0].eye);
        assert!(views[1].eye.abs_diff_eq(DVec3::new(1.70, 1.20, 0.05 + 0.86 * 0.4), 1e-12));
        assert!(views[2].eye.abs_diff_eq(DVec3::new(1.70, 2.80, 0.05 - 0.86 * 0.4), 1e-12));
        assert!(views[4].eye.abs_diff_eq(DVec3::new(0.30, 2.80, 0.05 + 0.86 * 0.4), 1e-12));
        assert_eq!(choose(&bounds, Axis::Y, |_| 3), views[0]);
        let wanted = views[5].eye.as_vec3().to_array();
        assert_eq!(choose(&bounds, Axis::Y, |rays| usize::from(rays[0].origin == wanted)), views[5]);
    }

    #[test]
    fn views_without_rays_are_refused() {
        let view = View { eye: DVec3::ZERO, direction: DVec3::X, fov: 75.0 };
        assert!(view.check().is_ok());
        for wrong in [
            View { eye: DVec3::NAN, ..view },
            View { eye: DVec3::splat(1e39), ..view },
            View { direction: DVec3::ZERO, ..view },
            View { direction: DVec3::INFINITY, ..view },
            View { fov: 0.0, ..view },
            View { fov: 180.0, ..view },
            View { fov: f64::NAN, ..view },
        ] {
            let text = wrong.check().unwrap_err().to_string();
            assert!(text.starts_with("--camera: found "), "{text}");
        }
    }
}
