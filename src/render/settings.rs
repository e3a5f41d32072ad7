//! What to render with.

use super::rounds::REPLICATES;
use crate::error::{Error, Result};
use crate::probe::Asked;
use crate::wave::{Method, Tuning};
use std::time::Duration;

/// Where random numbers come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Independent streams.
    Xoshiro,
    /// Owen-scrambled Sobol points.
    #[default]
    Sobol,
}

/// Which tiles get how many samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// All the same.
    #[default]
    Even,
    /// Tiles with more error get more, as a few samples tell that are traced before and are no part of the image.
    Tiles,
}

/// Which integrator runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Waves of paths through batched stages.
    #[default]
    Wavefront,
    /// One path after the other, one lane, but eight boxes or triangles of the tree at once: the oracle.
    Reference,
    /// The same with one box and one triangle at a time: scalar throughout, the baseline.
    Scalar,
}

/// What to render with.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Samples per pixel, at least 1; at most so many where the time or the error decides.
    pub spp: u32,
    /// When to end at the latest, counted from the start of the render; [`Duration::MAX`] never. Every pixel gets a sample
    /// even so.
    pub time: Duration,
    /// End once the estimated relMSE of the image is this small, more than 0; `None` does not estimate it.
    pub target_error: Option<f64>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Threads; 0 for all cores.
    pub threads: usize,
    /// Bounces at most; `None` leaves it to roulette.
    pub max_depth: Option<u32>,
    /// How light is found.
    pub method: Method,
    /// Where random numbers come from.
    pub sampler: SamplerKind,
    /// Which tiles get how many samples; their mean over the pixels is `spp` at most.
    pub effort: Effort,
    /// Paths in flight per worker, at least 1.
    pub wave_size: usize,
    /// Light paths per camera path, where mirrors or glass can focus light; 0 for none, at most [`MAX_LIGHT_PATHS`]. Paths
    /// that look for such light where light paths cannot show it grow more frequent along with them.
    pub light_paths: f32,
    /// Which integrator runs.
    pub integrator: Integrator,
    /// Choices of speed; where [`Effort::Tiles`] cuts the image its own way, its jobs are no larger than its tiles.
    pub tuning: Tuning,
    /// Whether the stages are timed.
    pub time_stages: bool,
    /// Whether it is noted, too, what each worker did when.
    pub timeline: bool,
    /// Whether hardware counters are read before and after each stage, where the machine has them; that takes some per cent of
    /// the time itself.
    pub counters: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            spp: 1,
            time: Duration::MAX,
            target_error: None,
            seed: 0,
            threads: 0,
            max_depth: None,
            method: Method::Mis,
            sampler: SamplerKind::Sobol,
            effort: Effort::Even,
            wave_size: DEFAULT_WAVE,
            light_paths: DEFAULT_LIGHT_PATHS,
            integrator: Integrator::Wavefront,
            tuning: Tuning::default(),
            time_stages: false,
            timeline: false,
            counters: false,
        }
    }
}

/// Paths in flight per worker unless set: their queues fit a core's own cache.
pub const DEFAULT_WAVE: usize = 4096;
/// Paths in flight per worker at most.
pub const MAX_WAVE: usize = 1 << 22;
/// Light paths per camera path unless set, where the scene needs any.
pub const DEFAULT_LIGHT_PATHS: f32 = 0.1;
/// Light paths per camera path at most.
pub const MAX_LIGHT_PATHS: f32 = 1000.0;
/// Threads at most.
pub const MAX_THREADS: usize = 1024;

impl Settings {
    /// Share of the camera paths that look for focused light where as much of it arrives as on average, to
    /// [`Spots::new`](crate::light::Spots::new): what is seen in mirrors and through glass gets effort along with what light
    /// paths can show (docs/decisions/light-paths.md).
    pub(super) fn looks(&self) -> f32 {
        5.0 * self.light_paths
    }
    /// Whether there is a clock in the stages.
    pub(super) fn is_timed(&self) -> bool {
        self.time_stages || self.timeline || self.counters
    }
    pub(super) fn asked(&self) -> Asked {
        Asked { timeline: self.timeline, counters: self.counters }
    }
    pub(super) fn check(&self) -> Result<()> {
        let wrong = |setting, found: usize, expected: String| {
            Err(Error::Setting { setting, found: found.to_string(), expected })
        };
        match self {
            Self { spp: 0, .. } => wrong("--spp", 0, "at least 1".into()),
            Self { wave_size, .. } if !(1..=MAX_WAVE).contains(wave_size) => {
                wrong("--wave", *wave_size, format!("1 to {MAX_WAVE}"))
            }
            Self { threads, .. } if *threads > MAX_THREADS => {
                wrong("--threads", *threads, format!("at most {MAX_THREADS}"))
            }
            Self { light_paths, .. } if !(0.0..=MAX_LIGHT_PATHS).contains(light_paths) => Err(Error::Setting {
                setting: "--light-paths",
                found: light_paths.to_string(),
                expected: format!("0 to {MAX_LIGHT_PATHS}"),
            }),
            Self { target_error: Some(error), .. } if !(*error > 0.0 && error.is_finite()) => Err(Error::Setting {
                setting: "--target-error",
                found: error.to_string(),
                expected: "a number above 0".into(),
            }),
            Self { target_error: Some(_), spp, .. } if *spp < REPLICATES => wrong(
                "--spp",
                *spp as usize,
                format!("at least {REPLICATES}, where --target-error estimates the error"),
            ),
            _ => Ok(()),
        }
    }
}
