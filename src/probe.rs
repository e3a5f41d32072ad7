//! What is measured inside the wave loop, and what it costs to measure nothing: no instruction.

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
    /// Removal of paths that ended.
    Compact,
    /// Samples into pixels.
    Accumulate,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Stage; 9] = [
        Stage::Generate,
        Stage::Intersect,
        Stage::Route,
        Stage::Escape,
        Stage::Emit,
        Stage::Shade,
        Stage::Connect,
        Stage::Compact,
        Stage::Accumulate,
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
            Stage::Compact => "compact",
            Stage::Accumulate => "accumulate",
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
    /// Time spent in it, summed over threads.
    pub time: Duration,
}

/// Measures calls, rows and time of each stage.
#[derive(Clone, Debug)]
pub struct StageTimes([StageRow; Stage::ALL.len()]);

impl Default for StageTimes {
    fn default() -> Self {
        Self(Stage::ALL.map(|stage| StageRow { stage, calls: 0, items: 0, time: Duration::ZERO }))
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
        result
    }
    fn rows(&self) -> Vec<StageRow> {
        self.0.to_vec()
    }
}
