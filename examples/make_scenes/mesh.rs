//! A triangle mesh and its OBJ text.

use crate::text::triple;
use glam::DVec3;
use std::fmt::Write;

/// Triangles, counter-clockwise seen from the front, with optional vertex normals.
#[derive(Clone, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// Three indices into `positions` per triangle.
    pub triangles: Vec<[usize; 3]>,
    /// Unit vertex normals; empty for a flat mesh.
    pub normals: Vec<DVec3>,
    /// Three indices into `normals` per triangle; empty for a flat mesh.
    pub triangle_normals: Vec<[usize; 3]>,
}

impl Mesh {
    /// Adds a position and gives its index.
    pub fn position(&mut self, p: DVec3) -> usize {
        self.positions.push(p);
        self.positions.len() - 1
    }

    /// Adds a flat quad: four corners, counter-clockwise seen from the front.
    pub fn quad(&mut self, [a, b, c, d]: [usize; 4]) {
        self.triangles.push([a, b, c]);
        self.triangles.push([a, c, d]);
    }

    /// The same surface with front and back exchanged (flat meshes only).
    pub fn flipped(mut self) -> Self {
        assert!(self.normals.is_empty());
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
        self
    }

    /// The OBJ file, led by `comment`.
    pub fn to_obj(&self, comment: &str) -> String {
        let mut text = format!("# {comment}\n");
        for &p in &self.positions {
            let _ = writeln!(text, "v {}", triple(p));
        }
        for &n in &self.normals {
            let _ = writeln!(text, "vn {}", triple(n));
        }
        for (i, &[a, b, c]) in self.triangles.iter().enumerate() {
            let _ = match self.triangle_normals.get(i) {
                Some(&[k, l, m]) => {
                    writeln!(text, "f {}//{} {}//{} {}//{}", a + 1, k + 1, b + 1, l + 1, c + 1, m + 1)
                }
                None => writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1),
            };
        }
        text
    }
}
