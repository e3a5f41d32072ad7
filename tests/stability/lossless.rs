//! Paths in white rooms: where they end, and what that costs.

use crate::common::meshes::{area, cuboid, inverted, patch, sphere, v};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, diffuse, lamp};
use crate::common::{METHODS, samples, settings};
use crate::curve::{Axes, curve, dots, svg};
use crate::row::{Finding, Part, Picture, ROW_FAMILIES, Row};
use glam::DVec3;
use plotters::prelude::SeriesLabelPosition;
use wavetrace::render::{Control, Rendered, Renderer, SamplerKind, Settings};
use wavetrace::wave::{BOUNCE_LIMIT, Method};
use wavetrace::{MaterialInput, Mesh};

pub const ROW: Row = Row {
    part: Part::Transport,
    name: "lossless",
    title: "White rooms: paths that never end, and light that is cut",
    fails: "In a closed room that reflects all light, roulette by throughput ends no path. Textbooks cut paths \
        after some 8 or 64 bounces, or take less albedo than was asked for; what that loses is not said. Roulette \
        whose survivors are not weighted by one over their chance loses light as well.",
    remedy: "Roulette begins after the second bounce where less than a third of a path's energy is left, with \
        three times that energy as the chance to go on and one over it as the weight. A path is cut after 4096 \
        bounces in any case. Each path that is cut is counted with its throughput: the share of light that may be \
        missing. `--max-depth` cuts sooner, and is counted the same way.",
    source: "Arvo and Kirk 1990; see [roulette](decisions/roulette.md)",
    run,
};

/// A sphere seen from its centre, a hundredth of it a lamp of radiance 1. Any two patches see each other by their share
/// of the area, so that after N bounces radiance is the sum of N terms rho f (rho (1 - f))^k, f the lamp's share.
struct Sphere {
    lamp: Mesh,
    wall: Mesh,
    f: f64,
}

impl Sphere {
    fn new() -> Self {
        let whole = sphere(DVec3::ZERO, 1.0, 5, false);
        let height = |t: &[u32; 3]| t.iter().map(|&i| whole.positions[i as usize].z).sum::<f64>() / 3.0;
        let part = |lit: bool| {
            let triangles = whole.triangles.iter().copied().filter(|t| (height(t) > 0.98) == lit).collect();
            Mesh { triangles, ..whole.clone() }
        };
        let (lamp, wall) = (part(true), part(false));
        let total = |m: &Mesh| (0..m.triangles.len()).map(|t| area(m, t)).sum::<f64>();
        let f = total(&lamp) / (total(&lamp) + total(&wall));
        Self { lamp, wall, f }
    }
    fn renderer(&self, albedo: f32) -> Renderer {
        let scene = Scene::new(camera(DVec3::ZERO, v(0.1, 1.0, -0.4), [8, 8], 60.0));
        scene.with(self.wall.clone(), diffuse(albedo)).with(self.lamp.clone(), lamp(1.0)).renderer()
    }
    /// What one bounce leaves.
    fn ratio(&self, albedo: f32) -> f64 {
        f64::from(albedo) * (1.0 - self.f)
    }
    /// Radiance after any number of bounces.
    fn whole(&self, albedo: f32) -> f64 {
        f64::from(albedo) * self.f / (1.0 - self.ratio(albedo))
    }
}

fn render(renderer: &Renderer, method: Method, max_depth: Option<u32>, spp: u32, seed: u64) -> Rendered {
    let settings = Settings { max_depth, ..settings(method, SamplerKind::Xoshiro, spp, seed) };
    let rendered = renderer.render(&settings, &Control::default()).unwrap();
    assert!(rendered.bad.is_empty());
    rendered
}

/// The share of energy that was cut. In the sphere throughput depends on the number of bounces alone, so that a path
/// brings either nothing or the same as every other that was cut.
fn cut(rendered: &Rendered) -> Estimate {
    let (n, cut) = (rendered.counts.camera as f64, rendered.counts.cut as f64);
    let mean = rendered.counts.cut_throughput / n;
    let each = rendered.counts.cut_throughput / cut.max(1.0);
    Estimate { mean, variance: mean * (each - mean) / n, freedom: n - 1.0 }
}

/// Radiance of the sphere's wall by textbook roulette: p = throughput, from the fourth bounce on.
fn chain(f: f64, albedo: f64, weighted: bool, paths: u32) -> Estimate {
    let mut random = Random(9);
    let mut unit = || f64::from(random.unit());
    let mut path = || {
        let mut throughput = albedo;
        for bounce in 1.. {
            if unit() < f {
                return throughput;
            }
            throughput *= albedo;
            if bounce > 3 {
                if unit() >= throughput {
                    return 0.0;
                }
                throughput = if weighted { 1.0 } else { throughput };
            }
        }
        unreachable!("a path ends")
    };
    Estimate::of_replicates(&(0..paths).map(|_| path()).collect::<Vec<_>>())
}

/// A closed room that reflects all light, with a lamp of this side: whatever its form, radiance is 1 everywhere.
fn white(side: f64) -> Renderer {
    Scene::new(camera(DVec3::ZERO, DVec3::Y, [4, 4], 60.0))
        .with(inverted(cuboid(v(-1.0, -1.0, -1.0), v(1.0, 1.0, 1.0))), diffuse(1.0))
        .with(patch(0.0, 0.0, 0.99, side, side), MaterialInput::Luminous { radiance: [1.0; 3] })
        .renderer()
}

fn run() -> Finding {
    let mut family = Family::one_of(ROW_FAMILIES);
    let ball = Sphere::new();
    let albedo = 0.99;
    let (renderer, whole) = (ball.renderer(albedo), ball.whole(albedo));
    // Of 20480 facets the deviation from a sphere is some 10^-4, below what the samples of either form can see.
    let (mut ours, mut lost) = (Vec::new(), Vec::new());
    for (m, method) in METHODS.into_iter().enumerate() {
        let e = Estimate::of_film(&render(&renderer, method, None, samples(96), 10 + m as u64).film, 1);
        println!("{method:?}: {:.5} for {whole:.5}, standard error {:.2} %", e.mean, 100.0 * e.relative_error());
        family.add(e.p_exact(whole), format!("{method:?}: {} for {whole}", e.mean));
        ours.push(e);
        for depth in [8, 64] {
            let rendered = render(&renderer, method, Some(depth), samples(64), u64::from(depth) + m as u64);
            let (e, left) = (Estimate::of_film(&rendered.film, 1), ball.ratio(albedo).powi(depth as i32));
            family.add(e.p_exact(whole * (1.0 - left)), format!("{method:?}, {depth} bounces: {}", e.mean));
            family.add(cut(&rendered).p_exact(left), format!("{method:?}, cut after {depth}: {}", cut(&rendered).mean));
            if method == Method::Mis {
                lost.push((1.0 - e.mean / whole, cut(&rendered).mean));
            }
        }
    }
    assert!(lost[0].0 > 0.5 && lost[1].0 > 0.1, "limits should lose light: {lost:?}");

    let paths = samples(40_000);
    let share = |radiance: f64| 100.0 * (1.0 - radiance / whole);
    let unweighted = share(chain(ball.f, f64::from(albedo), false, paths).mean);
    let clamped = share(chain(ball.f, 0.95, true, paths).mean);
    assert!(unweighted > 5.0 && clamped > 5.0, "{unweighted} % and {clamped} % lost");
    let sound = chain(ball.f, f64::from(albedo), true, paths);
    family.add(sound.p_exact(whole), format!("the textbook's roulette with weights: {}", sound.mean));

    // Every sample is 1 or was cut: with what is said to be cut, nothing is missing, to the last bit.
    let narrow = render(&white(0.1), Method::Path, None, 16, 3);
    let mean = Estimate::of_film(&narrow.film, 1).mean;
    let reported = narrow.counts.cut_throughput / narrow.counts.camera as f64;
    println!("white room: {mean} and {reported} cut");
    assert!(narrow.counts.cut > 0 && mean + reported == 1.0, "{mean} and {reported}");
    assert!(narrow.counts.bounce <= u64::from(BOUNCE_LIMIT) * narrow.counts.camera);
    for (m, method) in METHODS.into_iter().enumerate() {
        let wide = render(&white(1.0), method, None, samples(64), 20 + m as u64);
        assert_eq!(wide.counts.cut, 0, "{method:?}: a wide lamp ends all paths in time");
        family.add(Estimate::of_film(&wide.film, 1).p_exact(1.0), format!("white room, {method:?}"));
    }
    family.judge();

    let error = ours.iter().map(|e| (e.mean / whole - 1.0).abs()).fold(0.0, f64::max);
    Finding {
        textbook: format!(
            "{:.0} % of the light lost with 8 bounces, {:.0} % with 64, {:.0} % with albedo clamped to 0.95, {:.0} \
             % with roulette without weights",
            100.0 * lost[0].0,
            100.0 * lost[1].0,
            clamped,
            unweighted,
        ),
        ours: format!(
            "right to {:.1} % (standard error {:.1} %); 8 and 64 bounces report {:.0} % and {:.0} % as cut; a \
             white room ends, and image and report add up to {}",
            100.0 * error,
            100.0 * ours.iter().map(Estimate::relative_error).fold(0.0, f64::max),
            100.0 * lost[0].1,
            100.0 * lost[1].1,
            mean + reported,
        ),
        how: format!(
            "A sphere of albedo {albedo}, a hundredth of it lamp, has a closed form: radiance is a geometric \
             series of bounces. `path`, `nee` and `mis`, without a limit and with 8 and 64 bounces, are held \
             against it, as is what they report as cut. A closed room of albedo 1 has radiance 1 everywhere; with \
             a small lamp {:.0} % of its paths are cut after {BOUNCE_LIMIT} bounces.",
            100.0 * reported
        ),
        picture: Some(Picture {
            ending: "svg",
            bytes: picture(&ball),
            caption: "Light that a limit on bounces loses.".into(),
        }),
    }
}

/// Lost light against the limit, of three albedos: closed form, measured, reported.
fn picture(ball: &Sphere) -> Vec<u8> {
    let depths = [1u32, 4, 16, 64];
    let (mut curves, mut measured, mut reported) = (Vec::new(), Vec::new(), Vec::new());
    for albedo in [0.9, 0.99] {
        let renderer = ball.renderer(albedo);
        let exact = (1..512).map(|n| (f64::from(n), ball.ratio(albedo).powi(n)));
        curves.push(curve(format!("albedo {albedo}"), exact.filter(|p| p.1 > 1e-3).collect()));
        for &n in depths.iter().filter(|&&n| ball.ratio(albedo).powi(n as i32) > 0.02) {
            let rendered = render(&renderer, Method::Mis, Some(n), samples(32), 40 + u64::from(n));
            measured.push((f64::from(n), 1.0 - Estimate::of_film(&rendered.film, 1).mean / ball.whole(albedo)));
            reported.push((f64::from(n), cut(&rendered).mean));
        }
    }
    curves.extend([dots("measured", measured), dots("reported as cut", reported)]);
    let axes = Axes {
        x: ("bounces at most", 1.0..512.0),
        y: ("share of light lost", 1e-3..1.0),
        legend: SeriesLabelPosition::LowerLeft,
    };
    svg(&axes, &curves)
}
