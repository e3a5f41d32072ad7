//! The same seed gives the same image, to the bit, whatever the number of threads, the size of the waves, or the
//! integrator. Nothing here is statistical.

mod common;

use common::worlds::rooms;
use common::{METHODS, SAMPLERS, settings};
use wavetrace::film::Film;
use wavetrace::render::{Control, Integrator, Renderer, SamplerKind, Settings};
use wavetrace::wave::{Counts, Method, Tuning};

/// No multiple of a tile either way.
const SIZE: [u32; 2] = [37, 21];
/// Two jobs of each tile, and a part of a third.
const SPP: u32 = 130;

fn render(renderer: &Renderer, settings: &Settings) -> (Film, Counts) {
    let r = renderer.render(settings, &Control::default()).unwrap();
    assert!(r.bad.is_empty() && !r.partial);
    (r.film, r.counts)
}

fn assert_same(a: &Film, b: &Film, what: &str) {
    let bits = |f: &Film| -> Vec<_> {
        let sums = f.pixels().iter().map(|p| (p.sum.map(f64::to_bits), p.sum2.map(f64::to_bits), p.count));
        // With what light paths bring.
        let estimates = (0..f.pixels().len()).map(|i| (f.mean(i).map(f64::to_bits), f.variance(i).map(f64::to_bits)));
        sums.zip(estimates).collect()
    };
    let (x, y) = (bits(a), bits(b));
    let differ = x.iter().zip(&y).filter(|(p, q)| p != q).count();
    assert!(differ == 0 && x.len() == y.len(), "{what}: {differ} of {} pixels differ", x.len());
}

#[test]
fn threads_and_wave_sizes_change_no_bit() {
    for (name, renderer) in rooms(SIZE) {
        for sampler in SAMPLERS {
            let base = Settings { threads: 1, ..settings(Method::Mis, sampler, SPP, 5) };
            let (film, counts) = render(&renderer, &base);
            assert!(film.pixels().iter().all(|p| p.count == u64::from(SPP)));
            for (threads, wave_size) in [(2, 2048), (5, 2048), (2, 64), (5, 1000), (2, 4096), (1, 7), (2, 1)] {
                // The smallest waves are slow, and one scene of every material will do for them.
                if wave_size < 64 && name != "delta" {
                    continue;
                }
                let (other, c) = render(&renderer, &Settings { threads, wave_size, ..base.clone() });
                assert_same(&film, &other, &format!("{name}, {sampler:?}, {threads} threads, wave {wave_size}"));
                let of = |c: &Counts| (c.camera, c.bounce, c.shadow, c.light);
                assert_eq!(of(&counts), of(&c), "{name}");
                assert_eq!(c.light > 0, name == "delta", "{name}: light paths where something focuses light");
            }
        }
    }
}

#[test]
fn the_waves_give_the_image_of_the_reference() {
    for (name, renderer) in rooms(SIZE) {
        for method in METHODS {
            for sampler in SAMPLERS {
                for (max_depth, spp) in [(None, 20), (Some(0), 2), (Some(1), 4), (Some(3), 8)] {
                    let wave = Settings { max_depth, ..settings(method, sampler, spp, 11) };
                    let (film, counts) = render(&renderer, &wave);
                    for integrator in [Integrator::Reference, Integrator::Scalar] {
                        let (other, c) = render(&renderer, &Settings { integrator, ..wave.clone() });
                        let what = format!("{name}, {method:?}, {sampler:?}, depth {max_depth:?}, {integrator:?}");
                        assert_same(&film, &other, &what);
                        let of = |c: &Counts| (c.camera, c.bounce, c.shadow, c.light, c.cut);
                        assert_eq!(of(&counts), of(&c), "{what}");
                    }
                    assert_eq!(counts.camera, u64::from(SIZE[0] * SIZE[1] * spp));
                }
            }
        }
    }
}

#[test]
fn measuring_changes_no_bit() {
    let (_, renderer) = rooms(SIZE).swap_remove(2);
    let plain = settings(Method::Mis, SamplerKind::Xoshiro, 9, 1);
    let timed = Settings { time_stages: true, ..plain.clone() };
    let traced = Settings { timeline: true, ..plain.clone() };
    let film = render(&renderer, &plain).0;
    assert_same(&film, &render(&renderer, &timed).0, "timed stages");
    assert_same(&film, &render(&renderer, &traced).0, "with a timeline");
}

/// Choices of speed change no bit, alone and together, in a room of one kind of surface and in one of all.
#[test]
fn tuning_changes_no_bit() {
    let plain = Tuning::default();
    let all = Tuning { refill: false, tiles: false, streams: false, sort_always: true, job: 1 };
    let one_by_one = [
        Tuning { refill: false, ..plain },
        Tuning { tiles: false, ..plain },
        Tuning { streams: false, ..plain },
        Tuning { sort_always: true, ..plain },
        Tuning { job: 1, ..plain },
        Tuning { job: 1 << 20, ..plain },
        all,
    ];
    for (name, renderer) in rooms(SIZE) {
        let usual = settings(Method::Mis, SamplerKind::Sobol, 9, 1);
        let film = render(&renderer, &usual).0;
        for tuning in one_by_one {
            let tuned = Settings { tuning, threads: 2, ..usual.clone() };
            assert_same(&film, &render(&renderer, &tuned).0, &format!("{name}: {tuning:?}"));
        }
    }
}

/// Every seed has samples of its own: also those that differ in high bits alone.
#[test]
fn seeds_differ() {
    let (_, renderer) = rooms(SIZE).swap_remove(0);
    for sampler in SAMPLERS {
        let films: Vec<Film> = [0, 1, 2, 1 << 32, 1 << 63, u64::MAX]
            .map(|seed| render(&renderer, &settings(Method::Mis, sampler, 1, seed)).0)
            .into();
        for (i, a) in films.iter().enumerate() {
            for b in &films[..i] {
                let same = a.pixels().iter().zip(b.pixels()).filter(|(p, q)| p.sum == q.sum).count();
                // The lamp seen directly is the same in all.
                assert!(same * 3 < a.pixels().len(), "{sampler:?}: {same} of {} pixels agree", a.pixels().len());
            }
        }
    }
}

/// More samples with the same seed keep the first ones: the sums only grow. Up to 256 Sobol points are placed by their number.
#[test]
fn a_longer_render_begins_like_a_shorter_one() {
    let (_, renderer) = rooms(SIZE).swap_remove(1);
    for sampler in SAMPLERS {
        let film = |spp| render(&renderer, &settings(Method::Mis, sampler, spp, 3)).0;
        let few = if sampler == SamplerKind::Sobol { 257 } else { 64 };
        let (short, long) = (film(few), film(few + 1));
        for (a, b) in short.pixels().iter().zip(long.pixels()) {
            assert!((0..3).all(|k| a.sum[k] <= b.sum[k] && a.sum2[k] <= b.sum2[k]), "{sampler:?}: {a:?} {b:?}");
        }
    }
}
