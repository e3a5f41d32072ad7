//! The same rooms rendered by another program, Mitsuba 3, at some six thousand samples per pixel: means of blocks of
//! 16 x 16 pixels agree.
//!
//! Welch's t-test per block and channel, our variance from our samples, the reference's from the differences of its two
//! independent halves; chance of a false alarm 10^-3 for the suite (Sidak). Blocks in which one pixel holds more than a
//! tenth of the reference's own squared error have heavy tails (caustics), for which no such test is valid: they are left
//! out, by the reference alone, and counted.

mod common;

use common::meshes::{cuboid, patch, quad, sphere, turned, v};
use common::stats::{Estimate, Family, uniformity};
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

fn agree(film: &Film, text: &str, least: usize) {
    let blocks = reference(text);
    let across = film.width() as usize / BLOCK;
    assert_eq!(blocks.len(), across * across);
    let mut family = Family::one_of(FAMILIES);
    let (mut green, mut used) = (Vec::new(), 0);
    for (number, block) in blocks.iter().enumerate().filter(|b| !b.1.heavy) {
        used += 1;
        let (x0, y0) = (number % across * BLOCK, number / across * BLOCK);
        for k in 0..3 {
            let pixels =
                (0..BLOCK * BLOCK).map(|i| &film.pixels()[(y0 + i / BLOCK) * film.width() as usize + x0 + i % BLOCK]);
            let ours = Estimate::average(pixels.map(|p| Estimate::of_pixel(p, k)));
            let freedom = (BLOCK * BLOCK) as f64;
            let theirs = Estimate { mean: block.mean[k], variance: block.error[k].powi(2), freedom };
            let p = ours.p_equal(&theirs);
            family.add(
                p,
                format!(
                    "block ({}, {}), channel {k}: {} and {}",
                    number % across,
                    number / across,
                    ours.mean,
                    theirs.mean
                ),
            );
            if k == 1 {
                green.push(p);
            }
        }
    }
    family.add(uniformity(&green), "p-values of the blocks");
    println!("{used} of {} blocks", blocks.len());
    assert!(used >= least, "only {used} blocks have no heavy tail");
    family.judge();
}

#[test]
fn a_diffuse_room_agrees() {
    let renderer = room()
        .with(block(-0.33, 0.35, 0.601, 0.6, 1.2, 17.0), diffuse(0.73))
        .with(block(0.35, -0.25, 0.301, 0.6, 0.6, -18.0), diffuse(0.73))
        .renderer();
    let image = film(&renderer, &settings(Method::Mis, SamplerKind::Xoshiro, samples(24), 1));
    agree(&image, include_str!("data/cornell-diffuse.csv"), 230);
}

#[test]
fn mirror_and_glass_spheres_agree() {
    let renderer = room()
        .with(sphere(v(-0.42, 0.35, 0.37), 0.35, 5, true), mirror(0.95))
        .with(sphere(v(0.42, -0.25, 0.37), 0.35, 5, true), glass(1.0, 1.5))
        .renderer();
    let image = film(&renderer, &settings(Method::Mis, SamplerKind::Xoshiro, samples(48), 2));
    agree(&image, include_str!("data/cornell-spheres.csv"), 200);
}
