//! The options of `wavetrace chart`.

use crate::cli::choices::{Effort, Method, Sampler, word};
use crate::cli::values::{seconds, size};
use clap::{Args, value_parser};
use std::path::PathBuf;
use wavetrace::chart::sweep::{DEFAULT_SPP, MAX_SEEDS, MAX_SPP, Series};
use wavetrace::render::{MAX_THREADS, Settings};

const SPP_HELP: &str = "Samples per pixel, separated by commas [default: 1,2,4,8,16,32,64]";

/// Arguments of `wavetrace chart`.
#[derive(Debug, Args)]
pub struct ChartArgs {
    /// The scenes; their names must differ
    #[arg(value_name = "SCENE.json", required = true)]
    pub scenes: Vec<PathBuf>,
    /// Folder for chart.csv, chart.svg, chart.png and index.html; one that holds a part of the same chart is gone on with
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,

    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = value_parser!(u32).range(1..=MAX_SPP as i64),
        allow_negative_numbers = true, help = SPP_HELP, help_heading = "What is measured")]
    pub spp: Vec<u32>,
    /// 1, 2, 4, ... samples per pixel, until a render takes so many seconds
    #[arg(long, value_name = "S", value_parser = seconds, conflicts_with = "spp", allow_negative_numbers = true,
        help_heading = "What is measured")]
    pub seconds: Option<f64>,
    /// How light is found, separated by commas
    #[arg(
        long,
        value_name = "LIST",
        value_enum,
        value_delimiter = ',',
        default_value = "path,nee,mis",
        help_heading = "What is measured"
    )]
    pub methods: Vec<Method>,
    /// Where random numbers come from, separated by commas
    #[arg(
        long,
        value_name = "LIST",
        value_enum,
        value_delimiter = ',',
        default_value = "xoshiro,sobol",
        help_heading = "What is measured"
    )]
    pub samplers: Vec<Sampler>,
    /// Which tiles get how many samples, separated by commas
    #[arg(
        long,
        value_name = "LIST",
        value_enum,
        value_delimiter = ',',
        default_value = "even",
        help_heading = "What is measured"
    )]
    pub efforts: Vec<Effort>,
    /// Renders of each kind: with seeds 1 to N
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=MAX_SEEDS as i64), default_value_t = 10,
        allow_negative_numbers = true, help_heading = "What is measured")]
    pub seeds: u32,

    /// What images are held against: one file for each scene in their order, or two, independent halves of a reference
    /// [default: rendered with 16 times the samples of the largest budget]
    #[arg(long, value_name = "R.exr", help_heading = "What it is held against")]
    pub reference: Vec<PathBuf>,
    /// Measurements of another program, in columns as those of chart.csv; repeatable
    #[arg(long, value_name = "PEER.csv", help_heading = "What it is held against")]
    pub import: Vec<PathBuf>,

    /// Pixels across and down, in place of the cameras'
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true, help_heading = "Renders")]
    pub size: Option<(u32, u32)>,
    /// Bounces at most [default: unlimited, ended by Russian roulette]
    #[arg(long, value_name = "N", allow_negative_numbers = true, help_heading = "Renders")]
    pub max_depth: Option<u32>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=MAX_THREADS as i64),
        allow_negative_numbers = true, help_heading = "Renders")]
    pub threads: Option<u32>,
    /// No progress and no messages but errors
    #[arg(short, long, help_heading = "Messages")]
    pub quiet: bool,
}

impl ChartArgs {
    /// The ladder of samples, in rising order, where it does not follow from a time.
    pub fn budgets(&self) -> Vec<u32> {
        let mut budgets = if self.spp.is_empty() { DEFAULT_SPP.to_vec() } else { self.spp.clone() };
        budgets.sort_unstable();
        budgets.dedup();
        budgets
    }
    /// Each method with each sampler and each way to share out samples, once.
    pub fn series(&self) -> Vec<Series> {
        let mut series: Vec<Series> = Vec::new();
        let each = self.methods.iter().flat_map(|m| self.samplers.iter().map(move |s| (*m, *s)));
        for (method, sampler, effort) in each.flat_map(|(m, s)| self.efforts.iter().map(move |e| (m, s, *e))) {
            let mut label = format!("{} {}", word(method), word(sampler));
            if effort != Effort::default() {
                label = format!("{label} {}", word(effort));
            }
            if series.iter().all(|known| known.label != label) {
                let (method, sampler, effort) = (method.into(), sampler.into(), effort.into());
                series.push(Series { label, settings: Settings { method, sampler, effort, ..self.settings() } });
            }
        }
        series
    }
    /// Settings of all renders, references too: what is not measured goes by the default method.
    pub fn settings(&self) -> Settings {
        Settings { threads: self.threads.unwrap_or(0) as usize, max_depth: self.max_depth, ..Settings::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Program {
        #[command(flatten)]
        args: ChartArgs,
    }

    fn parsed(args: &[&str]) -> Result<ChartArgs, clap::Error> {
        Program::try_parse_from([&["chart", "a.json", "-o", "out"], args].concat()).map(|program| program.args)
    }

    #[test]
    fn every_method_goes_with_every_sampler() {
        let labels = |args: &[&str]| parsed(args).unwrap().series().into_iter().map(|s| s.label).collect::<Vec<_>>();
        let all = ["path xoshiro", "path sobol", "nee xoshiro", "nee sobol", "mis xoshiro", "mis sobol"];
        assert_eq!(labels(&[]), all);
        assert_eq!(labels(&["--methods", "mis,path,mis", "--samplers", "sobol"]), ["mis sobol", "path sobol"]);
        assert_eq!(
            labels(&["--methods", "mis", "--samplers", "sobol", "--efforts", "even,tiles"]),
            ["mis sobol", "mis sobol tiles"]
        );
        let series = parsed(&["--max-depth", "3", "--threads", "2"]).unwrap().series();
        assert!(series.iter().all(|s| s.settings.threads == 2 && s.settings.max_depth == Some(3)));
        assert_eq!(series[2].settings.method, wavetrace::wave::Method::Nee);
        assert_eq!(series[3].settings.sampler, wavetrace::render::SamplerKind::Sobol);
    }

    #[test]
    fn budgets_rise() {
        assert_eq!(parsed(&[]).unwrap().budgets(), DEFAULT_SPP);
        assert_eq!(parsed(&["--spp", "16,1,4,1"]).unwrap().budgets(), [1, 4, 16]);
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        for args in [
            &["--spp", "0"][..],
            &["--spp", "1,,2"],
            &["--spp", "268435456"],
            &["--spp", "1", "--seconds", "1"],
            &["--seconds", "0"],
            &["--seconds", "-1"],
            &["--seconds", "nan"],
            &["--seconds", "1e7"],
            &["--seeds", "0"],
            &["--seeds", "1001"],
            &["--methods", "bdpt"],
            &["--samplers", ""],
            &["--size", "0x1"],
        ] {
            assert!(parsed(args).is_err(), "{args:?}");
        }
        assert!(parsed(&["--spp", "268435455", "--seeds", "1000"]).is_ok());
    }
}
