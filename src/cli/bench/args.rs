//! The options of `wavetrace bench`.

use super::knob::{Knob, knob};
use crate::cli::choices::UpAxis;
use crate::cli::values::size;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand, ValueEnum, value_parser};
use std::path::PathBuf;
use wavetrace::DVec3;
use wavetrace::bench::suite::{Part, SIZES};
use wavetrace::bench::{Kernel, Options, SetKind, View};
use wavetrace::render::MAX_THREADS;
use wavetrace::wave::Feature;

/// Arguments of `wavetrace bench`.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct BenchArgs {
    /// What to measure instead of the standard suite.
    #[command(subcommand)]
    pub what: Option<Bench>,
    /// The standard suite.
    #[command(flatten)]
    pub suite: SuiteArgs,
}

/// Arguments of the standard suite.
#[derive(Debug, Args)]
pub struct SuiteArgs {
    /// Which parts, separated by commas [default: all]
    #[arg(long, value_name = "PARTS", value_delimiter = ',', value_parser = part())]
    pub only: Vec<Part>,
    /// Folder of the scenes that are rendered: all its .json files
    #[arg(long, value_name = "DIR", default_value = "scenes")]
    pub scenes: PathBuf,
    /// Most triangles of generated meshes; the largest takes 4 GB of memory and most of the time
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(SIZES[0] as i64..), default_value_t = 10_000_000,
        allow_negative_numbers = true)]
    pub up_to: u32,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=MAX_THREADS as i64),
        allow_negative_numbers = true)]
    pub threads: Option<u32>,
    /// How often everything is timed, in turns
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1000), default_value_t = 7,
        allow_negative_numbers = true)]
    pub repeats: u32,
    /// Figures as JSON
    #[arg(long)]
    pub json: bool,
    /// Keep the figures in the file NAME.json
    #[arg(long, value_name = "NAME")]
    pub save: Option<PathBuf>,
    /// Compare with the figures in NAME.json; exit code 3 where something is slower by more than --tolerance
    #[arg(long, value_name = "NAME")]
    pub against: Option<PathBuf>,
    /// How much slower something may be, in per cent
    #[arg(long, value_name = "PERCENT", value_parser = percent, default_value = "5", requires = "against",
        allow_hyphen_values = true)]
    pub tolerance: f64,
    /// Compare with figures of another machine, compiler, profile, instruction set, or of other settings, too
    #[arg(long, requires = "against")]
    pub force: bool,
    /// No progress and no messages but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// What `wavetrace bench` measures.
#[derive(Debug, Subcommand)]
pub enum Bench {
    /// Rays per second on sets of rays in a mesh
    Rays(RaysArgs),
    /// Throughput of renders against one setting or two
    Sweep(SweepArgs),
    /// What features cost scenes that lack them
    Tax(TaxArgs),
}

/// Arguments of `wavetrace bench sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// A scene; repeatable
    #[arg(long, value_name = "SCENE.json", required = true)]
    pub scene: Vec<PathBuf>,
    /// A knob and its values, once or twice: A,B,C or A..B in powers of two
    #[arg(long, value_name = "KNOB=VALUES", required = true, value_parser = knob)]
    pub vary: Vec<Knob>,
    /// A knob that stays as it is said; repeatable
    #[arg(long, value_name = "KNOB=VALUE", value_parser = setting)]
    pub set: Vec<Knob>,
    /// Pixels across and down
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "256x256", allow_hyphen_values = true)]
    pub size: (u32, u32),
    /// Samples per pixel
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..), default_value_t = 16,
        allow_negative_numbers = true)]
    pub spp: u32,
    /// How often each render is timed, in turns
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1000), default_value_t = 5,
        allow_negative_numbers = true)]
    pub repeats: u32,
    /// Folder for sweep.csv, sweep.svg, sweep.png and index.html
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// No progress and no messages but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// Arguments of `wavetrace bench tax`.
#[derive(Debug, Args)]
pub struct TaxArgs {
    /// Folder of the scenes: all its .json files
    #[arg(long, value_name = "DIR", default_value = "scenes")]
    pub scenes: PathBuf,
    /// A build without some features, to compare with in scenes that lack them: FEATURE+FEATURE=PROGRAM; repeatable
    #[arg(long, value_name = "FEATURES=PROGRAM", value_parser = without)]
    pub without: Vec<Without>,
    /// What is compared [default: instructions where valgrind is installed, else time]
    #[arg(long, value_name = "WHAT", value_enum)]
    pub by: Option<Measure>,
    /// More per cent of it than this are too many
    #[arg(long, value_name = "PERCENT", value_parser = percent, default_value = "0.5", allow_hyphen_values = true)]
    pub bar: f64,
    /// Pixels across and down
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "64x64", allow_hyphen_values = true)]
    pub size: (u32, u32),
    /// Samples per pixel [default: 16 to count instructions, 256 to take the time]
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=65536), allow_negative_numbers = true)]
    pub spp: Option<u32>,
    /// How often each render is timed, in turns; instructions are counted once
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=1000), default_value_t = 7,
        allow_negative_numbers = true)]
    pub repeats: u32,
    /// Write a page in Markdown
    #[arg(short, long, value_name = "FILE.md")]
    pub output: Option<PathBuf>,
    /// No progress and no messages but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// What is compared between builds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Measure {
    /// Instructions per sample, counted by valgrind: exact
    Instructions,
    /// Time per sample
    Time,
}

/// A build that lacks features.
#[derive(Clone, Debug)]
pub struct Without {
    /// What it lacks.
    pub features: Vec<Feature>,
    /// The program.
    pub program: PathBuf,
}

/// `FEATURE+FEATURE=PROGRAM`.
fn without(text: &str) -> Result<Without, String> {
    let (names, program) = text.split_once('=').ok_or("expected FEATURE+FEATURE=PROGRAM")?;
    let of = |name: &str| {
        let all = Feature::ALL.map(Feature::name).join(", ");
        Feature::from_name(name).ok_or(format!("expected features of {all}, found {name:?}"))
    };
    let features = names.split('+').map(of).collect::<Result<Vec<_>, _>>()?;
    Ok(Without { features, program: program.into() })
}

/// A knob with one value.
pub fn setting(text: &str) -> Result<Knob, String> {
    knob(text).and_then(|knob| if knob.values.len() == 1 { Ok(knob) } else { Err("expected one value".to_owned()) })
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

fn part() -> impl TypedValueParser<Value = Part> {
    named(Part::ALL.map(Part::name), Part::from_name)
}

/// Above 0 and below 100.
fn percent(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|x| *x > 0.0 && *x < 100.0);
    number.ok_or_else(|| "expected a number above 0 and below 100".to_owned())
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
