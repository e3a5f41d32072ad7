//! Paths through glass as textbooks trace them: f32, brute force, rays that start a fixed distance on.

use crate::common::meshes::Soup;
use crate::common::random::Random;
use crate::textbook::{Point, along, cross, dot, nearest, sub, unit};
use wavetrace::material::fresnel_dielectric;

/// How far on rays start.
pub const EPSILON: f32 = 1e-4;

/// How a path knows that it is in the glass.
#[derive(Clone, Copy)]
pub enum Side {
    /// By the triangle's front.
    Front,
    /// By counting crossings from outside.
    Counted,
}

/// Follows a path through triangles of glass of index `glass`, of which those from number `opaque` on absorb it. Its
/// last direction, or none where it was absorbed; and by how much crossings scaled radiance.
pub fn walk(
    soup: &Soup,
    glass: f32,
    opaque: usize,
    side: Side,
    (mut origin, mut direction): (Point, Point),
    random: &mut Random,
) -> (Option<Point>, f32) {
    let (mut scale, mut inside) = (1.0, false);
    while let Some((id, t)) = nearest(soup, origin, direction, EPSILON) {
        if id >= opaque {
            return (None, scale);
        }
        let [a, b, c] = soup[id];
        let front = unit(cross(sub(b, a), sub(c, a)));
        let facing = dot(front, direction);
        let (cos, n) = (facing.abs(), if facing < 0.0 { front } else { front.map(|x| -x) });
        let outside = match side {
            Side::Front => facing < 0.0,
            Side::Counted => !inside,
        };
        let eta = if outside { glass } else { 1.0 / glass };
        let (reflectance, cos_t) = fresnel_dielectric(cos, eta);
        origin = along(origin, direction, t);
        direction = if random.unit() < reflectance {
            unit(along(direction, n, 2.0 * cos))
        } else {
            inside = !inside;
            scale /= eta * eta;
            unit(std::array::from_fn(|k| (direction[k] + cos * n[k]) / eta - cos_t * n[k]))
        };
    }
    (Some(direction), scale)
}
