//! What is measured inside the wave loop, and what it costs to measure nothing: no instruction.

use crate::lanes::MAX_LANES;
use std::time::{Duration, Instant};

/// A stage of the wave loop, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Camera rays into the free rows.
    Generate,
    /// Closest hits of all rays.
    Intersect,
    /// Sorting rows by what they hit.
    Route,
    /// Background radiance.
    Escape,
    /// Radiance of lights that were hit.
    Emit,
    /// Scattering at surfaces, shadow rays.
    Shade,
    /// Shadow rays and direct light.
    Connect,
    /// Second paths, towards mirrors and glass.
    Aim,
    /// Removal of paths that ended.
    Compact,
    /// Samples into pixels.
    Accumulate,
    /// Light paths leave the lamps.
    Start,
    /// Light paths at surfaces, connections to the camera.
    Scatter,
    /// Connections to the camera.
    Expose,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Stage; 13] = [
        Stage::Generate,
        Stage::Intersect,
        Stage::Route,
        Stage::Escape,
        Stage::Emit,
        Stage::Shade,
        Stage::Connect,
        Stage::Aim,
        Stage::Compact,
        Stage::Accumulate,
        Stage::Start,
        Stage::Scatter,
        Stage::Expose,
    ];
    /// Lower-case name, as in `--stats`.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Generate => "generate",
            Stage::Intersect => "intersect",
            Stage::Route => "route",
            Stage::Escape => "escape",
            Stage::Emit => "emit",
            Stage::Shade => "shade",
            Stage::Connect => "connect",
            Stage::Aim => "aim",
            Stage::Compact => "compact",
            Stage::Accumulate => "accumulate",
            Stage::Start => "start",
            Stage::Scatter => "scatter",
            Stage::Expose => "expose",
        }
    }
}

/// Sees every stage run.
pub trait Probe: Default + Send {
    /// Runs `work` on `items` rows as stage `stage`.
    fn stage<T>(&mut self, stage: Stage, items: usize, work: impl FnOnce() -> T) -> T;
    /// What was seen, one row per stage; empty where nothing is measured.
    fn rows(&self) -> Vec<StageRow> {
        Vec::new()
    }
}

/// Measures nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProbe;

impl Probe for NoProbe {
    #[inline(always)]
    fn stage<T>(&mut self, _stage: Stage, _items: usize, work: impl FnOnce() -> T) -> T {
        work()
    }
}

/// What a stage did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageRow {
    /// Which stage.
    pub stage: Stage,
    /// How often it ran.
    pub calls: u64,
    /// Rows that it ran on, in all.
    pub items: u64,
    /// Lanes that were spent on them: each run takes its rows eight at a time.
    pub lanes: u64,
    /// Time spent in it, summed over threads.
    pub time: Duration,
}

impl StageRow {
    /// Share of the lanes that held a row; 1 where none were spent.
    pub fn occupancy(&self) -> f64 {
        if self.lanes == 0 { 1.0 } else { self.items as f64 / self.lanes as f64 }
    }
}

/// Measures calls, rows and time of each stage.
#[derive(Clone, Debug)]
pub struct StageTimes([StageRow; Stage::ALL.len()]);

impl Default for StageTimes {
    fn default() -> Self {
        Self(Stage::ALL.map(|stage| StageRow { stage, calls: 0, items: 0, lanes: 0, time: Duration::ZERO }))
    }
}

impl Probe for StageTimes {
    #[inline(always)]
    fn stage<T>(&mut self, stage: Stage, items: usize, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        let row = &mut self.0[stage as usize];
        row.time += start.elapsed();
        row.calls += 1;
        row.items += items as u64;
        row.lanes += items.next_multiple_of(MAX_LANES) as u64;
        result
    }
    fn rows(&self) -> Vec<StageRow> {
        self.0.to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_fill_lanes_eight_at_a_time() {
        let mut probe = StageTimes::default();
        for items in [16, 9, 0, 1] {
            probe.stage(Stage::Shade, items, || ());
        }
        let rows = probe.rows();
        let row = rows.iter().find(|r| r.stage == Stage::Shade).unwrap();
        assert_eq!((row.calls, row.items, row.lanes), (4, 26, 40));
        assert_eq!(row.occupancy(), 0.65);
        assert_eq!(rows[0].occupancy(), 1.0);
    }
}
