//! The table of verbs and options.

pub use super::args_compare::CompareArgs;
use super::chart::ChartArgs;
use super::choices::{Integrator, Method, Quality, Sampler, ToneMap, UpAxis};
use super::values::{exposure, light_paths, size};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, value_parser};
use std::path::PathBuf;
use std::sync::LazyLock;
use wavetrace::DVec3;
use wavetrace::accel::BuildOptions;
use wavetrace::bench::{Kernel, Options, SetKind, View};
use wavetrace::lanes;
use wavetrace::output::Tone;
use wavetrace::render::{DEFAULT_LIGHT_PATHS, DEFAULT_WAVE, MAX_THREADS, MAX_WAVE, Settings};

static VERSION: LazyLock<String> = LazyLock::new(|| format!("{} (SIMD: {})", env!("CARGO_PKG_VERSION"), lanes::simd()));

const EXAMPLES: &str = "\
Examples:
  wavetrace scene.json                      a preview: one sample per pixel, named after the time
  wavetrace scene.json 256 -o image.png     256 samples per pixel
  wavetrace scene.json 64 -o a.exr -o a.png --size 1920x1080 --stats a.json
  wavetrace check scene.json                are there mistakes, and what is in it?
  wavetrace compare image.exr reference.exr how far is one from the other?
  wavetrace bench rays mesh.obj             how fast are rays traced?
  wavetrace chart scene.json -o charts      how fast does the error fall?
  wavetrace ./check                         a scene file that is called like a verb

Exit codes: 0 done; 1 the scene or a file is at fault; 2 the command line is; 130 interrupted (what was
rendered so far is written).";

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
    /// Measure how fast rays are traced
    #[command(
        subcommand,
        subcommand_help_heading = "What is measured",
        subcommand_value_name = "WHAT",
        disable_help_subcommand = true
    )]
    Bench(Bench),
    /// Chart the error of renders against time and samples
    Chart(ChartArgs),
}

/// What `wavetrace bench` measures.
#[derive(Debug, Subcommand)]
pub enum Bench {
    /// Rays per second on sets of rays in a mesh
    Rays(RaysArgs),
}

/// Arguments of `wavetrace bench rays`.
#[derive(Debug, Args)]
pub struct RaysArgs {
    /// The mesh; all its objects are one
    #[arg(value_name = "MESH.obj")]
    pub mesh: PathBuf,
    /// Which sets, separated by commas [default: all, or all that --load finds]
    #[arg(long, value_name = "SETS", value_delimiter = ',', value_parser = set_kind())]
    pub rays: Vec<SetKind>,
    /// Pixels across and down, a multiple of 8
    #[arg(long, value_name = "N", default_value_t = Options::default().res, allow_negative_numbers = true)]
    pub res: u32,
    /// Eye, direction and angle across the image in degrees: ox,oy,oz,dx,dy,dz,fov [default: chosen by the mesh]
    #[arg(long, value_name = "CAMERA", value_parser = view, allow_hyphen_values = true)]
    pub camera: Option<View>,
    /// Which axis points up
    #[arg(long, value_name = "AXIS", value_enum, default_value_t)]
    pub up: UpAxis,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = Options::default().seed, allow_negative_numbers = true)]
    pub seed: u64,
    /// Trace the files SET.rays of this folder instead of making rays
    #[arg(long, value_name = "DIR", conflicts_with_all = ["res", "camera", "up", "seed"])]
    pub load: Option<PathBuf>,
    /// Write SET.rays and SET.hits into this folder
    #[arg(long, value_name = "DIR")]
    pub dump: Option<PathBuf>,
    /// How rays are traced
    #[arg(long, value_name = "KERNEL", default_value = Kernel::default().name(), value_parser = kernel())]
    pub kernel: Kernel,
    /// Threads, each on a CPU of its own where there are as many
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=MAX_THREADS as i64), default_value_t = 1,
        allow_negative_numbers = true)]
    pub threads: u32,
    /// How often each set is timed
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1000), default_value_t = 5,
        allow_negative_numbers = true)]
    pub repeats: u32,
    /// Figures as JSON
    #[arg(long)]
    pub json: bool,
}

impl RaysArgs {
    /// The sets that were asked for, each once, in the order of reports.
    pub fn kinds(&self) -> Vec<SetKind> {
        SetKind::ALL.into_iter().filter(|kind| self.rays.is_empty() || self.rays.contains(kind)).collect()
    }
    /// How rays are made.
    pub fn options(&self) -> Options {
        Options { res: self.res, seed: self.seed, up: self.up.into(), view: self.camera }
    }
}

/// A value that is one of a few names, as what the name stands for.
fn named<T: Clone + Send + Sync + 'static>(
    names: impl IntoIterator<Item = &'static str>,
    of: fn(&str) -> Option<T>,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names.into_iter().collect::<Vec<_>>())
        .try_map(move |name| of(&name).ok_or("no such name".to_owned()))
}

fn set_kind() -> impl TypedValueParser<Value = SetKind> {
    named(SetKind::ALL.map(SetKind::name), SetKind::from_name)
}

fn kernel() -> impl TypedValueParser<Value = Kernel> {
    named(Kernel::ALL.iter().map(|kernel| kernel.1), Kernel::from_name)
}

/// `ox,oy,oz,dx,dy,dz,fov`.
fn view(text: &str) -> Result<View, String> {
    let numbers: Vec<f64> = text.split(',').map_while(|word| word.trim().parse().ok()).collect();
    match (numbers.as_slice(), text.split(',').count()) {
        (&[ox, oy, oz, dx, dy, dz, fov], 7) => {
            Ok(View { eye: DVec3::new(ox, oy, oz), direction: DVec3::new(dx, dy, dz), fov })
        }
        _ => Err("expected seven numbers: ox,oy,oz,dx,dy,dz,fov".to_owned()),
    }
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
    /// Seed of the random numbers; the same seed gives the same image, on any number of threads
    #[arg(long, value_name = "N", default_value_t, allow_negative_numbers = true, help_heading = "Light transport")]
    pub seed: u64,
    /// Bounces at most [default: unlimited, ended by Russian roulette]
    #[arg(long, value_name = "N", allow_negative_numbers = true, help_heading = "Light transport")]
    pub max_depth: Option<u32>,

    /// Light paths per camera path, which find light that mirrors and glass focus; only with `--method mis`, and only
    /// where the scene has both such surfaces and others. 0: none
    #[arg(long, value_name = "N", default_value_t = DEFAULT_LIGHT_PATHS, allow_negative_numbers = true,
        value_parser = light_paths, help_heading = "Light transport")]
    pub light_paths: f32,

    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=MAX_THREADS as i64),
        allow_negative_numbers = true, help_heading = "Machine")]
    pub threads: Option<u32>,
    /// Paths in flight per thread; changes the speed, not the image
    #[arg(long, value_name = "N", default_value_t = DEFAULT_WAVE as u32, allow_negative_numbers = true,
        value_parser = value_parser!(u32).range(1..=MAX_WAVE as i64), help_heading = "Machine")]
    pub wave: u32,
    /// What the tree over the triangles is built for; changes the speed, not the image
    #[arg(long, value_name = "QUALITY", value_enum, default_value_t, help_heading = "Machine")]
    pub bvh: Quality,
    /// Which integrator runs
    #[arg(long, value_name = "INTEGRATOR", value_enum, default_value_t, help_heading = "Machine")]
    pub integrator: Integrator,

    /// Write figures of the run: seconds, rays, stages, bytes
    #[arg(long, value_name = "FILE.json", help_heading = "Messages")]
    pub stats: Option<PathBuf>,
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
    /// What to render with.
    pub fn settings(&self) -> Settings {
        Settings {
            spp: self.given_spp().unwrap_or(1),
            seed: self.seed,
            threads: self.threads.unwrap_or(0) as usize,
            max_depth: self.max_depth,
            method: self.method.into(),
            sampler: self.sampler.into(),
            wave_size: self.wave as usize,
            light_paths: self.light_paths,
            integrator: self.integrator.into(),
            time_stages: self.stats.is_some(),
        }
    }
    /// How the tree is built.
    pub fn build_options(&self) -> BuildOptions {
        BuildOptions { quality: self.bvh.into(), threads: self.threads.unwrap_or(0) as usize }
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
        let built = parse(&["--bvh", "best", "--threads", "3"]).build_options();
        assert_eq!(built, BuildOptions { quality: wavetrace::accel::Quality::Best, threads: 3 });
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
            "--wave",
            "64",
            "--light-paths",
            "0.5",
            "--integrator",
            "reference",
            "--stats",
            "s.json",
            "--exposure",
            "-1.5",
            "--tonemap",
            "max",
        ]);
        let expected = Settings {
            spp: 9,
            seed: u64::MAX,
            threads: 3,
            max_depth: Some(0),
            method: wavetrace::wave::Method::Nee,
            sampler: wavetrace::render::SamplerKind::Sobol,
            wave_size: 64,
            light_paths: 0.5,
            integrator: wavetrace::render::Integrator::Reference,
            time_stages: true,
        };
        assert_eq!(args.settings(), expected);
        assert_eq!(args.tone(), Tone { exposure_ev: -1.5, map: wavetrace::output::ToneMap::Max });
    }
}
