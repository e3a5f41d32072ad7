//! The drawings of a profile: stages by bounces, occupancy, roofline, timeline.

use super::Profile;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};
use wavetrace::chart::bars::{Part, bars};
use wavetrace::chart::number::figure;
use wavetrace::chart::roof::{Limits, Load, roof};
use wavetrace::chart::spans::{Span, spans};
use wavetrace::probe::{DEPTHS, Event, Stage, StageRow, What, period};

/// Spans that are drawn of a worker at most; where there are more in a period, the drawing ends sooner.
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

    /// What the workers did in a period about the middle of the render, of which all stages were kept; or in all of a render that is
    /// shorter.
    pub fn timeline(&self) -> String {
        let millis = |time: Duration| time.as_secs_f64() * 1e3;
        let since = |at: Instant| millis(at.saturating_duration_since(self.start));
        let total = millis(self.usual.time).max(1e-3);
        let window = whole_period(&self.usual.timeline, self.start + self.usual.time / 2).map(period);
        let window = window.filter(|[start, end]| self.usual.time > *end - *start);
        let [from, to] = window.map_or([0.0, total], |window| window.map(|at| since(at).min(total)));
        let span = |event: &Event| {
            let series = match event.what {
                What::Stage(stage) => stage as usize,
                What::Merge => Stage::ALL.len(),
                What::Visit | What::Light | What::Survey => return None,
            };
            let start = since(event.start);
            let end = start + millis(event.length);
            let rows = if event.items > 0 { format!("{} rows\n", event.items) } else { String::new() };
            let tip = format!("{}\n{rows}{} ms from {} ms on", event.what.name(), figure(end - start), figure(start));
            (end > from && start < to).then_some(Span { series, from: start, to: end, tip })
        };
        let row = |(k, events): (usize, &Vec<Event>)| {
            (format!("worker {}", k + 1), events.iter().filter_map(span).collect::<Vec<_>>())
        };
        let mut rows: Vec<_> = self.usual.timeline.iter().enumerate().map(row).collect();
        let to = rows.iter().filter_map(|(_, spans)| spans.get(MOST)).map(|span| span.from).fold(to, f64::min);
        rows.iter_mut().for_each(|(_, spans)| spans.retain(|span| span.from < to));
        spans("What the workers did", from, to, &rows)
    }
}

/// Of the periods in which each worker that has any stages has some, or else any worker, the one nearest to `middle`. What is left out of
/// a long timeline is left out by whole periods, so that those with stages have all of them.
fn whole_period(timeline: &[Vec<Event>], middle: Instant) -> Option<u32> {
    let of = |events: &Vec<Event>| -> BTreeSet<u32> {
        events.iter().filter(|event| matches!(event.what, What::Stage(_))).map(|event| event.period).collect()
    };
    let workers: Vec<BTreeSet<u32>> = timeline.iter().map(of).filter(|periods| !periods.is_empty()).collect();
    let all: BTreeSet<u32> = workers.iter().flatten().copied().collect();
    let common: BTreeSet<u32> =
        all.iter().copied().filter(|number| workers.iter().all(|periods| periods.contains(number))).collect();
    let far = |number: u32| {
        let [start, end] = period(number);
        let at = start + (end - start) / 2;
        at.saturating_duration_since(middle).max(middle.saturating_duration_since(at))
    };
    let near = |numbers: BTreeSet<u32>| numbers.into_iter().min_by_key(|&number| far(number));
    near(common).or_else(|| near(all))
}
