//! The table of verbs and options.

pub use super::args_compare::CompareArgs;
pub use super::bench::BenchArgs;
use super::chart::ChartArgs;
use super::choices::{BounceRays, CameraRays, Effort, Integrator, Method, Quality, Sampler, Sort, Switch, ToneMap};
use super::profile::ProfileArgs;
use super::values::{error, exposure, light_paths, seconds, size};
use clap::{Args, Parser, Subcommand, value_parser};
use std::path::PathBuf;
use std::sync::LazyLock;
use std::time::Duration;
use wavetrace::accel::{BuildOptions, MAX_LEAF};
use wavetrace::lanes;
use wavetrace::output::Tone;
use wavetrace::render::{DEFAULT_LIGHT_PATHS, DEFAULT_WAVE, MAX_THREADS, MAX_WAVE, Settings};
use wavetrace::wave::{DEFAULT_JOB, Tuning};

static VERSION: LazyLock<String> = LazyLock::new(|| format!("{} (SIMD: {})", env!("CARGO_PKG_VERSION"), lanes::simd()));

const EXAMPLES: &str = "\
Examples:
  wavetrace scene.json                      a preview: one sample per pixel, named after the time
  wavetrace scene.json 256 -o image.png     256 samples per pixel
  wavetrace scene.json 64 -o a.exr -o a.png --size 1920x1080 --stats a.json
  wavetrace check scene.json                are there mistakes, and what is in it?
  wavetrace compare image.exr reference.exr how far is one from the other?
  wavetrace bench --save before             how fast is all of it?
  wavetrace bench rays mesh.obj             how fast are rays traced?
  wavetrace chart scene.json -o charts      how fast does the error fall?
  wavetrace profile scene.json -o profile   where does the time go?
  wavetrace ./check                         a scene file that is called like a verb

Exit codes: 0 done; 1 the scene or a file is at fault; 2 the command line is; 3 `bench --against` found something
slower, `bench tax` something above its bar; 130 interrupted (what was rendered so far is written).";

/// Heading of the options that change the speed, not the image.
const SPEED: &str = "Speed alone: the image stays the same";

const OUTPUT_HELP: &str = "\
Image file, repeatable; its ending picks the format: .png, .ppm, .exr (float, linear), .hdr
[default: a new PNG in this folder, named after the time]";

/// Renders a scene by path tracing.
#[derive(Debug, Parser)]
#[command(
    name = "wavetrace",
    version = VERSION.as_str(),
    after_help = EXAMPLES,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    disable_help_subcommand = true,
    arg_required_else_help = true,
    subcommand_help_heading = "Verbs",
    subcommand_value_name = "VERB"
)]
pub struct Cli {
    /// What to do instead of rendering.
    #[command(subcommand)]
    pub verb: Option<Verb>,
    /// What to render, and how.
    #[command(flatten)]
    pub render: Option<RenderArgs>,
}

/// What the program does besides rendering.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Load a scene and its meshes; show all mistakes, or what is in it
    Check(CheckArgs),
    /// Compare an image with a reference: errors, FLIP, a t-test
    Compare(CompareArgs),
    /// Measure how fast the program is
    #[command(
        subcommand_help_heading = "What is measured instead of the standard suite",
        subcommand_value_name = "WHAT",
        disable_help_subcommand = true
    )]
    Bench(BenchArgs),
    /// Chart the error of renders against time and samples
    Chart(ChartArgs),
    /// Show where the time and the memory of a render go
    Profile(ProfileArgs),
}

/// Arguments of `wavetrace check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// The scene
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,
    /// Warnings become errors
    #[arg(long)]
    pub strict: bool,
}

/// Arguments of a render.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The scene
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,
    /// Samples per pixel, as --spp
    #[arg(value_name = "SPP", value_parser = value_parser!(u32).range(1..), allow_negative_numbers = true)]
    pub spp: Option<u32>,

    /// Samples per pixel [default: 1, a preview]
    #[arg(long = "spp", value_name = "N", value_parser = value_parser!(u32).range(1..), conflicts_with = "spp",
        allow_negative_numbers = true, help_heading = "Image")]
    pub spp_option: Option<u32>,
    /// End once so many seconds of rendering are spent; --spp is then the most, by default without limit
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true, help_heading = "Image")]
    pub time: Option<f64>,
    /// End once the image's estimated relMSE is this small; --spp is then the most, by default without limit
    #[arg(long, value_name = "E", value_parser = error, allow_hyphen_values = true, help_heading = "Image")]
    pub target_error: Option<f64>,
    /// Pixels across and down, in place of the camera's
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true, help_heading = "Image")]
    pub size: Option<(u32, u32)>,
    #[arg(short, long, value_name = "FILE", help_heading = "Image", help = OUTPUT_HELP)]
    pub output: Vec<PathBuf>,
    /// Write the variances of the pixels' means too, into .exr files
    #[arg(long, help_heading = "Image")]
    pub variance: bool,
    /// Exposure of 8-bit images, in stops
    #[arg(long, value_name = "EV", default_value = "0", value_parser = exposure, allow_hyphen_values = true,
        help_heading = "Image")]
    pub exposure: f32,
    /// How 8-bit images show what is brighter than 1
    #[arg(long, value_name = "MAP", value_enum, default_value_t, help_heading = "Image")]
    pub tonemap: ToneMap,

    /// How light is found
    #[arg(long, value_name = "METHOD", value_enum, default_value_t, help_heading = "Light transport")]
    pub method: Method,
    /// Where random numbers come from
    #[arg(long, value_name = "SAMPLER", value_enum, default_value_t, help_heading = "Light transport")]
    pub sampler: Sampler,
    /// Which tiles of the image get how many samples; --spp is the mean
    #[arg(long, value_name = "EFFORT", value_enum, default_value_t, help_heading = "Light transport")]
    pub effort: Effort,
    /// Seed of the random numbers; the same seed gives the same image, on any number of threads
    #[arg(long, value_name = "N", default_value_t, allow_negative_numbers = true, help_heading = "Light transport")]
    pub seed: u64,
    /// Bounces at most [default: unlimited, ended by Russian roulette]
    #[arg(long, value_name = "N", allow_negative_numbers = true, help_heading = "Light transport")]
    pub max_depth: Option<u32>,

    /// Light paths per camera path, which find light that mirrors and glass focus, and along with them the effort to find
    /// it through mirrors and glass; only with `--method mis`, and only where the scene has both such surfaces and
    /// others. 0: none
    #[arg(long, value_name = "N", default_value_t = DEFAULT_LIGHT_PATHS, allow_negative_numbers = true,
        value_parser = light_paths, help_heading = "Light transport")]
    pub light_paths: f32,

    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=MAX_THREADS as i64),
        allow_negative_numbers = true, help_heading = "Machine")]
    pub threads: Option<u32>,
    /// What the tree over the triangles is built for
    #[arg(long, value_name = "QUALITY", value_enum, default_value_t, help_heading = SPEED)]
    pub bvh: Quality,
    /// Triangles of the tree's leaves at most
    #[arg(long, value_name = "N", default_value_t = MAX_LEAF as u32, allow_negative_numbers = true,
        value_parser = value_parser!(u32).range(1..=MAX_LEAF as i64), help_heading = SPEED)]
    pub leaf: u32,
    /// Paths in flight per thread
    #[arg(long, value_name = "N", default_value_t = DEFAULT_WAVE as u32, allow_negative_numbers = true,
        value_parser = value_parser!(u32).range(1..=MAX_WAVE as i64), help_heading = SPEED)]
    pub wave: u32,
    /// Paths that a thread takes on at a time, at least
    #[arg(long, value_name = "N", default_value_t = DEFAULT_JOB, allow_negative_numbers = true,
        value_parser = value_parser!(u32).range(1..), help_heading = SPEED)]
    pub job: u32,
    /// Whether new paths take the place of those that ended at once, or once all have ended
    #[arg(long, value_name = "REFILL", value_enum, default_value_t, help_heading = SPEED)]
    pub refill: Switch,
    /// How camera rays are traced
    #[arg(long, value_name = "KERNEL", value_enum, default_value_t, help_heading = SPEED)]
    pub camera_rays: CameraRays,
    /// How other rays are traced
    #[arg(long, value_name = "KERNEL", value_enum, default_value_t, help_heading = SPEED)]
    pub bounce_rays: BounceRays,
    /// When paths are sorted by what they hit
    #[arg(long, value_name = "WHEN", value_enum, default_value_t, help_heading = SPEED)]
    pub sort: Sort,
    /// Which integrator runs
    #[arg(long, value_name = "INTEGRATOR", value_enum, default_value_t, help_heading = SPEED)]
    pub integrator: Integrator,

    /// Write figures of the run: seconds, rays, stages, bytes
    #[arg(long, value_name = "FILE.json", help_heading = "Messages")]
    pub stats: Option<PathBuf>,
    /// Read the machine's counters in each stage, for --stats; takes some per cent of the time itself
    #[arg(long, requires = "stats", help_heading = "Messages")]
    pub counters: bool,
    /// Write what each worker did when, for Perfetto and chrome://tracing
    #[arg(long, value_name = "FILE.json", help_heading = "Messages")]
    pub trace: Option<PathBuf>,
    /// Show which stages this scene needs and which it leaves out; render nothing
    #[arg(long, help_heading = "Messages")]
    pub explain: bool,
    /// No progress bar and no messages but errors
    #[arg(short, long, help_heading = "Messages")]
    pub quiet: bool,
    /// Warnings become errors
    #[arg(long, help_heading = "Messages")]
    pub strict: bool,
}

impl RenderArgs {
    /// Samples per pixel, where the user said how many.
    pub fn given_spp(&self) -> Option<u32> {
        self.spp.or(self.spp_option)
    }
    /// Whether the time or the error decides how many samples there are.
    pub fn is_open(&self) -> bool {
        self.time.is_some() || self.target_error.is_some()
    }
    /// What to render with.
    pub fn settings(&self) -> Settings {
        Settings {
            spp: self.given_spp().unwrap_or(if self.is_open() { u32::MAX } else { 1 }),
            time: self.time.map_or(Duration::MAX, Duration::from_secs_f64),
            target_error: self.target_error,
            seed: self.seed,
            threads: self.threads.unwrap_or(0) as usize,
            max_depth: self.max_depth,
            method: self.method.into(),
            sampler: self.sampler.into(),
            effort: self.effort.into(),
            wave_size: self.wave as usize,
            light_paths: self.light_paths,
            integrator: self.integrator.into(),
            tuning: self.tuning(),
            time_stages: self.stats.is_some(),
            timeline: self.trace.is_some(),
            counters: self.counters,
        }
    }
    /// Choices of speed.
    fn tuning(&self) -> Tuning {
        Tuning {
            refill: self.refill == Switch::On,
            tiles: self.camera_rays == CameraRays::Tile,
            streams: self.bounce_rays == BounceRays::Stream,
            sort_always: self.sort == Sort::Always,
            job: self.job,
        }
    }
    /// How the tree is built.
    pub fn build_options(&self) -> BuildOptions {
        let threads = self.threads.unwrap_or(0) as usize;
        BuildOptions { quality: self.bvh.into(), threads, leaf: self.leaf as usize }
    }
    /// How 8-bit images show radiance.
    pub fn tone(&self) -> Tone {
        Tone { exposure_ev: self.exposure, map: self.tonemap.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_table_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn options_become_settings() {
        let parse =
            |args: &[&str]| Cli::try_parse_from([&["wavetrace", "a.json"], args].concat()).unwrap().render.unwrap();
        assert_eq!(parse(&[]).settings(), Settings::default());
        assert_eq!(parse(&[]).build_options(), BuildOptions::default());
        assert_eq!(parse(&["--time", "9"]).settings().spp, u32::MAX);
        let built = parse(&["--bvh", "best", "--threads", "3", "--leaf", "4"]).build_options();
        assert_eq!(built, BuildOptions { quality: wavetrace::accel::Quality::Best, threads: 3, leaf: 4 });
        let args = parse(&[
            "9",
            "--seed",
            "18446744073709551615",
            "--threads",
            "3",
            "--max-depth",
            "0",
            "--method",
            "nee",
            "--sampler",
            "sobol",
            "--effort",
            "tiles",
            "--wave",
            "64",
            "--light-paths",
            "0.5",
            "--integrator",
            "reference",
            "--time",
            "1.5",
            "--target-error",
            "0.01",
            "--stats",
            "s.json",
            "--counters",
            "--trace",
            "t.json",
            "--refill",
            "off",
            "--camera-rays",
            "stream",
            "--bounce-rays",
            "many",
            "--sort",
            "always",
            "--job",
            "9",
            "--exposure",
            "-1.5",
            "--tonemap",
            "max",
        ]);
        let expected = Settings {
            spp: 9,
            time: Duration::from_millis(1500),
            target_error: Some(0.01),
            seed: u64::MAX,
            threads: 3,
            max_depth: Some(0),
            method: wavetrace::wave::Method::Nee,
            sampler: wavetrace::render::SamplerKind::Sobol,
            effort: wavetrace::render::Effort::Tiles,
            wave_size: 64,
            light_paths: 0.5,
            integrator: wavetrace::render::Integrator::Reference,
            tuning: Tuning { refill: false, tiles: false, streams: false, sort_always: true, job: 9 },
            time_stages: true,
            timeline: true,
            counters: true,
        };
        assert_eq!(args.settings(), expected);
        assert_eq!(args.tone(), Tone { exposure_ev: -1.5, map: wavetrace::output::ToneMap::Max });
    }
}
