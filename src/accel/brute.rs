//! The oracle: every triangle, one after another.

use super::ray::Prepared;
use super::triangle::closest_of_one;
use super::{Hit, Ray};

/// The nearest hit among all triangles.
pub fn brute_force(corners: &[[[f32; 3]; 3]], ray: &Ray) -> Hit {
    let prepared = Prepared::new(ray);
    let mut hit = Hit::miss(ray.t_max);
    for (id, triangle) in corners.iter().enumerate() {
        closest_of_one(triangle, id as u32, &prepared, &mut hit);
    }
    hit
}
