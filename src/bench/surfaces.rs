//! Closed surfaces of any number of triangles: boxes, spheres with or without bumps, tori.

use crate::linear::{DMat3, DVec3};
use crate::world::Mesh;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// How high bumps are, over the radius.
const BUMP: f64 = 0.15;

/// A closed surface about the origin.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// A box.
    Box {
        /// Half its extent.
        half: DVec3,
    },
    /// A sphere.
    Sphere {
        /// Its radius, in the mean.
        radius: f64,
        /// Waves of its bumps over its radius; 0 for none.
        bumps: f64,
    },
    /// A torus about the y axis.
    Torus {
        /// From the middle to that of the tube.
        radius: f64,
        /// Radius of the tube.
        tube: f64,
    },
}

impl Shape {
    /// Its area, bumps apart.
    pub fn area(&self) -> f64 {
        match *self {
            Self::Box { half } => 8.0 * (half.x * half.y + half.y * half.z + half.z * half.x),
            Self::Sphere { radius, .. } => 2.0 * TAU * radius * radius,
            Self::Torus { radius, tube } => TAU * TAU * radius * tube,
        }
    }
    /// Radius of a sphere about it.
    pub fn reach(&self) -> f64 {
        match *self {
            Self::Box { half } => half.length(),
            Self::Sphere { radius, bumps } => radius * if bumps > 0.0 { 1.0 + BUMP } else { 1.0 },
            Self::Torus { radius, tube } => radius + tube,
        }
    }
}

/// A shape at its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    pub shape: Shape,
    pub centre: DVec3,
    /// Angles about x, then y, then z.
    pub turn: [f64; 3],
}

impl Surface {
    /// Appends about so many triangles, fronts outward, or inward where that is wanted.
    pub fn append(&self, triangles: usize, inward: bool, mesh: &mut Mesh) {
        let [x, y, z] = self.turn;
        let turn = DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
        let base = mesh.positions.len() as u32;
        let mut grid = Grid { mesh, base, inward, place: |p: DVec3| (self.centre + turn * p).as_vec3().as_dvec3() };
        match self.shape {
            Shape::Box { half } => grid.cuboid(half, triangles),
            Shape::Sphere { radius, bumps } => grid.sphere(radius, bumps, triangles),
            Shape::Torus { radius, tube } => grid.torus(radius, tube, triangles),
        }
    }
}

/// Appends to a mesh, vertex numbers counted from those that it had.
struct Grid<'a, P> {
    mesh: &'a mut Mesh,
    base: u32,
    inward: bool,
    place: P,
}

impl<P: Fn(DVec3) -> DVec3> Grid<'_, P> {
    fn point(&mut self, p: DVec3) -> u32 {
        self.mesh.positions.push((self.place)(p));
        self.mesh.positions.len() as u32 - 1 - self.base
    }
    fn triangle(&mut self, [a, b, c]: [u32; 3]) {
        let corners = if self.inward { [a, c, b] } else { [a, b, c] };
        self.mesh.triangles.push(corners.map(|i| self.base + i));
    }
    fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// Faces in squares as far as whole numbers of them go; faces share the vertices of their edges.
    fn cuboid(&mut self, half: DVec3, triangles: usize) {
        let square = (2.0 * Shape::Box { half }.area() / triangles.max(1) as f64).sqrt();
        let cells = |size: f64| (half * 2.0 / size).round().to_array().map(|n| (n as u32).max(1));
        let count = |[x, y, z]: [u32; 3]| {
            4 * [(x, y), (y, z), (z, x)].map(|(a, b)| a as usize * b as usize).iter().sum::<usize>()
        };
        // Whole numbers make too many or too few: of squares about as large, those that come nearest.
        let sizes = (0..=60).map(|k| square * (0.7 + 0.01 * f64::from(k)));
        let nearest = sizes.map(cells).min_by_key(|&cells| count(cells).abs_diff(triangles));
        let cells = nearest.unwrap_or([1; 3]);
        let mut known = HashMap::new();
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for far in [false, true] {
                for (i, j) in (0..cells[b]).flat_map(|i| (0..cells[c]).map(move |j| (i, j))) {
                    let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| {
                        let mut at = [0; 3];
                        (at[axis], at[b], at[c]) = (if far { cells[axis] } else { 0 }, i, j);
                        *known.entry(at).or_insert_with(|| {
                            let share = |k: usize| f64::from(at[k]) / f64::from(cells[k]) * 2.0 - 1.0;
                            self.point(half * DVec3::new(share(0), share(1), share(2)))
                        })
                    });
                    let [p, q, r, s] = corners;
                    self.quad(if far { [p, q, r, s] } else { [p, s, r, q] });
                }
            }
        }
    }

    /// Rings between two poles.
    fn sphere(&mut self, radius: f64, bumps: f64, triangles: usize) {
        let rings = (((1.0 + (1.0 + triangles as f64).sqrt()) / 2.0).round() as u32).max(2);
        let around = ((triangles as f64 / f64::from(2 * (rings - 1))).round() as u32).max(3);
        let at = |d: DVec3| {
            let waves = (d * bumps + DVec3::new(0.3, 1.1, 2.0)).map(f64::sin).element_product();
            d * radius * if bumps > 0.0 { 1.0 + BUMP * waves } else { 1.0 }
        };
        let top = self.point(at(DVec3::Y));
        for ring in 1..rings {
            let (sin, cos) = (PI * f64::from(ring) / f64::from(rings)).sin_cos();
            for k in 0..around {
                let (s, c) = (TAU * f64::from(k) / f64::from(around)).sin_cos();
                self.point(at(DVec3::new(sin * s, cos, sin * c)));
            }
        }
        let bottom = self.point(at(-DVec3::Y));
        for k in 0..around {
            let next = (k + 1) % around;
            let of = |ring: u32, k: u32| top + 1 + ring * around + k;
            self.triangle([top, of(0, k), of(0, next)]);
            for ring in 0..rings - 2 {
                self.quad([of(ring, k), of(ring + 1, k), of(ring + 1, next), of(ring, next)]);
            }
            self.triangle([bottom, of(rings - 2, next), of(rings - 2, k)]);
        }
    }

    fn torus(&mut self, radius: f64, tube: f64, triangles: usize) {
        let half = triangles as f64 / 2.0;
        let across = ((half * tube / radius).sqrt().round() as u32).max(3);
        let along = ((half / f64::from(across)).round() as u32).max(3);
        for i in 0..along {
            let (s, c) = (TAU * f64::from(i) / f64::from(along)).sin_cos();
            for j in 0..across {
                let (up, out) = (TAU * f64::from(j) / f64::from(across)).sin_cos();
                let r = radius + tube * out;
                self.point(DVec3::new(r * s, tube * up, r * c));
            }
        }
        let of = |i: u32, j: u32| i % along * across + j % across;
        for (i, j) in (0..along).flat_map(|i| (0..across).map(move |j| (i, j))) {
            self.quad([of(i, j), of(i + 1, j), of(i + 1, j + 1), of(i, j + 1)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Areas and volumes of fine grids are those of the shapes: fronts look outward.
    #[test]
    fn fine_grids_have_the_area_and_the_volume_of_their_shape() {
        let shapes = [
            (Shape::Box { half: DVec3::new(1.0, 2.0, 0.5) }, 8.0),
            (Shape::Sphere { radius: 1.5, bumps: 0.0 }, 2.0 / 3.0 * TAU * 1.5f64.powi(3)),
            (Shape::Torus { radius: 1.0, tube: 0.25 }, TAU * PI * 0.25 * 0.25),
        ];
        for (shape, expected) in shapes {
            let mut mesh = Mesh::default();
            let surface = Surface { shape, centre: DVec3::new(1.0, 2.0, 3.0), turn: [0.3, 0.2, 0.1] };
            surface.append(100_000, false, &mut mesh);
            let (mut area, mut volume, mut farthest) = (0.0, 0.0, 0.0f64);
            for t in &mesh.triangles {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize] - surface.centre);
                area += (b - a).cross(c - a).length() / 2.0;
                volume += a.cross(b).dot(c) / 6.0;
                farthest = farthest.max(a.length());
            }
            assert!((area / shape.area() - 1.0).abs() < 1e-3, "{shape:?}: area {area}");
            assert!((volume / expected - 1.0).abs() < 2e-3, "{shape:?}: volume {volume}");
            assert!((farthest / shape.reach() - 1.0).abs() < 1e-6, "{shape:?}: reach {farthest}");
        }
    }
}
