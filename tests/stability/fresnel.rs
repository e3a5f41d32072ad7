//! Fresnel's equations around the critical angle, at grazing angles, for all indices; random numbers at their ends.

use crate::common::random::Random;
use crate::common::samples;
use crate::curve::{Axes, curve, dots, svg};
use crate::row::{Finding, Part, Picture, Row};
use plotters::prelude::SeriesLabelPosition;
use wavetrace::lanes::Vec3;
use wavetrace::material::{Diffuse, Lobe, Matt, MattRow, Transparent, TransparentRow, fresnel_dielectric};

pub const ROW: Row = Row {
    part: Part::Shading,
    name: "fresnel",
    title: "Fresnel at grazing and critical angles",
    fails: "Snell's law by sines, cos<sub>t</sub> = sqrt(1 - sin<sup>2</sup> / n<sup>2</sup>) with sin<sup>2</sup> = \
            1 - cos<sup>2</sup>, loses a small cosine: at grazing angles glass of index 1 turns into a mirror. At \
            the critical angle the root may be of a negative number. A sample chosen by `u <= F` and weighted by F / \
            F is 0 / 0 where F = 0 and u = 0.",
    remedy: "cos<sub>t</sub><sup>2</sup> is computed as cos<sup>2</sup> / n<sup>2</sup> + (1 - 1 / n<sup>2</sup>), \
             with one rounding and no difference for index 1; what is not positive is total reflection; reflection \
             is chosen by u < F, which neither F = 0 nor F = 1 can miss, and its weight is 1, not a quotient.",
    source: "the equations are Fresnel's, 1823; the form is our own",
    run,
};

/// Half a unit in the last place of 1.
const U: f64 = f32::EPSILON as f64 / 2.0;
const INDICES: [f32; 12] = [
    1.0,
    1.0 + f32::EPSILON,
    1.0 - f32::EPSILON,
    1.0001,
    1.0 / 1.0001,
    1.5,
    1.0 / 1.5,
    2.4,
    1.0 / 2.4,
    0.3,
    1000.0,
    1e-3,
];
/// The largest random number.
const LAST: f32 = 1.0 - f32::EPSILON / 2.0;

/// Reflectance by both cosines.
fn reflectance(ci: f64, ct: f64, n: f64) -> f64 {
    let (p, s) = ((n * ci - ct) / (n * ci + ct), (ci - n * ct) / (ci + n * ct));
    if ci + ct == 0.0 { 1.0 } else { 0.5 * (p * p + s * s) }
}

/// Squared cosine of refraction; negative where reflection is total.
fn squared(c: f32, n: f32) -> f64 {
    let (c, n2) = (f64::from(c), f64::from(n).powi(2));
    ((n2 - 1.0) + c * c) / n2
}

fn exact(c: f32, n: f32) -> f64 {
    reflectance(f64::from(c), squared(c, n).max(0.0).sqrt(), f64::from(n))
}

/// How far `r` is from what rounding explains. The squared cosine has the errors of 1 / n^2, which is known, of 1 less
/// that, and a rounding of either product and of the sum; the reflectance follows the root of it, steeply near 0, with
/// 16 roundings of its own.
fn excess(r: f32, c: f32, n: f32) -> f64 {
    let (inverse, c2) = (1.0 / (n * n), f64::from(c).powi(2));
    let wide = f64::from(inverse);
    let of_index = (wide - f64::from(n).powi(-2)).abs() * (1.0 - c2) + (f64::from(1.0 - inverse) - (1.0 - wide)).abs();
    let error = of_index + U * (c2 * wide + squared(c, n).abs());
    let at = |off: f64| reflectance(f64::from(c), (squared(c, n) + off).max(0.0).sqrt(), f64::from(n));
    let (low, high) = (at(error).min(at(-error)), at(error).max(at(-error)));
    let (low, high) = (low.min(exact(c, n)) - 16.0 * U, high.max(exact(c, n)) + 16.0 * U);
    let r = f64::from(r);
    if r.is_nan() { f64::INFINITY } else { (low - r).max(r - high).max(0.0) }
}

/// Snell's law by sines.
fn textbook(c: f32, n: f32) -> f32 {
    let sin_t = (1.0 - c * c).sqrt() / n;
    if sin_t >= 1.0 {
        return 1.0;
    }
    let ct = (1.0 - sin_t * sin_t).sqrt();
    let (p, s) = ((n * c - ct) / (n * c + ct), (c - n * ct) / (c + n * ct));
    0.5 * (p * p + s * s)
}

/// Cosines where it is hard: grazing down to 10^-7, and about the critical angle, and anywhere.
fn cosines(n: f32, random: &mut Random, count: usize) -> Vec<f32> {
    let critical = (1.0 - n * n).max(0.0).sqrt();
    (0..count)
        .map(|i| match i % 3 {
            0 => 10f32.powf(random.within(-7.0, 0.0)),
            1 => (critical + random.within(-1.0, 1.0) * 10f32.powf(random.within(-8.0, -2.0))).clamp(0.0, 1.0),
            _ => random.unit(),
        })
        .collect()
}

/// Unit, finite, on the side where it belongs.
fn proper(wi: Vec3<f32>, weight: Vec3<f32>, through: bool) -> bool {
    let side = if through { wi.z < 0.0 } else { wi.z >= 0.0 };
    let sound = weight.lane(0).iter().all(|w| w.is_finite() && *w >= 0.0);
    side && sound && (wi.length2() - 1.0).abs() < 8.0 * f32::EPSILON
}

/// The smallest and the largest random numbers, at all lobes, seen from above and edge-on; the number of samples.
fn ends() -> usize {
    let mut checked = 0;
    for (c, numbers) in [1.0f32, 0.5, 1e-3, 1e-7].into_iter().flat_map(|c| (0..8).map(move |bits| (c, bits))) {
        let wo = Vec3::splat([(1.0 - c * c).sqrt(), 0.0, c]);
        let u: [f32; 3] = std::array::from_fn(|k| if numbers >> k & 1 == 1 { LAST } else { 0.0 });
        for n in INDICES.into_iter().chain([1e-39, 1e-20, 1e20, 1e38]) {
            let p = Transparent::params(TransparentRow { color: [1.0; 3], ref_index: n }.into());
            for outside in [true, false] {
                let s = Transparent::sample(&p, wo, outside, u);
                assert!(proper(s.wi, s.weight, s.transmitted), "index {n}, cosine {c}, {u:?}: {s:?}");
                let (r, _) = fresnel_dielectric(c, if outside { n } else { 1.0 / n });
                assert!(
                    r > 0.0 || s.transmitted,
                    "index {n}, cosine {c}, {u:?}: reflects though there is no reflectance"
                );
                assert!(r < 1.0 || !s.transmitted, "index {n}, cosine {c}, {u:?}: passes where reflection is total");
                checked += 1;
            }
        }
        let diffuse = Diffuse::sample(&Vec3::splat([1.0; 3]), wo, true, u);
        assert!(proper(diffuse.wi, diffuse.weight, false), "Lambert, {u:?}: {diffuse:?}");
        for m in [f32::MIN_POSITIVE, 1e-7, 1e-4, 0.01, 0.5, 0.999, 1.0] {
            let s = Matt::sample(&Matt::params(MattRow::new([1.0; 3], m).into()), wo, true, u);
            assert!(proper(s.wi, s.weight, false), "mattness {m}, cosine {c}, {u:?}: {s:?}");
            checked += 1;
        }
        checked += 1;
    }
    checked
}

fn run() -> Finding {
    let count = samples(10_000) as usize;
    let (mut naive, mut total, mut random) = (0, 0, Random(4));
    for n in INDICES {
        let mut worst = 0.0f64;
        for c in cosines(n, &mut random, count) {
            let (ours, ct) = fresnel_dielectric(c, n);
            assert!((0.0..=1.0).contains(&ours) && ct >= 0.0, "index {n}, cosine {c}: {ours}, {ct}");
            let off = excess(ours, c, n);
            assert!(off == 0.0, "index {n}, cosine {c}: {ours} is {off} beyond rounding of {}", exact(c, n));
            // The root of a square errs by a rounding of its argument, and by its own.
            assert!(n != 1.0 || (ours == 0.0 || c * c == 0.0) && (ct - c).abs() <= f32::EPSILON * c, "index 1: {ours}");
            naive += usize::from(n == 1.0 && excess(textbook(c, n), c, n) > 0.0);
            worst = worst.max((f64::from(ours) - exact(c, n)).abs());
            total += 1;
        }
        println!("index {n}: error {worst:.1e} at most");
    }
    let share = 100.0 * naive as f64 / count as f64;
    let mirror = textbook(1e-4, 1.0);
    assert!(share > 10.0 && mirror > 0.5, "the textbook's form should fail: {share} %, {mirror}");
    let (f, u) = (fresnel_dielectric(0.5f32, 1.0).0, 0.0f32);
    let chance = std::hint::black_box(f);
    let weight = if u <= f { f / chance } else { 1.0 };
    assert!(weight.is_nan(), "a quotient of chances of 0: {weight}");
    let checked = ends();
    Finding {
        textbook: format!(
            "index 1: wrong at {share:.0} % of angles, and reflects {mirror:.2} at a cosine of 10<sup>-4</sup>; a \
             weight of {weight} at u = 0"
        ),
        ours: format!(
            "none of {total} beyond rounding; index 1 reflects {}; {checked} samples with numbers at their ends are \
             sound",
            fresnel_dielectric(1e-4f32, 1.0).0
        ),
        how: "Twelve indices from 10<sup>-3</sup> to 1000, 1 and its neighbours among them, at cosines down to \
              10<sup>-7</sup>, about the critical angle and anywhere, against f64 with an interval that rounding of \
              the squared cosine explains. All lobes with random numbers of 0 and 1 - 2<sup>-24</sup> in all \
              combinations, indices from 10<sup>-39</sup> to 10<sup>38</sup>."
            .into(),
        picture: Some(picture()),
    }
}

/// Reflectance of an index of 1 and of almost 1 at grazing angles.
fn picture() -> Picture {
    let cosines = || (0..=240).map(|k| 10f64.powf(f64::from(k) / 40.0 - 6.0));
    let of = |f: &dyn Fn(f32) -> f64| cosines().map(|c| (c, f(c as f32))).collect();
    let n = 1.0001;
    let few = cosines().step_by(12).map(|c| (c, exact(c as f32, n))).collect();
    let curves = [
        curve("textbook, index 1", of(&|c| f64::from(textbook(c, 1.0)))),
        curve("here, index 1: none", of(&|c| f64::from(fresnel_dielectric(c, 1.0).0))),
        curve("here, index 1.0001", of(&|c| f64::from(fresnel_dielectric(c, n).0))),
        dots("the same in f64", few),
    ];
    let axes = Axes { x: ("cosine", 1e-6..1.0), y: ("reflectance", 1e-8..1.0), legend: SeriesLabelPosition::LowerLeft };
    Picture { ending: "svg", bytes: svg(&axes, &curves), caption: "Reflectance at grazing angles.".into() }
}
