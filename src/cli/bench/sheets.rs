//! What is made of a sweep: table, drawing, page, picture.

use super::args::SweepArgs;
use super::knob::Knob;
use crate::cli::args::RenderArgs;
use crate::cli::facts;
use crate::cli::units::counted;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use wavetrace::bench::Figure;
use wavetrace::chart::board::{Cell, board};
use wavetrace::chart::curve::Band;
use wavetrace::chart::draw::{panel_element, panels_document};
use wavetrace::chart::number::figure;
use wavetrace::chart::plot::{Scale, Spot, plot};
use wavetrace::chart::svg::escape;
use wavetrace::chart::{Build, Machine, Sheet, raster};
use wavetrace::error::Result;
use wavetrace::output::Metadata;

/// What is drawn upwards.
const UP: &str = "Mrays/s";
/// Figures of a trial: rays, samples, time.
const FIGURES: usize = 3;

/// A scene with values of the knobs.
#[derive(Debug)]
pub struct Trial {
    /// The scene file.
    pub scene: PathBuf,
    /// A value for each knob that is varied.
    pub values: Vec<String>,
    /// What the render is told.
    pub render: RenderArgs,
}

/// All that was measured.
pub struct Sweep<'a> {
    /// What was asked for.
    pub args: &'a SweepArgs,
    /// The renders.
    pub trials: &'a [Trial],
    /// Three figures of each.
    pub figures: &'a [Figure],
}

impl Sweep<'_> {
    fn rows(&self) -> impl Iterator<Item = (&Trial, &[Figure])> {
        self.trials.iter().zip(self.figures.chunks(FIGURES))
    }

    /// A row for each repeat of each trial.
    pub fn csv(&self) -> String {
        let knobs: Vec<&str> = self.args.vary.iter().map(|knob| knob.name.as_str()).collect();
        let mut out = format!("scene,{},repeat,seconds,mrays_per_s,msamples_per_s\n", knobs.join(","));
        for (trial, figures) in self.rows() {
            let [rays, samples, time] = figures else { continue };
            let values = rays.values.iter().zip(&samples.values).zip(&time.values);
            for (repeat, ((rays, samples), milliseconds)) in values.enumerate() {
                let scene = name(&trial.scene).replace('"', "\"\"");
                let (values, seconds) = (trial.values.join(","), milliseconds / 1e3);
                // Writing to a string cannot fail.
                let _ = writeln!(out, "\"{scene}\",{values},{},{seconds},{rays},{samples}", repeat + 1);
            }
        }
        out
    }

    /// A line for each trial.
    pub fn table(&self) -> String {
        let mut out = String::new();
        for (trial, figures) in self.rows() {
            let settings: Vec<String> = self
                .args
                .vary
                .iter()
                .zip(&trial.values)
                .map(|(knob, value)| format!("{}={value}", knob.name))
                .collect();
            let [rays, samples, _] = figures else { continue };
            let _ = writeln!(
                out,
                "{:<16} {:<28} {:>9} Mrays/s  {:>9} Msamples/s  spread {:.1}%",
                name(&trial.scene),
                settings.join(" "),
                figure(rays.median()),
                figure(samples.median()),
                100.0 * rays.spread()
            );
        }
        out.trim_end().to_owned()
    }

    /// A panel for each scene: (its name, the drawing).
    fn panels(&self) -> Vec<(String, String)> {
        self.args.scene.iter().map(|scene| (name(scene), self.panel(scene))).collect()
    }

    fn panel(&self, scene: &Path) -> String {
        let own: Vec<_> = self.rows().filter(|(trial, _)| trial.scene == scene).collect();
        let tip = |trial: &Trial, figures: &[Figure]| {
            let knobs = self.args.vary.iter().zip(&trial.values);
            let lines = knobs.map(|(knob, value)| format!("{} {value}\n", knob.name)).collect::<String>();
            let of = |k: usize| figures.get(k).map_or(0.0, Figure::median);
            let spread = figures.first().map_or(0.0, Figure::spread);
            format!("{lines}{} {UP}, spread {:.1} %\n{} Msamples/s", figure(of(0)), 100.0 * spread, figure(of(1)))
        };
        match self.args.vary.as_slice() {
            [across, up] => {
                let cells: Vec<Cell> = own
                    .iter()
                    .map(|(trial, figures)| Cell { value: figures[0].median(), tip: tip(trial, figures) })
                    .collect();
                let rows: Vec<Vec<Cell>> = cells.chunks(across.values.len()).map(<[Cell]>::to_vec).collect();
                board([&across.name, &up.name], &across.values, &up.values, &rows)
            }
            [knob, ..] => {
                let numbers = numbers(knob);
                let spot = |(i, (trial, figures)): (usize, &(&Trial, &[Figure]))| {
                    let x = numbers.as_ref().map_or(i as f64, |numbers| numbers[i]);
                    Some(Spot { x, band: Band::of(&figures[0].values)?, tip: tip(trial, figures) })
                };
                let spots: Vec<Spot> = own.iter().enumerate().filter_map(spot).collect();
                let scale = if numbers.is_some() { Scale::Numbers } else { Scale::Names(knob.values.clone()) };
                plot(&knob.name, UP, &scale, &spots)
            }
            [] => String::new(),
        }
    }

    fn title(&self) -> String {
        let knobs: Vec<&str> = self.args.vary.iter().map(|knob| knob.name.as_str()).collect();
        let scenes: Vec<String> = self.args.scene.iter().map(|scene| name(scene)).collect();
        format!("Throughput of {} against {}", scenes.join(", "), knobs.join(" and "))
    }

    /// The drawing.
    pub fn svg(&self) -> String {
        panels_document(&self.title(), (String::new(), 0.0), &self.panels())
    }

    /// The picture.
    pub fn png(&self, path: &Path) -> Result<()> {
        let software = ("Software".to_owned(), format!("wavetrace {}", env!("CARGO_PKG_VERSION")));
        raster::write(path, &self.svg(), &Metadata { entries: vec![software], partial: false })
    }

    /// The page.
    pub fn page(&self) -> String {
        let section = |(name, content): (String, String)| {
            let name = escape(&name);
            format!(
                r#"<section aria-label="{name}"><h2>{name}</h2><div class="panels">{}</div></section>"#,
                panel_element(&format!("{UP} of {name}"), &content)
            )
        };
        let args = self.args;
        let mut facts = facts::machine(&Build::this(), &Machine::here());
        let threads = self.trials.first().map_or(0, |trial| trial.render.settings().threads);
        let threads = if threads == 0 { "all cores".to_owned() } else { threads.to_string() };
        facts.extend(
            [
                (
                    "renders",
                    format!("{}x{} pixels, {} samples per pixel unless varied", args.size.0, args.size.1, args.spp),
                ),
                ("threads", format!("{threads} unless varied")),
                ("repeats", format!("{} of each, in turns; medians, bands hold the middle 80 %", args.repeats)),
                ("page made", facts::local_time()),
            ]
            .map(|(name, value)| (name.to_owned(), value)),
        );
        let title = self.title();
        let sheet = Sheet {
            title: &title,
            summary: format!(
                "<p>{}, each timed {} in turns. Higher is faster; the image is the same at every point unless samples or \
                 methods vary. Points tell their figures.</p>",
                counted(self.trials.len() as u64, "setting"),
                counted(u64::from(args.repeats), "time")
            ),
            bar: String::new(),
            sections: self.panels().into_iter().map(section).collect(),
            facts: &facts,
            command: &facts::command(),
        };
        sheet.html()
    }
}

/// The values as places on an axis, where all are numbers and there are several.
fn numbers(knob: &Knob) -> Option<Vec<f64>> {
    knob.numbers().filter(|numbers| numbers.len() > 1)
}

/// Name of a scene: that of its file without the ending.
fn name(scene: &Path) -> String {
    scene.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}
