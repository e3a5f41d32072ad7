//! The tree finds what trying every triangle finds, to the last bit, and closed meshes have no gaps. Nothing here is
//! statistical: one ray that differs fails.

mod common;

use common::full;
use common::meshes::{Soup, cuboid, example, inverted, join, patch, soup, sphere, v};
use common::random::Random;
use common::rays::{any_of, bits, bounds, bundle, cases, closest_of, cloud, combine, degenerate, each_once, ray, some};
use wavetrace::accel::{
    BatchTracer, BuildOptions, Bvh, Hit, Many, Quality, Ray, Scalar, Single, Streams, Tiles, brute_force,
};

/// Rays of these kinds, about as many as given, find the same by the tree, one at a time and in batches, as by trying
/// every triangle.
fn compare_with_brute_force(kinds: &[usize], without: &[&str], least: usize, apart: f32) {
    let mut wrong = Vec::new();
    let (mut total, mut hits) = (0, 0);
    for (number, (name, corners)) in cases().into_iter().enumerate().filter(|(_, case)| !without.contains(&case.0)) {
        let mut random = Random(100 + number as u64);
        // About the same time for each: trying every triangle is what costs.
        let budget = if full() { 4_000_000_000 } else { 200_000_000 };
        let count = (budget / corners.len().max(1)).clamp(2_000, 30_000);
        let bounds = bounds(&corners);
        let rays: Vec<Ray> = (0..count).map(|i| ray(&mut random, &corners, &bounds, kinds[i % kinds.len()])).collect();
        let expected: Vec<Hit> = rays.iter().map(|r| brute_force(&corners, r)).collect();
        let bvh = Bvh::build(&corners);
        let (mut single, mut scalar) = (Single::new(&bvh), Scalar::new(&bvh));
        let (batch, blocked) = (closest_of::<Many>(&bvh, &rays), any_of::<Many>(&bvh, &rays));
        let (streamed, stopped) = (closest_of::<Streams>(&bvh, &rays), any_of::<Streams>(&bvh, &rays));
        let at_once = each_once(rays.len(), |found| Streams::new().closest(&bvh, rays.len(), rays.as_slice(), found));
        let stopped_at_once: Vec<bool> =
            each_once(rays.len(), |found| Streams::new().any(&bvh, rays.len(), rays.as_slice(), found));
        for (i, (r, e)) in rays.iter().zip(&expected).enumerate() {
            let found = [
                ("single", single.closest(&bvh, r)),
                ("scalar", scalar.closest(&bvh, r)),
                ("many", batch[i]),
                ("stream", streamed[i]),
                ("streams at once", at_once[i]),
            ];
            for (kernel, hit) in found {
                if bits(&hit) != bits(e) {
                    wrong.push(format!(
                        "{name}, {kernel}, kind {}: {r:?} gave {hit:?}, not {e:?}",
                        kinds[i % kinds.len()]
                    ));
                }
            }
            // A segment is open at its end, so that what lies exactly there blocks nothing.
            let blocks = e.is_some() && e.t < r.t_max;
            let any = [
                ("single any", single.any(&bvh, r)),
                ("scalar any", scalar.any(&bvh, r)),
                ("many any", blocked[i]),
                ("stream any", stopped[i]),
                ("streams any at once", stopped_at_once[i]),
            ];
            for (kernel, any) in any {
                if any != blocks {
                    wrong.push(format!(
                        "{name}, {kernel}, kind {}: {r:?} gave {any}, but {e:?}",
                        kinds[i % kinds.len()]
                    ));
                }
            }
            hits += usize::from(e.is_some());
        }
        let beside: Vec<Ray> = rays.iter().step_by(64).flat_map(|r| bundle(&mut random, r, apart)).collect();
        let (tiled, blocked) = (closest_of::<Tiles>(&bvh, &beside), any_of::<Tiles>(&bvh, &beside));
        for (i, r) in beside.iter().enumerate() {
            let e = brute_force(&corners, r);
            if bits(&tiled[i]) != bits(&e) || blocked[i] != (e.is_some() && e.t < r.t_max) {
                wrong.push(format!("{name}, tile: {r:?} gave {:?}, {}, not {e:?}", tiled[i], blocked[i]));
            }
        }
        total += count + beside.len();
    }
    println!("{total} rays, {hits} hits");
    assert!(total >= least, "{total} rays are too few to mean anything");
    assert!(wrong.is_empty(), "{}", some(&wrong));
}

#[test]
fn hits_are_those_of_brute_force_to_the_last_bit() {
    compare_with_brute_force(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11], &[], 100_000, 1.0);
}

/// Where bounces begin: far enough off a triangle that rounding puts no triangle on the wrong side of the ray's start.
/// Not so for needles, whose distance in f32 is as uncertain as their extent over their area: left out here, they are
/// among the cases above. Rays side by side would not keep that distance.
#[test]
fn hits_from_just_off_a_surface_are_those_of_brute_force() {
    compare_with_brute_force(&[10], &["slivers"], 100_000, 0.0);
}

/// A ray that ends exactly at a triangle does not reach it: the end is not part of the segment.
#[test]
fn segments_are_open_at_both_ends() {
    let corners = soup(&patch(0.0, 0.0, 1.0, 2.0, 2.0));
    let bvh = Bvh::build(&corners);
    let mut single = Single::new(&bvh);
    let mut up = |z: f32, t_max| {
        let ray = Ray { origin: [0.1, 0.2, z], direction: [0.0, 0.0, 1.0], t_max };
        (single.closest(&bvh, &ray).is_some(), single.any(&bvh, &ray), brute_force(&corners, &ray).is_some())
    };
    assert_eq!(up(0.0, 1.0 + f32::EPSILON), (true, true, true));
    assert_eq!(up(1.0, 1.0), (false, false, false), "a ray does not hit where it starts");
    assert_eq!(up(0.0, 1.0), (false, false, false), "nor where it ends");
}

/// Rays from inside closed meshes towards points on edges, corners, and anywhere: all of them hit something.
#[test]
fn closed_meshes_have_no_gaps() {
    let moved = |mut corners: Soup, by: [f32; 3]| {
        corners.iter_mut().flatten().for_each(|p| *p = std::array::from_fn(|a| p[a] + by[a]));
        corners
    };
    let ball = sphere(v(0.0, 0.0, 0.0), 1.0, 4, false);
    let closed = [
        ("rabbit", soup(&example("rabbit"))),
        ("sphere", soup(&ball)),
        ("sphere from outside in", soup(&inverted(ball.clone()))),
        ("sphere far from the origin", moved(soup(&ball), [1000.0, -3000.0, 77.0])),
        ("box", soup(&cuboid(v(-1.0, -0.5, 0.0), v(1.0, 0.5, 0.7)))),
        ("box.obj", soup(&example("box"))),
    ];
    let (origins, per_origin) = (if full() { 20_000 } else { 1000 }, 200);
    let (mut leaks, mut traced) = (Vec::new(), 0);
    for (name, corners) in closed {
        let bvh = Bvh::build(&corners);
        let mut single = Single::new(&bvh);
        let mut random = Random(7);
        let mut rays = Vec::with_capacity(per_origin);
        let mut all = Vec::new();
        for _ in 0..origins {
            // Half-way along a ray that goes in from the middle of a triangle.
            let t = random.pick(&corners);
            let c = combine(&t, 1.0 / 3.0, 1.0 / 3.0);
            let [a, b, d] = t.map(|p| glam::Vec3::from(p).as_dvec3());
            let flip = if name.ends_with("outside in") { 1.0 } else { -1.0 };
            let inward = ((b - a).cross(d - a).normalize() * flip).as_vec3();
            let from = |distance: f32| (glam::Vec3::from(c) + inward * distance).to_array();
            let nudge = 1e-5 * c.iter().fold(1.0f32, |m, x| m.max(x.abs()));
            let start = Ray { origin: from(nudge), direction: inward.to_array(), t_max: f32::INFINITY };
            let across = single.closest(&bvh, &start);
            if !across.is_some() || across.t < 10.0 * nudge {
                continue;
            }
            let origin = from(nudge + across.t * random.within(0.2, 0.8));
            rays.clear();
            for i in 0..per_origin {
                let t = random.pick(&corners);
                let target = match i % 4 {
                    0 => random.pick(&t),
                    3 => {
                        let d = random.direction();
                        std::array::from_fn(|a| origin[a] + d[a])
                    }
                    _ => {
                        let (s, e) = (random.unit(), random.below(3));
                        std::array::from_fn(|a| t[e][a] + (t[(e + 1) % 3][a] - t[e][a]) * s)
                    }
                };
                let direction = std::array::from_fn(|a| target[a] - origin[a]);
                if direction != [0.0; 3] {
                    rays.push(Ray { origin, direction, t_max: f32::INFINITY });
                }
            }
            traced += rays.len();
            for (i, hit) in closest_of::<Many>(&bvh, &rays).iter().enumerate() {
                if !hit.is_some() {
                    leaks.push(format!("{name}, closest: {:?}", rays[i]));
                }
            }
            // What starts at one point and goes to all sides is no tile, but a fan about each ray is.
            let fans: Vec<Ray> = rays.iter().step_by(64).flat_map(|r| bundle(&mut random, r, 0.0)).collect();
            for (i, hit) in closest_of::<Tiles>(&bvh, &fans).iter().enumerate() {
                if !hit.is_some() {
                    leaks.push(format!("{name}, tile: {:?}", fans[i]));
                }
            }
            for (i, hit) in any_of::<Many>(&bvh, &rays).iter().enumerate() {
                if !hit {
                    leaks.push(format!("{name}, any: {:?}", rays[i]));
                }
            }
            all.append(&mut rays);
        }
        for (i, (hit, blocked)) in
            closest_of::<Streams>(&bvh, &all).iter().zip(any_of::<Streams>(&bvh, &all)).enumerate()
        {
            if !hit.is_some() || !blocked {
                leaks.push(format!("{name}, stream: {:?}", all[i]));
            }
        }
    }
    println!("{traced} rays");
    assert!(traced >= 1_000_000, "{traced} rays are too few");
    assert!(leaks.is_empty(), "{}", some(&leaks));
}

/// A ray whose end is not a number, or lies behind it, is traced by the kernels for batches without a panic.
#[test]
fn ends_that_mean_nothing_are_survived() {
    let corners = cloud(&mut Random(5), 2000, 0.2);
    let bvh = Bvh::build(&corners);
    for t_max in [f32::NAN, -1.0, 0.0, f32::NEG_INFINITY] {
        let mut random = Random(6);
        let rays: Vec<Ray> = (0..640)
            .map(|_| Ray { origin: random.direction().map(|c| 2.0 * c), direction: random.direction(), t_max })
            .flat_map(|r| bundle(&mut Random(7), &r, 0.0).into_iter().take(4))
            .collect();
        let hits =
            [closest_of::<Many>(&bvh, &rays), closest_of::<Streams>(&bvh, &rays), closest_of::<Tiles>(&bvh, &rays)]
                .concat();
        assert!(hits.iter().all(|hit| !hit.is_some()), "{t_max}");
        let blocked =
            [any_of::<Many>(&bvh, &rays), any_of::<Streams>(&bvh, &rays), any_of::<Tiles>(&bvh, &rays)].concat();
        assert!(blocked.iter().all(|&b| !b), "{t_max}");
    }
}

/// A ray that is not made of numbers changes nothing for those beside it. Of a tile, one ray passes a near wall by and meets
/// a far one; the ray without numbers stands where a minimum or a maximum over the tile would forget the one before.
#[test]
fn a_ray_without_numbers_keeps_to_itself() {
    let cell = |x: f32, y: f32, z: f32| {
        let p = |dx: f32, dy: f32| [x + dx, y + dy, z];
        [[p(0.0, 0.0), p(0.25, 0.0), p(0.0, 0.25)], [p(0.25, 0.25), p(0.0, 0.25), p(0.25, 0.0)]]
    };
    let wall = |x: f32, z: f32| {
        (0..64).flat_map(move |i| cell(x + 0.25 * (i % 8) as f32 - 1.0, 0.25 * (i / 8) as f32 - 1.0, z))
    };
    let corners: Soup = wall(0.0, 1.0).chain(wall(5.0, 10.0)).collect();
    let bvh = Bvh::build(&corners);
    let (far, wrong) = (0, 8);
    let mut tile: Vec<Ray> = (0..64)
        .map(|i| {
            let direction = [0.001 * (1 + i % 8) as f32, 0.001 * (1 + i / 8) as f32, 1.0];
            Ray { origin: [if i == far { 5.0 } else { 0.1 }, 0.1, 0.0], direction, t_max: f32::INFINITY }
        })
        .collect();
    let expected: Vec<Hit> = tile.iter().map(|r| brute_force(&corners, r)).collect();
    assert!(expected[far].t > 9.0 && expected.iter().all(|hit| hit.is_some()));
    let good = tile[wrong];
    for bad in [
        Ray { t_max: f32::NAN, ..good },
        Ray { origin: [f32::NAN, 0.1, 0.0], ..good },
        Ray { direction: [f32::NAN, 0.001, 1.0], ..good },
    ] {
        tile[wrong] = bad;
        // Streams take no fewer rays than these.
        let many = [tile.as_slice(); 8].concat();
        for (kernel, hits) in
            [("tile", closest_of::<Tiles>(&bvh, &tile)), ("stream", closest_of::<Streams>(&bvh, &many))]
        {
            for (i, hit) in hits.iter().enumerate().filter(|(i, _)| i % 64 != wrong) {
                assert_eq!(bits(hit), bits(&expected[i % 64]), "{kernel}, ray {i} beside {bad:?}");
            }
        }
    }
}

/// Meshes that give a builder nothing to go by are built in time that grows with their size, not with its square, and
/// are traced right.
#[test]
fn degenerate_meshes_are_built_and_traced() {
    let mut random = Random(31);
    for (name, corners) in degenerate(100_000) {
        for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
            let bvh =
                Bvh::build_with(&corners, &BuildOptions { quality, threads: 2, ..BuildOptions::default() }).unwrap();
            let (mut single, bounds) = (Single::new(&bvh), bounds(&corners));
            for kind in [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11] {
                let ray = ray(&mut random, &corners, &bounds, kind);
                let (found, expected) = (single.closest(&bvh, &ray), brute_force(&corners, &ray));
                assert_eq!(bits(&found), bits(&expected), "{name}, {quality:?}, kind {kind}: {ray:?}");
            }
        }
    }
}

/// The tree with its copy of the triangles takes at most 100 bytes for each of them.
#[test]
fn trees_are_small() {
    for level in [3, 5, 7] {
        let balls: Vec<_> =
            (0..5).map(|i| sphere(v(f64::from(i) * 1.7, f64::from(i % 2), 0.0), 1.0, level, false)).collect();
        let mut corners = soup(&join(&balls));
        corners.extend(soup(&cuboid(v(-5.0, -5.0, -5.0), v(15.0, 5.0, 5.0))));
        for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
            let bvh =
                Bvh::build_with(&corners, &BuildOptions { quality, threads: 2, ..BuildOptions::default() }).unwrap();
            let each = bvh.bytes() as f64 / corners.len() as f64;
            assert!(each <= 100.0, "{quality:?}, {} triangles: {each} bytes each", corners.len());
        }
    }
}
