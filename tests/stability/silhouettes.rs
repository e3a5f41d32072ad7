//! Interpolated normals where they part from the surface.

use crate::common::meshes::{cuboid, inverted, soup, sphere, turned, v};
use crate::common::random::Random;
use crate::common::stats::{Estimate, Family};
use crate::common::worlds::{Scene, camera, lamp, matt};
use crate::common::{METHODS, film, samples, settings};
use crate::row::{Finding, Part, Picture, ROW_FAMILIES, Row};
use crate::textbook::{along, cross, dot, moeller_trumbore, sub, unit};
use glam::DVec3;
use wavetrace::film::{Film, Image};
use wavetrace::output::{Metadata, Tone, png_bytes};
use wavetrace::render::SamplerKind;
use wavetrace::wave::Method;
use wavetrace::{MaterialInput, Mesh};

pub const ROW: Row = Row {
    part: Part::Shading,
    name: "silhouettes",
    title: "Normals that are not the surface's: dark rims",
    fails: "Directions chosen about an interpolated normal may point into the surface. Textbooks drop them, and \
            paths that the normal looks away from: what reflects all light turns dark, most at silhouettes of coarse \
            meshes.",
    remedy: "A normal that looks away from the path is tilted until it does not. A direction into the surface is \
             mirrored in the triangle's plane; where a light is connected to, the lobe is the sum of both directions \
             that end there, and the density for multiple importance sampling too. No energy is lost, and no \
             direction goes through. What it costs: near silhouettes reflection is not reciprocal.",
    source: "own; the problem is Veach 1997, section 5.3",
    run,
};

const EYE: DVec3 = DVec3::new(0.3, -3.0, 0.4);
const SIDE: u32 = 160;
const ANGLE: f64 = 45.0;

fn ball(level: u32) -> Mesh {
    sphere(DVec3::ZERO, 1.0, level, true)
}

fn ours(body: Mesh, material: MaterialInput, side: u32, spp: u32) -> Film {
    let scene = Scene::new(camera(EYE, -EYE, [side, side], ANGLE)).background(1.0).with(body, material);
    film(&scene.renderer(), &settings(Method::Path, SamplerKind::Xoshiro, spp, 1))
}

/// Radiance of a Lambertian ball of this albedo under a sky of 1, by the textbook, pixel by pixel; none where it is not
/// seen.
fn textbook(level: u32, albedo: f32, paths: u32) -> Vec<Option<f32>> {
    let (mesh, mut random) = (ball(level), Random(6));
    let soup = soup(&mesh);
    let view = -EYE.normalize();
    let right = view.cross(DVec3::Z).normalize();
    let (up, half) = (right.cross(view), (ANGLE / 2.0).to_radians().tan());
    let eye = EYE.as_vec3().to_array();
    let pixel = |i: u32| {
        let at = |k: u32| (2.0 * (f64::from(k) + 0.5) / f64::from(SIDE) - 1.0) * half;
        let way = unit((view + right * at(i % SIDE) - up * at(i / SIDE)).as_vec3().to_array());
        let hits = soup.iter().enumerate().filter_map(|(id, t)| Some((id, moeller_trumbore(t, eye, way, 0.0)?)));
        let (id, (_, b, c)) = hits.min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
        let [p, q, r] = soup[id];
        let flat = unit(cross(sub(q, p), sub(r, p)));
        let [na, nb, nc] = mesh.triangle_normals[id].map(|n| mesh.normals[n as usize].as_vec3().to_array());
        let normal = unit(std::array::from_fn(|k| na[k] * (1.0 - b - c) + nb[k] * b + nc[k] * c));
        if dot(normal, way) >= 0.0 {
            return Some(0.0);
        }
        // A point of the unit sphere about the tip of the normal: cosine-weighted.
        let free = (0..paths).filter(|_| dot(along(normal, random.direction(), 1.0), flat) > 0.0).count();
        Some(albedo * free as f32 / paths as f32)
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

fn run() -> Finding {
    let dark = textbook(1, 1.0, samples(256));
    let seen: Vec<f32> = dark.iter().flatten().copied().collect();
    let lost = 100.0 * (1.0 - seen.iter().sum::<f32>() / seen.len() as f32);
    let rim = 100.0 * (1.0 - seen.iter().copied().fold(1.0, f32::min));
    assert!(lost > 1.0 && rim > 30.0, "the textbook's rims should be dark: {lost} %, {rim} %");

    let mut total = 0;
    let bodies = [("ball of 80", ball(1)), ("ball of 20", ball(0)), ("ball of 1280", ball(3))];
    let box_of_normals = {
        // Normals of a sphere on a cube.
        let mut mesh = turned(cuboid(v(-0.6, -0.6, -0.6), v(0.6, 0.6, 0.6)), 33.0);
        mesh.normals = mesh.positions.iter().map(|p| p.normalize()).collect();
        mesh.triangle_normals = mesh.triangles.clone();
        mesh
    };
    for (name, body) in bodies.into_iter().chain([("cube with a ball's normals", box_of_normals)]) {
        for m in [0.0, 0.01, 0.3, 1.0] {
            // Each path meets a convex body once: samples are 1, or 0.5.
            let image = ours(body.clone(), matt(0.5, m), 32, samples(64));
            let off = image.pixels().iter().map(|p| (p.sum2[1] - 1.5 * p.sum[1] + 0.5 * p.count as f64).abs());
            let off = off.fold(0.0, f64::max);
            // A path that is lost counts 0.5, one that meets the body again 0.19.
            assert!(off < 0.1, "{name}, mattness {m}: {off} of samples are neither the sky nor the albedo");
            total += image.pixels().iter().map(|p| p.count).sum::<u64>();
        }
    }

    // The same from lamps all around, for what connects to lights.
    let mut family = Family::one_of(ROW_FAMILIES);
    for (k, m) in [0.3f32, 1.0].into_iter().enumerate() {
        for (l, method) in METHODS.into_iter().enumerate() {
            let scene = Scene::new(camera(EYE, -EYE, [16, 16], 36.0))
                .with(ball(1), matt(1.0, m))
                .with(inverted(sphere(DVec3::ZERO, 4.0, 1, false)), lamp(1.0));
            let image =
                film(&scene.renderer(), &settings(method, SamplerKind::Xoshiro, samples(256), (10 * k + l) as u64));
            for i in 0..image.pixels().len() {
                family.add(Estimate::of(&image, i, 1).p_exact(1.0), format!("mattness {m}, {method:?}, pixel {i}"));
            }
            family.add(Estimate::of_film(&image, 1).p_exact(1.0), format!("mattness {m}, {method:?}"));
        }
    }
    let tests = family.count();
    family.judge();
    Finding {
        textbook: format!("a ball of 80 triangles loses {lost:.1} % of its light, {rim:.0} % at its rim"),
        ours: format!("no sample of {:.1} million loses any", total as f64 / 1e6),
        how: format!(
            "Balls of 20, 80 and 1280 triangles and a cube, all with a sphere's normals, under a constant sky: all \
             samples are the sky or the albedo, at mattness 0, 0.01, 0.3 and 1. The ball of 80 amid lamps on all \
             sides is as bright as they are for `path`, `nee` and `mis` ({tests} t-tests). The textbook's Lambertian \
             ball of 80 is traced by brute force."
        ),
        picture: Some(picture()),
    }
}

/// Both beside each other: a ball of albedo 0.8 before a sky of 1, which has no light of its own to be shaded by.
fn picture() -> Picture {
    let naive = textbook(1, 0.8, 512);
    let image = ours(ball(1), matt(0.8, 1.0), SIDE, 64).image();
    let side = SIDE as usize;
    let left = naive.chunks(side).map(|row| row.iter().map(|p| [p.unwrap_or(1.0); 3]).collect::<Vec<_>>());
    let rows = left.zip(image.pixels.chunks(side)).flat_map(|(left, right)| [left, right.to_vec()].concat());
    let both = Image { width: 2 * SIDE, height: SIDE, pixels: rows.collect() };
    Picture {
        ending: "png",
        bytes: png_bytes(&both, &Metadata::default(), &Tone::default()).expect("an image"),
        caption: "A ball of 80 triangles, albedo 0.8, under an even sky: textbook, and here.".into(),
    }
}
