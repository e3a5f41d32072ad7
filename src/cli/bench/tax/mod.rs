//! `wavetrace bench tax`: what features cost scenes that lack them, in bytes of each path, and in instructions or time
//! against builds that lack the features themselves.

mod page;
mod process;

use super::args::{Measure, TaxArgs, Without};
use super::suite::scenes;
use crate::cli::Exit;
use crate::cli::interrupt::Interrupt;
use crate::cli::messages::Console;
use crate::cli::progress::Meter;
use page::Page;
use process::{Figure, Work};
use std::cell::RefCell;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{env, thread};

use wavetrace::bench::{Case, Unit, measure};
use wavetrace::error::{Error, Result as LibraryResult};
use wavetrace::output;
use wavetrace::render::{Control, Settings};
use wavetrace::scene;
use wavetrace::wave::{Feature, Plan};

/// A scene and what it needs.
pub struct Scene {
    /// Its file.
    pub path: PathBuf,
    /// Its plan.
    pub plan: Plan,
}

impl Scene {
    /// Whether it lacks all that a build lacks.
    fn lacks(&self, build: &Without) -> bool {
        build.features.iter().all(|&feature| !self.plan.uses(feature))
    }
    /// Bytes of each path for features that it lacks.
    fn idle_bytes(&self) -> usize {
        let idle = Feature::ALL.into_iter().filter(|&feature| !self.plan.uses(feature));
        idle.map(|feature| self.plan.feature_bytes(feature)).sum()
    }
}

/// Shows the bytes, compares with the builds, and writes the page.
pub fn run(args: &TaxArgs) -> Result<Exit, Exit> {
    let console = Console::new(args.quiet, false);
    let fail = |error: Error| console.fail(&error);
    if let Some(path) = &args.output {
        output::check_writable_text(path).map_err(fail)?;
    }
    let loaded = scenes(&args.scenes).and_then(|paths| paths.into_iter().map(|path| load(path, args.size)).collect());
    let all: Vec<Scene> = loaded.map_err(fail)?;
    let by = args.by.unwrap_or(if process::can_count() { Measure::Instructions } else { Measure::Time });
    let interrupt = Interrupt::listen();
    let compared = compare(args, by, &all, interrupt.start_render());
    if interrupt.happened() {
        console.line("interrupted: nothing is written");
        return Err(Exit::Interrupted);
    }
    let page = Page { args, by, scenes: &all, taxes: &compared.map_err(fail)? };
    console.answer(page.text())?;
    if let Some(path) = &args.output {
        output::write_text(path, &page.markdown()).map_err(fail)?;
        console.line(format_args!("wrote {}", path.display()));
    }
    let too_many = page.above();
    too_many.iter().for_each(|line| console.warn(line));
    Ok(if too_many.is_empty() { Exit::Done } else { Exit::Slower })
}

fn load(path: PathBuf, size: (u32, u32)) -> LibraryResult<Scene> {
    let mut loaded = scene::load(&path)?;
    loaded.resize(size.0, size.1)?;
    let (world, set) = (loaded.builder.build()?, Settings::default());
    let plan = Plan::new(&world, set.method, set.max_depth, set.wave_size, set.light_paths);
    Ok(Scene { path, plan })
}

/// For each scene and each build what this program takes more than the build, as a share; `None` where the scene has what
/// the build lacks.
fn compare(args: &TaxArgs, by: Measure, scenes: &[Scene], control: &Control) -> LibraryResult<Vec<Vec<Option<f64>>>> {
    let own = |source| Error::Io { file: PathBuf::from("wavetrace"), action: "find this program", source };
    let this = env::current_exe().map_err(own)?;
    let spp = args.spp.unwrap_or(if by == Measure::Instructions { 16 } else { 256 });
    let mut jobs: Vec<Work<'_>> = Vec::new();
    for scene in scenes {
        let builds = || args.without.iter().filter(|build| scene.lacks(build));
        let programs = builds().take(1).map(|_| this.as_path()).chain(builds().map(|build| build.program.as_path()));
        jobs.extend(programs.map(|program| Work { program, scene: &scene.path, size: args.size, spp }));
    }
    let meter = Meter::new(args.quiet);
    let figures = match by {
        Measure::Instructions => count(&jobs, |share| meter.show(share), control)?,
        Measure::Time => time(&jobs, args.repeats as usize, |share| meter.show(share), control)?,
    };
    let find = |program: &Path, scene: &Path| {
        let at = jobs.iter().position(|job| (job.program, job.scene) == (program, scene))?;
        figures.get(at)
    };
    // What renders something else is no measure of what it lacks.
    for job in &jobs {
        let image = |program: &Path| find(program, job.scene).map(|figure| &figure.pixels);
        if image(job.program) != image(&this) {
            let reason = format!("renders {} otherwise, which uses something that it lacks", job.scene.display());
            return Err(Error::Output { file: job.program.to_owned(), reason });
        }
    }
    let tax = |scene: &Scene, build: &Without| {
        let figure = |program: &Path| find(program, &scene.path).filter(|_| scene.lacks(build)).map(|f| f.value);
        Some(figure(&this)? / figure(&build.program)? - 1.0)
    };
    Ok(scenes.iter().map(|scene| args.without.iter().map(|build| tax(scene, build)).collect()).collect())
}

/// Instructions per sample of each, several at a time: counts do not disturb each other.
fn count(jobs: &[Work<'_>], seen: impl Fn(f64) + Sync, control: &Control) -> LibraryResult<Vec<Figure>> {
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let done = AtomicUsize::new(0);
    let one = |job: &Work<'_>| {
        if control.is_stopped() {
            return Ok(Figure { value: f64::NAN, pixels: Vec::new() });
        }
        let figure = process::instructions(job);
        seen((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / jobs.len() as f64);
        figure
    };
    let share =
        &|first: usize| jobs.iter().skip(first).step_by(workers).map(one).collect::<LibraryResult<Vec<Figure>>>();
    let mut shares: Vec<std::vec::IntoIter<Figure>> = thread::scope(|scope| {
        let started: Vec<_> = (0..workers).map(|first| scope.spawn(move || share(first))).collect();
        started
            .into_iter()
            .map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)).map(Vec::into_iter))
            .collect::<LibraryResult<_>>()
    })?;
    Ok((0..jobs.len()).filter_map(|k| shares[k % workers].next()).collect())
}

/// Seconds per sample of each, the median of repeats in turns.
fn time(jobs: &[Work<'_>], repeats: usize, seen: impl Fn(f64), control: &Control) -> LibraryResult<Vec<Figure>> {
    // Once without the clock, so that what cannot run is told; and for the images.
    let once: Vec<Figure> =
        jobs.iter().map(|job| process::seconds(&Work { spp: 1, ..*job })).collect::<LibraryResult<_>>()?;
    let failed = RefCell::new(None);
    let figures = measure(jobs.iter().map(|job| timed(job, &failed)).collect(), repeats, |share| {
        seen(share);
        !control.is_stopped() && failed.borrow().is_none()
    });
    if let Some(error) = failed.into_inner() {
        return Err(error);
    }
    Ok(once.into_iter().zip(&figures).map(|(once, timed)| Figure { value: timed.median(), ..once }).collect())
}

fn timed<'a>(job: &'a Work<'_>, failed: &'a RefCell<Option<Error>>) -> Case<'a> {
    let run = move || match process::seconds(job) {
        Ok(figure) => vec![figure.value * 1e9],
        Err(error) => {
            *failed.borrow_mut() = Some(error);
            vec![f64::NAN]
        }
    };
    Case::new(vec![(String::new(), Unit::Nanoseconds)], run).elsewhere()
}
