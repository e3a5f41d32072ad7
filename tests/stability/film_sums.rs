//! Sums of very many samples.

use crate::common::random::Random;
use crate::common::worlds::{Scene, camera};
use crate::common::{full, meshes::v, settings};
use crate::curve::{Axes, curve, svg};
use crate::row::{Finding, Part, Picture, Row};
use glam::DVec3;
use plotters::prelude::SeriesLabelPosition;
use wavetrace::film::Pixel;
use wavetrace::render::{Control, SamplerKind};
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Numbers,
    name: "film_sums",
    title: "Sums of many samples stop to grow",
    fails: "An f32 sum stops to grow where a sample is less than half its last digit: of samples of one size, after \
        2<sup>24</sup> at the latest. The image gets darker with each further sample. A running mean, <code>m += (x \
        - m) / n</code>, stands still as soon as 1/n is below its last digit: all further samples are lost. A \
        variance from sums of squares is the difference of two large numbers: in f32 nothing is left of it.",
    remedy: "Sums and sums of squares are f64, counts u64. Samples are f32, so that sums of up to 2<sup>29</sup> \
        equal ones are exact. Passes of 64 samples are summed by themselves. A variance is still a difference: after \
        10<sup>8</sup> samples a spread below 10<sup>-5</sup> of the mean may be lost in rounding, which is \
        10<sup>-9</sup> of the mean's own error.",
    source: "Chan, Golub and LeVeque 1983 on variances; sums of parts: Higham 1993",
    run,
};

/// Samples of a pixel.
const MANY: u64 = 100_000_000;
/// Samples that are summed by themselves.
const PASS: u64 = 64;
/// No power of two divides out of these.
const CONSTANT: [f32; 3] = [0.1, 0.7, 12345.678];
/// Two values that take turns, whose variance is known.
const TURNS: [f32; 2] = [0.7, 0.7014];

/// What a textbook keeps of a pixel, in f32.
#[derive(Default)]
struct Plain {
    sum: f32,
    sum2: f32,
    running: f32,
}

/// A point of the curves: samples, and errors relative to the truth of the mean by f32 sum, f32 running mean and
/// film, and of the variance by f32 sums and film.
struct Point {
    n: u64,
    means: [f64; 3],
    variances: [f64; 2],
}

/// Adds [`MANY`] samples: a constant, uniform noise, and two values that take turns, to a film's pixel as the program
/// does and to the textbook's sums; the last sample that changed the running mean, too.
fn add_all() -> (Vec<Point>, Pixel, u64) {
    let (mut film, mut pass, mut random) = (Pixel::default(), Pixel::default(), Random(1));
    // f32 sum of the constant; running mean of the noise; sums of the two values.
    let [mut constant, mut noise, mut turns] = std::array::from_fn(|_| Plain::default());
    // Numbers of 24 bits: their sum is exact in integers.
    let (mut exact, mut points, mut next, mut moved) = (0u64, Vec::new(), 1000, 0);
    for n in 1..=MANY {
        let bits = random.bits() >> 40;
        let (u, turn) = (bits as f32 / (1 << 24) as f32, TURNS[(n % 2) as usize]);
        exact += bits;
        pass.add([CONSTANT[0], u, turn]);
        if n % PASS == 0 || n == MANY {
            film.merge(&std::mem::take(&mut pass));
        }
        constant.sum += CONSTANT[0];
        let running = noise.running + (u - noise.running) / n as f32;
        if running != noise.running {
            (noise.running, moved) = (running, n);
        }
        turns.sum += turn;
        turns.sum2 += turn * turn;
        if n < next && n < MANY {
            continue;
        }
        next = (next as f64 * 1.2).ceil() as u64;
        let mut now = film;
        now.merge(&pass);
        let count = n as f64;
        let mean = exact as f64 / f64::from(1 << 24) / count;
        let of_sum = |p: &Plain| f64::from(p.sum) / count;
        let error = |found: f64, truth: f64| (found / truth - 1.0).abs();
        let variance = of_turns(n) / (count - 1.0);
        let plain = (turns.sum2 - turns.sum * turns.sum / n as f32) / (n as f32 - 1.0) / n as f32;
        let ours = now.mean();
        points.push(Point {
            n,
            means: [
                error(of_sum(&constant), f64::from(CONSTANT[0])),
                error(f64::from(noise.running), mean),
                error(ours[0], f64::from(CONSTANT[0])).max(error(ours[1], mean)),
            ],
            variances: [error(f64::from(plain), variance), error(now.variance_of_mean()[2], variance)],
        });
    }
    (points, film, moved)
}

/// Variance of `n` values that take turns, about their own mean.
fn of_turns(n: u64) -> f64 {
    let (half, n) = ((n / 2) as f64, n as f64);
    (f64::from(TURNS[1]) - f64::from(TURNS[0])).powi(2) * half * (n - half) / n / n
}

/// Bound of the relative error of a sum of `n` positive numbers in passes: one rounding for each addition to the pass
/// and each pass.
fn bound(n: u64) -> f64 {
    (PASS + n.div_ceil(PASS)) as f64 * f64::powi(2.0, -53)
}

/// A pixel that sees nothing but a constant, rendered: exact or not at all.
fn rendered(spp: u32) -> Pixel {
    let mut scene = Scene::new(camera(DVec3::ZERO, v(0.0, 1.0, 0.0), [1, 1], 40.0));
    scene.0.background(CONSTANT);
    let settings = settings(Method::Mis, SamplerKind::Sobol, spp, 1);
    scene.renderer().render(&settings, &Control::default()).unwrap().film.pixels()[0]
}

fn run() -> Finding {
    let spp = if full() { MANY as u32 } else { 10_000_000 };
    let pixel = rendered(spp);
    assert_eq!(pixel.count, u64::from(spp));
    assert_eq!(pixel.mean(), CONSTANT.map(f64::from), "a constant image is exact");

    let (points, film, moved) = add_all();
    let last = &points[points.len() - 1];
    assert_eq!((last.n, film.count, film.mean()[0]), (MANY, MANY, f64::from(CONSTANT[0])));
    // One rounding of the division: sums of 24-bit numbers are exact.
    assert!(points.iter().all(|p| p.means[2] <= f64::EPSILON), "means of noise are exact");
    let ulp = f64::powi(2.0, -53);
    for p in &points {
        // The sum is exact; that of the squares errs by the bound, and what is taken off by a few roundings.
        let limit = (bound(p.n) + 4.0 * ulp) * f64::from(TURNS[1]).powi(2) / of_turns(p.n) + 4.0 * ulp;
        assert!(p.variances[1] <= limit, "variance of {}: {:e}, {limit:e}", p.n, p.variances[1]);
    }
    // What rounding leaves of a spread that is none, against the bound.
    let (left, mean) = (film.variance_of_mean()[0].sqrt(), f64::from(CONSTANT[0]));
    assert!(left <= mean * (2.0 * bound(MANY) / (MANY - 1) as f64).sqrt(), "{left:e}");
    println!("at {MANY}: means {:?}, variances {:?}; running mean moved until {moved}", last.means, last.variances);
    // A 0.5 / n that is less than half the last digit of a mean of 0.5 moves nothing.
    assert!(last.means[0] > 0.5 && moved <= 1 << 25 && last.variances[0] > 0.5, "the textbook should fail");

    let line = |k: usize| points.iter().map(|p| (p.n as f64, p.means[k])).collect();
    let spreads = |k: usize| points.iter().map(|p| (p.n as f64, p.variances[k])).collect();
    let axes = Axes {
        x: ("samples", 1e3..MANY as f64),
        y: ("relative error", 1e-10..1e9),
        legend: SeriesLabelPosition::UpperLeft,
    };
    let curves = [
        curve("mean, f32 sum", line(0)),
        curve("mean, f64 film", line(2)),
        curve("mean, f32 running mean", line(1)),
        curve("variance, f64 film", spreads(1)),
        curve("variance, f32 sums", spreads(0)),
    ];
    Finding {
        textbook: format!(
            "f32 sum: {:.0} % of a constant lost at 10<sup>8</sup> samples; a running mean moves no more after {:.1} \
             * 10<sup>7</sup>; variance off by a factor of {:.0e}",
            100.0 * last.means[0],
            moved as f64 / 1e7,
            last.variances[0]
        ),
        ours: format!(
            "means exact; variance right to {:.0e} for a spread of {:.1} % of the mean",
            last.variances[1],
            100.0 * of_turns(MANY).sqrt() / f64::from(TURNS[0])
        ),
        how: format!(
            "A constant image of {spp} samples, rendered, and 10<sup>8</sup> samples of a constant, of noise, and of \
             two values in turn, added to a film's pixel. The mean of the constant tells a standard error of {:.0e} \
             of itself where there is none.",
            left / mean
        ),
        picture: Some(Picture {
            ending: "svg",
            bytes: svg(&axes, &curves),
            caption: "Relative error by number of samples; errors below the axis stand on it".into(),
        }),
    }
}
