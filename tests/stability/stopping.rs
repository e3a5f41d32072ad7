//! Samples that decide how many samples there are.

use crate::common::meshes::{inverted, patch};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, diffuse, lamp};
use crate::common::{meshes::v, samples, settings};
use crate::lambert::irradiance;
use crate::row::{Finding, Part, ROW_FAMILIES, Row};
use glam::DVec3;
use std::f64::consts::PI;
use wavetrace::Mesh;
use wavetrace::render::{Control, SamplerKind, Settings};
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Numbers,
    name: "stopping",
    title: "Images that end when they look good are wrong",
    fails: "Textbooks end a pixel when the variance of its own samples says that it is good. A pixel that has not \
        met a rare bright sample looks good, and ends dark; one that has goes on, and dilutes it. More samples at \
        least make this rarer, and show another side of it: means end while they are large, because errors are \
        relative to them.",
    remedy: "A render with `--target-error` has two halves, each of two images with random numbers of their own. The \
        error of one half decides when the *other* ends: given its number of samples, each is then a mean of that \
        many independent ones ([stopping by the error](decisions/stopping.md)).",
    source: "the bias: Kirk and Arvo 1991; deciding by other samples is their remedy, too",
    run,
};

/// Sides of the lamp, at height 1.
const WIDE: f64 = 0.32;
/// Pixels across and down.
const SIDE: u32 = 8;
const ALBEDO: f32 = 0.7;
const RADIANCE: f32 = 10.0;
/// Relative mean squared error at which to end.
const TARGET: f64 = 0.2;
/// Samples of a pixel before the textbook looks at its variance.
const LEAST: [u32; 3] = [4, 16, 64];

/// A small lamp above the middle of a floor.
fn small_lamp() -> Mesh {
    inverted(patch(0.0, 0.0, 1.0, WIDE, WIDE))
}

/// The mean of a pixel by the textbook, which follows cosine-distributed bounces off the floor.
fn textbook(random: &mut Random, least: u32) -> f64 {
    let (mut n, mut sum, mut sum2) = (0u32, 0.0, 0.0);
    loop {
        let (r2, turn) = (f64::from(random.unit()), 2.0 * PI * f64::from(random.unit()));
        // Where the bounce passes the lamp's height.
        let r = (r2 / (1.0 - r2)).sqrt();
        let hit = (r * turn.cos()).abs() < WIDE / 2.0 && (r * turn.sin()).abs() < WIDE / 2.0;
        let sample = if hit { f64::from(ALBEDO * RADIANCE) } else { 0.0 };
        (n, sum, sum2) = (n + 1, sum + sample, sum2 + sample * sample);
        let count = f64::from(n);
        let (mean, variance) = (sum / count, (sum2 - sum * sum / count) / (count - 1.0) / count);
        if n >= least && variance <= TARGET * (mean * mean + 0.01) {
            return mean;
        }
    }
}

fn run() -> Finding {
    let mut family = Family::one_of(ROW_FAMILIES);
    let eye = v(0.3, -0.5, 0.4);
    let scene = Scene::new(camera(eye, -eye, [SIDE; 2], 1e-3)).with(patch(0.0, 0.0, 0.0, 4.0, 4.0), diffuse(ALBEDO));
    let renderer = scene.with(small_lamp(), lamp(RADIANCE)).renderer();
    let exact = f64::from(ALBEDO * RADIANCE) / PI * irradiance(&small_lamp().positions, DVec3::ZERO, DVec3::Z);
    let (mut means, mut spent) = (Vec::new(), 0.0);
    let runs = u64::from(samples(150));
    for seed in 0..runs {
        let base = settings(Method::Path, SamplerKind::Xoshiro, u32::MAX, 1000 + seed);
        let settings = Settings { threads: 1, target_error: Some(TARGET), ..base };
        let rendered = renderer.render(&settings, &Control::default()).unwrap();
        let pixels = (SIDE * SIDE) as usize;
        means.push((0..pixels).map(|i| rendered.film.mean(i)[1]).sum::<f64>() / pixels as f64);
        spent += rendered.mean_spp() / runs as f64;
    }
    let ours = Estimate::of_replicates(&means).scaled(1.0 / exact);
    println!("{:.4} +- {:.4} of {exact:.5} at {spent:.0} samples", ours.mean, ours.variance.sqrt());
    family.add(ours.p_exact(1.0), format!("{} of {exact}", ours.mean));
    let level = family.level();
    family.judge();

    let off = LEAST.map(|least| {
        let mut random = Random(u64::from(least));
        let means: Vec<f64> = (0..20_000).map(|_| textbook(&mut random, least)).collect();
        let naive = Estimate::of_replicates(&means).scaled(1.0 / exact);
        println!("textbook, {least} samples at least: {:.4} +- {:.4}", naive.mean, naive.variance.sqrt());
        assert!(naive.p_exact(1.0) < level, "the textbook should be biased: {}", naive.mean);
        naive.mean - 1.0
    });
    assert!(off[0] < -0.5 && off[1] < 0.0, "with few samples at least it should be too dark: {off:?}");
    let percent = |x: f64| format!("{:+.0} %", 100.0 * x);
    Finding {
        textbook: format!("{} of the light where pixels have {LEAST:?} samples at least", off.map(percent).join(", ")),
        ours: format!("{:+.1} % (standard error {:.1} %)", 100.0 * (ours.mean - 1.0), 100.0 * ours.variance.sqrt()),
        how: format!(
            "A floor under a small lamp that bounces find by chance, at relMSE {TARGET}; the mean of {runs} renders \
             of {SIDE} x {SIDE} pixels, which took {spent:.0} samples per pixel, against Lambert's formula. The \
             textbook's pixels follow the same bounces, 20,000 times."
        ),
        picture: None,
    }
}
