//! What the integration tests share: worlds built in code, statistics, renders.
#![allow(dead_code)] // Every suite is a crate of its own and uses its share of this.

pub mod meshes;
pub mod random;
pub mod rays;
pub mod stats;
pub mod worlds;

use wavetrace::film::Film;
use wavetrace::render::{Control, Renderer, SamplerKind, Settings};
use wavetrace::wave::Method;

/// The three ways to find light.
pub const METHODS: [Method; 3] = [Method::Path, Method::Nee, Method::Mis];
/// Both sources of random numbers.
pub const SAMPLERS: [SamplerKind; 2] = [SamplerKind::Xoshiro, SamplerKind::Sobol];

/// Whether the long form of the suites was asked for.
pub fn full() -> bool {
    std::env::var_os("WAVETRACE_FULL").is_some_and(|v| v == "1")
}

/// A number of samples: as given, or sixteen times as many in the long form.
pub fn samples(short: u32) -> u32 {
    if full() { short * 16 } else { short }
}

/// Settings by method, sampler, samples per pixel and seed.
pub fn settings(method: Method, sampler: SamplerKind, spp: u32, seed: u64) -> Settings {
    Settings { method, sampler, spp, seed, ..Settings::default() }
}

/// Renders; nothing may be amiss.
pub fn film(renderer: &Renderer, settings: &Settings) -> Film {
    let rendered = renderer.render(settings, &Control::default()).unwrap();
    assert!(rendered.bad.is_empty(), "samples that are not finite: {:?}", rendered.bad);
    assert!(!rendered.partial);
    rendered.film
}
