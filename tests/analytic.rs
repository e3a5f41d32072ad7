//! Images whose radiance has a closed form. Each mean is held against its form by a one-sample t-test; chance of a false
//! alarm 10^-3 for the suite (Sidak). Where every sample has the same value the only spread left is that of f32 rounding
//! (`ROUNDING`), and the test is as sharp as that.

mod common;

use common::meshes::{area, cuboid, example, inverted, patch, quad, sphere, turned, v};
use common::stats::{Estimate, Family, detectable};
use common::worlds::{Scene, camera, diffuse, glass, lamp, matt, mirror};
use common::{METHODS, SAMPLERS, film, samples, settings};
use glam::DVec3;
use wavetrace::film::Film;
use wavetrace::render::{Control, Renderer, SamplerKind, Settings};
use wavetrace::wave::Method;
use wavetrace::world::{MaterialInput, Mesh};

/// Families of tests in this suite; each is a test function that calls `judge`.
const FAMILIES: usize = 5;

fn xoshiro(method: Method, spp: u32, seed: u64) -> Settings {
    settings(method, SamplerKind::Xoshiro, samples(spp), seed)
}

/// How far the samples are from all being `x` or `y`: the mean of |(s - x) (s - y)| would be 0; without the sign this is
/// what a film can tell, and one sample of neither value moves it.
fn neither(film: &Film, x: f64, y: f64) -> f64 {
    let product = |p: &wavetrace::film::Pixel, k: usize| {
        (p.sum2[k] - (x + y) * p.sum[k] + x * y * p.count as f64) / p.count as f64
    };
    film.pixels().iter().flat_map(|p| (0..3).map(move |k| product(p, k).abs())).fold(0.0, f64::max)
}

fn unit_sphere(level: u32, smooth: bool) -> Mesh {
    sphere(DVec3::ZERO, 1.0, level, smooth)
}

/// Convex bodies, flat and smooth, and a view that holds all of each.
fn convex_bodies() -> Vec<(&'static str, Mesh)> {
    vec![
        ("box", turned(cuboid(v(-0.6, -0.5, -0.7), v(0.6, 0.5, 0.7)), 33.0)),
        ("sphere", unit_sphere(3, false)),
        ("smooth sphere", unit_sphere(3, true)),
        ("coarse smooth sphere", unit_sphere(1, true)),
    ]
}

fn outside(body: Mesh, material: MaterialInput, background: f32) -> Renderer {
    let eye = v(0.3, -3.0, 0.4);
    Scene::new(camera(eye, -eye, [24, 24], 50.0)).background(background).with(body, material).renderer()
}

/// A convex body of albedo rho under a constant sky Le: each path meets it once, so each sample is Le or rho Le, at any
/// mattness, for interpolated normals and at the silhouette too. Rays that hit their own surface again would show.
#[test]
fn a_convex_body_under_a_constant_sky_is_its_albedo() {
    let sky = 2.0;
    for (name, body) in convex_bodies() {
        for mattness in [0.0, 1e-3, 0.2, 0.5, 0.8, 1.0] {
            for sampler in SAMPLERS {
                let renderer = outside(body.clone(), matt(0.5, mattness), sky);
                let image = film(&renderer, &settings(Method::Mis, sampler, samples(32), 1));
                let off = neither(&image, 2.0, 1.0);
                // One of the samples that is neither would count at least this much.
                assert!(off < 0.5 / f64::from(samples(32)), "{name}, mattness {mattness}, {sampler:?}: {off}");
                let mean = Estimate::of_film(&image, 1).mean;
                assert!(mean > 1.1 && mean < 1.9, "{name}: {mean}: the view holds the body and the sky");
            }
        }
        let image = film(&outside(body.clone(), mirror(0.25), sky), &xoshiro(Method::Mis, 32, 1));
        assert!(neither(&image, 2.0, 0.5) < 0.5 / f64::from(samples(32)), "{name}, mirror");
    }
}

/// A flat floor cannot meet itself: under a constant sky every sample is the floor's albedo, wherever the floor lies in the
/// world (its plane through the world's centre, or far from it), whatever its size and tilt, and however low the light.
/// A speck above its corner, too small to matter, moves the world's centre off the plane and puts other boxes about it.
#[test]
fn a_flat_floor_does_not_meet_itself() {
    let mut wrong = Vec::new();
    for (side, tilt, above) in [
        (2.0, 0.0, 0.0),
        (2.0, 10.0, 0.0),
        (30.0, 45.0, 0.0),
        (2.0, 0.0, 0.1),
        (2.0, 0.0, 1.0),
        (10.0, 0.0, 0.15),
        (100.0, 0.0, 0.15),
        (100.0, 0.0, 3.0),
        (30.0, 5.0, 1.0),
        (30.0, 20.0, 10.0),
        (30.0, 0.0, 100.0),
    ] {
        let turn = glam::DMat3::from_rotation_x(f64::to_radians(tilt));
        let tilted = |mut mesh: Mesh| {
            mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
            mesh
        };
        let eye = turn * v(0.3, -1.5, 0.2);
        let mut scene = Scene::new(camera(eye, turn * v(-0.3, 1.4, -0.2), [16, 16], 5.0))
            .background(2.0)
            .with(tilted(patch(0.0, 0.0, 0.0, side, side)), diffuse(0.5));
        if above > 0.0 {
            let speck = patch(-0.49 * side, -0.49 * side, above, 1e-4 * side, 1e-4 * side);
            scene = scene.with(tilted(speck), mirror(1.0));
        }
        let image = film(&scene.renderer(), &xoshiro(Method::Path, 256, 9));
        let count = image.pixels().iter().map(|p| p.count as f64).sum::<f64>();
        let share = 1.0 - image.pixels().iter().map(|p| p.sum[0]).sum::<f64>() / count;
        if share.abs() > 1e-9 {
            wrong.push(format!("side {side}, tilt {tilt}, world {above} high: {:.1e} of the light is lost", share));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Whatever reflects all light, and clear glass of any index, is invisible under a constant sky: every sample is Le, after
/// any number of bounces, for concave bodies and interpolated normals too.
#[test]
fn lossless_bodies_are_invisible_under_a_constant_sky() {
    let mut family = Family::one_of(FAMILIES);
    let mut bodies = convex_bodies();
    let mut rabbit = example("rabbit");
    let (lo, hi) = rabbit.bounds();
    rabbit.positions.iter_mut().for_each(|p| *p = (*p - (lo + hi) * 0.5) * 2.0 / (hi - lo).max_element());
    bodies.push(("rabbit", rabbit));
    bodies.push(("glass shell", {
        let (a, b) = (unit_sphere(3, false), inverted(sphere(DVec3::ZERO, 0.8, 3, false)));
        common::meshes::join(&[a, b])
    }));
    bodies.push(("inside out", inverted(unit_sphere(2, true))));
    let kinds = [0.0, 0.2, 0.5, 0.8, 1.0].map(|m| (format!("mattness {m}"), matt(1.0, m)));
    let glasses = [1.5, 1.0, 0.7, 2.4].map(|n| (format!("index {n}"), glass(1.0, n)));
    for (name, body) in bodies {
        for (what, material) in kinds.iter().chain(&glasses) {
            let image = film(&outside(body.clone(), material.clone(), 1.5), &xoshiro(Method::Mis, 16, 2));
            family.add(Estimate::of_film(&image, 0).p_exact(1.5), format!("{name}, {what}, mean"));
            for (i, p) in image.pixels().iter().enumerate() {
                let e = Estimate::of_pixel(p, 0);
                family.add(e.p_exact(1.5), format!("{name}, {what}, pixel {i}: {} +- {}", e.mean, e.variance.sqrt()));
            }
        }
    }
    family.judge();
}

/// A limit on bounces cuts the series exactly: none leaves the body black, one is all that a convex body needs.
#[test]
fn depth_limits_cut_where_they_say() {
    for (name, body) in convex_bodies() {
        let renderer = outside(body, matt(0.5, 0.7), 1.0);
        for (max_depth, value) in [(0, 0.0), (1, 0.5), (2, 0.5)] {
            let image = film(&renderer, &Settings { max_depth: Some(max_depth), ..xoshiro(Method::Mis, 32, 3) });
            let off = neither(&image, 1.0, value);
            assert!(off < 0.25 / f64::from(samples(32)), "{name}, depth {max_depth}: {off}");
        }
    }
}

/// A sphere seen from its centre, walls of albedo `rho`, a cap of it a lamp of radiance 1. Returns the lamp's share of the
/// area.
fn integrating_sphere(rho: f32) -> (Renderer, f64) {
    let whole = unit_sphere(5, false);
    let share = |lamp: bool| {
        let inside = |t: &[u32; 3]| t.iter().map(|&i| whole.positions[i as usize].z).sum::<f64>() / 3.0 > 0.6;
        Mesh { triangles: whole.triangles.iter().copied().filter(|t| inside(t) == lamp).collect(), ..whole.clone() }
    };
    let (cap, wall) = (share(true), share(false));
    let total = |m: &Mesh| (0..m.triangles.len()).map(|t| area(m, t)).sum::<f64>();
    let fraction = total(&cap) / (total(&cap) + total(&wall));
    let scene = Scene::new(camera(DVec3::ZERO, v(0.1, 1.0, -0.4), [8, 8], 60.0));
    // Each part on its own would be centred on its own box; the other's vertices keep both in place.
    (scene.with(wall, diffuse(rho)).with(cap, lamp(1.0)).renderer(), fraction)
}

/// In a sphere, any two patches see each other by their share of the area: radiosity is uniform, and its series of
/// bounces is geometric. With lamp share f: L = rho f / (1 - rho (1 - f)), and after at most N bounces the sum of its
/// first N terms. Of 20480 facets the deviation from a sphere is about 10^-4, below what the test can see; so the long form
/// takes no more samples.
#[test]
fn an_integrating_sphere_holds_the_geometric_series() {
    let mut family = Family::one_of(FAMILIES);
    for (k, rho) in [0.1f32, 0.5, 0.8, 0.99].into_iter().enumerate() {
        let (renderer, f) = integrating_sphere(rho);
        let rho = f64::from(rho);
        let series = |n: i32| (0..n).map(|k| rho * f * (rho * (1.0 - f)).powi(k)).sum::<f64>();
        let whole = rho * f / (1.0 - rho * (1.0 - f));
        for (m, method) in METHODS.into_iter().enumerate() {
            let render = |max_depth, spp, seed| {
                let s = Settings {
                    max_depth,
                    ..settings(method, SamplerKind::Xoshiro, spp, seed + 10 * m as u64 + 100 * k as u64)
                };
                Estimate::of_film(&film(&renderer, &s), 1)
            };
            let e = render(None, 4096, 4);
            let what = format!("albedo {rho}, {method:?}");
            println!(
                "{what}: {:.5} for {whole:.5}, finds {:.2} %",
                e.mean,
                100.0 * detectable(e.relative_error(), 1e-5)
            );
            family.add(e.p_exact(whole), format!("{what}: {} +- {} for {whole}", e.mean, e.variance.sqrt()));
            for depth in [1, 2, 4] {
                let e = render(Some(depth), 1024, 5 + u64::from(depth));
                let expected = series(depth as i32);
                family.add(e.p_exact(expected), format!("{what}, depth {depth}: {} for {expected}", e.mean));
            }
        }
    }
    family.judge();
}

/// A white room whose lamp is all but absent ends in bounded time, and says what it cut.
#[test]
fn a_white_room_ends_and_reports_what_was_cut() {
    let room = |lamp_side: f64| {
        Scene::new(camera(DVec3::ZERO, DVec3::Y, [4, 4], 60.0))
            .with(inverted(cuboid(v(-1.0, -1.0, -1.0), v(1.0, 1.0, 1.0))), diffuse(1.0))
            .with(patch(0.0, 0.0, 0.99, lamp_side, lamp_side), lamp(1.0))
            .renderer()
    };
    for method in METHODS {
        let settings = settings(method, SamplerKind::Xoshiro, 8, 1);
        let r = room(0.01).render(&settings, &Control::default()).unwrap();
        assert!(r.counts.cut > 0, "{method:?}: the lamp is met once in some 10^5 bounces");
        let mean = r.counts.cut_throughput / r.counts.cut as f64;
        assert!((mean - 1.0).abs() < 1e-4, "{method:?}: nothing is lost at a white wall: {mean}");
        assert!(r.bad.is_empty() && r.counts.cut <= r.counts.camera);
        let large = room(1.0).render(&settings, &Control::default()).unwrap();
        assert_eq!(large.counts.cut, 0, "{method:?}: a wide lamp ends all paths in time");
    }
}

/// Unpolarised reflectance of a boundary met at cosine `c`, from index 1 to `n`: Fresnel.
fn fresnel(c: f64, n: f64) -> f64 {
    let t = (1.0 - (1.0 - c * c) / (n * n)).sqrt();
    let (p, s) = ((n * c - t) / (n * c + t), (c - n * t) / (c + n * t));
    0.5 * (p * p + s * s)
}

/// A wide glass panel turned by `degrees` before a narrow camera at distance 3 that looks along +y.
fn panel(width: u32, x_angle: f64, degrees: f64, thickness: f64, material: MaterialInput) -> Scene {
    let slab = turned(cuboid(v(-40.0, -thickness / 2.0, -40.0), v(40.0, thickness / 2.0, 40.0)), degrees);
    let mut view = camera(v(0.0, -3.0, 0.0), DVec3::Y, [width, 1], x_angle);
    view.y_angle = 0.01;
    Scene::new(view).with(slab, material)
}

/// A slab reflects R' = R + (1 - R)^2 R c^2 / (1 - R^2) and transmits T' = (1 - R)^2 c^2 / (1 - R^2), where c tints each
/// crossing; clear at normal incidence that is 2 R / (1 + R) and (1 - R) / (1 + R). The lamp is behind the slab, or where
/// the slab mirrors the camera's view.
#[test]
fn a_slab_reflects_and_transmits_by_fresnel() {
    let mut family = Family::one_of(FAMILIES);
    for (k, degrees) in [0.0f64, 30.0, 45.0, 70.0].into_iter().enumerate() {
        for (c, n) in [(1.0, 1.5), (0.7, 1.5), (1.0, 2.4), (0.9, 0.8)] {
            let r = fresnel(degrees.to_radians().cos(), n);
            if !r.is_finite() {
                continue; // past the critical angle of a thin medium
            }
            let through = (1.0 - r).powi(2) * c * c / (1.0 - r * r);
            let back = r + through * r;
            // The mirrored view: direction +y in the plane with the normal turned by `degrees` about z.
            let turn = (2.0 * degrees).to_radians();
            let mirrored = v(turn.sin(), -turn.cos(), 0.0);
            for (name, toward, expected) in [("transmits", DVec3::Y, through), ("reflects", mirrored, back)] {
                let side = v(-toward.y, toward.x, 0.0);
                let far = toward * 200.0;
                let wall = quad(far - side * 60.0 - DVec3::Z * 60.0, side * 120.0, DVec3::Z * 120.0);
                let renderer = panel(4, 0.02, degrees, 0.1, glass(c as f32, n as f32)).with(wall, lamp(1.0)).renderer();
                let e = Estimate::of_film(&film(&renderer, &xoshiro(Method::Mis, 16384, 60 + k as u64)), 1);
                let what = format!("{degrees} degrees, index {n}, tint {c}: {name}");
                family.add(e.p_exact(expected), format!("{what} {} +- {}, not {expected}", e.mean, e.variance.sqrt()));
            }
        }
    }
    family.judge();
}

/// A tilted slab shifts what is behind it by t sin(a) (1 - cos(a) / (n cos(b))) across the ray, and does nothing else: an
/// edge behind it appears where that says, by the share of the image that is lit.
#[test]
fn a_tilted_slab_shifts_the_view() {
    let mut family = Family::one_of(FAMILIES);
    let (n, thickness, behind, field) = (1.5, 0.5, 6.0, 20.0f64);
    for (k, degrees) in [0.0f64, 20.0, -35.0, 55.0].into_iter().enumerate() {
        // Where a ray at slope s from the camera's axis meets the wall, a distance of 3 + `behind` away.
        let meets = |slope: f64| {
            let (alpha, tilt) = (slope.atan(), degrees.to_radians());
            let a = alpha + tilt;
            let b = (a.sin() / n).asin();
            let shift = thickness * a.sin() * (1.0 - a.cos() / (n * b.cos()));
            (3.0 + behind) * slope - shift / alpha.cos()
        };
        let edge = 0.4;
        let half = (field / 2.0).to_radians().tan();
        let (mut lo, mut hi) = (-half, half);
        for _ in 0..60 {
            let mid = 0.5 * (lo + hi);
            if meets(mid) < edge { lo = mid } else { hi = mid }
        }
        // Two refractions and no more: what is reflected within would show the edge again elsewhere. The share of light
        // that passes depends on the angle, so each column is held against that column of a wall without an edge.
        let width = 64;
        let columns = |from: f64, seed| -> Vec<Estimate> {
            // Too narrow for what the front mirrors to meet it.
            let wall = quad(v(from, behind, -1.0), v(3.0 - from, 0.0, 0.0), v(0.0, 0.0, 2.0));
            let renderer =
                panel(width, field, degrees, thickness, glass(1.0, n as f32)).with(wall, lamp(1.0)).renderer();
            let s = Settings { max_depth: Some(2), ..xoshiro(Method::Path, 4096, seed) };
            film(&renderer, &s).pixels().iter().map(|p| Estimate::of_pixel(p, 1)).collect()
        };
        let (lit, whole) = (columns(edge, 70 + k as u64), columns(-3.0, 80 + k as u64));
        let position = (lo / half + 1.0) / 2.0 * f64::from(width);
        for (i, (l, w)) in lit.iter().zip(&whole).enumerate() {
            let share = (i as f64 + 1.0 - position).clamp(0.0, 1.0);
            let p = l.p_equal(&w.scaled(share));
            family.add(
                p,
                format!("{degrees} degrees, column {i}: {} for {} (edge at {position})", l.mean, w.mean * share),
            );
        }
        let unshifted = (edge / (3.0 + behind) / half + 1.0) / 2.0 * f64::from(width);
        println!("{degrees} degrees: edge at column {position:.3}, {:.3} without the slab", unshifted);
        assert!(degrees == 0.0 || (position - unshifted).abs() > 0.3, "the shift is too small to be tested");
    }
    family.judge();
}

/// Irradiance at the origin, normal +z, from a polygon of radiance 1 above the horizon: Lambert 1760.
fn irradiance(polygon: &[DVec3]) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (polygon[i].normalize(), polygon[(i + 1) % polygon.len()].normalize());
        a.dot(b).clamp(-1.0, 1.0).acos() * a.cross(b).normalize().z
    };
    0.5 * (0..polygon.len()).map(edge).sum::<f64>().abs()
}

/// A Lambertian floor under a polygon of light: L = rho / pi E, with E = 1/2 sum theta_i (Gamma_i . n).
#[test]
fn polygon_lights_give_the_irradiance_of_lamberts_formula() {
    let mut family = Family::one_of(FAMILIES);
    let triangle = |a, b, c| Mesh { positions: vec![a, b, c], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let lights = [
        ("above", patch(0.1, 0.2, 1.0, 1.0, 0.6)),
        ("near", patch(0.0, 0.0, 0.15, 1.0, 1.0)),
        ("at a hundredth of its size", patch(0.0, 0.0, 0.01, 1.0, 1.0)),
        ("the same, a triangle", triangle(v(-1.0, -1.0, 0.01), v(2.0, -0.5, 0.01), v(-0.5, 1.5, 0.01))),
        ("far", patch(3.0, 4.0, 40.0, 20.0, 20.0)),
        ("wide", patch(0.0, 0.0, 1.0, 50.0, 50.0)),
        ("grazing", quad(v(-1.0, 2.0, 0.05), v(2.0, 0.0, 0.0), v(0.0, 0.0, 0.4))),
        ("tilted triangle", triangle(v(-0.5, 0.3, 0.4), v(1.0, 0.2, 0.9), v(0.3, 1.2, 1.4))),
        ("triangle seen from behind", triangle(v(-0.5, 0.3, 0.4), v(0.3, 1.2, 1.4), v(1.0, 0.2, 0.9))),
    ];
    for (k, (name, light)) in lights.into_iter().enumerate() {
        let exact = 0.6 / std::f64::consts::PI * 2.0 * irradiance(&light.positions);
        // Below the light.
        let lowest = light.positions.iter().fold(0.12, |least, p| p.z.min(least));
        let eye = v(1.0, -1.5, if lowest < 0.05 { 0.5 * lowest } else { 0.12 });
        let renderer = Scene::new(camera(eye, -eye, [4, 4], 1e-3))
            .with(patch(0.0, 0.0, 0.0, 10.0, 10.0), diffuse(0.6))
            .with(light, lamp(2.0))
            .renderer();
        for (m, method) in METHODS.into_iter().enumerate() {
            let e = Estimate::of_film(&film(&renderer, &xoshiro(method, 16384, 90 + 10 * k as u64 + m as u64)), 1);
            println!(
                "{name}, {method:?}: {:.6} for {exact:.6}, finds {:.2} %",
                e.mean,
                100.0 * detectable(e.relative_error(), 5e-6)
            );
            family
                .add(e.p_exact(exact), format!("{name}, {method:?}: {} +- {}, not {exact}", e.mean, e.variance.sqrt()));
        }
    }
    family.judge();
}
