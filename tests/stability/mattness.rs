//! The lobe between mirror and Lambert, at both ends and near them.

use crate::common::meshes::{patch, sphere, v};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, lamp, matt};
use crate::common::{METHODS, film, samples, settings};
use crate::curve::{Axes, curve, svg};
use crate::lobe::{U, chi_squared, direction, exact, less, lobe, textbook, unit};
use crate::row::{Finding, Part, Picture, ROW_FAMILIES, Row};
use glam::DVec3;
use plotters::prelude::SeriesLabelPosition;
use std::f64::consts::{FRAC_PI_4, TAU};
use wavetrace::lanes::Vec3;
use wavetrace::material::{Lobe, Matt};
use wavetrace::render::SamplerKind;
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Shading,
    name: "mattness",
    title: "Lobes between mirror and Lambert",
    fails: "A narrow lobe is a quotient of small differences. Written as in a paper, in f32, all digits of 1 - \
            rho<sup>2</sup> and A<sup>2</sup> - B<sup>2</sup> cancel: the density that weights between light \
            sampling and the lobe is wrong, negative or no number.",
    remedy: "1 - rho is kept in place of rho, computed from mattness in f64 without a difference; A - B is the sum \
             (1 - rho)<sup>2</sup> + rho |r - w|<sup>2</sup> of what is positive, r the mirror direction; directions \
             are sampled exactly, with the colour as weight, so that no density divides another. Mattness 0 is a \
             mirror and 1 Lambertian, by their own code. Below about 10<sup>-6</sup> a lobe is narrower than \
             directions in f32 can tell apart, and its density loses its digits; at 10<sup>-7</sup> its light does \
             not. Below 2<sup>-26</sup> half of them are off the mirror's by less than that, and it is a mirror.",
    source: "Kato and McCullagh 2020 for the lobe; its form without cancellation is our own",
    run,
};

const MATTNESS: [f32; 10] = [0.0, 1e-38, 1e-20, 1e-12, 1e-7, 1e-4, 0.01, 0.5, 0.999, 1.0];
/// Below that it is a mirror.
const NARROWEST: f32 = 1.0 / (1 << 26) as f32;

/// Largest relative error of the density. Lengths of rounded unit vectors err by 4 U at most: between two of them that
/// is (8 U)^2 in A - B, which is (1 - rho)^2 at least and enters with exponent -5/2. The rest are the operations, each
/// counted with its exponent: about 100.
fn bound(m: f32) -> f64 {
    2.5 * (8.0 * U / less(m)).powi(2) + 100.0 * U
}

/// `count` directions from anywhere up to 85 degrees, and what the lobe makes of them.
fn scattered(m: f32, count: usize) -> Vec<(Vec3<f32>, Vec3<f32>)> {
    let mut random = Random(1);
    (0..count)
        .map(|_| {
            let wo = direction(f64::from(random.unit()) * 85f64.to_radians(), TAU * f64::from(random.unit()));
            let scattered = Matt::sample(&lobe(m), wo, true, [random.unit(), random.unit(), random.unit()]);
            assert_eq!(scattered.weight.lane(0), [1.0; 3]);
            (wo, scattered.wi)
        })
        .collect()
}

/// Relative errors of the density, ascending: of the textbook, and ours. What is no number counts as infinite.
fn errors(m: f32, count: usize) -> [Vec<f64>; 2] {
    let sorted = |density: &dyn Fn(Vec3<f32>, Vec3<f32>) -> f32| {
        let error = |(wo, wi): (Vec3<f32>, Vec3<f32>)| (f64::from(density(wo, wi)) / exact(m, wo, wi) - 1.0).abs();
        let errors = scattered(m, count).into_iter().map(error);
        let mut errors: Vec<f64> = errors.map(|e| if e.is_nan() { f64::INFINITY } else { e }).collect();
        errors.sort_by(f64::total_cmp);
        errors
    };
    [sorted(&|wo, wi| textbook(m, wo, wi)), sorted(&|wo, wi| Matt::eval(&lobe(m), wo, wi).pdf)]
}

/// Mean distance between the directions that two lobes make of the same numbers; mattness 0 is the mirror.
fn apart(a: f32, b: f32) -> f64 {
    let one = |m: f32| -> Vec<DVec3> {
        let mirror =
            |(wo, wi): &(Vec3<f32>, Vec3<f32>)| if m == 0.0 { unit(Vec3::new(-wo.x, -wo.y, wo.z)) } else { unit(*wi) };
        scattered(m.max(f32::MIN_POSITIVE), 20_000).iter().map(mirror).collect()
    };
    let (a, b) = (one(a), one(b));
    a.iter().zip(&b).map(|(a, b)| a.distance(*b)).sum::<f64>() / a.len() as f64
}

/// Radiance that a floor reflects of a lamp in the mirror direction, all of a narrow lobe; and how far samples of a
/// ball of albedo 0.5 under a sky of 2 are from all being 1 or 2, in samples.
fn images(m: f32) -> ([f64; 3], f64) {
    let floor = Scene::new(camera(v(0.0, -1.0, 1.0), v(0.0, 1.0, -1.0), [8, 8], 1.0))
        .with(patch(0.0, 0.0, 0.0, 1.0, 1.0), matt(1.0, m))
        .with(patch(0.0, 0.9, 0.9, 1.0, 1.0), lamp(1.0))
        .renderer();
    let render = |method| film(&floor, &settings(method, SamplerKind::Xoshiro, samples(256), 1));
    let lit = METHODS.map(|method| Estimate::of_film(&render(method), 1).mean);
    let ball = Scene::new(camera(v(0.3, -3.0, 0.4), v(-0.3, 3.0, -0.4), [24, 24], 50.0))
        .background(2.0)
        .with(sphere(DVec3::ZERO, 1.0, 1, true), matt(0.5, m))
        .renderer();
    let image = film(&ball, &settings(Method::Mis, SamplerKind::Xoshiro, samples(32), 1));
    let off = image.pixels().iter().map(|p| (p.sum2[1] - 3.0 * p.sum[1] + 2.0 * p.count as f64).abs());
    (lit, off.fold(0.0, f64::max))
}

fn run() -> Finding {
    let mut family = Family::one_of(ROW_FAMILIES);
    let count = samples(5_000) as usize;
    let mut worst = 0.0f64;
    for m in [1e-4, 1e-3, 0.01, 0.5, 0.999, 1.0] {
        let [naive, ours] = errors(m, count);
        println!(
            "mattness {m}: errors of the density {:.1e} and {:.1e}, bound {:.1e}",
            naive[count / 2],
            ours[count - 1],
            bound(m)
        );
        assert!(ours[count - 1] < bound(m), "mattness {m}: the density errs by {}", ours[count - 1]);
        worst = worst.max(ours[count - 1]);
    }
    let [naive, _] = errors(1e-4, count);
    let share = naive.iter().filter(|e| **e > 0.01).count() as f64 / count as f64;
    assert!(share > 0.5, "the textbook's form should cancel: {share}");

    for m in MATTNESS.into_iter().filter(|m| *m > 1e-6) {
        for theta in [0.0f64, 60.0, 85.0] {
            let p = chi_squared(m, theta.to_radians(), samples(100_000));
            family.add(p, format!("mattness {m} at {theta} degrees"));
        }
    }
    let tests = family.count();
    family.judge();

    for m in MATTNESS.into_iter().filter(|m| *m >= NARROWEST) {
        for (wo, wi) in scattered(m, 5_000) {
            let [there, back] = [(wo, wi), (wi, wo)].map(|(o, i)| f64::from(Matt::eval(&lobe(m), o, i).pdf / i.z));
            // Both do the same operations, but for the order of a product of three and the division here.
            assert!((there - back).abs() <= 16.0 * U * there, "mattness {m}: {there} there, {back} back");
        }
        // tan(theta/2) = tan(pi m/4) tan(phi/2) for the angle phi of a point uniform on the 3-sphere; theta bounds the
        // distance. Its derivative by m is largest, pi/4 (s + 1/s), where the two tangents' product is 1.
        let s = (f64::from(m) * FRAC_PI_4).tan();
        let next = if m < 1.0 { m * 1.01 } else { 0.99 }.min(1.0);
        let limit = FRAC_PI_4 * (s + 1.0 / s) * f64::from((next - m).abs()) * 1.01 + 16.0 * U;
        let step = apart(m, next);
        assert!(step < limit, "mattness {m} and {next}: directions {step} apart");
    }
    // The mean of theta is 8/pi tan(pi m/4) at most.
    let from_mirror = apart(0.0, 1e-7);
    assert!(from_mirror < 2.001e-7 + 4.0 * U, "mattness 1e-7 is {from_mirror} off the mirror");

    let mut lost = 0.0f64;
    for m in MATTNESS {
        let (lit, off) = images(m);
        // A second bounce leaves 0.5 of a sample and counts 0.75 here, light that is lost 2.
        assert!(off < 0.25, "mattness {m}: {off} samples are neither the sky nor the albedo");
        if m <= 1e-4 {
            // `nee` alone cannot find such lobes. Samples of `mis` differ from 1 where both densities are alike, by 1/2
            // at most and less than one in 10^3: 10^-3 is 8 standard errors of their mean.
            println!("mattness {m}: {lit:?} of the lamp");
            lost = lost.max((lit[0] - 1.0).abs()).max((lit[2] - 1.0).abs());
        }
    }
    assert!(lost < 1e-3, "{lost} of the light is lost");
    Finding {
        textbook: format!(
            "density off by more than 1 % for {:.0} % of directions at mattness 10<sup>-4</sup>",
            100.0 * share
        ),
        ours: format!(
            "off by {worst:.0e} at most from 10<sup>-4</sup> to 1; {tests} chi-squared tests hold; at \
             10<sup>-7</sup> directions are {from_mirror:.0e} off the mirror's in the mean, and no light is lost",
        ),
        how: "Densities against f64 and a rounding bound; samples against the density at 0, 60 and 85 degrees; \
              reciprocity; directions of mattness m and 1.01 m from the same numbers no farther apart than the \
              derivative allows; a ball under a constant sky, all samples its albedo; a lamp in the mirror direction \
              of a floor, all of it reflected, at 0, 10<sup>-38</sup>, 10<sup>-20</sup>, 10<sup>-12</sup>, 10<sup>-7</sup>, 10<sup>-4</sup>, 0.01, 0.5, 0.999 and 1."
            .into(),
        picture: Some(picture()),
    }
}

/// Error of the density over mattness.
fn picture() -> Picture {
    let at = |k: i32| 10f64.powf(f64::from(k) / 4.0);
    let points: Vec<(f64, [Vec<f64>; 2])> = (-24..=0).map(|k| (at(k), errors(at(k) as f32, 1001))).collect();
    let median = |which: usize| points.iter().map(|(m, e)| (*m, e[which][500].max(1e-9))).collect();
    let limit = points.iter().map(|(m, _)| (*m, bound(*m as f32))).collect();
    let axes = Axes {
        x: ("mattness", 1e-6..1.0),
        y: ("relative error of the density, median", 1e-8..10.0),
        legend: SeriesLabelPosition::UpperRight,
    };
    let curves = [curve("textbook", median(0)), curve("here", median(1)), curve("rounding bound", limit)];
    Picture {
        ending: "svg",
        bytes: svg(&axes, &curves),
        caption: "Error of the lobe's density in directions that it samples.".into(),
    }
}
