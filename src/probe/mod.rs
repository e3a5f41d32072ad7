//! What is measured inside the wave loop, and what it costs to measure nothing: no instruction.

mod counters;
mod timeline;
mod times;

pub use counters::{COUNTED, Counted, Counters};
pub use timeline::{Clock, Event, What, period, thin};
pub use times::{DEPTHS, DepthRow, StageRow, StageTimes};

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
pub trait Probe: Sized + Send {
    /// Has seen nothing. On the thread that it sees.
    fn new(asked: Asked) -> Self;
    /// Runs `work` on `items` rows as stage `stage`. Runs on no rows may count as none.
    fn stage<T>(&mut self, stage: Stage, items: usize, work: impl FnOnce() -> T) -> T;
    /// Runs work that holds stages, or none.
    #[inline(always)]
    fn span<T>(&mut self, _what: What, work: impl FnOnce(&mut Self) -> T) -> T {
        work(self)
    }
    /// Tells of the wave whose stages follow how many bounces its rows have; the last `fresh` ones have none.
    #[inline(always)]
    fn wave(&mut self, _depths: &[u32], _fresh: usize) {}
    /// What was seen; nothing where nothing is measured.
    fn seen(self) -> Seen {
        Seen::default()
    }
}

/// What is asked of a probe that measures.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked {
    /// Events.
    pub timeline: bool,
    /// Hardware counters, where there are any.
    pub counters: bool,
}

/// What a probe saw.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// One row per stage.
    pub stages: Vec<StageRow>,
    /// What began when, and how long it took.
    pub events: Vec<Event>,
}

/// Measures nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProbe;

impl Probe for NoProbe {
    #[inline(always)]
    fn new(_asked: Asked) -> Self {
        Self
    }
    #[inline(always)]
    fn stage<T>(&mut self, _stage: Stage, _items: usize, work: impl FnOnce() -> T) -> T {
        work()
    }
}
