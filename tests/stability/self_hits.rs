//! Bounces that meet the surface they leave.

use crate::common::meshes::{soup, sphere, turned, v};
use crate::common::random::Random;
use crate::common::worlds::{Scene, camera, diffuse};
use crate::common::{meshes::patch, samples, settings};
use crate::row::{Finding, Part, Row};
use crate::textbook::{along, cross, dot, nearest, sub, unit};
use glam::DVec3;
use wavetrace::Mesh;
use wavetrace::render::{Control, SamplerKind};
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Intersection,
    name: "self_hits",
    title: "A bounce meets the surface that it leaves",
    fails: "The point where a ray meets a triangle is rounded, to one side of the surface or the other. Textbooks start the next ray a \
            fixed distance away, 10<sup>-4</sup> say: too little far from the origin, where coordinates are coarser than that, and too much \
            in small scenes.",
    remedy: "Placement is computed in f64 and the world moved to its centre and scaled to about 1 before it is rounded to f32. Rays start off \
             the surface by 32 roundings of the triangle's largest coordinate, a bound of what the triangle test itself errs by; see \
             [where rays start](decisions/where-rays-start.md).",
    source: "after Pharr, Jakob and Humphreys 2023, section 6.8; Waechter and Binder 2019",
    run,
};

/// Distances from the origin, in sizes of the mesh.
const DISTANCES: [f64; 3] = [1.0, 1e3, 1e6];

/// A mesh that its own bounces cannot meet: a floor, or a ball.
fn meshes() -> [(&'static str, Mesh); 3] {
    let mut floor = turned(patch(0.0, 0.0, 0.0, 2.0, 2.0), 20.0);
    let tilt = glam::DMat3::from_rotation_x(0.4);
    floor.positions.iter_mut().for_each(|p| *p = tilt * *p);
    let origin = DVec3::ZERO;
    [("floor", floor), ("ball", sphere(origin, 1.0, 4, false)), ("smooth ball", sphere(origin, 1.0, 4, true))]
}

fn moved(mut mesh: Mesh, by: DVec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p += by);
    mesh
}

/// Bounces, and how many of them meet the mesh again: under a sky of 2 each camera ray brings 2 or, after one bounce, 1.
fn ours(mesh: &Mesh, distance: f64) -> (u64, f64) {
    let at = v(distance, -0.7 * distance, 0.3 * distance);
    let view = camera(at + v(0.3, -3.0, 1.4), v(-0.3, 3.0, -1.4), [64, 64], 40.0);
    let scene = Scene::new(view).background(2.0).with(moved(mesh.clone(), at), diffuse(0.5));
    let rendered = scene.renderer().render(&settings(Method::Path, SamplerKind::Xoshiro, samples(640), 5), &Control::default()).unwrap();
    let film = rendered.film;
    let (count, sum) = film.pixels().iter().fold((0.0, 0.0), |(n, s), p| (n + p.count as f64, s + p.sum[0]));
    let bounced = rendered.counts.bounce;
    (bounced, (bounced as f64 - (2.0 * count - sum)).abs())
}

/// The share of bounces that meet the mesh again where coordinates are rounded as they are and rays start 10^-4 off.
fn textbook(mesh: &Mesh, distance: f64, rays: usize) -> f64 {
    let at = v(distance, -0.7 * distance, 0.3 * distance);
    let soup = soup(&moved(mesh.clone(), at));
    let (mut random, mut again, mut bounced) = (Random(3), 0, 0);
    while bounced < rays {
        let from = (at + v(0.3, -3.0, 1.4)).as_vec3().to_array();
        let target: [f32; 3] = {
            let [a, b, c] = random.pick(&soup);
            std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
        };
        let way = unit(sub(target, from));
        let Some((id, t)) = nearest(&soup, from, way, 0.0) else {
            bounced += 1;
            continue;
        };
        let [a, b, c] = soup[id];
        let normal = unit(cross(sub(b, a), sub(c, a)));
        let out = if dot(normal, way) > 0.0 { normal.map(|c| -c) } else { normal };
        let direction = random.direction();
        let direction = if dot(direction, out) < 0.0 { direction.map(|c| -c) } else { direction };
        bounced += 1;
        again += usize::from(nearest(&soup, along(from, way, t), direction, 1e-4).is_some());
    }
    again as f64 / bounced as f64
}

fn run() -> Finding {
    let (mut total, mut worst) = (u64::MAX, 0.0);
    for (name, mesh) in meshes() {
        for distance in DISTANCES {
            let (bounced, again) = ours(&mesh, distance);
            println!("{name} at {distance}: {bounced} bounces, {again} meet it again");
            assert!(bounced >= 1_000_000, "{name} at {distance}: {bounced} bounces are too few");
            // A second bounce of one path would count 0.5 at least, rounding far less than that.
            assert!(again < 0.25, "{name} at {distance}: {again} of {bounced} bounces meet it again");
            total = total.min(bounced);
            worst = f64::max(worst, again);
        }
    }
    let coarse = sphere(DVec3::ZERO, 1.0, 2, false);
    let shares = DISTANCES.map(|distance| textbook(&coarse, distance, 20_000));
    assert!(shares[2] > 0.01, "the textbook's method should fail far away: {shares:?}");
    Finding {
        textbook: format!("{} of rays from a ball at distance 1, 10<sup>3</sup>, 10<sup>6</sup>", shares.map(|s| format!("{:.1} %", 100.0 * s)).join(", ")),
        ours: format!("none of {:.1} million each", total as f64 / 1e6),
        how: "A floor, a ball with flat faces and one with interpolated normals under a constant sky, at three distances; any second bounce \
              shows in the sum of the samples. The textbook's form is traced by brute force."
            .into(),
        picture: None,
    }
}
