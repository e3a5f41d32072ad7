//! Round meshes with exact normals: subdivided icosahedra and a bent wall.

use crate::mesh::Mesh;
use glam::{DVec3, dvec3};
use std::collections::BTreeMap;

/// A unit sphere of 20 * 4^`level` triangles: an icosahedron whose edges are halved `level` times.
pub fn sphere(level: u32) -> Mesh {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        points.extend([dvec3(a, 0.0, b), dvec3(b, a, 0.0), dvec3(0.0, b, a)].map(DVec3::normalize));
    }
    let edge = 2.0 / (1.0 + g * g).sqrt();
    let touching = |a: usize, b: usize| (points[a].distance(points[b]) - edge).abs() < 1e-6;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if touching(a, b) && touching(b, c) && touching(c, a) {
                    let outwards = points[a].dot(points[b].cross(points[c])) > 0.0;
                    triangles.push(if outwards { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..level {
        let mut middles = BTreeMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a] + points[b]).normalize());
                points.len() - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            })
            .collect();
    }
    Mesh { positions: points.clone(), triangle_normals: triangles.clone(), triangles, normals: points }
}

/// A wall bent about a vertical axis: part of a cylinder that bulges towards -y, its front. `chord` wide along x,
/// `sagitta` deep along y, `height` tall, in `strips` quads.
pub fn bent_wall(chord: f64, sagitta: f64, height: f64, strips: u32) -> Mesh {
    let radius = (0.25 * chord * chord + sagitta * sagitta) / (2.0 * sagitta);
    let half_angle = (0.5 * chord / radius).asin();
    let mut mesh = Mesh::default();
    for k in 0..=strips {
        let angle = half_angle * (2.0 * f64::from(k) / f64::from(strips) - 1.0);
        let normal = dvec3(angle.sin(), -angle.cos(), 0.0);
        mesh.normals.push(normal);
        mesh.position(normal * radius + DVec3::Y * radius);
        mesh.position(normal * radius + DVec3::Y * radius + DVec3::Z * height);
    }
    for k in 0..strips as usize {
        mesh.quad([2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1]);
        mesh.triangle_normals.extend([[k, k + 1, k + 1], [k, k + 1, k]]);
    }
    mesh
}
