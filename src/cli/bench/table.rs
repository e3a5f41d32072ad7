//! Figures of the suite for people: a table for each part.

use crate::cli::units::counted;
use std::fmt::Write;
use wavetrace::bench::measure::median;
use wavetrace::bench::suite::INSTRUMENTATION;
use wavetrace::bench::{Figure, Unit};
use wavetrace::chart::number;

/// Rows of words, the first one flush left, the others flush right.
pub struct Table(pub Vec<Vec<String>>);

impl Table {
    /// A table with its head alone.
    pub fn new(head: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self(vec![head.into_iter().map(Into::into).collect()])
    }
    /// Its lines.
    pub fn text(&self) -> String {
        let columns = self.0.iter().map(Vec::len).max().unwrap_or(0);
        let width = |k: usize| self.0.iter().filter_map(|row| row.get(k)).map(|cell| cell.chars().count()).max();
        let widths: Vec<usize> = (0..columns).map(|k| width(k).unwrap_or(0)).collect();
        let mut text = String::new();
        for row in &self.0 {
            let mut line = String::new();
            for (k, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                let _ = if k == 0 { write!(line, "{cell:<width$}") } else { write!(line, "  {cell:>width$}") };
            }
            text += line.trim_end();
            text.push('\n');
        }
        text
    }
}

/// Three digits; a question mark for what is no number.
fn figure_of(value: f64) -> String {
    if value.is_finite() { number::figure(value) } else { "?".to_owned() }
}

fn percent(share: f64) -> String {
    format!("{:.1}%", 100.0 * share)
}

/// Parts of a name.
fn words(figure: &Figure) -> Vec<&str> {
    figure.name.split('/').collect()
}

/// What stands in a list of names, each once, in order.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut all = Vec::new();
    names.for_each(|name| {
        if !all.contains(&name) {
            all.push(name);
        }
    });
    all
}

/// All parts that were measured.
pub fn report(figures: &[Figure]) -> String {
    let of = |part: &str| figures.iter().filter(|f| words(f).first() == Some(&part)).collect::<Vec<_>>();
    let (rays, scenes) = (of("rays"), of("scene"));
    let rest: Vec<_> = figures.iter().filter(|f| !["rays", "scene"].contains(&words(f)[0])).collect();
    let mut parts = Vec::new();
    if !rest.is_empty() {
        parts.push(plain(&rest));
    }
    if !rays.is_empty() {
        parts.push(format!("Mrays/s by kernel; spread: that of the worst of the row\n{}", kernels(&rays)));
    }
    if !scenes.is_empty() {
        parts.push(renders(&scenes));
        parts
            .push(format!("nanoseconds per item of each stage, on one thread of those that work\n{}", stages(&scenes)));
    }
    parts.join("\n").trim_end().to_owned()
}

fn plain(figures: &[&Figure]) -> String {
    let mut table = Table::new(["what", "median", "", "best", "spread", "busy CPUs"]);
    for f in figures {
        let busy = f.busy.map_or("?".to_owned(), |busy| format!("{busy:.2}"));
        table.0.push(vec![
            f.name.clone(),
            figure_of(f.median()),
            f.unit.name().to_owned(),
            figure_of(f.best()),
            percent(f.spread()),
            busy,
        ]);
    }
    table.text()
}

/// A row for each mesh and set, a column for each kernel.
fn kernels(figures: &[&Figure]) -> String {
    let parts: Vec<_> = figures.iter().map(|f| words(f)).collect();
    let columns = distinct(parts.iter().filter_map(|w| w.get(3).copied()));
    let rows = distinct(figures.iter().filter_map(|f| f.name.rsplit_once('/')).map(|(row, _)| row));
    let mut table = Table::new(["triangles, rays"].into_iter().chain(columns.iter().copied()).chain(["spread"]));
    for row in rows {
        let find = |kernel: &str| figures.iter().find(|f| f.name.rsplit_once('/') == Some((row, kernel)));
        let found: Vec<_> = columns.iter().map(|kernel| find(kernel)).collect();
        let worst = found.iter().flatten().map(|f| f.spread()).fold(0.0, f64::max);
        let cells = found.iter().map(|f| f.map_or(String::new(), |f| figure_of(f.median())));
        let name = row.strip_prefix("rays/").unwrap_or(row).replace('/', " ");
        table.0.push([name].into_iter().chain(cells).chain([percent(worst)]).collect());
    }
    table.text()
}

/// What the figures of scenes are of: (scene, what).
fn scene(figure: &Figure) -> (&str, &str) {
    figure.name.strip_prefix("scene/").and_then(|name| name.rsplit_once('/')).unwrap_or(("", ""))
}

fn renders(figures: &[&Figure]) -> String {
    let mut table = Table::new(["scene", "Mrays/s", "Msamples/s", "spread", "busy CPUs"]);
    for name in distinct(figures.iter().map(|f| scene(f).0)) {
        let find = |what: &str| figures.iter().find(|f| scene(f) == (name, what));
        let Some((rays, samples)) = find("rays").zip(find("samples")) else { continue };
        let busy = rays.busy.map_or("?".to_owned(), |busy| format!("{busy:.2}"));
        let cells = [figure_of(rays.median()), figure_of(samples.median()), percent(rays.spread()), busy];
        table.0.push([name.to_owned()].into_iter().chain(cells).collect());
    }
    let costs: Vec<f64> = figures.iter().filter(|f| scene(f).1 == INSTRUMENTATION).map(|f| f.median()).collect();
    format!(
        "{}time that a clock in each stage adds: {:+.2} %, the median of {}\n",
        table.text(),
        median(&costs),
        counted(costs.len() as u64, "scene")
    )
}

/// A row for each scene, a column for each stage.
fn stages(figures: &[&Figure]) -> String {
    let times: Vec<_> = figures.iter().filter(|f| f.unit == Unit::Nanoseconds).collect();
    let columns = distinct(times.iter().map(|f| scene(f).1));
    let mut table = Table::new(["scene"].into_iter().chain(columns.iter().copied()));
    for name in distinct(times.iter().map(|f| scene(f).0)) {
        let find = |what: &&str| times.iter().find(|f| scene(f) == (name, *what));
        let cells = columns.iter().map(|what| find(what).map_or("-".to_owned(), |f| figure_of(f.median())));
        table.0.push([name.to_owned()].into_iter().chain(cells).collect());
    }
    table.text()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(name: &str, unit: Unit, value: f64) -> Figure {
        Figure { name: name.to_owned(), unit, values: vec![value, 1.1 * value, 0.9 * value], busy: Some(1.5) }
    }

    #[test]
    fn every_part_has_its_table() {
        let text = report(&[
            figure("machine/memory", Unit::Megabytes, 27_000.0),
            figure("rays/1k/primary/auto", Unit::Mrays, 54.0),
            figure("rays/1k/primary/single", Unit::Mrays, 7.0),
            figure("rays/1k/shadow/single", Unit::Mrays, 9.0),
            figure("scene/a/rays", Unit::Mrays, 20.0),
            figure("scene/a/samples", Unit::Msamples, 2.0),
            figure("scene/a/shade", Unit::Nanoseconds, 12.0),
            figure("scene/a/instrumentation", Unit::Percent, 0.5),
            figure("scene/b/rays", Unit::Mrays, 20.0),
            figure("scene/b/samples", Unit::Msamples, 2.0),
            figure("scene/b/aim", Unit::Nanoseconds, 12.0),
            figure("scene/scene/rays", Unit::Mrays, 30.0),
            figure("scene/scene/samples", Unit::Msamples, 3.0),
        ]);
        let expected = "\
what            median          best  spread  busy CPUs
machine/memory  27,000  MB/s  29,700   20.0%       1.50

Mrays/s by kernel; spread: that of the worst of the row
triangles, rays  auto  single  spread
1k primary       54.0    7.00   20.0%
1k shadow                9.00   20.0%

scene  Mrays/s  Msamples/s  spread  busy CPUs
a         20.0        2.00   20.0%       1.50
b         20.0        2.00   20.0%       1.50
scene     30.0        3.00   20.0%       1.50
time that a clock in each stage adds: +0.50 %, the median of 1 scene

nanoseconds per item of each stage, on one thread of those that work
scene  shade   aim
a       12.0     -
b          -  12.0";
        assert_eq!(text, expected);
    }
}
