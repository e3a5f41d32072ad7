//! Vertex normals that cannot be normalised.

use crate::common::meshes::{patch, v};
use crate::common::random::Random;
use crate::common::worlds::{Scene, camera, diffuse, glass, lamp, matt, mirror};
use crate::common::{METHODS, samples, settings};
use crate::row::{Finding, Part, Row};
use crate::textbook::{Point, dot};
use glam::DVec3;
use wavetrace::render::{Control, SamplerKind};
use wavetrace::{MaterialInput, Mesh};

pub const ROW: Row = Row {
    part: Part::Shading,
    name: "normals",
    title: "Normals of length 0, opposite or backward normals",
    fails: "Meshes come with vertex normals of length 0, and with neighbours that look in opposite directions: \
            between them the interpolated normal vanishes. Normalising it divides 0 by 0, and the pixel is lost; a \
            normal to the wrong side makes the surface black.",
    remedy: "Vertex normals are normalised in f64 when the world is built, and replaced by the triangle's own where \
             they are 0 (or their squared length is 0 or infinite). An interpolated normal shorter than \
             10<sup>-4</sup>, or not a number, is replaced by the triangle's own; one that looks to the other side \
             of the triangle is turned. Triangles without area are left out and counted.",
    source: "own",
    run,
};

/// Normals at the four corners of a floor that looks along +z, and what is wrong with them.
fn broken() -> Vec<(&'static str, [DVec3; 4])> {
    let (up, x) = (DVec3::Z, DVec3::X);
    vec![
        ("length 0", [DVec3::ZERO; 4]),
        ("length 0 at two corners", [DVec3::ZERO, up, DVec3::ZERO, up]),
        ("length 1e-200", [up * 1e-200; 4]),
        ("length 1e200", [up * 1e200; 4]),
        ("opposite", [up, -up, up, -up]),
        ("opposite in the plane", [x, -x, x, -x]),
        ("backward", [-up; 4]),
        ("in the plane", [x; 4]),
        ("almost opposite", [up, v(1e-9, 0.0, -1.0), up, v(0.0, 1e-9, -1.0)]),
    ]
}

fn floor(normals: [DVec3; 4]) -> Mesh {
    let mesh = patch(0.0, 0.0, 0.0, 2.0, 2.0);
    Mesh { normals: normals.to_vec(), triangle_normals: mesh.triangles.clone(), ..mesh }
}

/// The share of points of the floor, seen from the eye, at which the textbook's normal is no number, and at which it
/// looks away.
fn textbook(normals: [DVec3; 4], eye: DVec3, points: u32) -> [f64; 2] {
    let mesh = floor(normals);
    let (mut random, mut none, mut away) = (Random(7), 0, 0);
    for i in 0..points {
        let t = (i % 2) as usize;
        // On a grid of barycentric coordinates, which vertex order and exact halves are part of.
        let (a, b) = (random.below(65) as f32 / 64.0, random.below(65) as f32 / 64.0);
        let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        let weights = [1.0 - a - b, a, b];
        let blend = |of: &[DVec3], ids: [u32; 3]| -> Point {
            std::array::from_fn(|k| (0..3).map(|c| of[ids[c] as usize][k] as f32 * weights[c]).sum())
        };
        let normal = blend(&mesh.normals, mesh.triangle_normals[t]);
        let length = dot(normal, normal).sqrt();
        let unit = normal.map(|c| c / length);
        let point = DVec3::from(blend(&mesh.positions, mesh.triangles[t]).map(f64::from));
        let wo = (eye - point).as_vec3().to_array();
        if unit.iter().all(|c| c.is_finite()) { away += u32::from(dot(unit, wo) <= 0.0) } else { none += 1 }
    }
    [none, away].map(|n| f64::from(n) / f64::from(points))
}

fn run() -> Finding {
    let eye = v(0.3, -2.5, 1.5);
    let materials: [(&str, MaterialInput); 6] = [
        ("Lambert", diffuse(1.0)),
        ("mattness 0.3", matt(1.0, 0.3)),
        ("mattness 1e-4", matt(1.0, 1e-4)),
        ("mirror", mirror(1.0)),
        ("glass", glass(1.0, 1.5)),
        ("index 1", glass(1.0, 1.0)),
    ];
    let (mut none, mut away) = (0.0f64, 0.0f64);
    let (mut traced, mut worst) = (0, 0.0f64);
    for (name, normals) in broken() {
        let [n, a] = textbook(normals, eye, 4_000);
        println!("{name}: textbook {:.1} % no number, {:.1} % away", 100.0 * n, 100.0 * a);
        match name {
            "length 0" => none = n,
            "opposite" => away = a,
            _ => {}
        }
        for (what, material) in &materials {
            for (sky, method) in METHODS.into_iter().flat_map(|method| [(true, method), (false, method)]) {
                let scene = Scene::new(camera(eye, -eye, [16, 16], 30.0)).with(floor(normals), material.clone());
                // Either a sky of 1, in which what reflects all light is invisible, or a lamp.
                let scene =
                    if sky { scene.background(1.0) } else { scene.with(patch(0.0, 0.0, 1.0, 0.5, 0.5), lamp(1.0)) };
                let settings = settings(method, SamplerKind::Xoshiro, samples(32), 3);
                let rendered =
                    scene.renderer().render(&settings, &Control::default()).expect("a scene that can be rendered");
                assert!(
                    rendered.bad.is_empty(),
                    "{name}, {what}, {method:?}: samples that are not finite: {:?}",
                    rendered.bad
                );
                traced += rendered.counts.camera;
                let glassy = matches!(material, MaterialInput::Transparent { ref_index, .. } if *ref_index != 1.0);
                if sky && !glassy {
                    let off =
                        rendered.film.pixels().iter().map(|p| (p.sum2[1] - 2.0 * p.sum[1] + p.count as f64).abs());
                    worst = off.fold(worst, f64::max);
                    assert!(worst < 1e-6, "{name}, {what}, {method:?}: {worst} from all samples being 1");
                }
            }
        }
    }
    assert!(none > 0.9 && away > 0.1, "the textbook's normals should fail: {none}, {away}");
    Finding {
        textbook: format!(
            "normals of length 0: {:.0} % of points no number; opposite ones: {:.0} % black",
            100.0 * none,
            100.0 * away
        ),
        ours: format!("all of {:.1} million samples finite, and no light lost", traced as f64 / 1e6),
        how: "A floor whose corners have normals of length 0, 10<sup>-200</sup>, 10<sup>200</sup>, opposite to each \
              other, backward, in the plane; six materials; `path`, `nee` and `mis`; under a lamp, where samples \
              must be finite, and under a sky of 1, where all of them must be 1 (but for a single sheet of glass, \
              whose inside has no other end)."
            .into(),
        picture: None,
    }
}
