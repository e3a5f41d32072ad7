//! Weights of multiple importance sampling where densities are extreme.

use crate::common::meshes::{patch, quad, v};
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, diffuse, lamp};
use crate::common::{film, samples, settings};
use crate::lambert::{irradiance, lights};
use crate::row::{Finding, Part, ROW_FAMILIES, Row};
use glam::DVec3;
use wavetrace::lanes::Vec3;
use wavetrace::light::Receiver;
use wavetrace::render::SamplerKind;
use wavetrace::sampling::{power_heuristic, power_heuristic_over_pdf};
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Transport,
    name: "weights",
    title: "The squares of the power heuristic overflow",
    fails: "The weight p<sup>2</sup> / (p<sup>2</sup> + q<sup>2</sup>) squares densities: in f32 it is not a \
        number once both are above 1.8 x 10<sup>19</sup> or below 10<sup>-23</sup>, and where one is infinite, as \
        that of a mirror. A lamp of 10<sup>-9</sup> of the room's size has such a density.",
    remedy: "The weight is 1 / (1 + (q / p)<sup>2</sup>), of the ratio alone: where that overflows, the weight is \
        0, as it should be. A mirror's density is infinite, and its weight 1.",
    source: "Veach 1997, equation 9.13",
    run,
};

/// The textbook's form (Pharr, Jakob and Humphreys 2023, section 2.2.3, without its guard against infinity).
fn textbook(p: f32, q: f32) -> f32 {
    p * p / (p * p + q * q)
}

fn exact(p: f32, q: f32) -> f64 {
    let ratio = f64::from(q) / f64::from(p);
    1.0 / (1.0 + ratio * ratio)
}

fn run() -> Finding {
    // Densities from 10^-30 to 10^30; the first may be infinite.
    let densities: Vec<f32> = (-60..=60).map(|k| 10f64.powf(f64::from(k) / 2.0) as f32).collect();
    let (mut pairs, mut wrong, mut worst) = (0u32, 0u32, 0.0f64);
    for &p in densities.iter().chain(&[f32::INFINITY]) {
        for &q in &densities {
            let exact = exact(p, q);
            let naive = f64::from(textbook(p, q));
            wrong += u32::from(naive.is_nan() || (naive - exact).abs() > 1e-5);
            let forms = [power_heuristic(p, q), p * power_heuristic_over_pdf(1.0 / p, q)];
            // The second is used where a point was sampled, which no infinite density has.
            for weight in forms.iter().take(if p.is_finite() { 2 } else { 1 }) {
                // Of a division, a square, a sum, a division, and of 1 / p and p themselves: 8 roundings of 2^-24.
                let error = (f64::from(*weight) - exact).abs();
                assert!(error <= 8.0 * f64::from(f32::EPSILON) / 2.0, "{p:e}, {q:e}: {weight} for {exact}");
                worst = worst.max(error);
            }
            pairs += 1;
        }
    }
    assert!(wrong * 10 > pairs, "the textbook's form should fail: {wrong} of {pairs}");
    let (density, radiance) = tiny_lamp();
    let naive = textbook(density, 1.0 / std::f32::consts::PI);
    assert!(naive.is_nan(), "the textbook's weight of a tiny lamp should be no number: {naive} at {density:e}");
    Finding {
        textbook: format!(
            "{} of {pairs} weights wrong by more than 10<sup>-5</sup> or not a number; of a tiny lamp's, {naive}",
            wrong
        ),
        ours: format!("largest error of a weight {worst:.0e}; the tiny lamp's light right to {radiance:.0e}"),
        how: format!(
            "Weights of all pairs of densities from 10<sup>-30</sup> to 10<sup>30</sup> and of infinity, against \
             f64. Then a floor under a lamp of 10<sup>-9</sup> of the room's size, seen from the side, whose \
             density per solid angle is {density:.0e}: renders by `nee` and `mis` against Lambert's formula."
        ),
        picture: None,
    }
}

/// Density per solid angle of a lamp of 10^-9 of its room, and by how much renders err in its light.
fn tiny_lamp() -> (f32, f64) {
    let (side, shining, albedo) = (1.1e-9, 1e17, 0.5);
    // In the middle of the room, where f32 holds its corners; a black speck opposite the floor makes it the middle.
    let lamp_mesh = quad(v(0.0, -side / 2.0, -side / 2.0), v(0.0, side, 0.0), v(0.0, 0.0, side));
    let at = v(0.02, 0.2, -1.0);
    // Light is looked for from where rays start: off the floor by 32 roundings of its largest coordinate, 1.
    let start = at + DVec3::Z * (16.0 * f64::from(f32::EPSILON));
    let exact = f64::from(albedo) / std::f64::consts::PI * shining * irradiance(&lamp_mesh.positions, start, DVec3::Z);
    let from = Receiver { point: Vec3::splat(at.as_vec3().to_array()), normal: Vec3::splat([0.0, 0.0, 1.0]) };
    let way = Vec3::splat((-at).as_vec3().to_array());
    let cos = (at.x / at.length()) as f32;
    let (_, density) = lights(&lamp_mesh).seen::<f32>(|_| 0, &from, way, cos);

    let eye = at + v(0.3, -0.4, 0.5);
    let renderer = Scene::new(camera(eye, at - eye, [4, 4], 1e-4))
        .with(patch(0.0, 0.0, -1.0, 2.0, 2.0), diffuse(albedo))
        .with(patch(0.99, 0.99, 1.0, 0.02, 0.02), diffuse(0.0))
        .with(lamp_mesh, lamp(shining as f32))
        .renderer();
    let mut family = Family::one_of(ROW_FAMILIES);
    let mut worst = 0.0f64;
    for (k, method) in [Method::Nee, Method::Mis].into_iter().enumerate() {
        let image = film(&renderer, &settings(method, SamplerKind::Xoshiro, samples(256), k as u64));
        let e = Estimate::of_film(&image, 1);
        println!("{method:?}: {} for {exact}, density {density:e}", e.mean);
        family.add(e.p_exact(exact), format!("{method:?}: {} for {exact}", e.mean));
        worst = worst.max((e.mean / exact - 1.0).abs());
    }
    family.judge();
    (density, worst)
}
