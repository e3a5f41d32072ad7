//! A closed room with objects in it, of any number of triangles: a mesh in which paths go on for ever.
//!
//! With 36 triangles it is a box with two boxes in it. With more the walls and the boxes get finer, and spheres, bumpy
//! spheres and tori of many sizes float in it, the more the finer it is. They touch neither each other nor a wall, and
//! leave room for the cameras and for the light of the ray sets. The walls get a quarter of the triangles, the objects
//! share the rest in proportion to their areas.

use super::camera::{Axis, candidates};
use super::mesh::Bounds;
use super::surfaces::{Shape, Surface};
use crate::linear::DVec3;
use crate::sampling::{Decision, Sampler, Xoshiro};
use crate::world::Mesh;
use std::f64::consts::TAU;

/// Triangles of the smallest room: its walls.
pub const MIN_TRIANGLES: usize = 12;
/// Triangles of the largest room that is made.
pub const MAX_TRIANGLES: usize = 1 << 30;
/// Triangles from which on there is more in the room than boxes.
const MORE_THAN_BOXES: usize = 200;
/// The walls.
const WALLS: Bounds = Bounds { lo: DVec3::new(-4.0, 0.0, -4.0), hi: DVec3::new(4.0, 5.0, 4.0) };
/// What stays free about an object, about an eye, and about the middle of the light.
const GAPS: [f64; 3] = [0.02, 0.35, 0.65];
/// Places that are tried for an object before the room counts as full.
const TRIES: u32 = 400;

/// A room of about `triangles` triangles (within [`MIN_TRIANGLES`] and [`MAX_TRIANGLES`]), the same for the same
/// numbers. Its coordinates are numbers of single precision; y points up.
pub fn room(triangles: usize, seed: u64) -> Mesh {
    let triangles = triangles.clamp(MIN_TRIANGLES, MAX_TRIANGLES);
    let objects = objects(triangles, seed);
    let mut mesh = Mesh::default();
    let walls = Shape::Box { half: WALLS.extent() * 0.5 };
    let share = if objects.is_empty() { triangles } else { triangles / 4 };
    Surface { shape: walls, centre: WALLS.centre(), turn: [0.0; 3] }.append(share, true, &mut mesh);
    // What one object takes too many or leaves over, the next ones get too few or more.
    let mut area_left: f64 = objects.iter().map(|object| object.shape.area()).sum();
    for object in objects {
        let left = triangles.saturating_sub(mesh.triangles.len()) as f64;
        let area = object.shape.area();
        object.append((left * area / area_left).round() as usize, false, &mut mesh);
        area_left -= area;
    }
    mesh
}

/// What is in a room of so many triangles.
fn objects(triangles: usize, seed: u64) -> Vec<Surface> {
    let boxes = [
        (DVec3::new(0.75, 0.75, 0.75), DVec3::new(1.3, 0.77, 1.0), -0.29),
        (DVec3::new(0.8, 1.6, 0.8), DVec3::new(-1.2, 1.62, -1.0), 0.3),
    ];
    let boxes =
        boxes.map(|(half, centre, turn)| Surface { shape: Shape::Box { half }, centre, turn: [0.0, turn, 0.0] });
    let mut objects: Vec<Surface> = boxes.into_iter().take(triangles / 12 - 1).collect();
    if triangles >= MORE_THAN_BOXES {
        let count = (0.9 * (triangles as f64 / 36.0).sqrt()).round();
        for number in 0..count as u32 {
            let size = 1.9 / count.cbrt();
            objects.extend((0..TRIES).map(|trial| object(seed, number, trial, size)).find(|o| fits(o, &objects)));
        }
    }
    objects
}

/// An object at random; each trial is another one, and later ones are smaller.
fn object(seed: u64, number: u32, trial: u32, size: f64) -> Surface {
    let mut stream = Xoshiro::start::<f32>(seed, number, trial);
    let [kind, scale, slim, x, y, z, a, b, c] =
        Xoshiro::draw::<f32, 9>(&mut stream, Decision::Scatter, 0).map(f64::from);
    let radius = size * 0.9f64.powi(trial as i32 / 8) * (1.2 * scale - 0.7).exp();
    let shape = match kind {
        k if k < 0.3 => Shape::Sphere { radius, bumps: 0.0 },
        k if k < 0.7 => Shape::Sphere { radius, bumps: 4.0 + 8.0 * slim },
        _ => Shape::Torus { radius: radius * (1.0 - 0.15 - 0.2 * slim), tube: radius * (0.15 + 0.2 * slim) },
    };
    let centre = WALLS.lo + WALLS.extent() * DVec3::new(x, y, z);
    Surface { shape, centre, turn: [a, b, c].map(|turn| TAU * turn) }
}

/// Whether an object is clear of walls, eyes, light and the others.
fn fits(object: &Surface, others: &[Surface]) -> bool {
    let [gap, eye_gap, light_gap] = GAPS;
    let (centre, reach) = (object.centre, object.shape.reach());
    let to_walls = (centre - WALLS.lo).min(WALLS.hi - centre).min_element();
    let light = WALLS.lo.midpoint(WALLS.hi).with_y(WALLS.lo.y + 0.9 * WALLS.extent().y);
    to_walls > reach + gap
        && centre.distance(light) > reach + light_gap
        && candidates(&WALLS, Axis::Y).iter().all(|view| centre.distance(view.eye) > reach + eye_gap)
        && others.iter().all(|other| centre.distance(other.centre) > reach + other.shape.reach() + gap)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn every_edge_has_two_triangles() {
        for triangles in [12, 24, 36, 100, 250, 1000, 20_000] {
            let mesh = room(triangles, 1);
            let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
            for &[a, b, c] in &mesh.triangles {
                assert!(a != b && b != c && c != a);
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    // Neighbours run along their edge in opposite directions.
                    assert_eq!(edges.insert((from, to), 1), None, "{triangles}: edge {from} {to} twice");
                }
            }
            assert!(edges.keys().all(|&(from, to)| edges.contains_key(&(to, from))), "{triangles}: an open edge");
            assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
            assert_eq!(mesh.bounds(), (WALLS.lo, WALLS.hi));
        }
    }

    #[test]
    fn there_are_about_as_many_triangles_as_asked_for() {
        for triangles in [1000, 1234, 2500, 5000, 7777, 10_000, 33_333, 100_000, 300_001, 1_000_000] {
            let found = room(triangles, 1).triangles.len() as f64;
            let error = (found / triangles as f64 - 1.0).abs();
            assert!(error < 0.1, "{found} triangles of {triangles}");
        }
        for triangles in [12, 24, 36] {
            assert_eq!(room(triangles, 1).triangles.len(), triangles);
        }
        assert_eq!(room(0, 1).triangles.len(), MIN_TRIANGLES);
    }

    /// The walls enclose the rest with their volume; all surfaces are turned the same way.
    #[test]
    fn walls_look_inward_and_objects_outward() {
        let volume = |mesh: &Mesh| -> f64 {
            let corner = |i: u32| mesh.positions[i as usize];
            mesh.triangles.iter().map(|&[a, b, c]| corner(a).cross(corner(b)).dot(corner(c)) / 6.0).sum()
        };
        assert!((volume(&room(12, 1)) + 320.0).abs() < 1e-6);
        let boxes = 8.0 * (0.75f64.powi(3) + 0.8 * 0.8 * 1.6);
        assert!((volume(&room(36, 1)) + 320.0 - boxes).abs() < 1e-5);
        let many = volume(&room(100_000, 1));
        assert!(many > -310.0 && many < -200.0, "{many}");
    }

    #[test]
    fn rooms_follow_from_their_numbers() {
        assert_eq!(room(3000, 5), room(3000, 5));
        assert_ne!(room(3000, 5).positions, room(3000, 6).positions);
        let count = |n| objects(n, 1).len();
        assert_eq!([12, 24, 36, 199].map(count), [0, 1, 2, 2]);
        assert!(count(1000) > 5 && count(1_000_000) > 120, "{} and {}", count(1000), count(1_000_000));
        let exact = |p: &DVec3| p.as_vec3().as_dvec3() == *p;
        assert!(room(3000, 5).positions.iter().all(exact), "coordinates of single precision");
    }
}
