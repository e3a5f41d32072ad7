//! `wavetrace bench sweep`: throughput against one knob or two.

use super::args::SweepArgs;
use super::knob::{Knob, settings, twice};
use super::sheets::{Sweep, Trial};
use crate::cli::Exit;
use crate::cli::messages::Console;
use crate::cli::progress::Meter;
use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};
use wavetrace::accel::BuildOptions;
use wavetrace::bench::{Case, Pace, Unit, measure};
use wavetrace::error::{Error, Result as LibraryResult};
use wavetrace::output;
use wavetrace::render::{Control, Renderer};
use wavetrace::scene;
use wavetrace::wave::Counts;

/// Renders all that was asked for, and draws it.
pub fn run(args: &SweepArgs) -> Result<Exit, Exit> {
    let console = Console::new(args.quiet, false);
    let fail = |error: Error| console.fail(&error);
    if args.vary.len() > 2 {
        let (found, expected) = (args.vary.len().to_string(), "one knob or two".to_owned());
        return Err(fail(Error::Setting { setting: "--vary", found, expected }));
    }
    if let Some(name) = twice(args.vary.iter().chain(&args.set)) {
        let (found, expected) = (format!("{name} twice"), "each knob once in --vary and --set".to_owned());
        return Err(fail(Error::Setting { setting: "--set", found, expected }));
    }
    let names: Vec<_> = args.scene.iter().map(|path| path.file_stem()).collect();
    if let Some(again) = (0..names.len()).find(|&i| names[..i].contains(&names[i])) {
        let found = format!("{} twice", args.scene[again].display());
        let expected = "each scene once, with a file name of its own, by which drawings call it".to_owned();
        return Err(fail(Error::Setting { setting: "--scene", found, expected }));
    }
    let trials = trials(args).map_err(fail)?;
    let files = files(&args.output).map_err(fail)?;
    let renderers = renderers(args, &trials).map_err(fail)?;

    let meter = Meter::new(args.quiet);
    let fault = RefCell::new(None);
    let cases = trials.iter().map(|trial| case(trial, &renderers, &fault)).collect();
    let figures = measure(cases, args.repeats as usize, |share| {
        meter.show(share);
        fault.borrow().is_none()
    });
    drop(meter);
    if let Some(error) = fault.into_inner() {
        return Err(fail(error));
    }

    let sweep = Sweep { args, trials: &trials, figures: &figures };
    let texts = [sweep.csv(), sweep.svg(), sweep.page()];
    for (path, text) in files.iter().filter(|path| path.extension().is_none_or(|e| e != "png")).zip(&texts) {
        output::write_text(path, text).map_err(fail)?;
    }
    sweep.png(&files[3]).map_err(fail)?;
    console.answer(sweep.table())?;
    files.iter().for_each(|path| console.line(format_args!("wrote {}", path.display())));
    Ok(Exit::Done)
}

/// Every scene with every pair of values, in order.
fn trials(args: &SweepArgs) -> LibraryResult<Vec<Trial>> {
    let one = Knob { name: String::new(), values: vec![String::new()] };
    let [first, second] = [0, 1].map(|k| args.vary.get(k).unwrap_or(&one));
    let pairs = || second.values.iter().flat_map(|up| first.values.iter().map(move |across| [across, up]));
    let trial = |scene: &PathBuf, pair: [&String; 2]| {
        let values: Vec<String> = args.vary.iter().zip(pair).map(|(_, value)| value.clone()).collect();
        let varied = args.vary.iter().zip(&values).map(|(knob, value)| (knob.name.as_str(), value.as_str()));
        let fixed =
            args.set.iter().flat_map(|knob| knob.values.iter().map(|value| (knob.name.as_str(), value.as_str())));
        let mut all: Vec<(&str, &str)> = varied.chain(fixed).collect();
        let spp = args.spp.to_string();
        if all.iter().all(|(name, _)| *name != "spp") {
            all.push(("spp", &spp));
        }
        let found = all.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(", ");
        let render = settings(scene, &all).map_err(|expected| Error::Setting { setting: "--vary", found, expected })?;
        Ok(Trial { scene: scene.clone(), values, render })
    };
    args.scene.iter().flat_map(|scene| pairs().map(move |pair| (scene, pair))).map(|(s, pair)| trial(s, pair)).collect()
}

/// The files: table, drawing, page, picture. The folder is made where there is none.
fn files(folder: &Path) -> LibraryResult<[PathBuf; 4]> {
    fs::create_dir_all(folder).map_err(|source| Error::Io { file: folder.to_owned(), action: "make", source })?;
    let files = ["sweep.csv", "sweep.svg", "index.html", "sweep.png"].map(|name| folder.join(name));
    files.iter().try_for_each(|path| output::check_writable_text(path))?;
    Ok(files)
}

/// A scene and its tree, built as told.
type Built = (PathBuf, BuildOptions, Renderer);

fn renderers(args: &SweepArgs, trials: &[Trial]) -> LibraryResult<Vec<Built>> {
    let mut built: Vec<Built> = Vec::new();
    for trial in trials {
        let options = trial.render.build_options();
        if built.iter().any(|(scene, other, _)| (scene, other) == (&trial.scene, &options)) {
            continue;
        }
        let mut loaded = scene::load(&trial.scene)?;
        loaded.resize(args.size.0, args.size.1)?;
        built.push((trial.scene.clone(), options, Renderer::with_options(loaded.builder.build()?, &options)?));
    }
    Ok(built)
}

/// Rays and samples per second, and seconds, of one trial; or else why there are none.
fn case<'a>(trial: &Trial, renderers: &'a [Built], fault: &'a RefCell<Option<Error>>) -> Case<'a> {
    let options = trial.render.build_options();
    let found = renderers.iter().find(|(scene, other, _)| (scene, other) == (&trial.scene, &options));
    let settings = trial.render.settings();
    let mut pace = Pace::default();
    let run = move || {
        let Some((_, _, renderer)) = found else { return Vec::new() };
        let mut counts = Counts::default();
        let seconds = pace.seconds(|passes| {
            (0..passes).for_each(|_| match renderer.render(&settings, &Control::default()) {
                Ok(rendered) => counts = rendered.counts,
                Err(error) => *fault.borrow_mut() = Some(error),
            });
        });
        vec![counts.rays() as f64 / seconds / 1e6, counts.camera as f64 / seconds / 1e6, seconds * 1e3]
    };
    let names = [("rays", Unit::Mrays), ("samples", Unit::Msamples), ("time", Unit::Milliseconds)];
    Case::new(names.map(|(name, unit)| (name.to_owned(), unit)).to_vec(), run)
}
