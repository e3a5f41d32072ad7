//! Glass within glass, against walls, about the camera; open sheets; all indices.

use crate::common::meshes::{cuboid, inverted, join, patch, quad, soup, sphere, turned, v};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, diffuse, glass, lamp};
use crate::common::{film, samples, settings};
use crate::row::{Finding, Part, ROW_FAMILIES, Row};
use crate::walk::{Side, walk};
use glam::DVec3;
use wavetrace::camera::Camera;
use wavetrace::film::Film;
use wavetrace::render::{Control, SamplerKind, Settings};
use wavetrace::wave::Method;
use wavetrace::{MaterialInput, Mesh};

pub const ROW: Row = Row {
    part: Part::Shading,
    name: "dielectrics",
    title: "Glass in glass, on a floor, about the camera",
    fails: "Textbooks count crossings to know whether a path is in the glass: wrong from the start where the camera \
            is in it. Rays that start a fixed distance on skip a floor that the glass stands on, and light leaks. \
            Indices next to 1 and far from it lose or make light by rounding.",
    remedy: "The side is that of the triangle's front, at every crossing anew, so that the camera may be anywhere \
             and glass lie in glass (its index is relative to what is around it). Rays start 32 roundings off. Where \
             it stands: glass must overlap what it touches, or keep a distance of 10<sup>-5</sup> of the larger \
             one's size. Faces in one and the same plane leak. An open sheet is the surface of glass without an end; \
             index 1 makes it a filter. Between facets light can be caught for thousands of bounces, more so at \
             large indices; what is cut is counted.",
    source: "own; the scale of radiance is Veach 1997, section 5.2",
    run,
};

const INDICES: [f32; 14] =
    [1.0, 1.0 + f32::EPSILON, 1.0 - f32::EPSILON, 1.0001, 0.9999, 0.7, 0.1, 1e-3, 1e-6, 1.5, 2.4, 10.0, 1000.0, 1e6];
/// Distances of a cube of glass, 1 wide, from the floor that it stands on; negative where it reaches into it.
const GAPS: [f64; 4] = [1e-3, 1e-4, 1e-5, -1e-3];

fn path(spp: u32, seed: u64) -> Settings {
    settings(Method::Path, SamplerKind::Xoshiro, samples(spp), seed)
}

/// The mean of an image, with what was cut: in a sky of 1 a path that is cut would have brought 1. And the share that
/// was cut.
fn mean(scene: Scene, spp: u32) -> (Estimate, f64) {
    let rendered = scene.renderer().render(&path(spp, 1), &Control::default()).expect("a scene that can be rendered");
    assert!(rendered.bad.is_empty(), "{:?}", rendered.bad);
    let cut = rendered.counts.cut as f64 / rendered.counts.camera as f64;
    (Estimate::of_film(&rendered.film, 1), cut)
}

fn outside() -> Camera {
    camera(v(0.3, -3.0, 0.4), v(-0.3, 3.0, -0.4), [16, 16], 30.0)
}

/// Looks along +y at the middle of what is about the origin.
fn straight() -> Camera {
    camera(v(0.05, -1.5, 0.02), DVec3::Y, [16, 16], 1.0)
}

fn wall(y: f64) -> Mesh {
    quad(v(-1.0, y, -1.0), v(2.0, 0.0, 0.0), v(0.0, 0.0, 2.0))
}

fn ball(radius: f64, smooth: bool) -> Mesh {
    sphere(DVec3::ZERO, radius, 3, smooth)
}

/// Reflectance of surfaces of these relative indices, one behind the other, at normal incidence.
fn stack(indices: &[f64]) -> f64 {
    let each = |n: &f64| ((n - 1.0) / (n + 1.0)).powi(2);
    let sum: f64 = indices.iter().map(each).map(|r| r / (1.0 - r)).sum();
    sum / (1.0 + sum)
}

/// Cube of glass over a black floor with a lamp below it: nothing of that may be seen.
fn floor(gap: f64) -> (Mesh, Mesh) {
    (turned(cuboid(v(-0.5, -0.5, gap), v(0.5, 0.5, 1.0 + gap)), 20.0), patch(0.0, 0.0, 0.0, 3.0, 3.0))
}

fn leak(gap: f64) -> f64 {
    let (cube, floor) = floor(gap);
    let scene = Scene::new(camera(v(0.05, -1.5, 2.0), v(0.0, 1.5, -1.5), [16, 16], 20.0))
        .with(cube, glass(1.0, 1.5))
        .with(floor, diffuse(0.0))
        .with(patch(0.0, 0.0, -0.5, 3.0, 3.0), lamp(1.0));
    mean(scene, 64).0.mean
}

/// The same by the textbook: the share of paths that pass the floor.
fn textbook_leak(gap: f64, paths: u32) -> f64 {
    let (cube, floor) = floor(gap);
    let (soup, glass, mut random) = (soup(&join(&[cube.clone(), floor])), cube.triangles.len(), Random(8));
    let eye = v(0.05, -1.5, 2.0);
    let mut passes = || {
        let target = v(f64::from(random.within(-0.4, 0.4)), f64::from(random.within(-0.4, 0.4)), 0.5);
        let way = (target - eye).normalize().as_vec3().to_array();
        walk(&soup, 1.5, glass, Side::Front, (eye.as_vec3().to_array(), way), &mut random).0.is_some_and(|d| d[2] < 0.0)
    };
    (0..paths).filter(|_| passes()).count() as f64 / f64::from(paths)
}

/// Radiance in the middle of a ball of glass under a sky of 1, by counting crossings.
fn textbook_inside(index: f32, paths: u32) -> f64 {
    let (soup, mut random) = (soup(&ball(1.0, false)), Random(9));
    let mut path = || {
        let way = random.direction();
        walk(&soup, index, soup.len(), Side::Counted, ([0.1, 0.1, 0.0], way), &mut random).1
    };
    (0..paths).map(|_| f64::from(path())).sum::<f64>() / f64::from(paths)
}

/// Lamps of several colours behind a ball, or without it.
fn view(body: Option<MaterialInput>) -> Film {
    let lamps = (0..5).fold(Scene::new(outside()), |scene, k| {
        let x = f64::from(k) - 2.0;
        scene.with(quad(v(x - 0.4, 2.0, -1.5), v(0.7, 0.1, 0.0), v(0.1, 0.2, 3.0)), lamp(1.0 + k as f32))
    });
    let scene = match body {
        Some(material) => lamps.with(ball(1.0, true), material),
        None => lamps,
    };
    film(&scene.renderer(), &path(64, 1))
}

fn run() -> Finding {
    let mut family = Family::one_of(ROW_FAMILIES);
    let cube = || turned(cuboid(v(-0.7, -0.7, -0.7), v(0.7, 0.7, 0.7)), 30.0);
    let (mut common, mut caught) = (0.0f64, 0.0f64);
    for n in INDICES {
        for (name, mesh) in [("flat ball", ball(1.0, false)), ("ball", ball(1.0, true)), ("cube", cube())] {
            let (e, cut) = mean(Scene::new(outside()).background(1.0).with(mesh, glass(1.0, n)), 16);
            caught = caught.max(cut);
            common = if n < 10.0 { common.max(cut) } else { common };
            let whole = Estimate { mean: e.mean + cut, ..e };
            // The sum has no spread but for rounding.
            family.add(
                Estimate { variance: 0.0, ..whole }.p_exact(1.0),
                format!("index {n}, {name}: {} and {cut} cut", e.mean),
            );
        }
    }
    let sky = |view: Camera| Scene::new(view).background(1.0);
    let inside = |n: f32| {
        mean(sky(camera(v(0.1, 0.1, 0.0), DVec3::Y, [16, 16], 60.0)).with(ball(1.0, true), glass(1.0, n)), 64).0
    };
    for n in [1.0f32, 1.5, 0.7] {
        family.add(inside(n).p_exact(f64::from(n).powi(2)), format!("inside of index {n}: {}", inside(n).mean));
    }
    let r = stack(&[1.5]);
    for (front, n, expected) in [
        (true, 1.0f32, 1.0),
        (false, 1.0, 1.0),
        (true, 1.5, r + (1.0 - r) / 1.5f64.powi(2)),
        (false, 1.5, r + (1.0 - r) * 1.5f64.powi(2)),
    ] {
        let sheet = if front { wall(0.0) } else { inverted(wall(0.0)) };
        let e = mean(sky(straight()).with(sheet, glass(1.0, n)), 64).0;
        family.add(e.p_exact(expected), format!("sheet of index {n}, front {front}: {} for {expected}", e.mean));
    }
    let bubble = join(&[ball(1.0, false), inverted(ball(0.8, false))]);
    family.add(mean(sky(outside()).with(bubble, glass(1.0, 1.5)), 16).0.p_exact(1.0), "bubble");
    // Glass, water against glass, water against air.
    let layers = Scene::new(straight())
        .with(wall(-0.5), glass(1.0, 1.5))
        .with(wall(0.0), glass(1.0, 1.33 / 1.5))
        .with(inverted(wall(0.5)), glass(1.0, 1.33))
        .with(wall(-2.0), lamp(1.0));
    let (e, expected) = (mean(layers, 256).0, stack(&[1.5, 1.33 / 1.5, 1.33]));
    family.add(e.p_exact(expected), format!("layers reflect {} for {expected}", e.mean));
    let tests = family.count();
    family.judge();

    let (with, without) = (view(Some(glass(1.0, 1.0))), view(None));
    let differ =
        with.pixels().iter().zip(without.pixels()).map(|(a, b)| (a.mean()[1] - b.mean()[1]).abs()).fold(0.0, f64::max);
    // One sample that meets another lamp would change a pixel by one over their number; rounding by 2^-20 of 5.
    assert!(differ < 0.5 / f64::from(samples(64)), "a ball of index 1 is seen: {differ}");

    let leaks = GAPS.map(leak);
    let naive = GAPS.map(|gap| textbook_leak(gap, samples(2_000)));
    println!("gaps {GAPS:?}: leak {leaks:?}, textbook {naive:?}; faces in one plane: {}", leak(0.0));
    assert!(leaks.iter().all(|l| *l == 0.0), "light leaks through a floor: {leaks:?}");
    let (center, truth) = (textbook_inside(1.5, samples(2_000)), 2.25);
    assert!(naive[2] > 0.05 && center < 0.5 * truth, "the textbook's method should fail: {naive:?}, {center}");
    Finding {
        textbook: format!(
            "{:.0} % of paths leak through the floor at a distance of 10<sup>-5</sup>; radiance {center:.2} for \
             {truth} in a ball of index 1.5",
            100.0 * naive[2]
        ),
        ours: format!(
            "none leak; {:.2} in the ball; all indices from 10<sup>-6</sup> to 10<sup>6</sup> conserve light, but \
             for what is cut: {:.1} % of paths at most, {common:.0e} below index 10; faces in one plane leak {:.0} %",
            inside(1.5).mean,
            100.0 * caught,
            100.0 * leak(0.0)
        ),
        how: format!(
            "Balls, flat and smooth, and a cube of 14 indices under a sky of 1, with what is cut; cameras in glass \
             (n<sup>2</sup>); open sheets from both sides (R + (1 - R) / n<sup>2</sup>, R + (1 - R) n<sup>2</sup>); \
             a bubble; glass on water (sum of R / (1 - R)); {tests} t-tests. A ball of index 1 before lamps: no \
             pixel changes. A cube 1 wide on a black floor over a lamp, at distances of 10<sup>-3</sup> to \
             10<sup>-5</sup> and reaching in: nothing is seen of the lamp."
        ),
        picture: None,
    }
}
