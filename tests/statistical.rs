//! Images that must have the same mean have it: all methods, both samplers, both integrators. And what would be found:
//! faults put in on purpose are.
//!
//! Welch's t-test per pixel and channel and of the image's mean, chi-squared of the pixels' p-values; chance of a false
//! alarm 10^-3 for the suite (Sidak). Every image has a seed of its own, so that all are independent.

mod common;

use common::meshes::{cuboid, quad, v};
use common::stats::{Estimate, Family, detectable, uniformity};
use common::worlds::{Scene, block, diffuse, glass, mirror, room, rooms};
use common::{METHODS, film, full, samples, settings};
use wavetrace::film::Film;
use wavetrace::render::{Integrator, Renderer, SamplerKind, Settings};
use wavetrace::wave::Method;
use wavetrace::world::{MaterialInput, WorldBuilder};

const SIZE: [u32; 2] = [14, 12];
/// Families of tests in this suite; each is a test function.
const FAMILIES: usize = 6;

/// All tests of two images with independent samples.
fn compare(family: &mut Family, a: &Film, b: &Film, what: &str) {
    let mut green = Vec::new();
    for i in 0..a.pixels().len() {
        for k in 0..3 {
            let (e, f) = (Estimate::of(a, i, k), Estimate::of(b, i, k));
            let chance = e.p_equal(&f);
            family.add(chance, format!("{what}, pixel {i}, channel {k}: {} and {}", e.mean, f.mean));
            if k == 1 && e.variance > 0.0 && f.variance > 0.0 {
                green.push(chance);
            }
        }
    }
    family.add(uniformity(&green), format!("{what}, p-values of {} pixels", green.len()));
    for k in 0..3 {
        let (e, f) = (Estimate::of_film(a, k), Estimate::of_film(b, k));
        family.add(e.p_equal(&f), format!("{what}, mean of channel {k}: {} and {}", e.mean, f.mean));
    }
}

fn xoshiro(method: Method, spp: u32, seed: u64) -> Settings {
    settings(method, SamplerKind::Xoshiro, samples(spp), seed)
}

/// `path`, `nee` and `mis` in turn, each pair with renders of its own. A pixel that `path` lights by a few hits of a lamp has no
/// Gaussian mean: the open room, where parts of the floor see little of the lamp, takes more samples, and `path` is left out
/// where lamps are tiny.
#[test]
fn methods_agree() {
    let mut family = Family::one_of(FAMILIES);
    for (number, (name, renderer)) in rooms(SIZE).into_iter().enumerate() {
        let spp = if name == "open" { 8192 } else { 1024 };
        let image = |method, k| film(&renderer, &xoshiro(method, spp, 100 * number as u64 + k));
        let all = [(Method::Path, Method::Nee), (Method::Nee, Method::Mis), (Method::Mis, Method::Path)];
        let pairs = if name == "many lamps" { &all[1..2] } else { &all[..] };
        for (k, &pair) in pairs.iter().enumerate() {
            let (a, b) = (image(pair.0, 2 * k as u64), image(pair.1, 2 * k as u64 + 1));
            compare(&mut family, &a, &b, &format!("{name}, {pair:?}"));
            let e = [Estimate::of_film(&a, 1), Estimate::of_film(&b, 1)];
            let error = (e[0].variance + e[1].variance).sqrt() / e[0].mean;
            println!("{name}, {pair:?}: standard error of the difference of means {:.2} %", 100.0 * error);
        }
    }
    family.judge();
}

/// A pane of index 1 lets all light through as it came, but no connection: light paths have to bring it to what the camera
/// sees, aimed paths to what it sees in a mirror. Without the pane connections find it.
#[test]
fn light_through_glass_agrees_with_light_through_nothing() {
    let mut family = Family::one_of(FAMILIES);
    let world = |pane: bool| {
        let glassy = cuboid(v(-0.98, -0.98, 1.5), v(0.98, 0.98, 1.56));
        let room = room(SIZE).with(quad(v(-0.98, 0.97, 0.02), v(1.96, -0.1, 0.0), v(0.0, 0.0, 1.4)), mirror(0.9));
        if pane { room.with(glassy, glass(1.0, 1.0)) } else { room }.renderer()
    };
    let (through, open) = (world(true), world(false));
    let seeds = |renderer: &Renderer, light_paths: f32, first: u64| -> Vec<Film> {
        let base = settings(Method::Mis, SamplerKind::Sobol, samples(1024), first);
        let seed = |k| Settings { light_paths, seed: first + k, ..base.clone() };
        (0..24).map(|k| film(renderer, &seed(k))).collect()
    };
    // What the mirror focuses is left to chance there, as in the methods that are tested above.
    let (a, b) = (seeds(&through, 0.1, 2000), seeds(&open, 0.0, 3000));
    let of = |films: &[Film], value: &dyn Fn(&Film) -> f64| {
        Estimate::of_replicates(&films.iter().map(value).collect::<Vec<_>>())
    };
    for i in 0..a[0].pixels().len() {
        let (e, f) = (of(&a, &|f| f.mean(i)[1]), of(&b, &|f| f.mean(i)[1]));
        family.add(e.p_equal(&f), format!("pixel {i}: {} and {}", e.mean, f.mean));
    }
    for k in 0..3 {
        let mean = |f: &Film| Estimate::of_film(f, k).mean;
        let (e, f) = (of(&a, &mean), of(&b, &mean));
        family.add(e.p_equal(&f), format!("mean {k}: {} and {}", e.mean, f.mean));
        let error = (e.variance + f.variance).sqrt() / f.mean;
        println!("channel {k}: {:.5} and {:.5}, error {:.3} %", e.mean, f.mean, 100.0 * error);
    }
    family.judge();
}

/// The reference integrator with other seeds than the waves.
#[test]
fn integrators_agree() {
    let mut family = Family::one_of(FAMILIES);
    for (name, renderer) in rooms(SIZE) {
        let a = film(&renderer, &xoshiro(Method::Mis, 512, 31));
        let reference = Settings { integrator: Integrator::Reference, ..xoshiro(Method::Mis, 512, 32) };
        compare(&mut family, &a, &film(&renderer, &reference), name);
    }
    family.judge();
}

/// Sobol points are not independent of each other: their error is estimated from whole images with scrambles of their
/// own, each a replicate.
#[test]
fn samplers_agree() {
    let mut family = Family::one_of(FAMILIES);
    let replicates = 24;
    for (name, renderer) in rooms(SIZE) {
        for method in METHODS {
            let independent = film(&renderer, &xoshiro(method, 512, 41));
            let spp = samples(32);
            let sobol: Vec<Film> = (0..replicates)
                .map(|seed| film(&renderer, &settings(method, SamplerKind::Sobol, spp, 1000 + seed)))
                .collect();
            let replicated =
                |value: &dyn Fn(&Film) -> f64| Estimate::of_replicates(&sobol.iter().map(value).collect::<Vec<_>>());
            for k in 0..3 {
                for i in 0..independent.pixels().len() {
                    let (e, f) = (replicated(&|f| f.mean(i)[k]), Estimate::of(&independent, i, k));
                    family.add(
                        e.p_equal(&f),
                        format!("{name}, {method:?}, pixel {i}, channel {k}: {} and {}", e.mean, f.mean),
                    );
                }
                let (e, f) = (replicated(&|f| Estimate::of_film(f, k).mean), Estimate::of_film(&independent, k));
                family.add(e.p_equal(&f), format!("{name}, {method:?}, mean {k}: {} and {}", e.mean, f.mean));
            }
        }
    }
    family.judge();
}

/// The stated error is the error: the variance that a film reports is that of its pixels over seeds. Chi-squared of the
/// spread of 40 images, by pixel; the sum of squares over a variance known from all of them.
#[test]
fn variances_are_those_of_the_seeds() {
    let mut family = Family::one_of(FAMILIES);
    let renderer = rooms(SIZE).swap_remove(0).1;
    let n = 40;
    let films: Vec<Film> = (0..n).map(|s| film(&renderer, &xoshiro(Method::Mis, 256, 500 + s))).collect();
    let mut ratios = Vec::new();
    for i in 0..films[0].pixels().len() {
        let over_seeds = Estimate::of_replicates(&films.iter().map(|f| f.mean(i)[1]).collect::<Vec<_>>());
        let stated = Estimate::average(films.iter().map(|f| Estimate::of(f, i, 1)));
        if stated.variance > 0.0 {
            ratios.push(over_seeds.variance / stated.variance);
        }
    }
    // Each ratio has mean 1 and, means of 256 samples being close to normal, variance 2 / (n - 1).
    let mean = Estimate::of_replicates(&ratios);
    println!("variance over seeds / stated variance: {:.4} +- {:.4}", mean.mean, mean.variance.sqrt());
    family.add(mean.p_exact(1.0), format!("variance over seeds is {} times the stated one", mean.mean));
    family.judge();
}

fn fault(change: impl Fn(&mut Vec<MaterialInput>)) -> Renderer {
    let whole = test_room();
    let old = whole.0;
    let mut materials = old.materials().to_vec();
    change(&mut materials);
    let mut new = WorldBuilder::new(old.camera().clone());
    old.meshes().iter().for_each(|m| _ = new.mesh(m.clone()));
    materials.into_iter().for_each(|m| _ = new.material(m));
    old.objects().iter().for_each(|o| new.object(o.clone()));
    Scene(new).renderer()
}

fn test_room() -> Scene {
    room(SIZE).with(block(-0.3, 0.4, 0.5, 0.9, 20.0), diffuse(0.8))
}

/// What the suite would find, shown by faults put in on purpose: the same tests at the same level as `methods_agree`
/// reject each of them.
#[test]
fn faults_are_found() {
    let spp = if full() { 65536 } else { 8192 };
    let mis = |renderer: &Renderer, seed| film(renderer, &settings(Method::Mis, SamplerKind::Xoshiro, spp, seed));
    let good = test_room().renderer();
    let base = mis(&good, 1);
    let mut sound = Family::one_of(FAMILIES);
    compare(&mut sound, &base, &mis(&good, 2), "no fault");
    let level = sound.level();
    let mean = Estimate::of_film(&base, 1);
    let bias = detectable(mean.relative_error() * std::f64::consts::SQRT_2, level);
    println!("a bias of {:.2} % of the mean is found with probability 0.99 at level {level:.1e}", 100.0 * bias);
    assert!(bias < 0.01, "the tests are too weak: they find {bias}");
    sound.judge();

    let scaled = |by: f64| {
        let mut f = mis(&good, 3);
        for y in 0..f.height() {
            for x in 0..f.width() {
                let p = f.pixel_mut([x, y]);
                p.sum = p.sum.map(|s| s * by);
                p.sum2 = p.sum2.map(|s| s * by * by);
            }
        }
        f
    };
    let brighter = fault(|m| {
        for material in m {
            if let MaterialInput::Diffuse { color, .. } = material {
                *color = color.map(|c| c * 1.01);
            }
        }
    });
    let shallow = Settings { max_depth: Some(6), ..settings(Method::Mis, SamplerKind::Xoshiro, spp, 5) };
    // What remains of direct light where the weights of multiple importance sampling are left out.
    let (path, nee) = (
        film(&good, &settings(Method::Path, SamplerKind::Xoshiro, spp, 6)),
        film(&good, &settings(Method::Nee, SamplerKind::Xoshiro, spp, 7)),
    );
    let mut unweighted = path.clone();
    for y in 0..nee.height() {
        for x in 0..nee.width() {
            let q = nee.pixels()[(y * nee.width() + x) as usize];
            let p = unweighted.pixel_mut([x, y]);
            for k in 0..3 {
                p.sum[k] += q.sum[k];
                p.sum2[k] += q.sum2[k] + 2.0 * p.mean()[k] * q.sum[k];
            }
        }
    }
    // Focused light that camera paths count in full, and light paths once more.
    let focusing = rooms(SIZE).swap_remove(2).1;
    let (focused, alone) = (mis(&focusing, 8), Settings { light_paths: 0.0, ..xoshiro(Method::Mis, 1, 9) });
    let mut doubled = film(&focusing, &Settings { spp, ..alone });
    for y in 0..doubled.height() {
        for x in 0..doubled.width() {
            let i = (y * doubled.width() + x) as usize;
            let (all, own) = (focused.mean(i), focused.pixels()[i].mean());
            let p = doubled.pixel_mut([x, y]);
            let add: [f64; 3] = std::array::from_fn(|k| (all[k] - own[k]) * p.count as f64);
            (0..3).for_each(|k| p.sum[k] += add[k]);
        }
    }
    let sound_base = mis(&focusing, 10);
    let mut sound = Family::one_of(FAMILIES);
    compare(&mut sound, &focused, &sound_base, "light paths, no fault");
    sound.judge();

    for (what, faulty) in [
        ("image times 1.01", scaled(1.01)),
        ("image times 0.99", scaled(0.99)),
        ("albedo times 1.01", mis(&brighter, 4)),
        ("paths cut after 6 bounces", film(&good, &shallow)),
        ("no weights", unweighted),
        ("light paths without weights", doubled),
    ] {
        let mut family = Family::one_of(FAMILIES);
        let right = if what.starts_with("light paths") { &sound_base } else { &base };
        compare(&mut family, right, &faulty, what);
        let rejected = family.rejected();
        println!("{what}: {} tests reject", rejected.len());
        assert!(!rejected.is_empty(), "{what} goes unnoticed");
    }
}
