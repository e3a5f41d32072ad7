//! Meshes: in code, and those of the repository.

use glam::DVec3;
use std::collections::HashMap;
use std::path::PathBuf;
use wavetrace::world::Mesh;

/// Corners of triangles, as the tree takes them.
pub type Soup = Vec<[[f32; 3]; 3]>;

pub fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A parallelogram from corner `a` along `u` and `v`; its front looks along `u` x `v`.
pub fn quad(a: DVec3, u: DVec3, v: DVec3) -> Mesh {
    Mesh { positions: vec![a, a + u, a + u + v, a + v], triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
}

/// A rectangle at height `z` about (x, y), its front up.
pub fn patch(x: f64, y: f64, z: f64, wide: f64, deep: f64) -> Mesh {
    quad(v(x - wide / 2.0, y - deep / 2.0, z), v(wide, 0.0, 0.0), v(0.0, deep, 0.0))
}

/// Several meshes without normals as one.
pub fn join(parts: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    for part in parts {
        let base = all.positions.len() as u32;
        all.positions.extend(&part.positions);
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|i| i + base)));
    }
    all
}

/// A closed box, fronts outward.
pub fn cuboid(lo: DVec3, hi: DVec3) -> Mesh {
    let positions = (0..8).map(|i| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), hi, lo)).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

/// A mesh with its fronts turned.
pub fn inverted(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.triangle_normals.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.normals.iter_mut().for_each(|n| *n = -*n);
    mesh
}

/// A mesh turned about z by `degrees`.
pub fn turned(mut mesh: Mesh, degrees: f64) -> Mesh {
    let turn = glam::DMat3::from_rotation_z(degrees.to_radians());
    mesh.positions.iter_mut().chain(&mut mesh.normals).for_each(|p| *p = turn * *p);
    mesh
}

/// A sphere of 20 * 4^`level` triangles, an icosahedron whose edges were halved `level` times; fronts outward.
pub fn sphere(centre: DVec3, radius: f64, level: u32, smooth: bool) -> Mesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        points.extend([v(0.0, a, b), v(a, b, 0.0), v(b, 0.0, a)]);
    }
    let near = |i: usize, j: usize| (points[i].distance(points[j]) - 2.0).abs() < 1e-9;
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(i, k) {
                    let out = (points[j] - points[i]).cross(points[k] - points[i]).dot(points[i]) > 0.0;
                    faces.push(if out { [i, j, k] } else { [i, k, j] }.map(|n| n as u32));
                }
            }
        }
    }
    points.iter_mut().for_each(|p| *p = p.normalize());
    for _ in 0..level {
        let mut middle: HashMap<(u32, u32), u32> = HashMap::new();
        let mut finer = Vec::with_capacity(faces.len() * 4);
        for [a, b, c] in faces {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                *middle.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    points.push((points[p as usize] + points[q as usize]).normalize());
                    points.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = finer;
    }
    let positions = points.iter().map(|&p| centre + p * radius).collect();
    let (normals, triangle_normals) = if smooth { (points, faces.clone()) } else { (Vec::new(), Vec::new()) };
    Mesh { positions, triangles: faces, normals, triangle_normals }
}

/// Area of a triangle of a mesh.
pub fn area(mesh: &Mesh, t: usize) -> f64 {
    let [a, b, c] = mesh.triangles[t].map(|i| mesh.positions[i as usize]);
    0.5 * (b - a).cross(c - a).length()
}

/// The corners of a mesh, rounded.
pub fn soup(mesh: &Mesh) -> Soup {
    mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize].as_vec3().to_array())).collect()
}

/// A folder or file of the repository.
pub fn repository(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Positions and triangles of a mesh of the repository.
pub fn example(name: &str) -> Mesh {
    let text = std::fs::read_to_string(repository("meshes").join(name).with_extension("obj")).unwrap();
    let mut mesh = Mesh::default();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => mesh.positions.push(DVec3::from_slice(&words.map(|w| w.parse().unwrap()).collect::<Vec<_>>())),
            Some("f") => {
                let first = |w: &str| w.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                let corners: Vec<u32> = words.map(first).collect();
                mesh.triangles.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]));
            }
            _ => {}
        }
    }
    mesh
}
