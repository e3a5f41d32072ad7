//! The mesh that rays are made for: corners of triangles in the order of their file, and the box about them.

use crate::error::Result;
use crate::linear::DVec3;
use crate::scene;
use crate::world::Mesh;
use std::io::{self, Write};
use std::path::Path;

/// Corners of triangles, as the tree takes them.
pub type Corners = Vec<[[f32; 3]; 3]>;

/// Reads the triangles of an OBJ file, all objects and groups in their order, polygons as fans. Triangles without area
/// keep their place, so that a triangle's number is that of its face.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) where the file cannot be read, [`Error::Scene`](crate::Error::Scene) with its mistakes.
pub fn load(path: &Path) -> Result<Corners> {
    Ok(corners(&scene::load_mesh(path)?))
}

/// The corners of a mesh, rounded to f32. Triangles that name a position which is not there are left out.
pub fn corners(mesh: &Mesh) -> Corners {
    let point = |i: u32| mesh.positions.get(i as usize).map(|p| p.as_vec3().to_array());
    mesh.triangles.iter().filter_map(|&[a, b, c]| Some([point(a)?, point(b)?, point(c)?])).collect()
}

/// Writes the positions, rounded to f32, and the triangles of a mesh as an OBJ file: `v` and `f` lines alone.
///
/// # Errors
/// What `out` says. It is written to in small pieces.
pub fn write_obj(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    for p in &mesh.positions {
        let [x, y, z] = p.as_vec3().to_array();
        writeln!(out, "v {x} {y} {z}")?;
    }
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|i| u64::from(i) + 1)) {
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// The normal of a triangle at length 1, zero where the triangle has no area.
pub(super) fn normal(corners: &[[f32; 3]; 3]) -> DVec3 {
    let [a, b, c] = corners.map(vector);
    (b - a).cross(c - a).normalize_or_zero()
}

/// A point or direction in f64.
pub(super) fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// The axis-aligned box about triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Corner with the smallest coordinates.
    pub lo: DVec3,
    /// Corner with the largest coordinates.
    pub hi: DVec3,
}

impl Bounds {
    /// The box about `corners`; of no triangles, the origin.
    pub fn of(corners: &[[[f32; 3]; 3]]) -> Self {
        let mut points = corners.iter().flatten().map(|&p| vector(p));
        let first = points.next().unwrap_or_default();
        let (lo, hi) = points.fold((first, first), |(lo, hi), p| (lo.min(p), hi.max(p)));
        Self { lo, hi }
    }
    /// Its middle.
    pub fn centre(&self) -> DVec3 {
        (self.lo + self.hi) * 0.5
    }
    /// How long it is along each axis.
    pub fn extent(&self) -> DVec3 {
        self.hi - self.lo
    }
    /// How far spawned rays start off a surface: more than the rounding error of any tracer.
    pub fn offset(&self) -> f64 {
        1e-4 * self.extent().length() + 1e-6 * self.lo.abs().max(self.hi.abs()).max_element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_without_area_keep_their_number() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        let text = "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 4\ng a\nf 1 1 2\ng b\nf 1 2 3 4\n";
        std::fs::write(&path, text).unwrap();
        let corners = load(&path).unwrap();
        let [a, b, c, d] = [[0.0; 3], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0], [0.0, 3.0, 4.0]];
        assert_eq!(corners, [[a, a, b], [a, b, c], [a, c, d]]);
        assert_eq!(normal(&corners[0]), DVec3::ZERO);
        assert_eq!(normal(&corners[1]), DVec3::Z);
        let bounds = Bounds::of(&corners);
        assert_eq!((bounds.centre(), bounds.extent()), (DVec3::new(1.0, 1.5, 2.0), DVec3::new(2.0, 3.0, 4.0)));
        assert!((bounds.offset() - (1e-4 * 29f64.sqrt() + 4e-6)).abs() < 1e-12);
    }
}
