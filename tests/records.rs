//! Images as they were last accepted, to the bit. Other suites tell whether an image is right; this one tells that it changed, where
//! nobody meant it to: by a faster way to the same numbers, or a chance that was chosen otherwise and averages to the same.
//!
//! Who means to change images says so: `WAVETRACE_ACCEPT=1 cargo test --test records` writes them anew. They are accepted on Linux
//! with AVX2 and FMA: other instructions and mathematical libraries round otherwise.

mod common;

use common::worlds::rooms;
use common::{METHODS, SAMPLERS, settings};
use std::fmt::Write;
use std::path::Path;
use wavetrace::film::Film;
use wavetrace::lanes::simd;
use wavetrace::render::{Control, SamplerKind, Settings};
use wavetrace::wave::Method;

/// No multiple of a tile either way.
const SIZE: [u32; 2] = [37, 21];
const SPP: u32 = 12;

/// Mean of all pixels, and a number that follows from the bits of all (FNV-1a, of 64 bits).
fn digest(film: &Film) -> ([f64; 3], u64) {
    let (mut mean, mut hash) = ([0.0; 3], 0xcbf2_9ce4_8422_2325_u64);
    let count = film.pixels().len();
    for pixel in 0..count {
        for (sum, value) in mean.iter_mut().zip(film.mean(pixel)) {
            *sum += value / count as f64;
        }
        for value in film.mean(pixel).into_iter().chain(film.variance(pixel)) {
            for byte in value.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }
    (mean, hash)
}

fn found() -> String {
    let mut lines = String::from(
        "room, method, sampler: camera, bounce, shadow and light rays, paths cut; mean; number of all bits\n",
    );
    for (name, renderer) in rooms(SIZE) {
        for method in METHODS {
            for sampler in SAMPLERS {
                let settings = Settings { time_stages: true, threads: 2, ..settings(method, sampler, SPP, 3) };
                let rendered = renderer.render(&settings, &Control::default()).unwrap();
                assert!(rendered.bad.is_empty() && !rendered.partial);
                let (mean, hash) = digest(&rendered.film);
                let c = rendered.counts;
                let rays = format!("{} {} {} {} {}", c.camera, c.bounce, c.shadow, c.light, c.cut);
                let mean = mean.map(|m| format!("{m:.6}")).join(" ");
                writeln!(lines, "{name}, {method:?}, {sampler:?}: {rays}; {mean}; {hash:016x}").unwrap();
                if (method, sampler) == (Method::Mis, SamplerKind::Sobol) {
                    for row in rendered.stages.iter().filter(|row| row.items > 0) {
                        let stage = row.stage.name();
                        writeln!(lines, "- {stage}: {} runs, {} rows, {} lanes", row.calls, row.items, row.lanes)
                            .unwrap();
                    }
                }
            }
        }
    }
    lines
}

#[test]
fn images_are_those_that_were_accepted() {
    if simd() != "avx2+fma" || cfg!(not(target_os = "linux")) {
        println!("accepted on Linux with avx2+fma, not on {}: nothing is compared", simd());
        return;
    }
    let found = found();
    if std::env::var_os("WAVETRACE_ACCEPT").is_some_and(|v| v == "1") {
        std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/images.txt"), &found).unwrap();
        return;
    }
    let accepted = include_str!("data/images.txt");
    let differ: Vec<_> = found.lines().zip(accepted.lines()).filter(|(f, a)| f != a).collect();
    let show = |(f, a): &(&str, &str)| format!("found    {f}\naccepted {a}\n");
    assert!(
        differ.is_empty() && found.lines().count() == accepted.lines().count(),
        "{} of {} lines are not as accepted, of which there are {}; if that is meant: WAVETRACE_ACCEPT=1 cargo test --test records\n{}",
        differ.len(),
        found.lines().count(),
        accepted.lines().count(),
        differ.iter().map(show).collect::<String>()
    );
}
