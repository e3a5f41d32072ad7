//! `wavetrace bench rays`: rays per second on sets of rays, and their files.

use super::args::RaysArgs;
use crate::cli::Exit;
use crate::cli::messages::Console;
use crate::cli::units::{bytes, count, counted, time};
use serde_json::{Map, Value, json};
use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use wavetrace::accel::Bvh;
use wavetrace::bench::{self, Figure, HitRecord, RaySet, SetKind, Tracer, View, files, mesh};
use wavetrace::error::{Error, Result as LibraryResult};
use wavetrace::lanes;
use wavetrace::output;

/// Share of the CPUs that a set can keep busy by which those that were may be fewer on a quiet machine.
const DISTURBED: f64 = 0.05;

/// What was measured on a set.
struct Timing {
    kind: SetKind,
    rays: usize,
    /// How many of them hit something.
    hits: usize,
    /// CPUs that can be busy with it.
    cpus: f64,
    figure: Figure,
}

/// What was measured, and on what.
struct Report<'a> {
    args: &'a RaysArgs,
    triangles: usize,
    bvh_bytes: usize,
    build: Duration,
    view: Option<View>,
    timings: Vec<Timing>,
}

/// Makes or loads the rays, traces them against the clock, and shows the figures.
pub fn run(args: &RaysArgs) -> Result<Exit, Exit> {
    let console = Console::new(false, false);
    let report = measure(args, &console).map_err(|error| console.fail(&error))?;
    if args.json {
        console.answer(report.json())?;
    } else {
        console.answer(report.table())?;
    }
    report.warn(&console);
    Ok(Exit::Done)
}

fn measure<'a>(args: &'a RaysArgs, console: &Console) -> LibraryResult<Report<'a>> {
    let options = args.options();
    options.check()?;
    if let Some(folder) = &args.dump {
        check_folder(folder, &args.kinds())?;
    }
    let loaded = args.load.as_ref().map(|folder| load(folder, args)).transpose()?;
    let corners = mesh::load(&args.mesh)?;

    let start = Instant::now();
    let bvh = Bvh::build(&corners);
    let build = start.elapsed();

    let tracer = Tracer { bvh: &bvh, kernel: args.kernel, threads: args.threads as usize };
    let (sets, view) = match loaded {
        Some(sets) => (sets, None),
        None => {
            let (sets, view) = bench::make(&corners, &tracer, &options, &args.kinds())?;
            (sets, Some(view))
        }
    };
    let (sets, empty): (Vec<_>, Vec<_>) = sets.into_iter().partition(|set| !set.rays.is_empty());
    let hits: Vec<_> = sets.iter().map(|set| RefCell::new(vec![HitRecord::MISS; set.rays.len()])).collect();
    let pairs = sets.iter().zip(&hits);
    let cases = pairs.map(|(set, hits)| bench::trace(set.kind.name().to_owned(), tracer, set, hits)).collect();
    let figures = bench::measure(cases, args.repeats as usize, |_| true);
    let hits: Vec<_> = hits.into_iter().map(RefCell::into_inner).collect();
    if let Some(folder) = &args.dump {
        sets.iter().zip(&hits).try_for_each(|(set, hits)| dump(folder, set, hits))?;
        empty.iter().try_for_each(|set| dump(folder, set, &[]))?;
    }
    for set in empty {
        console.warn(format_args!("{}: found no rays, left out of the report", set.kind.name()));
    }
    let timing = |((set, hits), figure): ((&RaySet, Vec<HitRecord>), Figure)| Timing {
        kind: set.kind,
        rays: set.rays.len(),
        hits: hits.iter().filter(|hit| hit.is_some()).count(),
        cpus: tracer.concurrency(set.rays.len()),
        figure,
    };
    let timings = sets.iter().zip(hits).zip(figures).map(timing).collect();
    Ok(Report { args, triangles: corners.len(), bvh_bytes: bvh.bytes(), build, view, timings })
}

/// The rays in a folder: of the sets that were asked for, else of those that it has.
fn load(folder: &Path, args: &RaysArgs) -> LibraryResult<Vec<RaySet>> {
    let path = |kind: SetKind| folder.join(format!("{}.rays", kind.name()));
    let mut kinds = args.kinds();
    if args.rays.is_empty() {
        kinds.retain(|&kind| path(kind).exists());
    }
    if kinds.is_empty() {
        let names = SetKind::ALL.map(|kind| format!("{}.rays", kind.name())).join(", ");
        let reason = format!("found no ray files, expected a folder with some of {names}");
        return Err(Error::Output { file: folder.to_owned(), reason });
    }
    kinds.iter().map(|&kind| Ok(RaySet { kind, rays: files::read_rays(&path(kind))? })).collect()
}

/// Makes the folder for the files, and finds out whether they can be written, before there is anything to lose.
fn check_folder(folder: &Path, kinds: &[SetKind]) -> LibraryResult<()> {
    fs::create_dir_all(folder).map_err(|source| Error::Io { file: folder.to_owned(), action: "make", source })?;
    kinds.iter().flat_map(|&kind| dumped(folder, kind)).try_for_each(|path| output::check_writable_text(&path))
}

/// The files of a set: rays and hits.
fn dumped(folder: &Path, kind: SetKind) -> [PathBuf; 2] {
    ["rays", "hits"].map(|ending| folder.join(format!("{}.{ending}", kind.name())))
}

fn dump(folder: &Path, set: &RaySet, hits: &[HitRecord]) -> LibraryResult<()> {
    let [rays_path, hits_path] = dumped(folder, set.kind);
    files::write_rays(&rays_path, &set.rays)?;
    files::write_hits(&hits_path, hits)
}

impl Report<'_> {
    fn table(&self) -> String {
        let args = self.args;
        let mut text = format!(
            "{}: {}, build {}, {}; {} kernel, {}, {}",
            args.mesh.display(),
            counted(self.triangles as u64, "triangle"),
            time(self.build),
            bytes(self.bvh_bytes as u64),
            args.kernel.name(),
            counted(u64::from(args.threads), "thread"),
            counted(u64::from(args.repeats), "repeat"),
        );
        if let Some(view) = &self.view {
            text += &format!("\n--camera {}", camera(view).map(|x| x.to_string()).join(","));
        }
        text += &format!(
            "\n{:<9} {:>11} {:>11} {:>9} {:>9} {:>7} {:>6}",
            "set", "rays", "hits", "Mrays/s", "best", "spread", "busy"
        );
        for t in &self.timings {
            text += &format!(
                "\n{:<9} {:>11} {:>11} {:>9.3} {:>9.3} {:>6.1}% {:>6}",
                t.kind.name(),
                count(t.rays as u64),
                count(t.hits as u64),
                t.figure.median(),
                t.figure.best(),
                100.0 * t.figure.spread(),
                t.figure.busy.map_or("?".to_owned(), |busy| format!("{busy:.2}")),
            );
        }
        text
    }

    fn json(&self) -> Value {
        let args = self.args;
        let set = |t: &Timing| {
            let figures = json!({
                "rays": t.rays,
                "hits": t.hits,
                "mrays_per_s": t.figure.median(),
                "best": t.figure.best(),
                "repeats": t.figure.values,
                "busy_cpus": t.figure.busy,
            });
            (t.kind.name().to_owned(), figures)
        };
        json!({
            "program": "wavetrace",
            "version": env!("CARGO_PKG_VERSION"),
            "simd": lanes::simd(),
            "kernel": args.kernel.name(),
            "threads": args.threads,
            "repeats": args.repeats,
            "mesh": args.mesh.display().to_string(),
            "triangles": self.triangles,
            "build_s": self.build.as_secs_f64(),
            "bvh_bytes": self.bvh_bytes,
            "camera": self.view.as_ref().map(camera),
            "sets": self.timings.iter().map(set).collect::<Map<_, _>>(),
        })
    }

    /// Figures that other programs have disturbed.
    fn warn(&self, console: &Console) {
        for t in &self.timings {
            if let Some(busy) = t.figure.busy.filter(|busy| *busy < (1.0 - DISTURBED) * t.cpus) {
                console.warn(format_args!(
                    "{}: {busy:.2} CPUs were busy, of {:.2} that {} can keep busy with it: other work disturbs the timing",
                    t.kind.name(),
                    t.cpus,
                    counted(u64::from(self.args.threads), "thread")
                ));
            }
        }
    }
}

/// The numbers of `--camera`.
fn camera(view: &View) -> [f64; 7] {
    let (e, d) = (view.eye, view.direction);
    [e.x, e.y, e.z, d.x, d.y, d.z, view.fov]
}
