//! Whole renders of scenes, without a clock inside and with one in each stage.

use super::Suite;
use crate::bench::measure::{Case, Pace, Unit};
use crate::error::Result;
use crate::probe::{Stage, StageRow};
use crate::render::{Control, Rendered, Renderer, Settings};
use crate::scene;
use std::path::PathBuf;

/// Ending of the figure that tells what measuring the stages costs.
pub const INSTRUMENTATION: &str = "instrumentation";

/// Pixels across and down, and samples of each: a million samples.
const SIDE: u32 = 256;
const SPP: u32 = 16;

/// A scene that is ready to render.
pub(super) struct Scene {
    name: String,
    renderer: Renderer,
    /// Stages that run.
    stages: Vec<Stage>,
}

fn settings(threads: usize, time_stages: bool) -> Settings {
    Settings { spp: SPP, threads, time_stages, ..Settings::default() }
}

/// Reads the scenes and builds their trees, as long as it goes on.
pub(super) fn load(files: &[PathBuf], suite: &Suite, goes_on: &mut impl FnMut() -> bool) -> Result<Vec<Scene>> {
    let one = |file: &PathBuf| {
        let mut loaded = scene::load(file)?;
        loaded.resize(SIDE, SIDE)?;
        let renderer = Renderer::with_options(loaded.builder.build()?, &suite.build_options())?;
        // Which stages a scene needs is known once it has run.
        let rendered = renderer.render(&settings(suite.threads, true), &Control::default())?;
        let stages = rendered.stages.iter().filter(|row| row.items > 0).map(|row| row.stage).collect();
        let name = file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Ok(Scene { name, renderer, stages })
    };
    files.iter().take_while(|_| goes_on()).map(one).collect()
}

/// One case for each scene: rays and samples per second, nanoseconds per item of each stage, and what its clock costs.
pub(super) fn cases(scenes: &[Scene], threads: usize) -> Vec<Case<'_>> {
    scenes.iter().map(|scene| case(scene, threads)).collect()
}

fn case(scene: &Scene, threads: usize) -> Case<'_> {
    let figure = |what: &str, unit: Unit| (format!("scene/{}/{what}", scene.name), unit);
    let mut figures = vec![figure("rays", Unit::Mrays), figure("samples", Unit::Msamples)];
    figures.extend(scene.stages.iter().map(|stage| figure(stage.name(), Unit::Nanoseconds)));
    figures.push(figure(INSTRUMENTATION, Unit::Percent));
    let (mut plain, mut timed) = (Pace::default(), Pace::default());
    let mut first = false;
    let run = move || {
        // Which of both comes first alternates: what follows is warmer.
        first = !first;
        let mut render = |time_stages: bool| {
            let pace = if time_stages { &mut timed } else { &mut plain };
            let mut last = None;
            let seconds = pace.seconds(|passes| {
                for _ in 0..passes {
                    last = scene.renderer.render(&settings(threads, time_stages), &Control::default()).ok();
                }
            });
            (seconds, last)
        };
        let (a, b) = (render(first), render(!first));
        let ((seconds, rendered), (with_clock, staged)) = if first { (b, a) } else { (a, b) };
        let counts = rendered.map(|rendered| rendered.counts).unwrap_or_default();
        let mut values = vec![counts.rays() as f64 / seconds / 1e6, counts.camera as f64 / seconds / 1e6];
        values.extend(scene.stages.iter().map(|&stage| nanoseconds(staged.as_ref(), stage)));
        values.push(100.0 * (with_clock / seconds - 1.0));
        values
    };
    Case::new(figures, run)
}

/// Time of a stage for each of its rows.
fn nanoseconds(rendered: Option<&Rendered>, stage: Stage) -> f64 {
    let row = rendered.and_then(|rendered| rendered.stages.iter().find(|row| row.stage == stage));
    row.map_or(0.0, StageRow::ns_per_item)
}
