//! What is made of the measurements: drawing, picture, page, and the last lines.

use super::subjects::Subject;
use super::summary;
use super::sweep::{SHOWN_SEED, Sweep};
use super::work::Outcome;
use crate::cli::Exit;
use crate::cli::facts;
use crate::cli::units::{bytes, count, counted, per_pixel, time};
use std::fs;
use wavetrace::chart::number::figure;
use wavetrace::chart::sweep::{Ladder, REFERENCE_SEEDS, common};
use wavetrace::chart::{
    Gallery, Imported, Legend, Metric, Page, Picture, Reference, ReferenceSetup, Row, Setup, curves, draw, heat, raster,
};
use wavetrace::error::Result as LibraryResult;
use wavetrace::output::{self, Metadata, Tone};

/// All that came of a run.
pub struct Results<'a> {
    /// What was asked for.
    pub sweep: &'a Sweep<'a>,
    /// Settings of all rows.
    pub setup: &'a Setup,
    /// Samples by scene and series.
    pub ladders: &'a [Vec<Ladder>],
    /// Rows and images.
    pub outcome: &'a Outcome,
    /// Rows of other programs.
    pub imported: &'a Imported,
    /// This program's labels, in the order of the legend.
    pub labels: &'a [String],
}

/// Writes all files and shows the last lines.
pub fn write(results: &Results<'_>) -> Result<Exit, Exit> {
    let Results { sweep, outcome, imported, labels, .. } = *results;
    let (console, folder) = (sweep.console, sweep.folder);
    let rows: Vec<Row> = outcome.rows.iter().chain(&imported.rows).cloned().collect();
    if outcome.rows.is_empty() {
        console.line("interrupted before anything was measured");
        return Ok(Exit::Interrupted);
    }
    let legend = Legend::new(labels.iter().cloned(), wavetrace::chart::curve::labels(&imported.rows));
    let names: Vec<&str> = sweep.subjects.iter().map(|subject| subject.name.as_str()).collect();
    let title = format!("Error of {}", names.join(", "));
    let scenes = curves(&rows, Metric::RelMse);
    let svg = draw::document(&title, &scenes, &legend, Metric::RelMse);
    let metadata = Metadata {
        entries: vec![("Software".to_owned(), format!("wavetrace {}", env!("CARGO_PKG_VERSION")))],
        partial: outcome.missing > 0,
    };
    let page = Page {
        title,
        unfinished: missing(outcome.missing),
        rows,
        legend,
        galleries: galleries(results).map_err(|error| console.fail(&error))?,
        facts: facts(results),
        command: facts::command(),
    };
    let fail = |error| console.fail(&error);
    output::write_text(&folder.svg(), &svg).map_err(fail)?;
    raster::write(&folder.png(), &svg, &metadata).map_err(fail)?;
    output::write_text(&folder.page(), &page.html()).map_err(fail)?;
    console.line(summary::text(&scenes));
    for path in [folder.rows(), folder.svg(), folder.png(), folder.page()] {
        let size = fs::metadata(&path).map_or_else(|_| String::new(), |found| format!(": {}", bytes(found.len())));
        console.line(format_args!("wrote {}{size}", path.display()));
    }
    Ok(Exit::Done)
}

fn missing(renders: usize) -> Option<String> {
    let verb = if renders == 1 { "is" } else { "are" };
    (renders > 0).then(|| format!("{} {verb} missing", counted(renders as u64, "render")))
}

/// The pictures of all scenes; of a scene without a reference none.
fn galleries(results: &Results<'_>) -> LibraryResult<Vec<Gallery>> {
    let Results { sweep, ladders, outcome, .. } = *results;
    let of = |(i, subject): (usize, &Subject)| {
        let mut gallery = Gallery { scene: subject.name.clone(), ..Gallery::default() };
        let spp = ladders.get(i).and_then(|ladders| common(ladders));
        let (Some(reference), Some(spp)) = (outcome.references.get(i), spp) else { return Ok(gallery) };
        (gallery.width, gallery.height) = subject.size();
        gallery.caption = format!("{}, seed {SHOWN_SEED}", per_pixel(spp));
        let shown = sweep.series.iter().enumerate();
        for (label, image) in shown.filter_map(|(k, series)| Some((&series.label, outcome.pictures.get(&(i, k))?))) {
            let of_image = |row: &&Row| {
                let what = (&row.scene, &row.label, row.spp, row.seed);
                what == (&subject.name, label, u64::from(spp), Some(SHOWN_SEED))
            };
            let note = outcome.rows.iter().find(of_image).map(|row| format!("relMSE {}", figure(row.relmse)));
            gallery.pictures.push(Picture {
                label: label.clone(),
                note: note.unwrap_or_default(),
                picture: output::png_bytes(image, &Metadata::default(), &Tone::default())?,
                heat: heat::map(image, reference.image())?,
            });
        }
        gallery.reference = Some(output::png_bytes(reference.image(), &Metadata::default(), &Tone::default())?);
        gallery.scale = Some(heat::scale()?);
        Ok(gallery)
    };
    sweep.subjects.iter().enumerate().map(of).collect()
}

/// What it takes to repeat the measurements.
fn facts(results: &Results<'_>) -> Vec<(String, String)> {
    let Results { sweep, setup, ladders, outcome, .. } = *results;
    let (build, machine, args) = (&setup.build, &setup.machine, sweep.args);
    let mut facts = facts::machine(build, machine);
    facts.extend([
        ("threads".to_owned(), setup.threads.to_string()),
        ("bounces".to_owned(), setup.max_depth.map_or("ended by roulette".to_owned(), |n| format!("at most {n}"))),
        ("seeds".to_owned(), format!("1 to {}", args.seeds)),
        (
            "seconds".to_owned(),
            "wall time of the render alone, its threads started and ended in it; load, build and figures are not"
                .to_owned(),
        ),
    ]);
    for (i, subject) in sweep.subjects.iter().enumerate() {
        let (world, (width, height)) = (subject.renderer.world(), subject.size());
        let about = format!(
            "{}, {width}x{height} pixels, {}, {}; load {}, build {}",
            subject.path.display(),
            counted(world.triangles() as u64, "triangle"),
            counted(world.lights() as u64, "light"),
            time(subject.load),
            time(subject.build)
        );
        facts.push((format!("scene {}", subject.name), about));
        facts.push((format!("reference of {}", subject.name), reference(results, i)));
        for (series, ladder) in sweep.series.iter().zip(ladders.get(i).into_iter().flatten()) {
            if args.seconds.is_some() {
                facts.push((format!("samples of {}, {}", subject.name, series.label), listed(ladder)));
            }
        }
    }
    if args.seconds.is_none() {
        facts.push(("samples per pixel".to_owned(), listed(&args.budgets())));
    }
    for path in &args.import {
        facts.push(("imported".to_owned(), path.display().to_string()));
    }
    facts.push(("page made".to_owned(), facts::local_time()));
    facts.push(("rows".to_owned(), count(outcome.rows.len() as u64)));
    facts
}

fn listed(numbers: &[u32]) -> String {
    numbers.iter().map(|&n| count(u64::from(n))).collect::<Vec<_>>().join(" ")
}

/// What the images of a scene are held against.
fn reference(results: &Results<'_>, scene: usize) -> String {
    let Results { sweep, setup, outcome, .. } = *results;
    let noise = outcome.references.get(scene).and_then(Reference::noise);
    let noise = noise.map_or_else(String::new, |noise| format!("; its own relMSE of {} is taken off", figure(noise)));
    let given = sweep.subjects.get(scene).and_then(|subject| subject.given.as_ref());
    let rendered = match setup.scenes.get(scene).map(|scene| &scene.reference) {
        Some(ReferenceSetup::Rendered(samples)) => *samples,
        _ => 0,
    };
    let what = match given {
        Some(given) => given.paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", "),
        None => format!(
            "mis sobol, two halves of {} samples per pixel, seeds {} and {}",
            count(rendered / 2),
            REFERENCE_SEEDS[0],
            REFERENCE_SEEDS[1]
        ),
    };
    format!("{what}{noise}")
}
