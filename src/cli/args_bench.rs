//! The options of `wavetrace bench`.

use super::choices::UpAxis;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand, value_parser};
use std::path::PathBuf;
use wavetrace::DVec3;
use wavetrace::bench::{Kernel, Options, SetKind, View};
use wavetrace::render::MAX_THREADS;

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
