//! `wavetrace bench`: how fast the program is. One file for each thing that can be measured.

mod against;
mod args;
mod knob;
mod rays;
mod saved;
mod sheets;
mod suite;
mod sweep;
mod table;
mod tax;

pub use args::{BenchArgs, setting};
pub use knob::{Knob, settings, twice};

use super::Exit;
use args::Bench;

/// Measures what is named, or the standard suite.
pub fn run(args: &BenchArgs) -> Result<Exit, Exit> {
    match &args.what {
        Some(Bench::Rays(rays)) => rays::run(rays),
        Some(Bench::Sweep(sweep)) => sweep::run(sweep),
        Some(Bench::Tax(tax)) => tax::run(tax),
        None => suite::run(&args.suite),
    }
}
