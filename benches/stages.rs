//! Nanoseconds per row of each stage and per ray of each kernel, a group for each: `cargo bench --bench stages [-- FILTER]`.
//!
//! Of a stage: whole renders on one thread, of which the time in the stage counts, over the rows that it ran on. Of a kernel: a set
//! of rays in a room. Criterion compares with the last run that it kept (`-- --save-baseline NAME`, `-- --baseline NAME`).

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::time::{Duration, Instant};
use wavetrace::accel::{BuildOptions, Bvh};
use wavetrace::bench::{self, HitRecord, Kernel, Options, SetKind, Tracer, mesh, room};
use wavetrace::probe::{Stage, StageRow};
use wavetrace::render::{Control, Renderer, Settings};
use wavetrace::scene;

/// Lambertian, with vertex normals, and with glass.
const SCENES: [&str; 3] = ["cornell", "demo3", "demo6"];
/// Pixels across and down, and samples of each.
const SIDE: u32 = 64;
const SPP: u32 = 16;
/// Time in the stage that is measured; the renders about it take longer, those of a small stage by far.
const TIME: Duration = Duration::from_millis(40);

fn load(name: &str) -> Renderer {
    let file = format!("{}/scenes/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let mut loaded = scene::load(file.as_ref()).expect("a scene that loads");
    loaded.resize(SIDE, SIDE).expect("a size in range");
    let world = loaded.builder.build().expect("a scene that builds");
    Renderer::with_options(world, &BuildOptions { threads: 1, ..BuildOptions::default() }).expect("a thread")
}

fn rows(renderer: &Renderer) -> Vec<StageRow> {
    let settings = Settings { spp: SPP, threads: 1, time_stages: true, ..Settings::default() };
    renderer.render(&settings, &Control::default()).expect("settings in range").stages
}

fn stages(criterion: &mut Criterion) {
    let scenes: Vec<(&str, Renderer)> = SCENES.iter().map(|&name| (name, load(name))).collect();
    for stage in Stage::ALL {
        let of = |renderer: &Renderer| rows(renderer).into_iter().find(|row| row.stage == stage);
        let mut group = criterion.benchmark_group(stage.name());
        group.sample_size(10).warm_up_time(TIME).measurement_time(TIME);
        for (name, renderer) in &scenes {
            if of(renderer).is_none_or(|row| row.items == 0) {
                continue;
            }
            group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
                // An iteration is a row.
                bencher.iter_custom(|iterations| {
                    let (mut time, mut items) = (Duration::ZERO, 0);
                    while items < iterations {
                        let Some(row) = of(renderer) else { break };
                        (time, items) = (time + row.time, items + row.items);
                    }
                    time.mul_f64(iterations as f64 / items.max(1) as f64)
                });
            });
        }
        group.finish();
    }
}

/// Triangles of the room, and pixels of its camera's side.
const TRIANGLES: usize = 30_000;
const RES: u32 = 128;

fn kernels(criterion: &mut Criterion) {
    let corners = mesh::corners(&room(TRIANGLES, 1));
    let bvh = Bvh::build_with(&corners, &BuildOptions { threads: 1, ..BuildOptions::default() }).expect("a thread");
    let maker = Tracer { bvh: &bvh, kernel: Kernel::Many, threads: 1 };
    let options = Options { res: RES, ..Options::default() };
    let (sets, _) = bench::make(&corners, &maker, &options, &SetKind::ALL).expect("options in range");
    for set in &sets {
        let mut group = criterion.benchmark_group(format!("rays {}", set.kind.name()));
        group.sample_size(10).warm_up_time(TIME).measurement_time(TIME);
        let mut hits = vec![HitRecord::MISS; set.rays.len()];
        for &(kernel, name) in Kernel::ALL {
            let tracer = Tracer { bvh: &bvh, kernel, threads: 1 };
            group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
                // An iteration is a ray; whole sets are traced.
                bencher.iter_custom(|iterations| {
                    let passes = (iterations as usize).div_ceil(set.rays.len());
                    let clock = Instant::now();
                    tracer.trace(&set.rays, &mut hits, set.kind.query(), passes);
                    clock.elapsed().mul_f64(iterations as f64 / (passes * set.rays.len()) as f64)
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, stages, kernels);
criterion_main!(benches);
