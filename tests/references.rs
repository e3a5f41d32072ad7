//! The same rooms rendered by another program, Mitsuba 3, at some six thousand samples per pixel: means of blocks of
//! 16 x 16 pixels agree.
//!
//! Welch's t-test per block and channel and of the mean of all blocks; the reference's variance comes from the pixels'
//! differences between its two independent halves. Chance of a false alarm 10^-3 for the suite (Sidak).
//!
//! Rare bright samples (caustics) are no Gaussian matter: while none of them was drawn, the samples' own spread says
//! nothing of them. So our variance is never taken to be less than the reference's, scaled to our number of samples; and
//! blocks in which one pixel holds more than a tenth of the reference's own squared error are left out, by the reference
//! alone.

mod common;

use common::meshes::{cuboid, patch, quad, sphere, turned, v};
use common::stats::{Estimate, Family, detectable};
use common::worlds::{Scene, camera, colored, diffuse, glass, mirror};
use common::{film, samples, settings};
use glam::DVec3;
use wavetrace::film::Film;
use wavetrace::render::SamplerKind;
use wavetrace::wave::Method;
use wavetrace::world::{MaterialInput, Mesh};

const FAMILIES: usize = 2;
/// Pixels of a block each way, blocks of the image each way.
const BLOCK: usize = 16;
/// Of the pixels' squared differences in a block, the largest pixel's share above which the block is left out.
const HEAVY: f64 = 0.1;

struct Reference {
    mean: [f64; 3],
    error: [f64; 3],
    heavy: bool,
}

fn reference(text: &str) -> Vec<Reference> {
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let n: Vec<f64> = line.split(',').map(|w| w.parse().unwrap()).collect();
            assert_eq!(n.len(), 10);
            Reference {
                mean: std::array::from_fn(|k| 0.5 * (n[k] + n[k + 3])),
                error: std::array::from_fn(|k| n[k + 6]),
                heavy: n[9] > HEAVY,
            }
        })
        .collect()
}

/// The room of both scenes, closed, its lamp filling a hole in the ceiling.
fn room() -> Scene {
    let red = colored([0.63, 0.065, 0.05], 1.0);
    let green = colored([0.14, 0.45, 0.091], 1.0);
    let (deep, tall, wide) = (v(0.0, 4.5, 0.0), v(0.0, 0.0, 2.0), v(2.0, 0.0, 0.0));
    let corner = v(-1.0, -3.5, 0.0);
    let ceiling =
        [(0.0, -1.875, 2.0, 3.25), (0.0, 0.625, 2.0, 0.75), (-0.625, 0.0, 0.75, 0.5), (0.625, 0.0, 0.75, 0.5)]
            .map(|(x, y, wide, deep)| patch(x, y, 2.0, wide, deep));
    Scene::new(camera(v(0.0, -3.4, 1.0), DVec3::Y, [256, 256], 45.0))
        .with(quad(corner, wide, deep), diffuse(0.73))
        .with(common::meshes::join(&ceiling), diffuse(0.73))
        .with(quad(corner + deep, wide, tall), diffuse(0.73))
        .with(quad(corner, wide, tall), diffuse(0.73))
        .with(quad(corner, deep, tall), red)
        .with(quad(corner + wide, deep, tall), green)
        .with(patch(0.0, 0.0, 2.0, 0.5, 0.5), MaterialInput::Luminous { radiance: [15.0, 12.75, 9.75] })
}

fn block(x: f64, y: f64, z: f64, side: f64, tall: f64, degrees: f64) -> Mesh {
    let half = v(side, side, tall) * 0.5;
    let mut mesh = turned(cuboid(-half, half), degrees);
    mesh.positions.iter_mut().for_each(|p| *p += v(x, y, z));
    mesh
}

/// Tests an image of `spp` samples against a reference of `reference_spp`; at least `least` blocks take part.
fn agree(film: &Film, spp: u32, text: &str, reference_spp: u32, least: usize) {
    let blocks = reference(text);
    let across = film.width() as usize / BLOCK;
    assert_eq!(blocks.len(), across * across);
    let mut family = Family::one_of(FAMILIES);
    let mut all = vec![(Vec::new(), Vec::new()); 3];
    for (number, block) in blocks.iter().enumerate().filter(|b| !b.1.heavy) {
        let (column, row) = (number % across, number / across);
        for (k, (our, their)) in all.iter_mut().enumerate() {
            let pixel = |i: usize| (row * BLOCK + i / BLOCK) * film.width() as usize + column * BLOCK + i % BLOCK;
            let pixels = (0..BLOCK * BLOCK).map(|i| Estimate::of(film, pixel(i), k));
            let own = Estimate::average(pixels);
            let variance = block.error[k].powi(2);
            let theirs = Estimate { mean: block.mean[k], variance, freedom: (BLOCK * BLOCK) as f64 };
            let least = variance * f64::from(reference_spp) / f64::from(spp);
            let ours = Estimate { variance: own.variance.max(least), ..own };
            let what = format!("block ({column}, {row}), channel {k}: {} and {}", ours.mean, theirs.mean);
            family.add(ours.p_equal(&theirs), what);
            our.push(ours);
            their.push(theirs);
        }
    }
    for (k, (our, their)) in all.into_iter().enumerate() {
        let used = our.len();
        assert!(used >= least, "only {used} blocks have no heavy tail");
        let (ours, theirs) = (Estimate::average(our), Estimate::average(their));
        family.add(ours.p_equal(&theirs), format!("mean of channel {k}: {} and {}", ours.mean, theirs.mean));
        let error = (ours.variance + theirs.variance).sqrt() / ours.mean;
        println!("{used} blocks; a bias of {:.2} % of channel {k} is found", 100.0 * detectable(error, family.level()));
    }
    family.judge();
}

#[test]
fn a_diffuse_room_agrees() {
    let renderer = room()
        .with(block(-0.33, 0.35, 0.601, 0.6, 1.2, 17.0), diffuse(0.73))
        .with(block(0.35, -0.25, 0.301, 0.6, 0.6, -18.0), diffuse(0.73))
        .renderer();
    let spp = samples(24);
    let image = film(&renderer, &settings(Method::Mis, SamplerKind::Xoshiro, spp, 1));
    agree(&image, spp, include_str!("data/cornell-diffuse.csv"), 2 * 2816, 230);
}

#[test]
fn mirror_and_glass_spheres_agree() {
    let renderer = room()
        .with(sphere(v(-0.42, 0.35, 0.37), 0.35, 5, true), mirror(0.95))
        .with(sphere(v(0.42, -0.25, 0.37), 0.35, 5, true), glass(1.0, 1.5))
        .renderer();
    let spp = samples(48);
    let image = film(&renderer, &settings(Method::Mis, SamplerKind::Xoshiro, spp, 2));
    agree(&image, spp, include_str!("data/cornell-spheres.csv"), 2 * 3072, 200);
}
