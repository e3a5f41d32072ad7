//! Renders that end when a time is spent or an error is reached: what they give is the image of as many samples, the error
//! that they tell is the error that they have, and that it decides when they end makes them no darker.

mod common;

use common::meshes::{inverted, patch, v};
use common::stats::{Estimate, Family};
use common::worlds::{Scene, block, camera, diffuse, lamp, room, rooms};
use common::{SAMPLERS, film, samples, settings};
use std::time::Duration;
use wavetrace::film::Film;
use wavetrace::render::{Control, Effort, Rendered, Renderer, SamplerKind, Settings};
use wavetrace::wave::Method;
use wavetrace::world::MaterialInput;

const SIZE: [u32; 2] = [20, 12];
/// Families of tests in this suite.
const FAMILIES: usize = 3;

fn render(renderer: &Renderer, settings: &Settings) -> Rendered {
    renderer.render(settings, &Control::default()).unwrap()
}

/// Counts of the pixels' samples: fewest and most.
fn counts(film: &Film) -> (u64, u64) {
    let counts = || film.pixels().iter().map(|p| p.count);
    (counts().min().unwrap(), counts().max().unwrap())
}

#[test]
fn rounds_give_the_samples_of_one_render() {
    for (name, renderer) in rooms(SIZE) {
        for sampler in SAMPLERS {
            let once = Settings { spp: 150, ..settings(Method::Mis, sampler, 1, 4) };
            let rounds = Settings { time: Duration::from_secs(100_000), ..once.clone() };
            let (once, rounds) = (render(&renderer, &once), render(&renderer, &rounds));
            assert!(!rounds.partial && rounds.counts.camera == once.counts.camera, "{name}");
            assert_eq!((counts(&rounds.film), rounds.counts.light), ((150, 150), once.counts.light), "{name}");
            for i in 0..once.film.pixels().len() {
                // Sums are the same but for their order.
                for (a, b) in once.film.mean(i).into_iter().zip(rounds.film.mean(i)) {
                    assert!((a - b).abs() <= 1e-12 * a.abs(), "{name}, {sampler:?}, pixel {i}: {a} and {b}");
                }
            }
        }
    }
}

#[test]
fn the_time_ends_a_render_and_leaves_no_pixel_out() {
    let (_, renderer) = rooms(SIZE).swap_remove(0);
    let open = Settings { spp: u32::MAX, ..settings(Method::Mis, SamplerKind::Sobol, 1, 4) };
    let none = render(&renderer, &Settings { time: Duration::ZERO, ..open.clone() });
    assert_eq!((counts(&none.film), none.partial), ((1, 1), false));
    let time = Duration::from_millis(300);
    let some = render(&renderer, &Settings { time, ..open.clone() });
    let (fewest, most) = counts(&some.film);
    assert!(!some.partial && some.time >= time && fewest > 1 && most <= 2 * fewest, "{fewest} to {most} samples");
    // With both goals, the first counts.
    let both = Settings { time, target_error: Some(1e-12), ..open };
    let both = render(&renderer, &both);
    assert!(both.time >= time && both.error.is_some_and(|error| error > 1e-12) && !both.partial);
}

#[test]
fn goals_out_of_range_are_mistakes() {
    let (_, renderer) = rooms(SIZE).swap_remove(0);
    let base = settings(Method::Mis, SamplerKind::Xoshiro, 16, 4);
    for (spp, target) in [(16, 0.0), (16, -1.0), (16, f64::NAN), (16, f64::INFINITY), (3, 0.1)] {
        let wrong = Settings { spp, target_error: Some(target), ..base.clone() };
        assert!(renderer.render(&wrong, &Control::default()).is_err(), "{spp} {target}");
    }
}

#[test]
fn an_error_is_reached_with_the_same_samples_everywhere() {
    for (name, renderer) in rooms(SIZE) {
        for sampler in SAMPLERS {
            let base = Settings { target_error: Some(0.05), threads: 1, ..settings(Method::Mis, sampler, u32::MAX, 4) };
            let one = render(&renderer, &base);
            let other = render(&renderer, &Settings { threads: 3, wave_size: 64, ..base });
            let estimates = |r: &Rendered| -> Vec<_> { (0..240).map(|i| r.film.mean(i).map(f64::to_bits)).collect() };
            assert_eq!((one.counts.camera, one.error), (other.counts.camera, other.error), "{name}");
            assert!(estimates(&one) == estimates(&other), "{name}");
            assert!(one.counts.camera > 0 && one.counts.camera.is_multiple_of(4) && one.error.is_some(), "{name}");
        }
    }
}

/// The mean over pixels and channels of (a - b)^2 / (b^2 + 0.01).
fn rel_mse(a: &Film, b: &Film) -> f64 {
    let pixels = a.pixels().len();
    let of =
        |i: usize| -> f64 { a.mean(i).into_iter().zip(b.mean(i)).map(|(a, b)| (a - b).powi(2) / (b * b + 0.01)).sum() };
    (0..pixels).map(of).sum::<f64>() / (3 * pixels) as f64
}

/// A lit floor in one corner of an image of three by two tiles; the rest is black.
fn corner() -> Renderer {
    Scene::new(camera(v(0.0, -3.0, 1.0), v(0.0, 1.0, -0.1), [96, 64], 60.0))
        .with(patch(-0.8, 0.0, 0.2, 1.0, 1.0), diffuse(0.7))
        .with(patch(-0.8, 0.0, 0.3, 0.4, 0.4), diffuse(0.7))
        .with(inverted(patch(-0.9, 0.1, 1.0, 0.3, 0.3)), lamp(10.0))
        .renderer()
}

#[test]
fn tiles_share_out_the_samples_alike_everywhere() {
    let renderer = corner();
    for sampler in SAMPLERS {
        for (goal, spp) in [(None, 40), (Some(1e-4), u32::MAX)] {
            let base = Settings { target_error: goal, threads: 1, ..settings(Method::Mis, sampler, spp, 4) };
            let tiles = Settings { effort: Effort::Tiles, ..base };
            let one = render(&renderer, &tiles);
            let other = render(&renderer, &Settings { threads: 3, wave_size: 64, ..tiles });
            assert!(one.film == other.film && one.counts.camera == other.counts.camera && one.error == other.error);
            let (fewest, most) = counts(&one.film);
            assert!(4 * fewest <= most && fewest > 0 && !one.partial, "{fewest} to {most} samples");
            assert!(goal.is_some() || one.mean_spp() <= 40.0, "{}", one.mean_spp());
        }
    }
    // A trial that is not done in time decides nothing.
    let open = Settings { spp: u32::MAX, time: Duration::ZERO, ..settings(Method::Mis, SamplerKind::Sobol, 1, 4) };
    let none = render(&renderer, &Settings { effort: Effort::Tiles, ..open });
    assert_eq!((counts(&none.film), none.partial), ((1, 1), false));
}

/// By t-test, over seeds: the same mean, with less error.
#[test]
fn tiles_with_more_error_get_more_samples_and_keep_their_mean() {
    let mut family = Family::one_of(FAMILIES);
    let renderer = corner();
    let truth = film(&renderer, &settings(Method::Mis, SamplerKind::Sobol, 1 << 12, 1));
    for sampler in SAMPLERS {
        let [even, tiles] = [Effort::Even, Effort::Tiles].map(|effort| -> [Estimate; 2] {
            let films = (0..u64::from(samples(30))).map(|seed| {
                // Other seeds for each, so that means are independent.
                let seed = 2 * seed + u64::from(effort == Effort::Tiles);
                film(&renderer, &Settings { effort, ..settings(Method::Mis, sampler, 32, 100 + seed) })
            });
            let (means, errors): (Vec<_>, Vec<_>) = films.map(|film| (mean(&film), rel_mse(&film, &truth))).unzip();
            [means, errors].map(|values| Estimate::of_replicates(&values))
        });
        println!("{sampler:?}: relMSE {:.3e} even, {:.3e} by tiles", even[1].mean, tiles[1].mean);
        family
            .add(even[0].p_equal(&tiles[0]), format!("{sampler:?}: {} even, {} by tiles", even[0].mean, tiles[0].mean));
        assert!(tiles[1].mean < even[1].mean && tiles[1].p_equal(&even[1]) < 1e-6, "{sampler:?}");
    }
    family.judge();
}

/// Estimates of renders of a fixed number of samples, against their errors.
#[test]
fn the_error_that_is_told_is_the_error() {
    let mut family = Family::one_of(FAMILIES);
    let renderer = room(SIZE).with(block(0.3, 0.2, 0.4, 0.7, 20.0), diffuse(0.6)).renderer();
    let truth = film(&renderer, &settings(Method::Mis, SamplerKind::Sobol, samples(1 << 14), 1));
    for sampler in SAMPLERS {
        let (mut told, mut found) = (Vec::new(), Vec::new());
        for seed in 0..u64::from(samples(100)) {
            let base = settings(Method::Mis, sampler, 64, 1000 + seed);
            let rendered = render(&renderer, &Settings { target_error: Some(1e-30), ..base });
            assert_eq!(counts(&rendered.film), (64, 64));
            told.push(rendered.error.unwrap());
            found.push(rel_mse(&rendered.film, &truth));
        }
        let (told, found) = (Estimate::of_replicates(&told), Estimate::of_replicates(&found));
        println!(
            "{sampler:?}: told {:.4e}, found {:.4e}, standard error {:.1} %",
            told.mean,
            found.mean,
            100.0 * (told.variance + found.variance).sqrt() / found.mean
        );
        family.add(told.p_equal(&found), format!("{sampler:?}: {} told, {} found", told.mean, found.mean));
    }
    family.judge();
}

/// A small lamp found by chance: a few samples are very bright. Images that end by the error keep their mean; those that
/// end by the error of their own samples, as textbook code does, are too dark, and this test would say so.
#[test]
fn ending_by_the_error_leaves_the_mean_alone() {
    let mut family = Family::one_of(FAMILIES);
    let renderer = Scene::new(camera(v(0.0, -2.0, 1.0), v(0.0, 2.0, -1.0), [2, 2], 20.0))
        .with(patch(0.0, 0.0, 0.0, 4.0, 4.0), diffuse(0.7))
        .with(inverted(patch(0.0, 0.0, 1.0, 0.5, 0.5)), MaterialInput::Luminous { radiance: [10.0; 3] })
        .renderer();
    let truth = film(&renderer, &settings(Method::Mis, SamplerKind::Sobol, samples(1 << 17), 1));
    let exact = mean(&truth);
    let (target, runs) = (0.2, u64::from(samples(1000)));
    let (mut ours, mut naive, mut spent) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 0..runs {
        let base = Settings { threads: 1, ..settings(Method::Path, SamplerKind::Xoshiro, u32::MAX, 1000 + seed) };
        let rendered = render(&renderer, &Settings { target_error: Some(target), ..base.clone() });
        ours.push(mean(&rendered.film));
        spent.push(rendered.mean_spp());
        naive.push(own_error(&renderer, &base, target));
    }
    let (ours, naive) = (Estimate::of_replicates(&ours), Estimate::of_replicates(&naive));
    let spp = spent.iter().sum::<f64>() / runs as f64;
    println!(
        "exact {exact:.5}; ours {:.5} +- {:.5} at {spp:.0} samples; by their own error {:.5} +- {:.5}",
        ours.mean,
        ours.variance.sqrt(),
        naive.mean,
        naive.variance.sqrt()
    );
    family.add(ours.p_exact(exact), format!("{} for {exact}", ours.mean));
    assert!(naive.p_exact(exact) < family.level() && naive.mean < exact, "the test sees the fault of textbook code");
    family.judge();
}

fn mean(film: &Film) -> f64 {
    let pixels = film.pixels().len();
    (0..pixels).map(|i| film.mean(i).iter().sum::<f64>()).sum::<f64>() / (3 * pixels) as f64
}

/// The mean of the first image whose own samples say that it is good enough.
fn own_error(renderer: &Renderer, base: &Settings, target: f64) -> f64 {
    let mut spp = 4;
    loop {
        let film = film(renderer, &Settings { spp, ..base.clone() });
        let pixels = film.pixels().len();
        let error =
            |i: usize| -> f64 { film.variance(i).into_iter().zip(film.mean(i)).map(|(v, m)| v / (m * m + 0.01)).sum() };
        if (0..pixels).map(error).sum::<f64>() / (3 * pixels) as f64 <= target {
            return mean(&film);
        }
        spp += spp / 2;
    }
}
