//! Thin glass.

use crate::common::meshes::{cuboid, quad, soup, v};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, glass, lamp};
use crate::common::{film, samples, settings};
use crate::curve::{Axes, curve, svg};
use crate::row::{Finding, Part, Picture, ROW_FAMILIES, Row};
use crate::textbook::dot;
use crate::walk::{Side, walk};
use glam::{DMat3, DVec3};
use plotters::prelude::SeriesLabelPosition;
use wavetrace::Mesh;
use wavetrace::render::SamplerKind;
use wavetrace::wave::Method;

pub const ROW: Row = Row {
    part: Part::Shading,
    name: "slabs",
    title: "Thin glass",
    fails: "A ray that enters a pane starts some fixed distance beyond its front. Where the pane is thinner than \
            that, the ray starts behind it and never leaves the glass: there is no second reflection, the view stays \
            refracted, and radiance stays divided by n<sup>2</sup>.",
    remedy: "Rays start off a surface by 32 roundings of the triangle's largest coordinate, 2 &middot; \
             10<sup>-6</sup> of it, in a world scaled to about 1. Panes thinner than that still fail in the same \
             way: it is a limit of the program. What is as thin should be an open sheet of index 1, or left out.",
    source: "after Pharr, Jakob and Humphreys 2023, section 6.8; the limit is our own measurement",
    run,
};

const INDEX: f32 = 1.5;
/// Thickness, in widths, from which a pane must be right: 32 roundings of its largest coordinate, which is less than
/// its width, and 8 for the errors that these are there for.
const LIMIT: f64 = 40.0 * 0.5 * f32::EPSILON as f64;

/// Reflectance of a surface at normal incidence, and that of a pane: 2 R0 / (1 + R0).
fn exact() -> (f64, f64) {
    let r = ((f64::from(INDEX) - 1.0) / (f64::from(INDEX) + 1.0)).powi(2);
    (r, 2.0 * r / (1.0 + r))
}

fn turned(mut mesh: Mesh, turn: DMat3) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
    mesh
}

/// A pane 2 wide, so many widths thick.
fn pane(thickness: f64, turn: DMat3) -> Mesh {
    turned(cuboid(v(-1.0, -thickness, -1.0), v(1.0, thickness, 1.0)), turn)
}

/// What a pane reflects of a lamp behind the camera; and a sky of 1 seen through it and in it, which is 1.
fn ours(thickness: f64, turn: DMat3, seed: u64) -> [Estimate; 2] {
    let at = thickness + 0.5;
    let front = turned(quad(v(-1.0, -at, -1.0), v(2.0, 0.0, 0.0), v(0.0, 0.0, 2.0)), turn);
    let eye = v(0.05, -thickness - 0.2, 0.07);
    let scene = || {
        Scene::new(camera(turn * eye, turn * DVec3::Y, [16, 16], 1.0)).with(pane(thickness, turn), glass(1.0, INDEX))
    };
    let settings = settings(Method::Path, SamplerKind::Xoshiro, samples(128), seed);
    let renders = [scene().with(front, lamp(1.0)), scene().background(1.0)];
    renders.map(|scene| Estimate::of_film(&film(&scene.renderer(), &settings), 1))
}

/// The same reflectance by the textbook.
fn textbook(thickness: f64, turn: DMat3, paths: u32) -> f64 {
    let soup = soup(&pane(thickness, turn));
    let [eye, way] = [turn * v(0.05, -thickness - 0.2, 0.07), turn * DVec3::Y].map(|p| p.as_vec3().to_array());
    let mut random = Random(5);
    let mut path =
        || walk(&soup, INDEX, soup.len(), Side::Front, (eye, way), &mut random).0.expect("glass absorbs nothing");
    let back = (0..paths).filter(|_| dot(path(), way) < 0.0).count();
    back as f64 / f64::from(paths)
}

fn run() -> Finding {
    let (single, whole) = exact();
    let mut family = Family::one_of(ROW_FAMILIES);
    let turns = [DMat3::IDENTITY, DMat3::from_rotation_z(0.6) * DMat3::from_rotation_x(0.3)];
    let (mut flat, mut tilted, mut naive) = (Vec::new(), Vec::new(), Vec::new());
    let mut through = 1.0;
    for k in 0..=14 {
        let thickness = 10f64.powf(-f64::from(k) / 2.0);
        let paths = samples(10_000);
        naive.push((thickness, textbook(thickness, turns[1], paths)));
        for (turn, curve) in turns.iter().zip([&mut flat, &mut tilted]) {
            let [reflected, sky] = ours(thickness, *turn, k as u64);
            println!("{thickness:.1e}: {:.4} +- {:.4}, sky {:.4}", reflected.mean, reflected.variance.sqrt(), sky.mean);
            curve.push((thickness, reflected.mean));
            through = sky.mean;
            if thickness > LIMIT {
                family.add(reflected.p_exact(whole), format!("{thickness:.1e}: reflects {}", reflected.mean));
                family.add(sky.p_exact(1.0), format!("{thickness:.1e}: sky {}", sky.mean));
            }
        }
    }
    let tests = family.count();
    family.judge();
    // Both fall from 2 R0 / (1 + R0) to R0.
    let holds = |curve: &[(f64, f64)]| {
        curve.iter().take_while(|p| p.1 > 0.5 * (single + whole)).last().map_or(f64::INFINITY, |p| p.0)
    };
    let (limits, theirs) = ([holds(&flat), holds(&tilted)], holds(&naive));
    assert!(theirs > 20.0 * limits[0].max(limits[1]), "the textbook's panes should fail sooner: {theirs}, {limits:?}");
    Finding {
        textbook: format!("reflects {whole:.3} of light down to a thickness of {theirs:.0e} widths, {single:.3} below"),
        ours: format!(
            "down to {:.0e} ({:.0e} parallel to the axes); below, {single:.3} as well, and a sky of 1 is {through:.2}",
            limits[1], limits[0]
        ),
        how: format!(
            "A clear pane of index {INDEX} at normal incidence, parallel to the axes and turned, 1 to \
             10<sup>-7</sup> of its width thick. From {LIMIT:.1e} on, its reflection of a lamp is held against 2 R0 \
             / (1 + R0) and the sky around it against 1 ({tests} t-tests). The textbook's form is traced by brute \
             force in a scene of size 2."
        ),
        picture: Some(picture(naive, flat, tilted)),
    }
}

fn picture(naive: Vec<(f64, f64)>, flat: Vec<(f64, f64)>, tilted: Vec<(f64, f64)>) -> Picture {
    let (_, whole) = exact();
    let curves = [
        curve("textbook, rays start 10⁻⁴ on", naive),
        curve("here, turned", tilted),
        curve("here, parallel to the axes", flat),
        curve("2 R0 / (1 + R0)", vec![(1e-7, whole), (1.0, whole)]),
    ];
    let axes = Axes {
        x: ("thickness in widths of the pane", 1e-7..1.0),
        y: ("reflectance", 0.01..0.2),
        legend: SeriesLabelPosition::LowerRight,
    };
    Picture {
        ending: "svg",
        bytes: svg(&axes, &curves),
        caption: "Reflectance of a pane of index 1.5 against its thickness.".into(),
    }
}
