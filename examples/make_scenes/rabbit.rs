//! A sitting rabbit, modelled from ellipsoids and round cones that melt into each other.

use crate::{mesh::Mesh, surface_nets};
use glam::{DMat3, DVec3, dvec3};

/// The rabbit: its nose points to +x, it sits on z = 0 and is about 1.9 tall with its ears. Closed.
pub fn rabbit() -> Mesh {
    surface_nets::surface(field, dvec3(-1.0125, -0.7125, -0.11), dvec3(0.9, 0.7125, 2.1), CELL)
}

/// Width of a grid cell: decides the number of triangles.
const CELL: f64 = 0.0375;

/// Negative inside, positive outside, roughly the distance to the surface.
fn field(p: DVec3) -> f64 {
    // The left half is the right one seen in a mirror.
    let p = dvec3(p.x, p.y.abs(), p.z);
    let mut d = ellipsoid(p, dvec3(-0.25, 0.0, 0.44), dvec3(0.46, 0.38, 0.42));
    d = melt(d, tilted(p, dvec3(0.12, 0.0, 0.58), dvec3(0.30, 0.27, 0.46), 22.0), 0.2);
    let haunch = tilted(p, dvec3(-0.18, 0.29, 0.34), dvec3(0.34, 0.17, 0.28), -25.0);
    d = melt(d, haunch, 0.05);
    d = melt(d, round_cone(p, dvec3(-0.28, 0.34, 0.08), dvec3(0.24, 0.36, 0.07), 0.10, 0.085), 0.12);
    d = melt(d, round_cone(p, dvec3(0.26, 0.12, 0.5), dvec3(0.36, 0.13, 0.1), 0.13, 0.075), 0.06);
    d = melt(d, ellipsoid(p, dvec3(0.42, 0.135, 0.065), dvec3(0.12, 0.085, 0.07)), 0.04);
    d = melt(d, ellipsoid(p, dvec3(-0.74, 0.0, 0.3), dvec3(0.16, 0.15, 0.16)), 0.05);
    d = melt(d, head(p), 0.12);
    d = melt(d, ear(p), 0.1);
    // Sits on the floor.
    -melt(-d, p.z, 0.04)
}

fn head(p: DVec3) -> f64 {
    let mut d = tilted(p, dvec3(0.34, 0.0, 1.1), dvec3(0.29, 0.215, 0.23), 20.0);
    d = melt(d, ellipsoid(p, dvec3(0.53, 0.0, 1.02), dvec3(0.15, 0.12, 0.12)), 0.12);
    d = melt(d, ellipsoid(p, dvec3(0.42, 0.12, 0.99), dvec3(0.13, 0.1, 0.1)), 0.1);
    d = melt(d, ellipsoid(p, dvec3(0.61, 0.055, 0.99), dvec3(0.07, 0.06, 0.055)), 0.03);
    d = melt(d, ellipsoid(p, dvec3(0.672, 0.0, 1.05), dvec3(0.035, 0.04, 0.03)), 0.025);
    let socket = ellipsoid(p, dvec3(0.445, 0.215, 1.165), dvec3(0.085, 0.055, 0.075));
    d = -melt(-d, socket, 0.06);
    melt(d, ellipsoid(p, dvec3(0.435, 0.147, 1.16), dvec3(0.06, 0.055, 0.055)), 0.045)
}

/// A long leaf, hollow towards the front.
fn ear(p: DVec3) -> f64 {
    let long = dvec3(-0.3, 0.2, 0.95).normalize();
    let front = dvec3(0.8, 0.6, 0.2).reject_from(long).normalize();
    let frame = DMat3::from_cols(front, long.cross(front), long);
    let q = frame.transpose() * (p - dvec3(0.14, 0.155, 1.62));
    // The tip leans back.
    let q = q + dvec3(0.22 * q.z * q.z, 0.0, 0.0);
    let leaf = ellipsoid(q, DVec3::ZERO, dvec3(0.09, 0.14, 0.42));
    let hollow = ellipsoid(q, dvec3(0.115, 0.0, 0.0), dvec3(0.085, 0.075, 0.31));
    -melt(-leaf, hollow, 0.06)
}

/// Smooth minimum: the union of two bodies, with a fillet about `k` wide.
fn melt(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - 0.25 * h * h * k
}

fn ellipsoid(p: DVec3, centre: DVec3, radii: DVec3) -> f64 {
    let q = p - centre;
    let (k, l) = ((q / radii).length(), (q / (radii * radii)).length());
    if l < 1e-9 { -radii.min_element() } else { k * (k - 1.0) / l }
}

/// An ellipsoid whose nose (+x end) is lowered by `degrees`.
fn tilted(p: DVec3, centre: DVec3, radii: DVec3, degrees: f64) -> f64 {
    let turn = DMat3::from_rotation_y(-degrees.to_radians());
    ellipsoid(turn * (p - centre), DVec3::ZERO, radii)
}

/// The hull of two spheres, roughly: a segment whose radius goes from `ra` at `a` to `rb` at `b`.
fn round_cone(p: DVec3, a: DVec3, b: DVec3, ra: f64, rb: f64) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t) - (ra + (rb - ra) * t)
}
