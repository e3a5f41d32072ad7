//! Light from very near.

use crate::common::meshes::{patch, quad, v};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, diffuse, lamp};
use crate::common::{METHODS, film, samples, settings};
use crate::curve::{Axes, curve, dots, svg};
use crate::lambert::{connection, irradiance, lights, rounded};
use crate::row::{Finding, Part, Picture, ROW_FAMILIES, Row};
use glam::DVec3;
use plotters::prelude::SeriesLabelPosition;
use wavetrace::Mesh;
use wavetrace::render::SamplerKind;

pub const ROW: Row = Row {
    part: Part::Transport,
    name: "near_lights",
    title: "Close to a lamp nearly all light comes from few of its points",
    fails: "A point chosen by area on a lamp weighs cos cos / d<sup>2</sup>. At height h below a lamp of size 1, \
        nearly all light comes from a share h<sup>2</sup> of the lamp, with weights up to 1 / h<sup>2</sup>: the \
        image is dark, with single samples of enormous weight, and where a wall touches a lamp as well.",
    remedy: "From within about its own size a lamp is sampled by solid angle, where all points weigh the same but for \
        the receiver's cosine; `mis` weighs this against the lobe. Surfaces nearer to each other than a few \
        10<sup>-6</sup> of their largest coordinate are not told apart: see [where rays \
        start](decisions/where-rays-start.md).",
    source: "Arvo 1995, \"Stratified Sampling of Spherical Triangles\"; Veach 1997",
    run,
};

/// Distances from the lamp, in its sizes.
const HEIGHTS: [f64; 9] = [1.0, 0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// Lamps of about size 1, seen from the origin, `h` from it.
fn lamps(h: f64) -> [(&'static str, Mesh); 4] {
    let corners = vec![v(-0.3, -0.4, h), v(0.9, -0.3, h), v(-0.2, 0.8, h)];
    [
        ("above", patch(0.2, 0.13, h, 1.0, 1.0)),
        ("above, centred", patch(0.0, 0.0, h, 1.0, 1.0)),
        ("triangle above", Mesh { positions: corners, triangles: vec![[0, 1, 2]], ..Mesh::default() }),
        ("beside, touching the floor", quad(v(h, -0.4, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 0.7))),
    ]
}

/// What one connection brings where points are chosen by area, in f32.
fn by_area(mesh: &Mesh, random: &mut Random) -> f64 {
    let t = random.pick(&mesh.triangles);
    let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_vec3());
    let (mut u, mut w) = (random.unit(), random.unit());
    if u + w > 1.0 {
        (u, w) = (1.0 - u, 1.0 - w);
    }
    let point = a + (b - a) * u + (c - a) * w;
    let cross = (b - a).cross(c - a) * 0.5 * mesh.triangles.len() as f32;
    f64::from(point.z * cross.dot(point).abs() / point.length_squared().powi(2))
}

fn run() -> Finding {
    let mut family = Family::one_of(ROW_FAMILIES);
    let n = samples(20_000);
    let (mut naive, mut ours) = (Vec::new(), Vec::new());
    for (k, h) in HEIGHTS.into_iter().enumerate() {
        for (name, mesh) in lamps(h) {
            let mesh = rounded(mesh);
            let exact = irradiance(&mesh.positions, DVec3::ZERO, DVec3::Z);
            let lights = lights(&mesh);
            let mut random = Random(k as u64);
            let values: Vec<f64> = (0..n).map(|_| f64::from(connection(&lights, &mut random))).collect();
            assert!(values.iter().all(|x| x.is_finite()), "{name} at {h}");
            let e = Estimate::of_replicates(&values);
            family.add(e.p_exact(exact), format!("{name} at {h}: {} +- {} for {exact}", e.mean, e.variance.sqrt()));
            let area = Estimate::of_replicates(&(0..n).map(|_| by_area(&mesh, &mut random)).collect::<Vec<_>>());
            // The spread of one sample, in means.
            let spread = |e: &Estimate| (e.variance * f64::from(n)).sqrt() / exact;
            println!(
                "{name} at {h}: by area {:.4}, here {:.4}, spread {:.2}",
                area.mean / exact,
                e.mean / exact,
                spread(&e)
            );
            if name == "above" {
                naive.push((h, area.mean / exact));
                ours.push((h, e.mean / exact, spread(&e)));
            }
        }
    }
    let renders = rendered(&mut family);
    family.judge();
    let (dark, widest) = (naive[naive.len() - 1].1, ours.iter().map(|o| o.2).fold(0.0, f64::max));
    assert!(dark < 0.5, "sampling by area should lose the light of a near lamp: {dark}");
    let curves = [curve("by area", naive.clone()), dots("here", ours.iter().map(|&(h, mean, _)| (h, mean)).collect())];
    let axes = Axes {
        x: ("distance over the lamp's size", 1e-6..1.0),
        y: ("light found over exact", 1e-3..10.0),
        legend: SeriesLabelPosition::LowerRight,
    };
    Finding {
        textbook: format!(
            "{:.2} % of the light found at 10<sup>-6</sup> of the lamp's size, in {n} samples",
            100.0 * dark
        ),
        ours: format!(
            "right in the mean at all distances; a sample deviates by {widest:.2} of it; renders right to {:.1} %",
            100.0 * renders
        ),
        how: format!(
            "Irradiance from lamps of size 1 at distances from 1 to 10<sup>-6</sup>, above and beside the receiver \
             and touching its floor, against Lambert's formula: {n} connections each, and renders at 10<sup>-2</sup> and \
             10<sup>-4</sup> by all methods."
        ),
        picture: Some(Picture {
            ending: "svg",
            bytes: svg(&axes, &curves),
            caption: format!("Light of a lamp found by {n} connections. What is below the chart stands at its edge."),
        }),
    }
}

/// Renders of a floor close to a lamp; the largest relative error.
fn rendered(family: &mut Family) -> f64 {
    let (albedo, mut worst) = (0.6, 0.0f64);
    for h in [1e-2, 1e-4] {
        for (k, (name, mesh)) in lamps(h).into_iter().enumerate() {
            let exact = f64::from(albedo) / std::f64::consts::PI * irradiance(&mesh.positions, DVec3::ZERO, DVec3::Z);
            // Between floor and lamp.
            let eye = v(-0.5, -0.3, 0.6) * h;
            let scene =
                Scene::new(camera(eye, -eye, [4, 4], 1e-3)).with(patch(0.0, 0.0, 0.0, 1.5, 1.5), diffuse(albedo));
            let renderer = scene.with(mesh, lamp(1.0)).renderer();
            for (m, &method) in METHODS.iter().enumerate() {
                let seed = (10 * k + m) as u64 + (1e6 * h) as u64;
                let image = film(&renderer, &settings(method, SamplerKind::Xoshiro, samples(4096), seed));
                let e = Estimate::of_film(&image, 1);
                println!("{name} at {h}, {method:?}: {:.4} +- {:.4}", e.mean / exact, e.relative_error());
                family.add(e.p_exact(exact), format!("{name} at {h}, {method:?}: {} for {exact}", e.mean));
                worst = worst.max((e.mean / exact - 1.0).abs());
            }
        }
    }
    worst
}
