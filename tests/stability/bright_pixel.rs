//! One pixel that outshines the image.

use crate::common::worlds::{block, colored, room};
use crate::common::{film, samples, settings};
use crate::row::{Finding, Part, Picture, Row};
use wavetrace::output::{Image, Metadata, Tone, ToneMap, png_of_rgb8};
use wavetrace::render::SamplerKind;
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Numbers,
    name: "bright_pixel",
    title: "One bright pixel darkens the image",
    fails: "Where the image is divided by its largest value, or exposed by its mean, one very bright pixel decides \
        how all others look. A lamp seen directly is enough, or a single sample of small density.",
    remedy: "The tone map is `clamp` unless told otherwise: exposure is a number that the user gives, each value is \
        mapped by itself, and what is above 1 becomes 1. `--tonemap max` divides by the largest value, as its name \
        says, and does have this fault. EXR files hold radiance as it is; the shared exponent of HDR files is one \
        per pixel.",
    source: "exposure by the mean: Reinhard, Stark, Shirley and Ferwerda 2002, equation 1, by the logarithm",
    run,
};

const SIZE: [u32; 2] = [120, 90];
const BRIGHT: f32 = 1e6;
/// Mean that the textbook gives to an image.
const KEY: f32 = 0.18;

fn codes(image: &Image, map: ToneMap) -> Vec<u8> {
    Tone { map, ..Tone::default() }.to_srgb8(image)
}

/// Codes after all values are multiplied.
fn scaled(image: &Image, by: f32) -> Vec<u8> {
    let pixels = image.pixels.iter().map(|p| p.map(|c| c * by)).collect();
    codes(&Image { pixels, ..image.clone() }, ToneMap::Clamp)
}

fn by_maximum(image: &Image) -> Vec<u8> {
    scaled(image, 1.0 / image.pixels.as_flattened().iter().copied().fold(0.0, f32::max))
}

fn by_mean(image: &Image) -> Vec<u8> {
    let values = image.pixels.as_flattened();
    scaled(image, KEY * values.len() as f32 / values.iter().sum::<f32>())
}

/// Pixels but number `bright` whose codes differ, and the mean code of all but that.
fn compare(before: &[u8], after: &[u8], bright: usize) -> (usize, f64) {
    let pairs = || before.chunks(3).zip(after.chunks(3)).enumerate().filter(|(i, _)| *i != bright);
    let sum: f64 = pairs().flat_map(|(_, (_, b))| b).map(|&code| f64::from(code)).sum();
    (pairs().filter(|(_, (a, b))| a != b).count(), sum / (before.len() - 3) as f64)
}

/// Codes side by side, with a gap, as a PNG.
fn beside(images: &[Vec<u8>]) -> Vec<u8> {
    let (wide, tall, gap) = (SIZE[0] as usize, SIZE[1] as usize, 6);
    let all = images.len() * (wide + gap) - gap;
    let mut codes = vec![255; 3 * all * tall];
    for (n, image) in images.iter().enumerate() {
        for (y, row) in image.chunks(3 * wide).enumerate() {
            codes[3 * (y * all + n * (wide + gap))..][..3 * wide].copy_from_slice(row);
        }
    }
    png_of_rgb8(all as u32, tall as u32, &codes, &Metadata::default()).unwrap()
}

fn run() -> Finding {
    let renderer = room(SIZE).with(block(-0.3, 0.3, 0.5, 1.0, 20.0), colored([0.2, 0.4, 0.9], 1.0)).renderer();
    let plain = film(&renderer, &settings(Method::Mis, SamplerKind::Sobol, samples(16), 1)).image();
    let at = [70, 60];
    let bright = (at[1] * SIZE[0] + at[0]) as usize;
    let mut spoilt = plain.clone();
    spoilt.pixels[bright] = [BRIGHT; 3];

    type Map = fn(&Image) -> Vec<u8>;
    let maps: [Map; 4] = [|i| codes(i, ToneMap::Clamp), by_maximum, by_mean, |i| codes(i, ToneMap::Max)];
    let found = maps.map(|map| compare(&map(&plain), &map(&spoilt), bright));
    println!("pixels that differ, and mean code: clamp, maximum, mean, our max: {found:?}");
    let others = plain.pixels.len() - 1;
    assert_eq!(found[0].0, 0, "clamp");
    assert_eq!(maps[0](&spoilt)[3 * bright..][..3], [255; 3]);
    for (map, (differ, mean)) in maps.iter().zip(&found).skip(1) {
        let before = compare(&map(&plain), &map(&plain), bright).1;
        assert!(
            *differ == others && *mean < before / 20.0,
            "dividing should darken: {differ} differ, {before} to {mean}"
        );
    }
    Finding {
        textbook: format!(
            "mean code of the others {:.2} when divided by the maximum, {:.2} when exposed by the mean; {} and {} of \
             {others} pixels differ",
            found[1].1, found[2].1, found[1].0, found[2].0
        ),
        ours: format!(
            "{} of them differ by `clamp` (mean code {:.0}); by `max` {:.2}, as it says",
            found[0].0, found[0].1, found[3].1
        ),
        how: format!(
            "A room, and the same with one pixel of 10<sup>{:.0}</sup>: the 8-bit codes of all other pixels before \
             and after.",
            BRIGHT.log10()
        ),
        picture: Some(Picture {
            ending: "png",
            bytes: beside(&[maps[2](&plain), maps[1](&spoilt), maps[2](&spoilt), maps[0](&spoilt)]),
            caption: "Exposed by the mean without the bright pixel; with it divided by the maximum, exposed by the \
             mean, and here"
                .into(),
        }),
    }
}
