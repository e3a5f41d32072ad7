//! The last lines of a render: what was written, how long it took, and what is odd about it.

use super::messages::Console;
use super::stats::{Run, cut_share};
use super::units::{bytes, counted, per_pixel, rate, si, time};
use std::fs;
use std::path::{Path, PathBuf};
use wavetrace::wave::BOUNCE_LIMIT;

/// Samples that are named one by one at most.
const MAX_NAMED: usize = 5;

/// Shows the last lines.
pub fn show(run: &Run<'_>, files: &[PathBuf], console: &Console) {
    let Run { args, settings, renderer, rendered, times, .. } = *run;
    oddities(run, console);
    if args.given_spp().is_none() && !args.is_open() {
        console
            .note("one sample per pixel is a preview; ask for more as in `wavetrace SCENE.json 64` or by `--spp 64`");
    }
    let world = renderer.world();
    let mean = rendered.mean_spp();
    let open = format!("{mean:.1} samples per pixel on average");
    let samples = match (rendered.partial, args.is_open()) {
        (false, false) => per_pixel(settings.spp),
        (false, true) if mean.fract() == 0.0 => per_pixel(mean as u32),
        (false, true) => open,
        (true, false) => format!("partial, {mean:.1} of {} on average", per_pixel(settings.spp)),
        (true, true) => format!("partial, {open}"),
    };
    for file in files {
        console.line(format_args!(
            "wrote {}: {}x{}, {samples}{}",
            file.display(),
            world.width(),
            world.height(),
            file_size(file)
        ));
    }
    if let Some(error) = rendered.error {
        console.line(format_args!("estimated relMSE {error:.3e}"));
    }
    console.line(format_args!(
        "load {}, build {}, render {}, write {}",
        time(times.load),
        time(times.build),
        time(times.render),
        time(times.write)
    ));
    console.line(format_args!(
        "{}samples/s, {:.2} Mrays/s; {}, {}, {}",
        si(rate(rendered.counts.camera, times.render)),
        rate(rendered.counts.rays(), times.render) / 1e6,
        counted(world.triangles() as u64, "triangle"),
        counted(world.lights() as u64, "light"),
        counted(rendered.threads as u64, "thread"),
    ));
}

fn oddities(run: &Run<'_>, console: &Console) {
    let Run { settings, renderer, rendered, .. } = *run;
    if let dropped @ 1.. = renderer.world().dropped() as u64 {
        console.note(format_args!("{} left out", counted(dropped, "degenerate triangle")));
    }
    if let cut @ 1.. = rendered.counts.cut {
        let limit = settings.max_depth.unwrap_or(BOUNCE_LIMIT).min(BOUNCE_LIMIT);
        console.note(format_args!(
            "{} cut at {}; they carried {:.2} % of all throughput",
            counted(cut, "path"),
            counted(u64::from(limit), "bounce"),
            cut_share(rendered) * 100.0
        ));
    }
    if !rendered.bad.is_empty() {
        let named = rendered.bad.iter().take(MAX_NAMED);
        let named: Vec<String> =
            named.map(|bad| format!("pixel {},{} sample {}", bad.pixel[0], bad.pixel[1], bad.sample)).collect();
        let more = if rendered.bad.len() > MAX_NAMED { "; ..." } else { "" };
        console.warn(format_args!(
            "{} not finite and left out, seed {}: {}{more}",
            counted(rendered.bad.len() as u64, "sample"),
            settings.seed,
            named.join("; ")
        ));
    }
}

fn file_size(file: &Path) -> String {
    match fs::metadata(file) {
        Ok(found) if found.is_file() => format!(", {}", bytes(found.len())),
        _ => String::new(),
    }
}
