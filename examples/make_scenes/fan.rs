//! Ten triangles at ten angles.

use crate::mesh::Mesh;
use glam::dvec3;

/// Width of the base of each triangle; they stand 1 apart.
const WIDTH: f64 = 0.9;
/// Height of each triangle.
const HEIGHT: f64 = 3.0;

/// Ten upright triangles side by side along x, their tips up. The k-th is turned by 10 k degrees about its own
/// vertical axis: the first faces +x, the last -y, towards the viewer, and those between face both.
pub fn fan() -> Mesh {
    let mut mesh = Mesh::default();
    for k in 0..10 {
        let (sin, cos) = (10.0 * f64::from(k)).to_radians().sin_cos();
        let foot = dvec3(f64::from(k) - 4.5, 0.0, 0.0);
        // The normal is (cos, -sin, 0), so this is the direction to the right as seen from the front.
        let right = dvec3(sin, cos, 0.0) * (0.5 * WIDTH);
        let corners = [foot - right, foot + right, foot + dvec3(0.0, 0.0, HEIGHT)].map(|p| mesh.position(p));
        mesh.triangles.push(corners);
    }
    mesh
}
