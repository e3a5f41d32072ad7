//! Rays at meshes on which intersection fails if it fails anywhere, and what tracers find.

use super::meshes::{Soup, cuboid, example, join, patch, soup, sphere, v};
use super::random::Random;
use wavetrace::accel::{BatchTracer, Bvh, Hit, Ray};

/// Triangles anywhere in a cube, up to `size` large.
pub fn cloud(random: &mut Random, count: usize, size: f32) -> Soup {
    let mut point = |at: [f32; 3], r: f32| at.map(|c| c + random.within(-r, r));
    (0..count)
        .map(|_| {
            let p = point([0.0; 3], 1.0);
            [p, point(p, size), point(p, size)]
        })
        .collect()
}

/// Meshes on which rounding or a builder may fail.
pub fn cases() -> Vec<(&'static str, Soup)> {
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

/// The box about them; one of its own about none.
pub fn bounds(corners: &Soup) -> ([f32; 3], [f32; 3]) {
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

/// A point of a triangle.
pub fn combine(t: &[[f32; 3]; 3], u: f32, v: f32) -> [f32; 3] {
    std::array::from_fn(|a| t[0][a] + (t[1][a] - t[0][a]) * u + (t[2][a] - t[0][a]) * v)
}

/// A ray of kind `kind`, 0 to 11: random, or aimed where rounding hurts.
pub fn ray(random: &mut Random, corners: &Soup, (lo, hi): &([f32; 3], [f32; 3]), kind: usize) -> Ray {
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

/// A hit as bits.
pub fn bits(hit: &Hit) -> (u32, u32, u32, u32) {
    (hit.triangle, hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits())
}

/// The results of a batch, each told once.
pub fn each_once<T: Clone>(count: usize, trace: impl FnOnce(&mut dyn FnMut(usize, T))) -> Vec<T> {
    let mut out = vec![None; count];
    trace(&mut |i, result| assert!(out[i].replace(result).is_none(), "ray {i} twice"));
    out.into_iter().map(|result| result.expect("each ray has a result")).collect()
}

/// Rays that a tracer gets at once: streams that turn out not to pay are given up after as many.
const AT_ONCE: usize = 2000;

/// The nearest hits of a batch.
pub fn closest_of<T: BatchTracer + Default>(bvh: &Bvh, rays: &[Ray]) -> Vec<Hit> {
    let trace = |rays: &[Ray]| each_once(rays.len(), |found| T::default().closest(bvh, rays.len(), rays, found));
    rays.chunks(AT_ONCE).flat_map(trace).collect()
}

/// Which rays of a batch are blocked.
pub fn any_of<T: BatchTracer + Default>(bvh: &Bvh, rays: &[Ray]) -> Vec<bool> {
    let trace = |rays: &[Ray]| each_once(rays.len(), |found| T::default().any(bvh, rays.len(), rays, found));
    rays.chunks(AT_ONCE).flat_map(trace).collect()
}

/// A ray and 63 that run beside it: from one point, as through neighbouring pixels, or side by side up to `apart`.
pub fn bundle(random: &mut Random, ray: &Ray, apart: f32) -> Vec<Ray> {
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
pub fn some(lines: &[String]) -> String {
    format!("{} in all\n{}", lines.len(), lines[..lines.len().min(12)].join("\n"))
}

/// Meshes of `count` triangles that give a builder nothing to go by.
pub fn degenerate(count: usize) -> Vec<(&'static str, Soup)> {
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
    let extreme: Soup = numbers()
        .map(|i| {
            let s = 10f32.powf(12.0 * i / count as f32 - 6.0);
            small(s, -s, 0.5 * s, s)
        })
        .collect();
    vec![
        ("growing exponentially", growing),
        ("coincident", vec![small(0.0, 0.0, 0.0, 1.0); count]),
        ("nested", numbers().map(|s| [[-s, -s, -s], [s, s, -s], [0.0, 0.0, s]]).collect()),
        ("evenly on a line", numbers().map(|x| small(x, 0.0, 0.0, 0.5)).collect()),
        ("farther and farther apart on a line", numbers().map(|x| small(x * x, 0.0, 0.0, 0.5)).collect()),
        ("without area", numbers().map(|x| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x + 0.5, 0.0, 0.0]]).collect()),
        ("sizes from 1e-7 to 1e5", scales),
        ("sizes from 1e-6 to 1e6", extreme),
    ]
}
