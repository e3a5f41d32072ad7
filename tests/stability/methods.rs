//! Three ways to find light, and what each of them misses.

use crate::common::meshes::{cuboid, join, patch, quad, soup, v};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, diffuse, glass, lamp, mirror};
use crate::common::{METHODS, film, samples, settings};
use crate::lambert::irradiance;
use crate::row::{Finding, Part, ROW_FAMILIES, Row};
use crate::textbook::{Point, nearest};
use glam::DVec3;
use std::f64::consts::PI;
use wavetrace::Mesh;
use wavetrace::render::{Renderer, SamplerKind, Settings};
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Transport,
    name: "methods",
    title: "Light that is counted twice, or not at all",
    fails: "Where paths that hit a lamp count in full beside connections to it, its light is there twice. Where \
        they count nothing, as with connections alone, all light behind glass and in mirrors is missing: no \
        straight line leads there.",
    remedy: "What hits a lamp and what connects to it share one weight, the power heuristic, and what is stored on \
        a path decides it: a finite density, infinity after a mirror or glass, to which nothing can be connected. \
        So `path`, `nee` and `mis` have the same mean in every scene. Light that mirrors or glass focus is left to \
        chance in `path` and `nee`; `mis` finds it by light paths too, in the same sum of weights. `wavetrace \
        check` and `render` name light that is left to chance.",
    source: "Veach 1997; see [light paths](decisions/light-paths.md)",
    run,
};

const ALBEDO: f32 = 0.6;
const MIRROR: f32 = 0.8;
const EYE: DVec3 = DVec3::new(0.2, -0.8, 0.6);
/// Half the image's width at distance 1.
const HALF: f64 = 0.2;

/// A lamp of some side above the floor, nothing or something in its way, and the irradiance of a floor point by
/// Lambert's formula.
struct Case {
    name: &'static str,
    lamp: Mesh,
    /// The lamp as the mirror shows it.
    shown: Option<Mesh>,
    pane: Option<Mesh>,
}

impl Case {
    fn all(side: f64) -> [Self; 3] {
        let lamp = patch(0.1, 0.2, 1.5, side, side);
        let mut shown = lamp.clone();
        shown.positions.iter_mut().for_each(|p| p.x = 2.0 - p.x);
        let pane = cuboid(v(-0.6, -0.6, 0.8), v(0.6, 0.6, 0.9));
        [
            Self { name: "open", lamp: lamp.clone(), shown: None, pane: None },
            Self { name: "clear pane", lamp: lamp.clone(), shown: None, pane: Some(pane) },
            Self { name: "mirror", lamp, shown: Some(shown), pane: None },
        ]
    }
    fn floor() -> Mesh {
        patch(0.0, 0.0, 0.0, 2.0, 2.0)
    }
    /// A wall at x = 1.
    fn wall() -> Mesh {
        quad(v(1.0, -3.0, 0.0), v(0.0, 6.0, 0.0), v(0.0, 0.0, 3.0))
    }
    fn renderer(&self) -> Renderer {
        let x_angle = 2.0 * HALF.atan().to_degrees();
        let mut scene = Scene::new(camera(EYE, -EYE, [8, 8], x_angle)).with(Self::floor(), diffuse(ALBEDO));
        if let Some(pane) = &self.pane {
            scene = scene.with(pane.clone(), glass(1.0, 1.0));
        }
        if self.shown.is_some() {
            scene = scene.with(Self::wall(), mirror(MIRROR));
        }
        scene.with(self.lamp.clone(), lamp(1.0)).renderer()
    }
    /// Irradiance at `at`: what comes straight, and what the mirror brings.
    fn light(&self, at: DVec3) -> [f64; 2] {
        let of = |mesh: &Mesh| irradiance(&mesh.positions, at, DVec3::Z);
        [of(&self.lamp), self.shown.as_ref().map_or(0.0, |shown| f64::from(MIRROR) * of(shown))]
    }
    /// Mean radiance of the image: it varies so little that a sum over 64 x 64 rays is good to 10^-5.
    fn radiance(&self) -> f64 {
        let points = floor_points(64);
        let sum: f64 = points.iter().map(|&at| self.light(at).iter().sum::<f64>()).sum();
        f64::from(ALBEDO) / PI * sum / points.len() as f64
    }
    fn settings(&self, method: Method, spp: u32, seed: u64) -> Settings {
        // Two bounces, so that the floor does not see itself in the mirror.
        let max_depth = self.shown.as_ref().map(|_| 2);
        Settings { max_depth, ..settings(method, SamplerKind::Xoshiro, spp, seed) }
    }
    /// The share of this light that shadow rays find, one from each point.
    fn connected(&self) -> f64 {
        let mut blockers = vec![Self::floor()];
        blockers.extend(self.pane.clone());
        blockers.extend(self.shown.as_ref().map(|_| Self::wall()));
        let (soup, mut random) = (soup(&join(&blockers)), Random(1));
        let p = &self.lamp.positions;
        let (mut found, mut all) = (0.0, 0.0);
        for at in floor_points(40) {
            let to = p[0] + (p[1] - p[0]) * f64::from(random.unit()) + (p[3] - p[0]) * f64::from(random.unit());
            let [from, way] = [at, to - at].map(|x| -> Point { x.as_vec3().to_array() });
            let light = self.light(at);
            all += light[0] + light[1];
            found += if nearest(&soup, from, way, 1e-4).is_some_and(|hit| hit.1 < 1.0) { 0.0 } else { light[0] };
        }
        found / all
    }
}

/// Where `n` x `n` rays of the image meet the floor.
fn floor_points(n: u32) -> Vec<DVec3> {
    let (forward, right) = ((-EYE).normalize(), (-EYE).cross(DVec3::Z).normalize());
    let up = right.cross(forward);
    let at = |k: u32| HALF * ((2 * k + 1) as f64 / f64::from(n) - 1.0);
    let ray = |i: u32, j: u32| forward + right * at(i) + up * at(j);
    (0..n * n).map(|k| ray(k % n, k / n)).map(|d| EYE - d * (EYE.z / d.z)).collect()
}

fn run() -> Finding {
    let mut family = Family::one_of(ROW_FAMILIES);
    let (mut worst, mut error, mut doubled) = (0.0f64, 0.0f64, 0.0);
    let cases = Case::all(0.3);
    for (k, case) in cases.iter().enumerate() {
        let (renderer, exact) = (case.renderer(), case.radiance());
        let estimates = METHODS.map(|method| {
            let settings = case.settings(method, samples(4096), 10 * k as u64 + method as u64);
            let e = Estimate::of_film(&film(&renderer, &settings), 1);
            println!("{}, {method:?}: {:.5} +- {:.5} of {exact:.5}", case.name, e.mean / exact, e.relative_error());
            family.add(e.p_exact(exact), format!("{}, {method:?}: {} for {exact}", case.name, e.mean));
            worst = worst.max((e.mean / exact - 1.0).abs());
            e
        });
        if k == 0 {
            doubled = (estimates[0].mean + estimates[1].mean) / exact;
        }
        error = estimates.iter().map(Estimate::relative_error).fold(error, f64::max);
    }
    // Behind the pane a path of `nee` brings the albedo if it happens to hit the lamp, else nothing: its variance is
    // known.
    let small = &Case::all(0.03)[1];
    let (exact, image) = (small.radiance(), film(&small.renderer(), &small.settings(Method::Mis, samples(4096), 50)));
    let e = Estimate::of_film(&image, 1);
    println!("small lamp, {:?}: {:.5} +- {:.5} of {exact:.7}", Method::Mis, e.mean / exact, e.relative_error());
    family.add(e.p_exact(exact), format!("small lamp behind the pane: {} for {exact}", e.mean));
    let gain = exact * (f64::from(ALBEDO) - exact) / (e.variance * 64.0 * f64::from(samples(4096)));
    assert!(gain > 4.0, "light paths should find what is behind the pane: {gain}");
    family.judge();
    let connected = cases.each_ref().map(Case::connected);
    assert!(connected[0] == 1.0 && connected[1] < 0.01 && connected[2] < 0.9, "{connected:?}");
    assert!((doubled - 2.0).abs() < 0.2, "{doubled}");

    // What is left to chance is named, and is much noisier.
    let said = |case: &Case, settings: &Settings| case.renderer().plan(settings).unwrap().left_to_chance().is_some();
    for (k, case) in cases.iter().enumerate() {
        let [nee, mis] = [Method::Nee, Method::Mis].map(|method| case.settings(method, 1, 0));
        assert!(!said(case, &mis), "{}", case.name);
        assert_eq!(said(case, &nee), k > 0, "{}", case.name);
        assert_eq!(said(case, &Settings { light_paths: 0.0, ..mis }), k > 0, "{}", case.name);
    }
    Finding {
        textbook: format!(
            "{doubled:.2} times the light without weights; {:.0} % of it lost behind a pane and {:.0} % beside a \
             mirror by connections alone",
            100.0 * (1.0 - connected[1]),
            100.0 * (1.0 - connected[2])
        ),
        ours: format!(
            "all nine right to {:.1} % (standard error {:.1} %); behind the pane `mis` has {gain:.0} times less \
             variance than `nee`, of which the plan says that it leaves light to chance",
            100.0 * worst,
            100.0 * error
        ),
        how: "A floor under a lamp: alone, behind a clear pane of index 1, and beside a mirror. `path`, `nee` and \
            `mis` against Lambert's formula, that of the mirrored lamp added; a lamp a tenth as wide behind the \
            pane, by `mis`; and whether the plan names what is left to chance."
            .into(),
        picture: None,
    }
}
