//! The tree finds what trying every triangle finds, to the last bit, and closed meshes have no gaps. Nothing here is
//! statistical: one ray that differs fails.

mod common;

use common::full;
use common::meshes::{Soup, cuboid, example, inverted, join, patch, soup, sphere, v};
use common::random::Random;
use wavetrace::accel::{
    BatchTracer, BuildOptions, Bvh, Hit, Many, Quality, Ray, Scalar, Single, Streams, Tiles, brute_force,
};

fn cloud(random: &mut Random, count: usize, size: f32) -> Soup {
    let mut point = |at: [f32; 3], r: f32| at.map(|c| c + random.within(-r, r));
    (0..count)
        .map(|_| {
            let p = point([0.0; 3], 1.0);
            [p, point(p, size), point(p, size)]
        })
        .collect()
}

fn cases() -> Vec<(&'static str, Soup)> {
    let mut random = Random(1);
    let one = vec![[[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.0, 0.5, 0.1]]];
    let two = soup(&patch(0.0, 0.0, 0.0, 1.0, 1.0));
    let slivers = (0..500)
        .map(|i| {
            let y = (i as f32 - 250.0) / 250.0;
            [[-1.0, y, 0.0], [1.0, y + 1e-7, 1e-6 * y], [1.0, y, 0.3 * y]]
        })
        .collect();
    let mut duplicates = cloud(&mut random, 200, 0.3);
    duplicates.extend(duplicates.clone());
    let mixed: Soup = (0..12)
        .flat_map(|k| {
            let size = 0.5f32.powi(k);
            cloud(&mut random, 50, size).into_iter().map(move |t| t.map(|p| p.map(|c| c * size)))
        })
        .collect();
    let cross = join(&[
        patch(0.0, 0.0, 0.0, 1.0, 1.0),
        cuboid(v(-1.0, 0.0, 0.0), v(0.0, 1.0, 1.0)),
        cuboid(v(0.0, -1.0, -1.0), v(1.0, 0.0, 0.0)),
    ]);
    vec![
        ("nothing", Vec::new()),
        ("one triangle", one.clone()),
        ("two triangles", two.clone()),
        ("1000 times the same triangle", one.repeat(1000)),
        ("duplicates", duplicates),
        ("slivers", slivers),
        ("boxes that meet in planes and corners", soup(&cross)),
        // Planes at exactly 0, where nothing relative to a coordinate has any width.
        ("box above the origin", soup(&cuboid(v(0.0, 0.0, 0.0), v(1.0, 1.0, 1.0)))),
        ("box below the origin", soup(&cuboid(v(-1.0, -1.0, -1.0), v(0.0, 0.0, 0.0)))),
        ("all scales", mixed),
        ("box.obj", soup(&example("box"))),
        ("fan.obj", soup(&example("fan"))),
        ("sphere", soup(&sphere(v(0.0, 0.0, 0.0), 1.0, 3, false))),
        ("rabbit.obj", soup(&example("rabbit"))),
        ("cloud", cloud(&mut random, 3000, 0.1)),
    ]
}

fn bounds(corners: &Soup) -> ([f32; 3], [f32; 3]) {
    let all = || corners.iter().flatten();
    let fold = |a: usize, start: f32, f: fn(f32, f32) -> f32| all().map(|p| p[a]).fold(start, f);
    if corners.is_empty() {
        return ([-1.0; 3], [1.0; 3]);
    }
    (
        std::array::from_fn(|a| fold(a, f32::INFINITY, f32::min)),
        std::array::from_fn(|a| fold(a, f32::NEG_INFINITY, f32::max)),
    )
}

fn combine(t: &[[f32; 3]; 3], u: f32, v: f32) -> [f32; 3] {
    std::array::from_fn(|a| t[0][a] + (t[1][a] - t[0][a]) * u + (t[2][a] - t[0][a]) * v)
}

/// A ray of kind `kind`, 0 to 11: random, or aimed where rounding hurts.
fn ray(random: &mut Random, corners: &Soup, (lo, hi): &([f32; 3], [f32; 3]), kind: usize) -> Ray {
    let triangle = if corners.is_empty() { [[0.0; 3]; 3] } else { corners[random.below(corners.len())] };
    let around = |random: &mut Random, grow: f32| {
        std::array::from_fn::<f32, 3, _>(|a| {
            let (mid, half) = (0.5 * (lo[a] + hi[a]), 0.5 * (hi[a] - lo[a]).max(1e-3));
            mid + random.within(-1.0, 1.0) * half * grow
        })
    };
    let toward = |from: [f32; 3], to: [f32; 3]| std::array::from_fn::<f32, 3, _>(|a| to[a] - from[a]);
    let corner = random.pick(&triangle);
    let on_edge = {
        let (s, edge) = (random.unit(), random.below(3));
        let (p, q) = (triangle[edge], triangle[(edge + 1) % 3]);
        std::array::from_fn::<f32, 3, _>(|a| p[a] + (q[a] - p[a]) * s)
    };
    let mut axis_parallel = |rest: f32| {
        let axis = random.below(3);
        let mut d = [random.pick(&[rest, -rest]), random.pick(&[rest, -rest]), random.pick(&[rest, -rest])];
        d[axis] = random.pick(&[1.0, -1.0, 0.3, -40.0]);
        d
    };
    let parallel = axis_parallel(0.0);
    let nearly = axis_parallel(1e-30);
    let (mut origin, mut direction) = match kind {
        0 => (around(random, 2.0), random.direction()),
        1 => {
            let from = around(random, 3.0);
            (from, toward(from, corner))
        }
        2 => {
            let from = around(random, 3.0);
            (from, toward(from, on_edge))
        }
        3 => (around(random, 1.5), parallel),
        4 => (around(random, 1.5), nearly),
        // On the planes of boxes, all axes or some, along them or not.
        5 => {
            let (a, b) = (around(random, 1.5), random.bits());
            let from = std::array::from_fn(|k| if b >> k & 1 == 1 { corner[k] } else { a[k] });
            let free = random.direction();
            (from, random.pick(&[parallel, nearly, free]))
        }
        // In the plane of a triangle.
        6 => {
            let (p, q) = (random.within(-2.0, 2.0), random.within(-2.0, 2.0));
            let from = combine(&triangle, p, q);
            (from, toward(from, combine(&triangle, random.unit(), random.unit())))
        }
        // From far away.
        7 => {
            let d = random.direction();
            let from = random.direction().map(|c| c * 1e4);
            let to = random.pick(&[corner, on_edge, combine(&triangle, 0.3, 0.3), d]);
            (from, toward(from, to))
        }
        // From a corner, or from an edge.
        8 => {
            let free = random.direction();
            (random.pick(&[corner, on_edge]), random.pick(&[free, parallel, nearly]))
        }
        // At corners, along an axis, hitting them from outside.
        9 => {
            let axis = (0..3).find(|&a| parallel[a] != 0.0).unwrap();
            let mut from = random.pick(&[corner, on_edge]);
            from[axis] -= parallel[axis].signum() * 4.0;
            (from, random.pick(&[parallel, nearly]))
        }
        // As far off a triangle as bounces begin, or farther, and away from it.
        10 => {
            let at = combine(&triangle, 0.5 * random.unit(), 0.5 * random.unit());
            let [a, b, c] = triangle.map(glam::Vec3::from);
            let n = (b - a).cross(c - a).normalize_or_zero();
            let away = glam::Vec3::from(random.direction());
            let reach = triangle.iter().flatten().fold(0.0f32, |m, c| m.max(c.abs()));
            let off = reach * 16.0 * f32::EPSILON * random.pick(&[1.0, 1.5, 10.0, 100.0]);
            ((glam::Vec3::from(at) + n * off).to_array(), (away * away.dot(n).signum()).to_array())
        }
        _ => {
            let from = around(random, 2.0);
            (from, toward(from, combine(&triangle, 0.5 * random.unit(), 0.5 * random.unit())))
        }
    };
    if direction == [0.0; 3] {
        direction = [0.0, 0.0, 1.0];
    }
    if random.below(50) == 0 {
        origin = origin.map(|c| if c.abs() < 1e-3 { 0.0 } else { c });
    }
    let t_max = match random.below(4) {
        0 => random.within(0.0, 2.0),
        1 => 1.0,
        _ => f32::INFINITY,
    };
    Ray { origin, direction, t_max }
}

fn bits(hit: &Hit) -> (u32, u32, u32, u32) {
    (hit.triangle, hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits())
}

/// The results of a batch, each told once.
fn each_once<T: Clone>(count: usize, trace: impl FnOnce(&mut dyn FnMut(usize, T))) -> Vec<T> {
    let mut out = vec![None; count];
    trace(&mut |i, result| assert!(out[i].replace(result).is_none(), "ray {i} twice"));
    out.into_iter().map(|result| result.expect("each ray has a result")).collect()
}

/// Rays that a tracer gets at once: streams that turn out not to pay are given up after as many.
const AT_ONCE: usize = 2000;

fn closest_of<T: BatchTracer + Default>(bvh: &Bvh, rays: &[Ray]) -> Vec<Hit> {
    let trace = |rays: &[Ray]| each_once(rays.len(), |found| T::default().closest(bvh, rays.len(), rays, found));
    rays.chunks(AT_ONCE).flat_map(trace).collect()
}

fn any_of<T: BatchTracer + Default>(bvh: &Bvh, rays: &[Ray]) -> Vec<bool> {
    let trace = |rays: &[Ray]| each_once(rays.len(), |found| T::default().any(bvh, rays.len(), rays, found));
    rays.chunks(AT_ONCE).flat_map(trace).collect()
}

/// A ray and 63 that run beside it: from one point, as through neighbouring pixels, or side by side up to `apart`.
fn bundle(random: &mut Random, ray: &Ray, apart: f32) -> Vec<Ray> {
    let size = |v: [f32; 3]| v.iter().fold(0.0f32, |a, c| a.max(c.abs()));
    let spread = 10f32.powf(random.within(-5.0, -0.5));
    let (along, aside) = (size(ray.direction) * spread, random.within(-apart, apart).max(0.0) * spread);
    let jitter =
        |random: &mut Random, v: [f32; 3], by: f32| v.map(|c| if by > 0.0 { c + random.within(-by, by) } else { c });
    let beside = |random: &mut Random| Ray {
        origin: jitter(random, ray.origin, aside),
        direction: jitter(random, ray.direction, along),
        t_max: ray.t_max,
    };
    std::iter::once(*ray).chain((1..64).map(|_| beside(random))).collect()
}

/// At most so many lines of a long list.
fn some(lines: &[String]) -> String {
    format!("{} in all\n{}", lines.len(), lines[..lines.len().min(12)].join("\n"))
}

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
    let count = 100_000;
    let small = |x: f32, y: f32, z: f32, s: f32| [[x, y, z], [x + s, y, z], [x, y + s, z + s]];
    let mut random = Random(3);
    let numbers = || (0..count).map(|i| i as f32);
    let scales: Soup = (0..count)
        .map(|i| {
            let [x, y, z] = random.direction();
            if i % 1000 == 0 {
                small(x * 1e6, y * 1e6, z * 1e6, 1e5)
            } else {
                small(x * 1e-6, y * 1e-6, z * 1e-6, 1e-7)
            }
        })
        .collect();
    let growing: Soup = (0..count as i32)
        .map(|i| 1.5f32.powf(i as f32 * 1e-3 - 50.0))
        .map(|s| if random.below(2) == 0 { small(s, s, s, 0.1 * s) } else { small(-s, -s, -s, 2.0 * s) })
        .collect();
    let cases: [(&str, Soup); 7] = [
        ("growing exponentially", growing),
        ("coincident", vec![small(0.0, 0.0, 0.0, 1.0); count]),
        ("nested", numbers().map(|s| [[-s, -s, -s], [s, s, -s], [0.0, 0.0, s]]).collect()),
        ("evenly on a line", numbers().map(|x| small(x, 0.0, 0.0, 0.5)).collect()),
        ("farther and farther apart on a line", numbers().map(|x| small(x * x, 0.0, 0.0, 0.5)).collect()),
        ("without area", numbers().map(|x| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x + 0.5, 0.0, 0.0]]).collect()),
        ("sizes from 1e-7 to 1e5", scales),
    ];
    for (name, corners) in cases {
        for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
            let bvh = Bvh::build_with(&corners, &BuildOptions { quality, threads: 2 }).unwrap();
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
            let bvh = Bvh::build_with(&corners, &BuildOptions { quality, threads: 2 }).unwrap();
            let each = bvh.bytes() as f64 / corners.len() as f64;
            assert!(each <= 100.0, "{quality:?}, {} triangles: {each} bytes each", corners.len());
        }
    }
}
