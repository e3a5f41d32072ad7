//! `--stats`: the figures of a run as JSON.

use super::args::RenderArgs;
use super::choices::word;
use super::render::Times;
use super::units::rate;
use serde_json::{Number, Value, json};
use std::collections::BTreeMap;
use std::fs;
use wavetrace::lanes;
use wavetrace::probe::{COUNTED, Counters, StageRow};
use wavetrace::render::{Arithmetic, Rendered, Renderer, Settings};
use wavetrace::wave::Plan;

/// Samples that were not finite and are named one by one, at most.
const MAX_NAMED: usize = 100;

/// All that is known of a run.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    /// What the user asked for.
    pub args: &'a RenderArgs,
    /// What it was rendered with.
    pub settings: &'a Settings,
    /// The scene.
    pub renderer: &'a Renderer,
    /// Which stages ran, and how.
    pub plan: &'a Plan,
    /// What it gave.
    pub rendered: &'a Rendered,
    /// How long it took.
    pub times: &'a Times,
}

/// Samples per pixel: what was asked for, or where the time or the error decided, how many there are on average.
pub fn spp(args: &RenderArgs, settings: &Settings, rendered: &Rendered) -> Number {
    let mean = rendered.mean_spp();
    let whole = if args.is_open() { (mean.fract() == 0.0).then_some(mean as u32) } else { Some(settings.spp) };
    whole.map(Number::from).or_else(|| Number::from_f64(mean)).unwrap_or_else(|| Number::from(0))
}

/// The figures as an indented JSON document.
pub fn text(run: &Run<'_>) -> String {
    format!("{:#}\n", document(run))
}

fn document(run: &Run<'_>) -> Value {
    let Run { args, settings, renderer, plan, rendered, times } = *run;
    let (world, counts) = (renderer.world(), &rendered.counts);
    // The settings are those of the render that is done.
    let arithmetic = renderer.arithmetic(settings).unwrap_or_default();
    let bad = rendered.bad.iter().take(MAX_NAMED);
    let bad: Vec<Value> = bad.map(|bad| json!({ "pixel": bad.pixel, "sample": bad.sample })).collect();
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": args.scene.display().to_string(),
        "width": world.width(),
        "height": world.height(),
        "spp": spp(args, settings, rendered),
        "threads": rendered.threads,
        "seed": settings.seed,
        "method": word(args.method),
        "sampler": word(args.sampler),
        "effort": word(args.effort),
        "time": args.time,
        "target_error": args.target_error,
        "max_depth": settings.max_depth,
        "light_paths": settings.light_paths,
        "integrator": word(args.integrator),
        "wave": settings.wave_size,
        "tuning": {
            "bvh": word(args.bvh),
            "leaf": args.leaf,
            "job": args.job,
            "refill": word(args.refill),
            "camera_rays": word(args.camera_rays),
            "bounce_rays": word(args.bounce_rays),
            "sort": word(args.sort),
        },
        "simd": lanes::simd(),
        "triangles": world.triangles(),
        "dropped_triangles": world.dropped(),
        "lights": world.lights(),
        "seconds": {
            "load": times.load.as_secs_f64(),
            "build": times.build.as_secs_f64(),
            "render": times.render.as_secs_f64(),
            "write": times.write.as_secs_f64(),
            "total": times.total.as_secs_f64(),
        },
        "rays": {
            "camera": counts.camera,
            "bounce": counts.bounce,
            "shadow": counts.shadow,
            "light": counts.light,
            "total": counts.rays(),
        },
        "mrays_per_s": rate(counts.rays(), times.render) / 1e6,
        "samples_per_s": rate(counts.camera, times.render),
        "estimated_relmse": rendered.error,
        "cut_paths": counts.cut,
        "cut_throughput": cut_share(rendered),
        "bad_samples": rendered.bad.len(),
        "first_bad_samples": bad,
        "counters": counters(rendered, settings),
        "stages": rendered.stages.iter().map(|row| stage(row, plan, &arithmetic)).collect::<Vec<_>>(),
        "bytes": {
            "world": world.bytes(),
            "bvh": renderer.bvh().bytes(),
            "waves": rendered.wave_bytes,
            "film": rendered.film.bytes(),
            "peak_rss": peak_rss(),
        },
        "partial": rendered.partial,
    })
}

fn stage(row: &StageRow, plan: &Plan, arithmetic: &Arithmetic) -> Value {
    let seconds = row.time.as_secs_f64();
    let bytes = plan.stage_bytes(row.stage);
    let flops = arithmetic.per_row(row.stage);
    let last = row.depths.iter().rposition(|depth| depth.items + depth.seconds > 0.0).map_or(0, |last| last + 1);
    let depths = row.depths[..last]
        .iter()
        .enumerate()
        .map(|(depth, row)| json!({"depth": depth, "items": row.items, "seconds": row.seconds}));
    json!({
        "name": row.stage.name(),
        "calls": row.calls,
        "items": row.items,
        "seconds": seconds,
        "occupancy": row.occupancy(),
        "ns_per_item": row.ns_per_item(),
        "bytes_per_item": bytes,
        "gb_per_s": bytes.map(|bytes| if seconds > 0.0 { bytes as f64 * row.items as f64 / seconds / 1e9 } else { 0.0 }),
        "flops_per_item": flops,
        "flops_per_byte": flops.zip(bytes).map(|(flops, bytes)| flops / bytes as f64),
        "depths": depths.collect::<Vec<_>>(),
        "counters": row.counted.map(|counted| COUNTED.into_iter().zip(counted).collect::<BTreeMap<_, _>>()),
    })
}

/// Whether hardware counters were read, and if not, why: the reason, or null where they were not asked for.
fn counters(rendered: &Rendered, settings: &Settings) -> Option<String> {
    settings.counters.then(|| match rendered.stages.iter().any(|row| row.counted.is_some()) {
        true => "read".to_owned(),
        false => Counters::missing().unwrap_or_else(|| "no stage ran".to_owned()),
    })
}

/// Throughput of the paths that were cut, over that of all paths at the camera.
pub fn cut_share(rendered: &Rendered) -> f64 {
    match rendered.counts.camera {
        0 => 0.0,
        paths => rendered.counts.cut_throughput / paths as f64,
    }
}

/// Most memory that the program has held, in bytes, where the system tells.
fn peak_rss() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}
