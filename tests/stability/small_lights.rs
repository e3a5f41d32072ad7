//! Lights of any solid angle.

use crate::common::meshes::{patch, quad, v};
use crate::common::random::Random;
use crate::common::samples;
use crate::common::stats::{Estimate, Family};
use crate::curve::{Axes, dots, svg};
use crate::lambert::{connection, irradiance, lights, polygon_angle, rounded};
use crate::row::{Finding, Part, Picture, ROW_FAMILIES, Row};
use crate::textbook::{Point, cross, dot, unit};
use glam::DVec3;
use plotters::prelude::SeriesLabelPosition;
use wavetrace::Mesh;
use wavetrace::lanes::Vec3;
use wavetrace::light::Receiver;

pub const ROW: Row = Row {
    part: Part::Transport,
    name: "small_lights",
    title: "The solid angle of a small light is lost in rounding",
    fails: "Textbooks sample a triangle by its spherical excess, the sum of three angles less pi (Girard; Arvo \
        1995). In f32 the sum is rounded to 2 x 10<sup>-7</sup>, and the angles come from arc cosines near 1: a \
        small light's solid angle, and with it its brightness, is rounding error, 0, negative, or not a number.",
    remedy: "Lights are sampled by solid angle only from within about their own size, where they fill more than \
        0.02 sr, and by area elsewhere, where the weight cos cos / d<sup>2</sup> hardly varies. The solid angle \
        has no arc cosine and no difference of angles: tan(omega / 2) = a . (b x c) / (1 + a.b + b.c + c.a).",
    source: "Van Oosterom and Strackee 1983; Arvo 1995; the choice between area and angle after Pharr, Jakob and \
        Humphreys 2023, section 6.5.4",
    run,
};

/// Solid angle of a triangle by Girard's theorem, as textbooks have it.
fn girard(corners: [Point; 3]) -> f32 {
    let [a, b, c] = corners.map(unit);
    let angle = |u: Point, v: Point| dot(unit(u), unit(v)).acos();
    let [ab, bc, ca] = [cross(a, b), cross(b, c), cross(c, a)];
    let turn = |u: Point| u.map(|x| -x);
    angle(ab, turn(ca)) + angle(bc, turn(ab)) + angle(ca, turn(bc)) - std::f32::consts::PI
}

/// Lights of some shape whose solid angle, seen from the origin, is about `omega`.
fn shapes(omega: f64) -> [(&'static str, Mesh); 3] {
    // A square overhead at height 1 has tan(omega / 4) = s^2 / sqrt(1 + 2 s^2), s half its side: solved for s^2.
    let t2 = (omega / 4.0).tan().powi(2);
    let half = (t2 + (t2 * t2 + t2).sqrt()).sqrt();
    let square = patch(0.0, 0.0, 1.0, 2.0 * half, 2.0 * half);
    let side = omega.sqrt().min(1.0);
    let corner = v(-0.3, 0.4, 0.7);
    let edges = [v(0.9, 0.1, 0.2) * side, v(-0.2, 1.1, 0.1) * side];
    let triangle = Mesh {
        positions: vec![corner, corner + edges[0], corner + edges[1]],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    // A hundred times as long as it is wide.
    let (long, wide) = ((100.0 * omega).sqrt().min(10.0), omega / (100.0 * omega).sqrt().min(10.0));
    let strip = quad(v(-wide / 2.0, -long / 2.0, 0.8), v(wide, 0.0, 0.1 * wide), v(0.0, long, 0.0));
    [("square", square), ("triangle", triangle), ("strip", strip)]
}

fn run() -> Finding {
    let mut family = Family::one_of(ROW_FAMILIES);
    let (mut ours, mut naive) = (Vec::new(), Vec::new());
    let (mut tried, mut unusable, mut wrong) = (0, 0, 0);
    let (mut worst_density, mut worst_small) = (0.0f64, 0.0f64);
    let n = samples(20_000);
    for step in 0..=64u32 {
        // 10^-12 sr to all but 10^-3 of a half sphere.
        let omega = 10f64.powf(-12.0 + 0.2 * f64::from(step)).min(2.0 * std::f64::consts::PI - 1e-3);
        for (k, (name, mesh)) in shapes(omega).into_iter().enumerate() {
            let mesh = rounded(mesh);
            let exact = irradiance(&mesh.positions, DVec3::ZERO, DVec3::Z);
            let angle = polygon_angle(&mesh.positions, DVec3::ZERO);
            let lights = lights(&mesh);
            let mut random = Random(u64::from(1000 * step) + k as u64);
            let values: Vec<f64> = (0..n).map(|_| f64::from(connection(&lights, &mut random))).collect();
            assert!(values.iter().all(|x| x.is_finite()), "{name} of {angle:e} sr");
            let e = Estimate::of_replicates(&values);
            family.add(
                e.p_exact(exact),
                format!("{name} of {angle:e} sr: {} +- {} for {exact}", e.mean, e.variance.sqrt()),
            );
            let error = (e.mean / exact - 1.0).abs();
            if angle < 1e-6 {
                worst_small = worst_small.max(error);
            }
            let (density, bound) = density_error(&mesh, angle);
            assert!(density <= bound, "{name} of {angle:e} sr: the density errs by {density:e}, more than {bound:e}");
            worst_density = worst_density.max(density);

            let corners = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize].as_vec3().to_array());
            let girard: f32 = mesh.triangles.iter().map(|t| girard(corners(t))).sum();
            let lost = (f64::from(girard) / angle - 1.0).abs();
            tried += 1;
            unusable += u32::from(girard.is_nan() || girard <= 0.0);
            wrong += u32::from(lost.is_nan() || lost > 0.01);
            if name == "triangle" {
                naive.push((angle, if lost.is_nan() { f64::INFINITY } else { lost }));
                ours.push((angle, error));
            }
        }
    }
    family.judge();
    println!("Girard: {unusable} of {tried} unusable, {wrong} wrong by more than 1 %; density here {worst_density:e}");
    assert!(unusable * 10 > tried && wrong * 3 > tried, "spherical excess should fail: {unusable}, {wrong} of {tried}");
    let axes = Axes {
        x: ("solid angle in sr", 1e-12..10.0),
        y: ("relative error", 1e-9..100.0),
        legend: SeriesLabelPosition::UpperRight,
    };
    let curves = [dots("spherical excess in f32", naive), dots(format!("light here, {n} samples"), ours)];
    Finding {
        textbook: format!(
            "of {tried} solid angles {wrong} wrong by more than 1 %, {unusable} of these 0, negative \
            or not a number"
        ),
        ours: format!(
            "all irradiances right within their standard error, below 10<sup>-6</sup> sr to {worst_small:.0e}; \
             densities to {worst_density:.0e}"
        ),
        how: format!(
            "A square, a triangle and a strip a hundred times as long as it is wide, of 10<sup>-12</sup> sr to all \
             but 10<sup>-3</sup> of a half sphere: irradiance from {n} connections each, against Lambert's formula \
             in f64."
        ),
        picture: Some(Picture {
            ending: "svg",
            bytes: svg(&axes, &curves),
            caption: "Relative error of the triangle's solid angle and of its light. What is above the chart \
                stands at its edge. To the right the error is that of the number of samples."
                .into(),
        }),
    }
}

/// Relative error of the density with which a ray into a light's middle would have been chosen, and a bound of it.
fn density_error(mesh: &Mesh, angle: f64) -> (f64, f64) {
    let rounding = f64::from(f32::EPSILON) / 2.0;
    let triangles = mesh.triangles.len() as f64;
    let of = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize]);
    let [a, b, c] = of(&mesh.triangles[0]);
    let cross = (b - a).cross(c - a);
    let middle = (mesh.positions.iter().sum::<DVec3>() / mesh.positions.len() as f64).as_vec3();
    let at = middle.as_dvec3();
    let cos = cross.normalize().dot(at.normalize()).abs();
    let from = Receiver { point: Vec3::splat([0.0; 3]), normal: Vec3::splat([0.0, 0.0, 1.0]) };
    let (_, density) = lights(mesh).seen::<f32>(|_| 0, &from, Vec3::splat(middle.to_array()), cos as f32);
    let error = |exact: f64| (f64::from(density) / exact - 1.0).abs();
    // By area it is d^2 / (cos A): 8 roundings.
    let by_area = error(at.length_squared() / (0.5 * cross.length() * triangles * cos));
    if by_area <= 8.0 * rounding {
        return (by_area, 8.0 * rounding);
    }
    // Else 1 / omega, omega = 2 atan2(y, x): y and x are dot products of unit vectors and err by 6 roundings, the arc
    // tangent by 6e-8 turns.
    let size = |t: &[u32; 3]| {
        let [a, b, c] = of(t).map(DVec3::normalize);
        a.dot(b.cross(c)).hypot(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    };
    let least = mesh.triangles.iter().map(size).fold(f64::INFINITY, f64::min);
    let each = 2.0 * (2f64.sqrt() * 6.0 * rounding / least + 6e-8 * std::f64::consts::TAU);
    (error(1.0 / angle), triangles * each / angle)
}
