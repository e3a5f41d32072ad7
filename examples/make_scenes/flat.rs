//! Flat-sided meshes: rectangles, ceilings with holes, boxes, rulings.

use crate::mesh::Mesh;
use glam::{DVec3, dvec3};

/// A rectangle in the plane z = 0, centred, facing +z.
pub fn rectangle(width: f64, depth: f64) -> Mesh {
    let (x, y) = (0.5 * width, 0.5 * depth);
    grid(&[-x, x], &[-y, y], |_, _| true)
}

/// A rectangle in the plane z = 0 facing +z, `width` by `depth` and centred, with rectangular holes given as
/// (x from, x to, y from, y to). Neighbouring cells share their vertices, so that no ray slips between them.
pub fn rectangle_with_holes(width: f64, depth: f64, holes: &[[f64; 4]]) -> Mesh {
    let cuts = |half: f64, from: usize| {
        let mut at = vec![-half, half];
        at.extend(holes.iter().flat_map(|hole| [hole[from], hole[from + 1]]));
        at.sort_by(f64::total_cmp);
        at.dedup();
        at
    };
    let inside = |x: f64, y: f64| holes.iter().any(|h| h[0] < x && x < h[1] && h[2] < y && y < h[3]);
    grid(&cuts(0.5 * width, 0), &cuts(0.5 * depth, 2), |x, y| !inside(x, y))
}

/// Rectangles in the plane z = 0 facing +z, given as (x from, x to, y from, y to), that have no vertex in common.
pub fn rectangles(all: &[[f64; 4]]) -> Mesh {
    let mut mesh = Mesh::default();
    for &[x0, x1, y0, y1] in all {
        let corners = [dvec3(x0, y0, 0.0), dvec3(x1, y0, 0.0), dvec3(x1, y1, 0.0), dvec3(x0, y1, 0.0)];
        let corners = corners.map(|p| mesh.position(p));
        mesh.quad(corners);
    }
    mesh
}

/// The cells between the grid lines `xs` and `ys` whose centre passes `keep`, in the plane z = 0, facing +z.
fn grid(xs: &[f64], ys: &[f64], keep: impl Fn(f64, f64) -> bool) -> Mesh {
    let mut mesh = Mesh::default();
    for &y in ys {
        for &x in xs {
            mesh.position(dvec3(x, y, 0.0));
        }
    }
    for (j, y) in ys.windows(2).enumerate() {
        for (i, x) in xs.windows(2).enumerate() {
            if keep(0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])) {
                let a = j * xs.len() + i;
                mesh.quad([a, a + 1, a + 1 + xs.len(), a + xs.len()]);
            }
        }
    }
    mesh
}

/// An axis-aligned box of the given size, centred, facing outwards.
pub fn block(size: DVec3) -> Mesh {
    let mut mesh = Mesh::default();
    for k in 0..8 {
        let corner = dvec3(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2 & 1));
        mesh.position((corner - 0.5) * size);
    }
    for quad in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        mesh.quad(quad);
    }
    mesh
}

/// Every second one of the stripes along y that rule a `width` by `depth` rectangle, the first of them at the low
/// end of x; facing +z.
pub fn ruling(width: f64, depth: f64, stripes: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let stripe = width / f64::from(stripes);
    for k in (0..stripes).step_by(2) {
        let (x, y) = (stripe * f64::from(k) - 0.5 * width, 0.5 * depth);
        let corners = [dvec3(x, -y, 0.0), dvec3(x + stripe, -y, 0.0), dvec3(x + stripe, y, 0.0), dvec3(x, y, 0.0)];
        let corners = corners.map(|p| mesh.position(p));
        mesh.quad(corners);
    }
    mesh
}
