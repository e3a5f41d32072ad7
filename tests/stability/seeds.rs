//! Random numbers of neighbouring pixels and seeds.

use crate::common::meshes::{inverted, patch, v};
use crate::common::stats::{Estimate, Family, two_sided};
use crate::common::worlds::{Scene, camera, diffuse, lamp};
use crate::common::{film, samples, settings};
use crate::row::{Finding, Part, Picture, ROW_FAMILIES, Row};
use rand_xoshiro::Xoroshiro64Star;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::f64::consts::PI;
use wavetrace::output::{Metadata, png_of_rgb8};
use wavetrace::render::{Renderer, SamplerKind, Settings};
use wavetrace::sampling::{Decision, Sampler, Sobol, Xoshiro};
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Numbers,
    name: "seeds",
    title: "Neighbouring pixels and seeds share their noise",
    fails: "A generator seeded with `seed + pixel` begins at adjacent states in adjacent pixels, and its first \
        numbers show it. Seed n + 1 gives the image of seed n, moved by a pixel: replicates are no replicates, and \
        the mean of many is a blurred image, not a better one. The same Sobol scramble in all pixels makes the same \
        error in all of them.",
    remedy: "States are hashes of seed, pixel and sample: SplitMix64 for independent streams \
        ([streams](decisions/streams.md)), hashes of 32 bits for scrambles. Up to 256 samples per pixel, Sobol \
        points of neighbours are related on purpose, so that their errors are opposed and cancel out before the eye \
        ([blue noise](decisions/blue-noise.md)); beyond, and in all seeds, nothing is.",
    source: "Steele, Lea and Flood 2014; Burley 2020; Ahmed and Wonka 2020",
    run,
};

/// Samples of a pixel up to which Sobol points of neighbours are related, for one.
const FEW: u32 = 16;
/// Samples of a pixel of the textbook's images.
const FEWER: u32 = 2;
/// Pixels of these, across.
const SIDE: usize = 96;

/// Where numbers come from: two in [0, 1) of a seed, pixel and sample.
type Source = fn(u64, u32, u32) -> [f64; 2];

/// The linear congruential generator of Numerical Recipes, one for each pixel.
fn congruential(seed: u64, pixel: u32, sample: u32) -> [f64; 2] {
    let mut state = (seed as u32).wrapping_add(pixel);
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX)
    };
    (0..2 * sample).for_each(|_| _ = next());
    [next(), next()]
}

/// The generator that is used here, without the hash.
fn unmixed(seed: u64, pixel: u32, sample: u32) -> [f64; 2] {
    let mut generator = Xoroshiro64Star::from_seed((seed + u64::from(pixel)).to_le_bytes());
    let mut next = || f64::from(generator.next_u32()) / f64::from(u32::MAX);
    (0..2 * sample).for_each(|_| _ = next());
    [next(), next()]
}

/// One scramble for all pixels.
fn one_scramble(seed: u64, _: u32, sample: u32) -> [f64; 2] {
    sampler::<Sobol>(seed, 0, sample)
}

fn sampler<S: Sampler>(seed: u64, pixel: u32, sample: u32) -> [f64; 2] {
    let mut state = S::start::<f32>(seed, pixel, sample);
    S::draw::<f32, 2>(&mut state, Decision::Light, 1).map(f64::from)
}

/// The part of a quarter disk in pixels that are all alike, less its mean.
fn noise(source: Source, seed: u64, pixels: usize) -> Vec<f64> {
    let inside =
        |pixel: u32| (0..FEWER).filter(move |&s| source(seed, pixel, s).iter().map(|x| x * x).sum::<f64>() < 0.6);
    (0..pixels as u32).map(|pixel| inside(pixel).count() as f64 / f64::from(FEWER) - 0.15 * PI).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let sum = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    sum(a, b) / (sum(a, a) * sum(b, b)).sqrt()
}

/// Correlation of neighbours, and of seeds with the second image moved by a pixel, or not.
fn of_source(source: Source) -> [f64; 3] {
    let pixels = SIDE * SIDE;
    let [a, b] = [7, 8].map(|seed| noise(source, seed, pixels));
    [correlation(&a[1..], &a[..pixels - 1]), correlation(&a[1..], &b[..pixels - 1]), correlation(&a, &b)]
}

/// Correlation of first numbers of adjacent pixels and adjacent seeds, of each of two dimensions.
fn of_numbers(source: Source, family: &mut Family, name: &str) {
    let n = samples(200_000);
    for (what, seed, step) in [("pixels", 7, 1), ("seeds", 8, 0)] {
        let mut sums = [0.0; 2];
        for i in 0..n {
            let (a, b) = (source(7, i, 0), source(seed, i + step, 0));
            (0..2).for_each(|k| sums[k] += (a[k] - 0.5) * (b[k] - 0.5));
        }
        for (k, sum) in sums.iter().enumerate() {
            // Uniform numbers have variance 1 / 12; a mean of n such products has standard deviation 1 / (12 sqrt(n)).
            let r = 12.0 * sum / f64::from(n);
            family.add(two_sided(r * f64::from(n).sqrt(), f64::INFINITY), format!("{name}: {what}, number {k}: {r}"));
        }
    }
}

/// Correlations in renders of a lit floor, with their standard errors: of errors of pixels `steps` apart, and of
/// adjacent seeds.
struct Images {
    pixels: Vec<Estimate>,
    seeds: Estimate,
}

fn of_images(renderer: &Renderer, size: [u32; 2], base: &Settings, count: u64, steps: &[[usize; 2]]) -> Images {
    let values = |seed: u64| -> Vec<f64> {
        let film = film(renderer, &Settings { seed, ..base.clone() });
        (0..film.pixels().len()).map(|i| film.mean(i)[1]).collect()
    };
    let [wide, tall] = size.map(|c| c as usize);
    let (mut all, mut square) = (Vec::new(), 0.0);
    for k in 0..count {
        // What two renders of seeds far apart differ by has no mean, whatever a pixel sees.
        let [a, b] = [0, 1].map(|next| {
            let (x, y) = (values(100 * k + next), values((1 << 40) + 100 * k + next));
            x.iter().zip(&y).map(|(x, y)| x - y).collect::<Vec<_>>()
        });
        square += a.iter().chain(&b).map(|d| d * d).sum::<f64>() / (2 * a.len()) as f64 / count as f64;
        let apart = |d: &[f64], [right, down]: [usize; 2]| {
            let places = (0..tall - down).flat_map(|y| (0..wide - right).map(move |x| y * wide + x));
            let products = places.map(|i| d[i] * d[i + down * wide + right]);
            products.sum::<f64>() / ((tall - down) * (wide - right)) as f64
        };
        let mut row: Vec<f64> = steps.iter().map(|&step| (apart(&a, step) + apart(&b, step)) / 2.0).collect();
        row.push(a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64);
        all.push(row);
    }
    let estimate =
        |k: usize| Estimate::of_replicates(&all.iter().map(|row| row[k]).collect::<Vec<_>>()).scaled(1.0 / square);
    Images { pixels: (0..steps.len()).map(estimate).collect(), seeds: estimate(steps.len()) }
}

/// Noise side by side as a PNG, each pixel three wide.
fn picture(sources: &[Source]) -> Vec<u8> {
    let (zoom, gap) = (3, 8);
    let tall = SIDE * zoom;
    let wide = sources.len() * (tall + gap) - gap;
    let mut codes = vec![255u8; 3 * wide * tall];
    for (n, source) in sources.iter().enumerate() {
        let noise = noise(*source, 7, SIDE * SIDE);
        for (y, x) in (0..tall).flat_map(|y| (0..tall).map(move |x| (y, x))) {
            let code = (127.5 + 200.0 * noise[y / zoom * SIDE + x / zoom]).clamp(0.0, 255.0) as u8;
            codes[3 * (y * wide + n * (tall + gap) + x)..][..3].fill(code);
        }
    }
    png_of_rgb8(wide as u32, tall as u32, &codes, &Metadata::default()).unwrap()
}

fn run() -> Finding {
    let textbook = [congruential, unmixed, one_scramble].map(of_source);
    println!("neighbours, seeds moved by a pixel, seeds: textbook {textbook:.3?}");
    assert!(textbook[0][1] > 0.999 && textbook[1][1] > 0.999, "seeds should be images moved: {textbook:?}");
    assert!(textbook[2][0] > 0.999, "neighbours should be alike: {textbook:?}");
    let standard = 1.0 / (SIDE * SIDE) as f64;
    assert!(textbook[..2].iter().all(|t| t[0].abs() > 5.0 * standard.sqrt()), "neighbours: {textbook:?}");

    let mut family = Family::one_of(ROW_FAMILIES);
    of_numbers(sampler::<Xoshiro>, &mut family, "xoshiro");
    of_numbers(sampler::<Sobol>, &mut family, "sobol");
    let (mut worst, mut error, mut opposed) = (0.0f64, 0.0f64, 0.0);
    // Sobol with few samples: pixels of different tiles, and the neighbours by themselves.
    let near = [[1, 0], [0, 1], [1, 1]];
    let cases = [
        (SamplerKind::Xoshiro, FEW, [48, 32], 24, &near[..]),
        (SamplerKind::Sobol, 257, [24, 16], 8, &near[..]),
        (SamplerKind::Sobol, FEW, [48, 32], 24, &[[16, 0], [0, 16], [1, 0], [0, 1]][..]),
    ];
    for (sampler, spp, size, count, steps) in cases {
        let renderer = Scene::new(camera(v(0.0, 0.0, 2.0), v(0.0, 1e-3, -1.0), size, 30.0))
            .with(patch(0.0, 0.0, 0.0, 4.0, 4.0), diffuse(0.7))
            .with(inverted(patch(0.0, 0.0, 2.5, 4.0, 4.0)), lamp(1.0))
            .renderer();
        let base = Settings { max_depth: Some(1), ..settings(Method::Nee, sampler, spp, 0) };
        let count = u64::from(samples(count));
        let found = of_images(&renderer, size, &base, count, steps);
        for (step, e) in steps.iter().zip(&found.pixels) {
            let what =
                format!("{sampler:?}, {spp} samples, pixels {step:?} apart: {:.4} +- {:.4}", e.mean, e.variance.sqrt());
            println!("{what}");
            if (sampler, spp) == (SamplerKind::Sobol, FEW) && step.iter().sum::<usize>() == 1 {
                assert!(e.mean < -5.0 * e.variance.sqrt(), "errors of neighbours are opposed: {what}");
                opposed += e.mean / 2.0;
                continue;
            }
            (worst, error) = (worst.max(e.mean.abs()), error.max(e.variance.sqrt()));
            family.add(e.p_exact(0.0), what);
        }
        let e = found.seeds;
        println!("{sampler:?}, {spp} samples, seeds n and n + 1: {:.4} +- {:.4}", e.mean, e.variance.sqrt());
        (worst, error) = (worst.max(e.mean.abs()), error.max(e.variance.sqrt()));
        family.add(e.p_exact(0.0), format!("{sampler:?}, {spp} samples, seeds: {}", e.mean));
    }
    family.judge();
    Finding {
        textbook: format!(
            "correlation of neighbours {:.2} and {:.2}, and {:.2} of seeds n and n + 1 moved by a pixel, with `seed \
             + pixel` in a linear congruential generator and in xoroshiro64*; {:.2} of neighbours with one \
             scramble",
            textbook[0][0], textbook[1][0], textbook[1][1], textbook[2][0]
        ),
        ours: format!(
            "{worst:.4} at most (standard error up to {error:.4}) between pixels and between seeds; {opposed:.2} \
             between neighbours with {FEW} Sobol samples, as intended"
        ),
        how: format!(
            "Errors of renders of a lit floor: of pixels 1 and 16 apart, and of seeds n and n + 1, by t-test over \
             seeds, for independent samples, 257 Sobol samples and {FEW}; and first numbers of adjacent pixels and \
             seeds. The textbook's images: the area of a quarter disk in each pixel, from {FEWER} samples."
        ),
        picture: Some(Picture {
            ending: "png",
            bytes: picture(&[congruential, unmixed, one_scramble, sampler::<Xoshiro>, sampler::<Sobol>]),
            caption: "Noise from `seed + pixel` in a linear congruential generator and in xoroshiro64*, from one \
                      Sobol scramble; and from independent streams and from a Sobol scramble for each pixel, here"
                .into(),
        }),
    }
}
