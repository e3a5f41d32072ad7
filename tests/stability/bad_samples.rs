//! A sample that is not a number.

use crate::common::{samples, settings, worlds};
use crate::row::{Finding, Part, Row};
use std::collections::BTreeSet;
use wavetrace::film::{BadSample, Film, Pixel};
use wavetrace::render::{Control, Integrator, Rendered, Renderer, SamplerKind, Settings};
use wavetrace::wave::Method;
use wavetrace::{MaterialInput, WorldBuilder};

pub const ROW: Row = Row {
    part: Part::Numbers,
    name: "bad_samples",
    title: "One sample that is no number spoils a pixel for good",
    fails: "A weight that overflows is infinite, infinity times zero or less infinity is no number, and whatever is \
        added to either stays so. The pixel shows a dot that no further sample removes; a reconstruction filter \
        wider than a pixel spreads it to all pixels around. Textbooks leave such samples out without a word, and \
        with them the fault.",
    remedy: "Each sample is looked at before it enters the film. One that is not finite is left out, counted, and \
        told by pixel and number, in the closing lines of the program and as `bad_samples` and `first_bad_samples` \
        in `--stats`. Filters are one pixel wide. A sample depends on seed, pixel and number alone: \
        `Renderer::sample` of the library traces it again; the program has no option for that. Of what a light path brings, the \
        pixel alone is told.",
    source: "after Pharr, Jakob and Humphreys 2023, section 1.3, who leave it out with a message",
    run,
};

const SIZE: [u32; 2] = [32, 24];
/// Samples of a pixel: one pass, so that the film's order of adding is that of the samples.
const SPP: u32 = 64;
/// The strong lamp's power of two: it gives 2.6 * 10^38, and f32 ends at 3.4 * 10^38.
const EXPONENT: i32 = 126;

/// A room whose lamp is 2^`exponent` times as strong: nothing rounds differently, unless it overflows.
fn world(exponent: i32) -> Renderer {
    let room = worlds::room(SIZE).0;
    let mut strong = WorldBuilder::new(room.camera().clone());
    for material in room.materials() {
        strong.material(match material {
            MaterialInput::Luminous { radiance } => {
                MaterialInput::Luminous { radiance: radiance.map(|c| c * f32::powi(2.0, exponent)) }
            }
            other => other.clone(),
        });
    }
    room.meshes().iter().for_each(|mesh| _ = strong.mesh(mesh.clone()));
    room.objects().iter().for_each(|object| strong.object(object.clone()));
    Renderer::new(strong.build().unwrap())
}

/// The same pixel, 2^[`EXPONENT`] times as bright: exact in f64.
fn stronger(pixel: &Pixel) -> Pixel {
    let by = f64::powi(2.0, EXPONENT);
    Pixel { sum: pixel.sum.map(|c| c * by), sum2: pixel.sum2.map(|c| c * by * by), count: pixel.count }
}

fn is_finite(sample: [f32; 3]) -> bool {
    sample.iter().all(|c| c.is_finite())
}

/// Pixels that are no numbers where each sample is added to all pixels within `reach`, as by a filter 2 `reach` + 1
/// wide.
fn textbook(bad: &[BadSample], reach: u32) -> usize {
    let around = |c: u32, side: u32| c.saturating_sub(reach)..(c + reach + 1).min(side);
    let spoilt = bad.iter().flat_map(|b| {
        let [x, y] = b.pixel;
        around(y, SIZE[1]).flat_map(move |j| around(x, SIZE[0]).map(move |i| [i, j]))
    });
    spoilt.collect::<BTreeSet<_>>().len()
}

/// Holds a render that had bad samples to the one that is 2^-[`EXPONENT`] times as bright and had none: how many
/// pixels are the same to the bit.
fn check(renderer: &Renderer, settings: &Settings, strong: &Rendered, plain: &Film) -> usize {
    let mut same = 0;
    for (i, (pixel, whole)) in strong.film.pixels().iter().zip(plain.pixels()).enumerate() {
        let at = [i as u32 % SIZE[0], i as u32 / SIZE[0]];
        let told: Vec<u32> = strong.bad.iter().filter(|b| b.pixel == at).map(|b| b.sample).collect();
        if told.is_empty() {
            assert_eq!(*pixel, stronger(whole), "pixel {at:?} has no bad sample");
            same += 1;
            continue;
        }
        // Traced again one by one, the same samples are bad, and the film holds the others.
        let all: Vec<_> = (0..SPP).map(|sample| renderer.sample(settings, at, sample).unwrap()).collect();
        let bad: Vec<u32> = (0..SPP).filter(|&sample| !is_finite(all[sample as usize])).collect();
        assert_eq!(told, bad, "pixel {at:?}");
        let mut good = Pixel::default();
        all.iter().filter(|s| is_finite(**s)).for_each(|s| _ = good.add(*s));
        assert_eq!(*pixel, good, "pixel {at:?} without its bad samples");
        // What `+=` makes of it.
        let sum = all.iter().fold([0.0f32; 3], |sum, s| std::array::from_fn(|k| sum[k] + s[k]));
        assert!(!is_finite(sum), "the textbook's sum should be no number: {sum:?}");
    }
    same
}

fn run() -> Finding {
    let [renderer, plain] = [EXPONENT, 0].map(world);
    let (mut bad, mut spoilt, mut spread, mut same, mut images) = (0, 0, 0, 0, 0);
    for seed in 0..u64::from(samples(4)) {
        let settings = Settings { threads: 2, ..settings(Method::Nee, SamplerKind::Sobol, SPP, seed) };
        let [strong, weak] = [&renderer, &plain].map(|r| r.render(&settings, &Control::default()).unwrap());
        assert!(weak.bad.is_empty());
        same += check(&renderer, &settings, &strong, &weak.film);
        assert!(strong.film.image().pixels.iter().all(|p| is_finite(*p)));
        let other = Settings { threads: 5, wave_size: 7, integrator: Integrator::Reference, ..settings };
        let other = renderer.render(&other, &Control::default()).unwrap();
        assert_eq!((&strong.bad, &strong.film), (&other.bad, &other.film), "told alike, whatever the schedule");
        bad += strong.bad.len();
        spoilt += textbook(&strong.bad, 0);
        spread += textbook(&strong.bad, 2);
        images += 1;
    }
    assert!(bad > 0 && spread > 10 * spoilt, "{bad} bad samples should spoil pixels: {spoilt}, {spread} by a filter");
    let mut pixel = Pixel::default();
    assert!(!pixel.add([1.0, f32::NAN, 1.0]) && !pixel.add([f32::NEG_INFINITY, 0.0, 0.0]) && pixel == Pixel::default());
    let pixels = images * SIZE[0] * SIZE[1];
    assert_eq!(same + spoilt, pixels as usize);
    Finding {
        textbook: format!(
            "{bad} bad samples of {:.2} million spoil {spoilt} pixels, {spread} with a filter 5 pixels wide",
            f64::from(pixels * SPP) / 1e6
        ),
        ours: format!(
            "none spoilt; all {bad} told, {same} of {pixels} pixels the same to the bit, {spoilt} without them"
        ),
        how: format!(
            "A room whose lamp gives 2<sup>{EXPONENT}</sup> times as much, so that a few samples overflow, against \
             the same room without: apart from them all is 2<sup>{EXPONENT}</sup> times as bright to the bit, sums \
             and sums of squares. All samples of a pixel that has bad ones are traced again, each by itself: those \
             that were told are those that are bad. Images by `nee`, {SPP} samples per pixel, {images} seeds, by \
             waves and by the reference."
        ),
        picture: None,
    }
}
