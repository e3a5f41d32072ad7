//! Sobol points past the length of a sequence.

use crate::common::meshes::{inverted, patch, v};
use crate::common::stats::Family;
use crate::common::worlds::{Scene, camera, diffuse, lamp};
use crate::common::{samples, settings};
use crate::curve::{Axes, curve, dots, svg};
use crate::row::{Finding, Part, Picture, ROW_FAMILIES, Row};
use plotters::prelude::SeriesLabelPosition;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::collections::HashSet;
use std::f64::consts::PI;
use wavetrace::render::SamplerKind;
use wavetrace::sampling::{Decision, Sampler, Sobol, Xoshiro};
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Numbers,
    name: "long_sobol",
    title: "Sobol points repeat, and the error stays",
    fails: "Sequences in tables end somewhere: an index cut to 16 bits, or one that overflows, gives the same points \
        again. The error stays where it was, however many samples are added, and since the samples look no worse, \
        nothing tells.",
    remedy: "Points are computed, not looked up. Each 2<sup>16</sup> samples of a pixel get a scramble of their own, \
        up to the 2<sup>32</sup> samples that can be asked for; a 32-bit hash that is one-to-one gives all 65,536 of \
        them. Past 2<sup>16</sup> the error falls as that of independent samples, 1/sqrt(n), from what \
        2<sup>16</sup> points leave: an unbroken sequence would be better there, and is not offered.",
    source: "Burley 2020",
    run,
};

const BLOCK: u64 = 1 << 16;
/// Samples of each estimate, as a power of two.
const MOST: u32 = 20;
/// What is integrated: the part of a disk in the unit square, whose edge is everywhere. Square of its radius.
const RADIUS2: f64 = 0.6;
const EXACT: f64 = PI * RADIUS2 / 4.0;

fn inside<S: Sampler>(seed: u64, sample: u32) -> bool {
    let mut state = S::start::<f32>(seed, 5, sample);
    let [x, y] = S::draw::<f32, 2>(&mut state, Decision::Light, 1).map(f64::from);
    x * x + y * y < RADIUS2
}

/// Errors after 2^8, 2^9, ... samples, and of each block by itself.
fn errors<S: Sampler>(seed: u64, index: impl Fn(u32) -> u32) -> (Vec<f64>, Vec<f64>) {
    let (mut all, mut block, mut errors, mut blocks) = (0u64, 0u64, Vec::new(), Vec::new());
    for i in 0..1u32 << MOST {
        let hit = u64::from(inside::<S>(seed, index(i)));
        (all, block) = (all + hit, block + hit);
        let n = u64::from(i) + 1;
        if n.is_power_of_two() && n >= 256 {
            errors.push(all as f64 / n as f64 - EXACT);
        }
        if n % BLOCK == 0 {
            blocks.push(std::mem::take(&mut block) as f64 / BLOCK as f64 - EXACT);
        }
    }
    (errors, blocks)
}

/// Root of the mean square over replicates, by number of samples.
fn rms(replicates: &[(Vec<f64>, Vec<f64>)]) -> Vec<(f64, f64)> {
    let of = |k: usize| replicates.iter().map(|(errors, _)| errors[k].powi(2)).sum::<f64>() / replicates.len() as f64;
    (0..replicates[0].0.len()).map(|k| (f64::from(1 << (8 + k)), of(k).sqrt())).collect()
}

/// What the variance of a sum of blocks is to that of independent ones, and how likely so far from 1 (F test).
fn dependence(replicates: &[(Vec<f64>, Vec<f64>)]) -> (f64, f64) {
    let blocks = || replicates.iter().map(|(_, blocks)| blocks);
    let of_sums: f64 = blocks().map(|b| b.iter().sum::<f64>().powi(2)).sum();
    let of_each: f64 = blocks().flatten().map(|e| e * e).sum();
    let (ratio, n) = (of_sums / of_each, replicates.len() as f64);
    let below = FisherSnedecor::new(n, n * replicates[0].1.len() as f64).unwrap().cdf(ratio);
    (ratio, 2.0 * below.min(1.0 - below))
}

fn run() -> Finding {
    let mut family = Family::one_of(ROW_FAMILIES);
    let count = u64::from(samples(16));
    let of = |index: fn(u32) -> u32| (0..count).map(|seed| errors::<Sobol>(seed, index)).collect::<Vec<_>>();
    let (ours, cut) = (of(|i| i), of(|i| i % BLOCK as u32));
    let independent: Vec<_> = (0..count).map(|seed| errors::<Xoshiro>(seed, |i| i)).collect();
    // The last blocks that there are, by themselves.
    let last = of(|i| i.wrapping_sub(1 << MOST));
    let (first, end) = (dependence(&ours), dependence(&last));
    family.add(first.1, format!("first blocks: {}", first.0));
    family.add(end.1, format!("last blocks: {}", end.0));
    let level = family.level();
    family.judge();
    let (stalled, blocks) = (dependence(&cut), f64::from(1u32 << MOST) / BLOCK as f64);
    println!("variance to that of independent blocks: {first:?}, at the end {end:?}, cut to 16 bits {stalled:?}");
    assert!(stalled.1 < level && (stalled.0 / blocks - 1.0).abs() < 1e-9, "{stalled:?}");

    // All scrambles of a pixel differ, and in a render no sample past the first block is one of that again.
    let keys: HashSet<u32> = (0..BLOCK as u32).map(|b| Sobol::start::<f32>(1, 5, b << 16)[0]).collect();
    assert_eq!(keys.len(), BLOCK as usize);
    // A floor on which the light of no two points is the same.
    let renderer = Scene::new(camera(v(0.0, 0.0, 1.0), v(0.0, 1e-3, -1.0), [1, 1], 60.0))
        .with(patch(0.0, 0.0, 0.0, 4.0, 4.0), diffuse(0.7))
        .with(inverted(patch(0.0, 0.0, 1.5, 1.0, 1.0)), lamp(1.0))
        .renderer();
    let set = settings(Method::Nee, SamplerKind::Sobol, u32::MAX, 1);
    let at = |sample: u32| renderer.sample(&set, [0, 0], sample).unwrap();
    let again = (0..256).filter(|&i| at(i) == at(i + BLOCK as u32) || at(i) == at(i.wrapping_sub(256))).count();
    assert_eq!(again, 0, "samples come again");

    let [ours, cut, independent] = [&ours, &cut, &independent].map(|r| rms(r));
    let at = |curve: &[(f64, f64)], log: u32| curve[log as usize - 8].1;
    let fall = |curve: &[(f64, f64)]| at(curve, 16) / at(curve, MOST);
    let axes = Axes {
        x: ("samples", 256.0..f64::from(1u32 << MOST)),
        y: ("root mean squared error", 1e-6..1e-1),
        legend: SeriesLabelPosition::LowerLeft,
    };
    let picture = Picture {
        ending: "svg",
        bytes: svg(
            &axes,
            &[
                curve("index cut to 16 bits", cut.clone()),
                dots("here", ours.clone()),
                curve("independent samples", independent.clone()),
            ],
        ),
        caption: "Error of the area of a quarter disk by number of samples".into(),
    };
    Finding {
        textbook: format!(
            "error {:.2} times smaller with {blocks:.0} times as many samples as 2<sup>16</sup>",
            fall(&cut)
        ),
        ours: format!(
            "{:.2} times smaller, {:.2} expected; variance {:.2} and {:.2} of that of independent blocks, the first \
             and the last that there are; {:.0} times less error than independent samples",
            fall(&ours),
            blocks.sqrt(),
            first.0,
            end.0,
            at(&independent, MOST) / at(&ours, MOST)
        ),
        how: format!(
            "The area of a quarter disk from 2<sup>{MOST}</sup> points, {count} scrambles; F test of the variance of \
             the blocks' sum; all 65,536 scrambles of a pixel compared; and samples of a render from first, second \
             and last block."
        ),
        picture: Some(picture),
    }
}
