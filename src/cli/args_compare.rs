//! Arguments of `wavetrace compare`.

use super::choices::Metric;
use super::values::exposure;
use clap::{Args, ValueEnum, value_parser};
use std::path::PathBuf;

/// Arguments of `wavetrace compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// The image: PNG, PPM, OpenEXR or Radiance HDR
    #[arg(value_name = "A")]
    pub image: PathBuf,
    /// The reference, of the same size
    #[arg(value_name = "B")]
    pub reference: PathBuf,
    /// Which figures, separated by commas [default: all]
    #[arg(long, value_name = "METRICS", value_enum, value_delimiter = ',')]
    pub metric: Vec<Metric>,
    /// Write an image of the relative squared errors; of FLIP where that alone is asked for
    #[arg(long, value_name = "FILE.png")]
    pub heatmap: Option<PathBuf>,
    /// Standard deviations of the pixels' means, for a t-test; twice for A, then B
    #[arg(long, value_name = "FILE")]
    pub stddev: Vec<PathBuf>,
    /// The t-test takes squares of N x N pixels together [default: 1 for renders alike, else so many that each has 65536 samples]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=65536), allow_negative_numbers = true)]
    pub block: Option<u32>,
    /// Exposure for FLIP, in stops
    #[arg(long, value_name = "EV", default_value = "0", value_parser = exposure, allow_hyphen_values = true)]
    pub exposure: f32,
    /// Figures as JSON
    #[arg(long)]
    pub json: bool,
}

impl CompareArgs {
    /// Whether a figure was asked for.
    pub fn wants(&self, metric: Metric) -> bool {
        self.metric.is_empty() || self.metric.contains(&metric)
    }
    /// Whether FLIP alone was asked for.
    pub fn wants_flip_alone(&self) -> bool {
        let others = Metric::value_variants().iter().filter(|&&metric| metric != Metric::Flip);
        self.wants(Metric::Flip) && !others.copied().any(|metric| self.wants(metric))
    }
}
