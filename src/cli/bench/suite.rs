//! The standard suite: measures, keeps, compares.

use super::against::Against;
use super::args::SuiteArgs;
use super::saved::{self, Saved};
use super::table;
use crate::cli::Exit;
use crate::cli::interrupt::Interrupt;
use crate::cli::messages::Console;
use crate::cli::progress::Meter;
use std::path::{Path, PathBuf};
use std::{env, fs, thread};
use wavetrace::bench::suite::{Part, Suite};
use wavetrace::bench::{Figure, Unit};
use wavetrace::chart::Build;
use wavetrace::error::{Error, Result as LibraryResult};
use wavetrace::output;
use wavetrace::render::Control;

/// Share of the threads that may be idle in renders before other work is said to disturb them.
const DISTURBED: f64 = 0.1;

/// Measures, shows the figures, keeps them and compares them as the user wants.
pub fn run(args: &SuiteArgs) -> Result<Exit, Exit> {
    let console = Console::new(args.quiet, false);
    let fail = |error: Error| console.fail(&error);
    let threads = args.threads.map_or_else(|| thread::available_parallelism().map_or(1, usize::from), |n| n as usize);
    let before = args.against.as_deref().map(|name| Saved::read(saved::path(name))).transpose().map_err(fail)?;
    if let Some(before) = &before {
        let differences = before.differences(&saved::document(args, threads, &[]));
        if !differences.is_empty() && !args.force {
            differences.iter().for_each(|line| console.error(line));
            console.note("figures of different machines or builds tell nothing of the program; --force compares them");
            return Err(Exit::Fault);
        }
        differences.iter().for_each(|line| console.warn(line));
    }
    let save = args.save.as_deref().map(saved::path);
    if let Some(path) = &save {
        output::check_writable_text(path).map_err(fail)?;
    }
    if Build::this().profile != "release" {
        console.warn("this is no release build: its figures say little");
    }

    // Ended from within: temporary files go with what holds them.
    let interrupt = Interrupt::listen();
    let figures = measure(args, threads, &console, interrupt.start_render()).map_err(fail)?;
    if interrupt.happened() {
        console.line("interrupted: nothing is kept");
        return Err(Exit::Interrupted);
    }
    let mut document = saved::document(args, threads, &figures);
    // What was measured is kept before anything else can go wrong.
    if let Some(path) = &save {
        output::write_text(path, &format!("{document:#}\n")).map_err(fail)?;
        console.line(format_args!("wrote {}", path.display()));
    }
    let compared = before.map(|before| (Against::new(&before, &figures, args.tolerance / 100.0), before));
    if args.json {
        if let Some((against, _)) = &compared {
            document["compared"] = against.json();
        }
        console.answer(format_args!("{document:#}"))?;
    } else {
        console.answer(table::report(&figures))?;
        if let Some((against, before)) = &compared {
            console.answer(format_args!("\nagainst {}, version {}", before.path.display(), before.build()))?;
            console.answer(against.text(args.tolerance))?;
        }
    }
    warn(&console, threads, &figures);
    match compared {
        Some((against, before)) if against.all.is_empty() => {
            let path = before.path.display();
            console.error(format_args!("{path}: found no figure of this run, expected some to compare with"));
            Err(Exit::Fault)
        }
        Some((against, _)) if against.is_slower() => Ok(Exit::Slower),
        _ => Ok(Exit::Done),
    }
}

fn measure(args: &SuiteArgs, threads: usize, console: &Console, control: &Control) -> LibraryResult<Vec<Figure>> {
    let mut parts = if args.only.is_empty() { Part::ALL.to_vec() } else { args.only.clone() };
    // Without them a machine that is slower now would be taken for a program that is.
    if args.against.is_some() && !parts.contains(&Part::Machine) {
        parts.push(Part::Machine);
    }
    let scenes = if parts.contains(&Part::Scenes) { scenes(&args.scenes)? } else { Vec::new() };
    let own = |source| Error::Io { file: PathBuf::from("wavetrace"), action: "find this program", source };
    let suite = Suite {
        parts,
        scenes,
        program: env::current_exe().map_err(own)?,
        up_to: args.up_to as usize,
        threads,
        repeats: args.repeats as usize,
    };
    let meter = Meter::new(console.is_quiet());
    suite.run(|share| {
        meter.show(share);
        !control.is_stopped()
    })
}

/// The scene files of the folder, by name.
pub fn scenes(folder: &Path) -> LibraryResult<Vec<PathBuf>> {
    let fault = |source| Error::Io { file: folder.to_owned(), action: "look for scenes in", source };
    let entries = fs::read_dir(folder).map_err(fault)?.collect::<Result<Vec<_>, _>>().map_err(fault)?;
    let mut files: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == "json"));
    files.sort();
    if files.is_empty() {
        let reason = "found no scene, expected .json files (the scenes of a checkout are in its folder `scenes`; \
                      --only leaves parts of the suite out)";
        return Err(Error::Output { file: folder.to_owned(), reason: reason.to_owned() });
    }
    Ok(files)
}

/// Figures that other programs have disturbed, and those of runs that failed. Of figures that use all threads, whole renders tell best.
fn warn(console: &Console, threads: usize, figures: &[Figure]) {
    let threads = threads.min(thread::available_parallelism().map_or(threads, usize::from));
    let renders = figures.iter().filter(|f| f.unit == Unit::Mrays && f.name.starts_with("scene/"));
    let busy: Vec<f64> = renders.filter_map(|f| f.busy).collect();
    if let Some(least) =
        busy.iter().copied().reduce(f64::min).filter(|least| *least < (1.0 - DISTURBED) * threads as f64)
    {
        console.warn(format_args!(
            "renders kept only {least:.2} of {threads} CPUs busy at the worst: other work disturbs the timing"
        ));
    }
    for figure in figures.iter().filter(|figure| !figure.values.iter().all(|x| x.is_finite())) {
        console.warn(format_args!("{}: not all runs ended well", figure.name));
    }
}
