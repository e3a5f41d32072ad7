//! Lamps of all sizes and strengths in one scene.

use crate::common::meshes::{patch, quad, v};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, diffuse};
use crate::common::{film, samples, settings};
use crate::lambert::irradiance;
use crate::row::{Finding, Part, ROW_FAMILIES, Row};
use glam::DVec3;
use std::f64::consts::PI;
use wavetrace::render::SamplerKind;
use wavetrace::wave::Method;
use wavetrace::{MaterialInput, Mesh};

pub const ROW: Row = Row {
    part: Part::Transport,
    name: "light_range",
    title: "A strong lamp hides the weak one beside you",
    fails: "Textbooks choose a lamp by its power. Where powers differ by 10<sup>12</sup>, the weaker one is not \
        chosen once in any image, though it may be near, and give as much light; if it is, its sample weighs \
        10<sup>12</sup>.",
    remedy: "Lamps are chosen by what they may bring to the lit point: power times cosines over squared distance, \
        each bounded over the lamp. No lamp before the receiver has chance 0. Powers and densities are computed in \
        f64 and rounded once; coordinates are scaled so that no square overflows.",
    source: "Conty Estevez and Kulla 2018",
    run,
};

/// Sizes of the red lamp, in those of the floor and the green one.
const SIZES: [f64; 7] = [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6];

/// A red lamp of this size and its radiance, on one side of the floor's middle: so far away, or so bright, that it
/// gives about as much light as the green one.
fn red(size: f64) -> (Mesh, f64) {
    let far = size.max(1.0);
    let corner = v(0.1 * far, -0.5 * size, 0.8 * far);
    (quad(corner, v(size, 0.0, 0.0), v(0.0, size, 0.0)), if size < 1.0 { size.powi(-2) } else { 1.0 })
}

fn green() -> Mesh {
    quad(v(-1.1, -0.4, 0.3), v(0.3, 0.0, 0.9), v(0.0, 1.0, 0.0))
}

fn area(mesh: &Mesh) -> f64 {
    let p = &mesh.positions;
    (p[1] - p[0]).cross(p[3] - p[0]).length()
}

/// Light of both lamps by a textbook: chosen by power, a point by area.
fn textbook(lamps: &[(Mesh, f64); 2], count: u32) -> [f64; 2] {
    let power = lamps.each_ref().map(|(mesh, radiance)| area(mesh) * radiance);
    let (mut random, mut sums) = (Random(4), [0.0; 2]);
    for _ in 0..count {
        let k = usize::from(f64::from(random.unit()) >= power[0] / (power[0] + power[1]));
        let (mesh, radiance) = &lamps[k];
        let p = &mesh.positions;
        let (e, f) = (p[1] - p[0], p[3] - p[0]);
        let point = p[0] + e * f64::from(random.unit()) + f * f64::from(random.unit());
        let cosines = point.z * e.cross(f).dot(point).abs() / point.length_squared().powi(2);
        sums[k] += radiance * cosines * (power[0] + power[1]) / power[k];
    }
    sums.map(|s| s / f64::from(count))
}

fn run() -> Finding {
    let mut family = Family::one_of(ROW_FAMILIES);
    let albedo = 0.6;
    let (mut worst, mut error, mut lost) = (0.0f64, 0.0f64, 0.0);
    for size in SIZES {
        let lamps = [red(size), (green(), 1.0)];
        let exact =
            lamps.each_ref().map(|(mesh, radiance)| radiance * irradiance(&mesh.positions, DVec3::ZERO, DVec3::Z));
        let eye = v(0.2, -0.4, 0.3);
        let mut scene =
            Scene::new(camera(eye, -eye, [4, 4], 1e-3)).with(patch(0.0, 0.0, 0.0, 1.0, 1.0), diffuse(albedo));
        for (k, (mesh, radiance)) in lamps.iter().enumerate() {
            let mut color = [0.0; 3];
            color[k] = *radiance as f32;
            // A black speck opposite each lamp keeps the floor in the middle of the world, where f32 is fine enough for
            // it.
            let speck = Mesh { positions: mesh.positions.iter().map(|p| -*p).collect(), ..mesh.clone() };
            scene = scene.with(mesh.clone(), MaterialInput::Luminous { radiance: color }).with(speck, diffuse(0.0));
        }
        let renderer = scene.renderer();
        for (m, method) in [Method::Nee, Method::Mis].into_iter().enumerate() {
            let image = film(&renderer, &settings(method, SamplerKind::Xoshiro, samples(4096), m as u64));
            for (k, irradiance) in exact.iter().enumerate() {
                let (e, expected) = (Estimate::of_film(&image, k), f64::from(albedo) / PI * irradiance);
                let what = format!("size {size:e}, {method:?}, lamp {k}");
                println!("{what}: {:.5} +- {:.5} of {expected:.5}", e.mean / expected, e.relative_error());
                family.add(e.p_exact(expected), what);
                worst = worst.max((e.mean / expected - 1.0).abs());
                error = error.max(e.relative_error());
            }
        }
        if size == SIZES[6] {
            lost = 1.0 - textbook(&lamps, samples(65_536))[1] / exact[1];
        }
    }
    family.judge();
    assert!(lost > 0.9, "choice by power should lose the weak lamp: {lost}");
    Finding {
        textbook: format!(
            "{:.0} % of the light of a lamp lost beside one 10<sup>12</sup> times as strong",
            100.0 * lost
        ),
        ours: format!(
            "right to {:.1} % (standard error {:.1} %) from 10<sup>-6</sup> to 10<sup>6</sup> of the \
            floor's size",
            100.0 * worst,
            100.0 * error
        ),
        how: "A floor of size 1 under a green lamp of its size and a red one of 10<sup>-6</sup> to 10<sup>6</sup> \
            times that, which gives about as much light: the small ones are 10<sup>12</sup> times as bright, the \
            large ones 10<sup>12</sup> times as strong. Renders by `nee` and `mis`, each channel against Lambert's \
            formula."
            .into(),
        picture: None,
    }
}
