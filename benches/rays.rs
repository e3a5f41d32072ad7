//! Rays per second of the traversal kernels, interleaved: `cargo bench --bench rays [-- MESH.obj|SCENE.json ...]`.
//!
//! Camera rays through every pixel, and the diffuse bounces that leave what they hit. Prints nanoseconds per ray and
//! thread, median and best of the repeats.

use std::time::Instant;
use wavetrace::accel::{BatchTracer, Bvh, Hit, Many, Ray, Single};
use wavetrace::lanes::{Frame, Vec3};
use wavetrace::sampling::{Decision, Sampler, Xoshiro, warp};
use wavetrace::scene;

const REPEATS: usize = 9;
const SIDE: u32 = 512;

/// Diffuse bounce off a hit, on the side that the ray came from, a little off the surface.
fn bounce(corners: &[[[f32; 3]; 3]], ray: &Ray, hit: &Hit, number: u32) -> Option<Ray> {
    let [a, b, c] = corners.get(hit.triangle as usize)?.map(Vec3::<f32>::splat);
    let d = Vec3::splat(ray.direction);
    let n = (b - a).cross(c - a).normalize();
    let n = if n.dot(d) > 0.0 { -n } else { n };
    let mut s = Xoshiro::start::<f32>(1, number, 0);
    let local = warp::cosine_hemisphere(Xoshiro::draw::<f32, 2>(&mut s, Decision::Scatter, 0));
    let point = d.mul_add(hit.t, Vec3::splat(ray.origin)) + n * 1e-5;
    Some(Ray { origin: point.lane(0), direction: Frame::about(n).to_world(local).lane(0), t_max: f32::INFINITY })
}

fn report(name: &str, rays: &[Ray], bvh: &Bvh) {
    let (mut single, mut many) = (Single::new(bvh), Many::new());
    let short: Vec<Ray> = rays.iter().map(|r| Ray { t_max: 0.5, ..*r }).collect();
    let mut times = [const { Vec::new() }; 4];
    let mut sums = [0u64; 4];
    for _ in 0..REPEATS {
        let clock = Instant::now();
        sums[0] = rays.iter().map(|r| u64::from(single.closest(bvh, r).triangle)).sum();
        times[0].push(clock.elapsed());
        let (clock, mut sum) = (Instant::now(), 0);
        many.closest(bvh, rays.len(), rays, |_, hit| sum += u64::from(hit.triangle));
        times[1].push(clock.elapsed());
        sums[1] = sum;
        let clock = Instant::now();
        sums[2] = short.iter().map(|r| u64::from(single.any(bvh, r))).sum();
        times[2].push(clock.elapsed());
        let (clock, mut sum) = (Instant::now(), 0);
        many.any(bvh, rays.len(), short.as_slice(), |_, hit| sum += u64::from(hit));
        times[3].push(clock.elapsed());
        sums[3] = sum;
    }
    assert_eq!((sums[0], sums[2]), (sums[1], sums[3]), "the kernels disagree");
    for (kernel, mut t) in ["single closest", "many closest", "single any", "many any"].into_iter().zip(times) {
        t.sort();
        let ns = |i: usize| t[i].as_secs_f64() * 1e9 / rays.len() as f64;
        println!(
            "{name:28} {kernel:15} {:9} rays  median {:7.1} ns  best {:7.1} ns",
            rays.len(),
            ns(REPEATS / 2),
            ns(0)
        );
    }
}

fn main() {
    let mut files: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    if files.is_empty() {
        files =
            ["cornell", "demo3", "demo4"].map(|n| format!("{}/scenes/{n}.json", env!("CARGO_MANIFEST_DIR"))).to_vec();
    }
    for file in files {
        let mut builder = scene::load(file.as_ref()).expect("a scene that loads").builder;
        (builder.camera_mut().width, builder.camera_mut().height) = (SIDE, SIDE);
        let world = builder.build().expect("a scene that builds");
        let bvh = Bvh::build(world.corners());
        let mut rays: Vec<Ray> = (0..SIDE * SIDE)
            .map(|i| {
                let (o, d) = world.view().ray((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5);
                Ray { origin: o.lane(0), direction: d.lane(0), t_max: f32::INFINITY }
            })
            .collect();
        let name = file.rsplit('/').next().unwrap_or(&file).to_string();
        let mut single = Single::new(&bvh);
        for depth in ["camera", "bounce", "second bounce"] {
            report(&format!("{name} {depth}"), &rays, &bvh);
            rays = rays
                .iter()
                .enumerate()
                .filter_map(|(i, r)| bounce(world.corners(), r, &single.closest(&bvh, r), i as u32))
                .collect();
        }
    }
}
