//! What a tax measurement tells: as text, and as a page in Markdown.

use super::super::args::{Measure, TaxArgs, Without};
use super::super::table::Table;
use super::Scene;
use crate::cli::facts;
use std::fmt::Write;
use wavetrace::chart::{Build, Machine};
use wavetrace::wave::Feature;

/// All that was found.
pub struct Page<'a> {
    /// What was asked for.
    pub args: &'a TaxArgs,
    /// What was compared.
    pub by: Measure,
    /// The scenes.
    pub scenes: &'a [Scene],
    /// For each scene and each build what this program takes more, as a share.
    pub taxes: &'a [Vec<Option<f64>>],
}

/// A head and its rows.
type Cells = Vec<Vec<String>>;

impl Page<'_> {
    /// Bytes of each path: a row for each scene, a column for each feature.
    fn bytes(&self) -> Cells {
        let head = ["scene"].into_iter().chain(Feature::ALL.map(Feature::name)).chain(["all of a path"]);
        let row = |scene: &Scene| {
            let cell = |feature: Feature| {
                let bytes = scene.plan.feature_bytes(feature);
                if scene.plan.uses(feature) { format!("used, {bytes}") } else { bytes.to_string() }
            };
            let cells = Feature::ALL.into_iter().map(cell);
            [name(scene)].into_iter().chain(cells).chain([scene.plan.path_bytes().to_string()]).collect()
        };
        [head.map(str::to_owned).collect()].into_iter().chain(self.scenes.iter().map(row)).collect()
    }

    /// What this program takes more: a row for each scene, a column for each build.
    fn taxes(&self) -> Cells {
        let head = ["scene".to_owned()].into_iter().chain(self.args.without.iter().map(lacking));
        let cell = |tax: &Option<f64>| tax.map_or("used".to_owned(), |tax| format!("{:+.2} %", 100.0 * tax));
        let row = |(scene, taxes): (&Scene, &Vec<Option<f64>>)| {
            [name(scene)].into_iter().chain(taxes.iter().map(cell)).collect()
        };
        [head.collect()].into_iter().chain(self.scenes.iter().zip(self.taxes).map(row)).collect()
    }

    fn what(&self) -> &'static str {
        match self.by {
            Measure::Instructions => "instructions per sample",
            Measure::Time => "time per sample",
        }
    }

    /// Tables for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!("bytes of each path by feature\n{}", Table(self.bytes()).text());
        let _ = if self.args.without.is_empty() {
            write!(text, "\nno build to compare with: --without FEATURES=PROGRAM gives one")
        } else {
            write!(
                text,
                "\n{} more than a build without the features\n{}",
                self.what(),
                Table(self.taxes()).text().trim_end()
            )
        };
        text
    }

    /// The page.
    pub fn markdown(&self) -> String {
        let mut facts = facts::machine(&Build::this(), &Machine::here());
        facts.push(("page made".to_owned(), facts::local_time()));
        let facts: String = facts.iter().map(|(name, value)| format!("| {name} | {value} |\n")).collect();
        let method = match self.by {
            Measure::Instructions => {
                "Instructions are counted by callgrind, of renders on one thread with two numbers of samples, so that reading \
                 and building cancel out. What a compiler happens to do otherwise in a build \
                 that is smaller is in them, in either direction."
                    .to_owned()
            }
            Measure::Time => format!("Medians of {} renders each, in turns.", self.args.repeats),
        };
        let builds = match (self.args.without.is_empty(), self.high().as_slice()) {
            (true, _) => String::new(),
            (false, high) => {
                let verdict = match high {
                    [] => format!("Nothing takes more than {} % more.", self.args.bar),
                    lines => format!("Above the bar of {} %: {}.", self.args.bar, lines.join("; ")),
                };
                format!(
                    "\n## {} against builds that lack the feature\n\n\
                     Each column is another build, from whose source the feature's code was taken out; a cell tells how much more \
                     this program takes in a scene that lacks the feature. {method} {verdict}\n\n{}",
                    capital(self.what()),
                    markdown(&self.taxes())
                )
            }
        };
        let idle: String = self.idle().iter().map(|line| format!("\n{line}.\n")).collect();
        format!(
            "# What a scene pays for what it lacks\n\n\
             Made by `wavetrace bench tax`, see [measuring](measuring.md). `used`: the scene has it.\n\n\
             ## Bytes of each path\n\n\
             Columns that a path has because of a feature; 0 where the scene lacks it.\n\n{}{idle}{builds}\n\
             ## This build\n\n| | |\n|---|---|\n{facts}\n```\n{}\n```\n",
            markdown(&self.bytes()),
            facts::command()
        )
    }

    /// Scenes whose paths hold what they have no use for, in words.
    fn idle(&self) -> Vec<String> {
        let idle = self.scenes.iter().filter(|scene| scene.idle_bytes() > 0);
        idle.map(|scene| format!("{}: paths hold bytes for what it lacks", name(scene))).collect()
    }

    /// What is above the bar, in words.
    fn high(&self) -> Vec<String> {
        let of = |(scene, taxes): (&Scene, &Vec<Option<f64>>)| {
            let high = |tax: &Option<f64>| tax.is_some_and(|tax| 100.0 * tax > self.args.bar);
            let line = |(build, tax): (&Without, &Option<f64>)| {
                let percent = 100.0 * tax.unwrap_or_default();
                format!("{} pays {percent:.2} % for {}", name(scene), lacking(build))
            };
            self.args.without.iter().zip(taxes).filter(|(_, tax)| high(tax)).map(line).collect::<Vec<_>>()
        };
        self.scenes.iter().zip(self.taxes).flat_map(of).collect()
    }

    /// What takes more than it may, in words.
    pub fn above(&self) -> Vec<String> {
        [self.idle(), self.high()].concat()
    }
}

fn name(scene: &Scene) -> String {
    scene.path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

fn lacking(build: &Without) -> String {
    build.features.iter().map(|feature| feature.name()).collect::<Vec<_>>().join("+")
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

/// A table in Markdown.
fn markdown(cells: &Cells) -> String {
    let line = |row: &Vec<String>| format!("| {} |\n", row.join(" | "));
    let mut lines = cells.iter().map(line);
    let head = lines.next().unwrap_or_default();
    let rule = format!("|---{}|\n", "|--:".repeat(cells.first().map_or(1, Vec::len) - 1));
    [head, rule].into_iter().chain(lines).collect()
}
