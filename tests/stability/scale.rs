//! Scenes that are very small, very large, or far from the origin.

use crate::common::meshes::{cuboid, inverted, patch, soup, sphere, turned, v};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, colored, diffuse, glass, lamp};
use crate::common::{film, full, samples, settings};
use crate::row::{Finding, Part, ROW_FAMILIES, Row};
use crate::textbook::{along, nearest};
use glam::DVec3;
use std::time::Duration;
use wavetrace::Mesh;
use wavetrace::film::Film;
use wavetrace::render::{Control, Renderer, SamplerKind};
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Intersection,
    name: "scale",
    title: "Tiny scenes, huge scenes, scenes far from the origin",
    fails: "Absolute distances (10<sup>-4</sup> to start a ray, 10<sup>-8</sup> to call a triangle empty) fit scenes of one size. Far from \
            the origin f32 coordinates are coarser than the geometry.",
    remedy: "Objects are placed in f64; the world is moved to its centre and scaled by a power of two to a size of about 1 before it is \
             rounded to f32. Nothing after that knows the scene's units.",
    source: "own; the camera as origin is Thorne 2005 (floating origin)",
    run,
};

/// Scale, and distance from the origin in sizes of the scene.
const PLACES: [(f64, f64); 7] = [(1e-6, 0.0), (1e-3, 0.0), (1e3, 0.0), (1e6, 0.0), (1.0, 1e3), (1.0, 1e6), (1e-6, 1e6)];

fn put(mut mesh: Mesh, scale: f64, shift: DVec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = *p * scale + shift);
    mesh
}

/// A room with a block, a ball of glass and a lamp.
fn parts() -> Vec<(Mesh, wavetrace::MaterialInput)> {
    let block = turned(cuboid(v(-0.6, 0.1, 0.01), v(-0.1, 0.6, 1.0)), 15.0);
    vec![
        (inverted(cuboid(v(-1.0, -1.0, 0.0), v(1.0, 1.0, 2.0))), diffuse(0.6)),
        (block, colored([0.8, 0.4, 0.2], 0.4)),
        (sphere(v(0.4, 0.1, 0.41), 0.4, 2, true), glass(0.95, 1.5)),
        (patch(0.0, 0.0, 1.95, 1.0, 1.0), lamp(3.0)),
    ]
}

fn world(scale: f64, away: f64) -> Renderer {
    let shift = v(1.0, -0.7, 0.3) * (2.0 * away * scale);
    let view = camera(v(0.0, -0.95, 1.0) * scale + shift, DVec3::Y, [24, 24], 75.0);
    let placed = |scene: Scene, (mesh, material)| scene.with(put(mesh, scale, shift), material);
    parts().into_iter().fold(Scene::new(view), placed).renderer()
}

fn compare(family: &mut Family, a: &Film, b: &Film, name: &str) {
    for i in 0..a.pixels().len() {
        family.add(Estimate::of(a, i, 1).p_equal(&Estimate::of(b, i, 1)), format!("{name}, pixel {i}"));
    }
    family.add(Estimate::of_film(a, 1).p_equal(&Estimate::of_film(b, 1)), format!("{name}, mean"));
}

/// Rays per second of a place over those of the room as it is: medians of interleaved renders.
fn speed(scale: f64, away: f64, base: &Renderer) -> f64 {
    let (other, settings) = (world(scale, away), settings(Method::Mis, SamplerKind::Xoshiro, 2048, 1));
    let time = |renderer: &Renderer| {
        let rendered = renderer.render(&settings, &Control::default()).unwrap();
        rendered.counts.rays() as f64 / rendered.time.max(Duration::from_nanos(1)).as_secs_f64()
    };
    let mut ratios: Vec<f64> = (0..7).map(|_| time(&other) / time(base)).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[3]
}

/// The share of rays from surfaces of the room, in f32 coordinates as they are and started 10^-4 off, that find another
/// triangle than in f64.
fn textbook(scale: f64, away: f64) -> f64 {
    let shift = v(1.0, -0.7, 0.3) * (2.0 * away * scale);
    let (mut random, mut wrong, rays) = (Random(8), 0, 4000);
    let near: Vec<[[f32; 3]; 3]> = parts().iter().flat_map(|(mesh, _)| soup(mesh)).collect();
    let far: Vec<[[f32; 3]; 3]> = parts().into_iter().flat_map(|(mesh, _)| soup(&put(mesh, scale, shift))).collect();
    for _ in 0..rays {
        let from = v(
            f64::from(random.within(-0.9, 0.9)),
            f64::from(random.within(-0.9, -0.2)),
            f64::from(random.unit()) + 0.5,
        );
        let direction = random.direction();
        let Some((_, t)) = nearest(&near, from.as_vec3().to_array(), direction, 0.0) else { continue };
        let next = random.direction();
        let bounce = along(from.as_vec3().to_array(), direction, t * 0.999);
        let expected = nearest(&near, bounce, next, 0.0).map(|hit| hit.0);
        let point = DVec3::from(bounce.map(f64::from)) * scale + shift;
        let found = nearest(&far, point.as_vec3().to_array(), next, 1e-4).map(|hit| hit.0);
        wrong += usize::from(found != expected);
    }
    wrong as f64 / f64::from(rays)
}

fn run() -> Finding {
    let base = world(1.0, 0.0);
    let mut family = Family::one_of(ROW_FAMILIES);
    let settings = |seed| settings(Method::Mis, SamplerKind::Xoshiro, samples(256), seed);
    let reference = film(&base, &settings(1));
    let mut slowest = 1.0f64;
    for (number, (scale, away)) in PLACES.into_iter().enumerate() {
        let image = film(&world(scale, away), &settings(2 + number as u64));
        compare(&mut family, &reference, &image, &format!("scale {scale:e}, {away:e} away"));
        if full() {
            let ratio = speed(scale, away, &base);
            assert!(
                (0.9..1.0 / 0.9).contains(&ratio),
                "scale {scale:e}, {away:e} away: {ratio} of the rays per second"
            );
            slowest = if (ratio - 1.0).abs() > (slowest - 1.0).abs() { ratio } else { slowest };
        }
    }
    let tests = family.count();
    family.judge();
    let shares = [(1e-6, 0.0), (1.0, 1e6)].map(|(scale, away)| textbook(scale, away));
    assert!(shares.iter().all(|&share| share > 0.05), "the textbook's method should fail: {shares:?}");
    let timed = if full() {
        format!("; rays per second {slowest:.3} of the scene as it is, at most apart")
    } else {
        String::new()
    };
    Finding {
        textbook: format!(
            "{:.0} % of bounces go wrong at 10<sup>-6</sup> of the size, {:.0} % at 10<sup>6</sup> sizes from the origin",
            100.0 * shares[0],
            100.0 * shares[1]
        ),
        ours: format!("images agree ({tests} t-tests at 10<sup>-3</sup> for all suites' rows){timed}"),
        how: "A room with glass scaled by 10<sup>-6</sup> to 10<sup>6</sup>, moved by 10<sup>3</sup> and 10<sup>6</sup> of its size, and both; \
              per pixel and in the mean against the room as it is, with seeds of their own."
            .into(),
        picture: None,
    }
}
