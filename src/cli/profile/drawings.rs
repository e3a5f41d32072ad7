//! The drawings of a profile: stages by bounces, occupancy, roofline, timeline.

use super::Profile;
use std::time::Duration;
use wavetrace::chart::bars::{Part, bars};
use wavetrace::chart::number::figure;
use wavetrace::chart::roof::{Limits, Load, roof};
use wavetrace::chart::spans::{Span, spans};
use wavetrace::probe::{DEPTHS, Event, Stage, StageRow, What};

/// Milliseconds of the timeline.
const WINDOW: f64 = 12.0;
/// Spans that are drawn of a worker at most.
const MOST: usize = 1500;

/// What is told apart by colour: stages, and what is none.
pub fn series() -> Vec<&'static str> {
    Stage::ALL.iter().map(|stage| stage.name()).chain(["waiting for the film"]).collect()
}

/// Stages with any rows, in order.
fn ran(rows: &[StageRow]) -> impl Iterator<Item = &StageRow> {
    rows.iter().filter(|row| row.items > 0)
}

fn depth_name(depth: usize) -> String {
    if depth + 1 == DEPTHS { format!("{depth}+") } else { depth.to_string() }
}

impl Profile<'_> {
    /// Milliseconds of each stage by the number of bounces.
    pub fn breakdown(&self) -> String {
        let rows: Vec<&StageRow> = ran(&self.by_depth.stages).collect();
        let deepest = rows.iter().filter_map(|row| row.depths.iter().rposition(|d| d.items > 0.0)).max().unwrap_or(0);
        let bar = |depth: usize| {
            let part = |row: &&StageRow| {
                let d = row.depths[depth];
                let ns = if d.items > 0.0 { d.seconds * 1e9 / d.items } else { 0.0 };
                let tip = format!(
                    "{}, {} bounces\n{} ms of all threads\n{} rows, {} ns each",
                    row.stage.name(),
                    depth_name(depth),
                    figure(d.seconds * 1e3),
                    d.items.round(),
                    figure(ns)
                );
                Part { series: row.stage as usize, value: d.seconds * 1e3, tip }
            };
            (depth_name(depth), rows.iter().map(part).collect())
        };
        bars("bounces", "milliseconds of all threads", &(0..=deepest).map(bar).collect::<Vec<_>>())
    }

    /// Per cent of lanes with a row in them, stage by stage, of the render as users have it.
    pub fn occupancy(&self) -> String {
        let bar = |row: &StageRow| {
            let value = 100.0 * row.occupancy();
            let tip = format!(
                "{}\n{} % of lanes hold a row\n{} rows in {} runs",
                row.stage.name(),
                figure(value),
                row.items,
                row.calls
            );
            (row.stage.name().to_owned(), vec![Part { series: row.stage as usize, value, tip }])
        };
        bars("", "per cent of lanes in use", &ran(&self.usual.stages).map(bar).collect::<Vec<_>>())
    }

    /// Stages whose arithmetic is known, below the limits of the machine.
    pub fn roof(&self) -> String {
        let limits = Limits {
            gflops: self.limits.gflops,
            memories: vec![("own cache".to_owned(), self.limits.cache), ("memory".to_owned(), self.limits.memory)],
        };
        let load = |row: &StageRow| {
            let (bytes, flops) = (self.plan.stage_bytes(row.stage)? as f64, self.arithmetic.per_row(row.stage)?);
            let rate = row.items as f64 / row.time.as_secs_f64() / 1e9;
            let tip = format!(
                "{}\n{} Gflop/s, {} GB/s\n{} operations for each byte",
                row.stage.name(),
                figure(flops * rate),
                figure(bytes * rate),
                figure(flops / bytes)
            );
            Some(Load { name: row.stage.name().to_owned(), intensity: flops / bytes, gflops: flops * rate, tip })
        };
        roof(&limits, &ran(&self.usual.stages).filter_map(load).collect::<Vec<_>>())
    }

    /// What the workers did in some milliseconds from the middle of the render on.
    pub fn timeline(&self) -> String {
        let total = self.usual.time.as_secs_f64() * 1e3;
        let from = (total / 2.0 - WINDOW / 2.0).max(0.0);
        let to = (from + WINDOW).min(total.max(1e-3));
        let millis = |time: Duration| time.as_secs_f64() * 1e3;
        let span = |event: &Event| {
            let series = match event.what {
                What::Stage(stage) => stage as usize,
                What::Merge => Stage::ALL.len(),
                What::Visit | What::Light | What::Survey => return None,
            };
            let start = millis(event.start.saturating_duration_since(self.start));
            let end = start + millis(event.length);
            let rows = if event.items > 0 { format!("{} rows\n", event.items) } else { String::new() };
            let tip = format!("{}\n{rows}{} ms from {} ms on", event.what.name(), figure(end - start), figure(start));
            (end > from && start < to).then_some(Span { series, from: start, to: end, tip })
        };
        let row = |(k, events): (usize, &Vec<Event>)| {
            (format!("worker {}", k + 1), events.iter().filter_map(span).take(MOST).collect())
        };
        let rows: Vec<_> = self.usual.timeline.iter().enumerate().map(row).collect();
        spans("What the workers did", from, to, &rows)
    }
}
