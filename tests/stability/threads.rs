//! The order in which threads finish.

use crate::common::random::Random;
use crate::common::worlds::rooms;
use crate::common::{SAMPLERS, full, settings};
use crate::row::{Finding, Part, Row};
use wavetrace::film::Film;
use wavetrace::render::{Control, Integrator, Renderer, Settings};
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Numbers,
    name: "threads",
    title: "Each render gives another image",
    fails: "Sums of rounded numbers depend on their order. Where each thread adds its samples to the image when it \
        has them, by atomic adds say, that order is another in each run, and so is the image: a change of the code \
        that should not alter it cannot be told from chance. So it is where each thread has a generator of random \
        numbers of its own.",
    remedy: "An image is cut into jobs by its size and number of samples alone. What jobs bring is added to a pixel \
        in the order of its samples: what comes early waits ([threads](decisions/threads.md)). Random numbers are \
        keyed by seed, pixel and sample. Kernels are written once for one lane and eight, and round alike in both.",
    source: "order of sums: Goldberg 1991; keyed random numbers: Salmon, Moraes, Dror and Shaw 2011",
    run,
};

/// No multiple of a tile either way.
const SIZE: [u32; 2] = [17, 9];
/// A part of a job more than one.
const SPP: u32 = 70;
const THREADS: [usize; 7] = [2, 3, 5, 8, 16, 33, 64];
const WAVES: [usize; 5] = [1, 7, 64, 4096, 1 << 16];

fn render(renderer: &Renderer, settings: &Settings) -> Film {
    let rendered = renderer.render(settings, &Control::default()).unwrap();
    assert!(rendered.bad.is_empty() && !rendered.partial && rendered.threads == settings.threads);
    rendered.film
}

/// All that a film holds, in bits: sums, and estimates with what light paths bring.
fn bits(film: &Film) -> Vec<u64> {
    let sums = film.pixels().iter().flat_map(|p| p.sum.into_iter().chain(p.sum2).chain([p.count as f64]));
    let estimates = (0..film.pixels().len()).flat_map(|i| film.mean(i).into_iter().chain(film.variance(i)));
    sums.chain(estimates).map(f64::to_bits).collect()
}

/// The share of pixels that differ between two runs in which jobs of 64 samples are added to f32 sums as they finish,
/// and the largest difference between them, relative.
fn textbook(pixels: usize, jobs: usize) -> (f64, f64) {
    let mut random = Random(1);
    let samples: Vec<Vec<f32>> =
        (0..pixels).map(|_| (0..jobs * 64).map(|_| -(1.0 - random.unit()).ln()).collect()).collect();
    let [a, b] = [2, 3].map(|seed| {
        let mut random = Random(seed);
        let mut order: Vec<usize> = (0..jobs).collect();
        (1..jobs).for_each(|i| order.swap(i, random.below(i + 1)));
        let add = |of: &Vec<f32>| order.iter().flat_map(|&job| &of[job * 64..][..64]).fold(0.0f32, |sum, s| sum + s);
        samples.iter().map(add).collect::<Vec<_>>()
    });
    let differ = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    let most = a.iter().zip(&b).map(|(a, b)| f64::from((a - b).abs() / a)).fold(0.0, f64::max);
    (differ as f64 / pixels as f64, most)
}

fn run() -> Finding {
    let mut renders = 0;
    for (name, renderer) in rooms(SIZE) {
        // In the short form a room of every material, with light paths.
        if !full() && name != "delta" {
            continue;
        }
        for sampler in SAMPLERS {
            let base = Settings { threads: 1, ..settings(Method::Mis, sampler, SPP, 5) };
            let expected = bits(&render(&renderer, &base));
            let threads = THREADS.map(|threads| Settings { threads, ..base.clone() });
            let waves = WAVES.map(|wave_size| Settings { wave_size, threads: 2, ..base.clone() });
            let reference =
                [1, 2, 64].map(|threads| Settings { integrator: Integrator::Reference, threads, ..base.clone() });
            for other in threads.iter().chain(&waves).chain(&reference) {
                let found = bits(&render(&renderer, other));
                let differ = found.iter().zip(&expected).filter(|(a, b)| a != b).count();
                assert_eq!(differ, 0, "{name}: {differ} numbers differ with {other:?}");
                renders += 1;
            }
        }
    }
    let (differ, most) = textbook(1000, 16);
    assert!(differ > 0.5, "f32 sums in two orders should differ: {differ}");
    Finding {
        textbook: format!("{:.0} % of pixels differ between two runs, by up to {most:.0e}", 100.0 * differ),
        ours: format!("no bit, in {renders} renders"),
        how: format!(
            "Renders with {THREADS:?} threads, waves of {WAVES:?} paths, and by the reference integrator, of {} x {} \
             pixels, {SPP} samples each, with both samplers: sums, sums of squares and estimates against those of \
             one thread. The textbook's form: 1024 exponential samples in each pixel, in jobs of 64 that end in two \
             orders, f32.",
            SIZE[0], SIZE[1]
        ),
        picture: None,
    }
}
