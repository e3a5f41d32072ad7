//! A closed mesh of the surface where a function is zero: naive surface nets, vertices then moved onto the surface.

use crate::mesh::Mesh;
use glam::{DVec3, dvec3};

/// The surface of `field` (negative inside) between `low` and `high`, on a grid of cells `cell` wide. The surface
/// has to stay off the border of that box. Normals are the gradient of `field`.
pub fn surface(field: impl Fn(DVec3) -> f64, low: DVec3, high: DVec3, cell: f64) -> Mesh {
    let counts = ((high - low) / cell).ceil().as_usizevec3() + 1;
    let strides = [1, counts.x, counts.x * counts.y];
    let place = |i: usize| {
        let (x, y, z) = (i % counts.x, i / counts.x % counts.y, i / strides[2]);
        low + dvec3(x as f64, y as f64, z as f64) * cell
    };
    let values: Vec<f64> = (0..strides[2] * counts.z).map(|i| field(place(i))).collect();
    let gradient = |p: DVec3, step: f64| {
        DVec3::from(DVec3::AXES.map(|axis| (field(p + axis * step) - field(p - axis * step)) / (2.0 * step)))
    };
    // Newton's method along the gradient, no farther than `reach` along each axis.
    let onto_surface = |start: DVec3, reach: f64| {
        (0..4).fold(start, |p, _| {
            let slope = gradient(p, 1e-4);
            (p - slope * (field(p) / slope.length_squared())).clamp(start - reach, start + reach)
        })
    };

    let mut mesh = Mesh::default();
    let mut vertex_of_cell = vec![usize::MAX; values.len()];
    let last = |i: usize| {
        i % counts.x + 1 == counts.x || i / counts.x % counts.y + 1 == counts.y || i / strides[2] + 1 == counts.z
    };
    for i in (0..values.len()).filter(|&i| !last(i)) {
        if let Some(middle) = mean_crossing(&values, i, strides) {
            vertex_of_cell[i] = mesh.position(onto_surface(place(i) + middle * cell, 0.4 * cell));
        }
    }
    let mut quads = Vec::new();
    for i in (0..values.len()).filter(|&i| !last(i)) {
        for axis in 0..3 {
            let (a, b, c) = (strides[axis], strides[(axis + 1) % 3], strides[(axis + 2) % 3]);
            let (inside, inside_next) = (values[i] < 0.0, values[i + a] < 0.0);
            if inside != inside_next {
                let quad = [i - b - c, i - c, i, i - b].map(|cell| vertex_of_cell[cell]);
                let [p, q, r, s] = quad;
                quads.push(if inside { quad } else { [s, r, q, p] });
            }
        }
    }

    // Vertices on a border of their cell make slivers: spread them, then put them back onto the surface.
    for _ in 0..2 {
        let mut sums = vec![(DVec3::ZERO, 0.0); mesh.positions.len()];
        for quad in &quads {
            for k in 0..4 {
                let (sum, count) = &mut sums[quad[k]];
                *sum += mesh.positions[quad[(k + 1) % 4]];
                *count += 1.0;
            }
        }
        for (p, (sum, count)) in mesh.positions.iter_mut().zip(sums) {
            *p = onto_surface(0.5 * (*p + sum / count), 0.4 * cell);
        }
    }

    // A step as wide as half a cell keeps the normal true to the triangles where the surface bends sharply.
    mesh.normals = mesh.positions.iter().map(|&p| gradient(p, 0.5 * cell).normalize()).collect();
    for mut q in quads {
        // The shorter diagonal makes the better pair of triangles.
        let length = |k: usize, l: usize| mesh.positions[q[k]].distance(mesh.positions[q[l]]);
        if length(1, 3) < length(0, 2) - 1e-9 {
            q.rotate_left(1);
        }
        mesh.quad(q);
    }
    mesh.triangle_normals = mesh.triangles.clone();
    mesh
}

/// Mean of the points where the edges of cell `i` cross zero, in cell widths from its low corner; none where no edge
/// does.
fn mean_crossing(values: &[f64], i: usize, strides: [usize; 3]) -> Option<DVec3> {
    let (mut sum, mut count) = (DVec3::ZERO, 0);
    for axis in 0..3 {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        for (at_b, at_c) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let from = i + at_b * strides[b] + at_c * strides[c];
            let (v, w) = (values[from], values[from + strides[axis]]);
            if (v < 0.0) != (w < 0.0) {
                let crossing = [(axis, v / (v - w)), (b, at_b as f64), (c, at_c as f64)];
                for (k, value) in crossing {
                    sum[k] += value;
                }
                count += 1;
            }
        }
    }
    (count > 0).then(|| sum / f64::from(count))
}
