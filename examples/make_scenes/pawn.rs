//! A chess pawn, turned on a lathe.

use crate::mesh::Mesh;
use glam::{DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Steps around the axis.
const AROUND: usize = 56;

/// A smooth stretch of the profile, a cubic Bezier curve of (distance from the axis, height), and its steps.
struct Piece(usize, [DVec2; 4]);

impl Piece {
    /// Position and outward unit normal at `t` in [0, 1].
    fn at(&self, t: f64) -> (DVec2, DVec2) {
        let [a, b, c, d] = self.1;
        let s = 1.0 - t;
        let position = a * (s * s * s) + b * (3.0 * s * s * t) + c * (3.0 * s * t * t) + d * (t * t * t);
        let tangent = (b - a) * (s * s) + (c - b) * (2.0 * s * t) + (d - c) * (t * t);
        (position, dvec2(tangent.y, -tangent.x).normalize())
    }
}

/// The profile from the middle of the foot to the top of the head. Where one piece ends and the next starts in
/// another direction there is a crease.
fn profile() -> Vec<Piece> {
    let p = dvec2;
    // Two arcs make the head; a control point lies `reach(angle)` radii from the end of an arc of that angle.
    let reach = |angle: f64| 4.0 / 3.0 * (0.25 * angle).tan();
    let (neck, head, centre) = (0.15_f64, 0.255, 1.425);
    let below = (neck / head).acos();
    let chin = centre - head * below.sin();
    let jaw = dvec2(centre - chin, neck) * reach(below);
    let (low, high) = (head * reach(below), head * reach(FRAC_PI_2));
    vec![
        Piece(1, [p(0.0, 0.0), p(0.15, 0.0), p(0.31, 0.0), p(0.46, 0.0)]),
        Piece(9, [p(0.46, 0.0), p(0.525, 0.0), p(0.525, 0.17), p(0.445, 0.18)]),
        Piece(8, [p(0.445, 0.18), p(0.375, 0.19), p(0.36, 0.235), p(0.345, 0.265)]),
        Piece(5, [p(0.345, 0.265), p(0.385, 0.27), p(0.385, 0.325), p(0.33, 0.335)]),
        Piece(10, [p(0.33, 0.335), p(0.2, 0.4), p(0.155, 0.62), p(0.14, 1.06)]),
        Piece(5, [p(0.14, 1.06), p(0.19, 1.065), p(0.29, 1.08), p(0.29, 1.115)]),
        Piece(5, [p(0.29, 1.115), p(0.29, 1.15), p(0.2, 1.165), p(neck, chin)]),
        Piece(6, [p(neck, chin), p(neck, chin) + jaw, p(head, centre - low), p(head, centre)]),
        Piece(9, [p(head, centre), p(head, centre + high), p(high, centre + head), p(0.0, centre + head)]),
    ]
}

/// The pawn: its axis is z, its foot stands on z = 0, the foot is about 1 across. Closed.
pub fn pawn() -> Mesh {
    let mut mesh = Mesh::default();
    let turn = |p: DVec2, i: usize| {
        let (sin, cos) = (TAU * i as f64 / AROUND as f64).sin_cos();
        dvec3(p.x * cos, p.x * sin, p.y)
    };
    let mut ring = Ring::new(&mut mesh, DVec2::ZERO, turn);
    for piece in profile() {
        let mut normals = ring_normals(&mut mesh, piece.at(0.0).1, turn);
        for step in 1..=piece.0 {
            let (point, normal) = piece.at(step as f64 / piece.0 as f64);
            let next = Ring::new(&mut mesh, point, turn);
            let next_normals = ring_normals(&mut mesh, normal, turn);
            for i in 0..AROUND {
                let j = (i + 1) % AROUND;
                let (a, b, c, d) = (ring.at(i), ring.at(j), next.at(j), next.at(i));
                let (na, nb, nc, nd) = (normals + i, normals + j, next_normals + j, next_normals + i);
                // At the two poles one side of the quad is a point, and one triangle remains.
                if a != b {
                    mesh.triangles.push([a, b, c]);
                    mesh.triangle_normals.push([na, nb, nc]);
                }
                if c != d {
                    mesh.triangles.push([a, c, d]);
                    mesh.triangle_normals.push([na, nc, nd]);
                }
            }
            (ring, normals) = (next, next_normals);
        }
    }
    mesh
}

/// The vertices at one height: a circle, or a single one on the axis.
struct Ring {
    first: usize,
    on_axis: bool,
}

impl Ring {
    fn new(mesh: &mut Mesh, p: DVec2, turn: impl Fn(DVec2, usize) -> DVec3) -> Self {
        let ring = Self { first: mesh.positions.len(), on_axis: p.x < 1e-9 };
        mesh.positions.extend((0..if ring.on_axis { 1 } else { AROUND }).map(|i| turn(p, i)));
        ring
    }

    fn at(&self, i: usize) -> usize {
        if self.on_axis { self.first } else { self.first + i }
    }
}

/// Adds the normals around one circle and gives the index of the first.
fn ring_normals(mesh: &mut Mesh, n: DVec2, turn: impl Fn(DVec2, usize) -> DVec3) -> usize {
    let first = mesh.normals.len();
    mesh.normals.extend((0..AROUND).map(|i| turn(n, i)));
    first
}
