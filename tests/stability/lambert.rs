//! Irradiance from polygons in f64 (Lambert 1760), and what the rows on light sample from.

use crate::common::random::Random;
use glam::DVec3;
use wavetrace::Mesh;
use wavetrace::lanes::Vec3;
use wavetrace::light::{LightTriangle, Lights, Receiver};

/// Irradiance at `at`, whose unit normal is `normal`, from a flat polygon of radiance 1, all of it on the normal's
/// side: E = 1/2 sum theta_i (Gamma_i . n). Angles by atan2, which keeps its digits where they are small. The sum does
/// not: below 10^-4 of its distance in size, where that errs by 10^-8 too, the polygon counts as triangles of one
/// direction each.
pub fn irradiance(polygon: &[DVec3], at: DVec3, normal: DVec3) -> f64 {
    let p: Vec<DVec3> = polygon.iter().map(|p| *p - at).collect();
    if p.iter().all(|q| q.distance(p[0]) < 1e-4 * p[0].length()) {
        let fan = (1..p.len() - 1).map(|k| [p[0], p[k], p[k + 1]]);
        let of = |[a, b, c]: [DVec3; 3]| {
            let (area, way) = (0.5 * (b - a).cross(c - a), (a + b + c) / 3.0);
            area.dot(way).abs() * way.dot(normal) / way.length_squared().powi(2)
        };
        return fan.map(of).sum();
    }
    let edge = |i: usize| {
        let (a, b) = (p[i].normalize(), p[(i + 1) % p.len()].normalize());
        let across = a.cross(b);
        across.length().atan2(a.dot(b)) * across.normalize_or_zero().dot(normal)
    };
    0.5 * (0..p.len()).map(edge).sum::<f64>().abs()
}

/// Solid angle of a triangle in sr (Van Oosterom and Strackee 1983), by differences of corners: small ones keep their
/// digits.
pub fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let volume = a.dot((b - a).cross(c - a)).abs();
    let (x, y, z) = (a.length(), b.length(), c.length());
    2.0 * volume.atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
}

/// The same of a polygon, convex and flat, from `at`.
pub fn polygon_angle(polygon: &[DVec3], at: DVec3) -> f64 {
    (1..polygon.len() - 1).map(|k| solid_angle([polygon[0] - at, polygon[k] - at, polygon[k + 1] - at])).sum()
}

/// A mesh with corners that f32 can hold.
pub fn rounded(mut mesh: Mesh) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = p.as_vec3().as_dvec3());
    mesh
}

/// A mesh as lights of radiance 1.
pub fn lights(mesh: &Mesh) -> Lights {
    let triangle = |t: &[u32; 3]| {
        let corners = t.map(|i| mesh.positions[i as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize().as_vec3().to_array();
        LightTriangle { corners: corners.map(|p| p.as_vec3().to_array()), normal, radiance: [1.0; 3] }
    };
    Lights::new(&mesh.triangles.iter().map(triangle).collect::<Vec<_>>())
}

/// What one connection from the origin, normal +z, brings of `lights`: an estimate of irradiance.
pub fn connection(lights: &Lights, random: &mut Random) -> f32 {
    let from = Receiver { point: Vec3::splat([0.0; 3]), normal: Vec3::splat([0.0, 0.0, 1.0]) };
    let light = lights.sample(&from, random.unit(), [random.unit(), random.unit()]);
    let distance2 = light.point.length2();
    let wi = light.point * (1.0 / distance2.sqrt());
    light.radiance.x * wi.z.max(0.0) * light.normal.dot(wi).abs() / (distance2 * light.pdf_area)
}
