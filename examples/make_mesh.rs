//! Makes test meshes of any size: `cargo run --release --example make_mesh -- room 1000000 out.obj [--seed N]`.

use clap::{Parser, ValueEnum};
use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use wavetrace::bench::{mesh, room};

/// Makes a test mesh.
#[derive(Parser)]
struct Args {
    /// What to make
    #[arg(value_enum)]
    kind: Kind,
    /// About how many triangles it has
    #[arg(value_parser = clap::value_parser!(u32).range(room::MIN_TRIANGLES as i64..=10_000_000))]
    triangles: u32,
    /// The file
    #[arg(value_name = "OUT.obj")]
    out: PathBuf,
    /// Seed of what is at random in it
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Clone, ValueEnum)]
enum Kind {
    /// A closed room with objects in it
    Room,
}

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let made = match args.kind {
        Kind::Room => room::room(args.triangles as usize, args.seed),
    };
    let mut out = BufWriter::new(File::create(&args.out)?);
    mesh::write_obj(&made, &mut out)?;
    out.flush()?;
    println!("{}: {} triangles", args.out.display(), made.triangles.len());
    Ok(())
}
