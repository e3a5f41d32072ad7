//! Writes one room lit by 1, 10, 1000 and 100,000 luminous triangles, of the same area and radiance in all:
//! `cargo run --release --example many_lights -- DIR`, to be charted with `wavetrace chart DIR/lights-*.json`.

use clap::Parser;
use std::error::Error;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use wavetrace::bench::mesh::write_obj;
use wavetrace::linear::DVec3;
use wavetrace::sampling::{Decision, Sampler, Xoshiro};
use wavetrace::world::Mesh;

/// Writes one room under 1 to 100,000 lights.
#[derive(Parser)]
struct Args {
    /// The folder
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

const NUMBERS: [u32; 4] = [1, 10, 1000, 100_000];
/// Area of all lights together.
const AREA: f64 = 0.16;

/// Adds a parallelogram by a corner and its two edges.
fn add_parallelogram(mesh: &mut Mesh, corner: DVec3, e: DVec3, f: DVec3) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([corner, corner + e, corner + e + f, corner + f]);
    mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i| first + i)));
}

/// Floor, ceiling and three walls of two units, and a block that stands free.
fn room() -> Mesh {
    let (x, y, z) = (DVec3::X * 2.0, DVec3::Y * 2.0, DVec3::Z * 2.0);
    let low = DVec3::new(-1.0, -1.0, 0.0);
    let mut mesh = Mesh::default();
    for (corner, e, f) in [(low, x, y), (low + z, y, x), (low + y, x, z), (low, y, z), (low + x, z, y)] {
        add_parallelogram(&mut mesh, corner, e, f);
    }
    let (u, v, w) = (DVec3::new(0.55, 0.2, 0.0), DVec3::new(-0.2, 0.55, 0.0), DVec3::new(0.0, 0.0, 0.9));
    let foot = DVec3::new(-0.3, -0.2, 0.0);
    for (corner, e, f) in [(foot, u, w), (foot, v, w), (foot + u, v, w), (foot + v, u, w), (foot + w, u, v)] {
        add_parallelogram(&mut mesh, corner, e, f);
    }
    mesh
}

/// So many triangles, turned any way, in the upper part of the room.
fn lights(number: u32) -> Mesh {
    // Of an equilateral triangle with corners at distance r from its middle.
    let r = (AREA / f64::from(number) * 4.0 / (3.0 * 3f64.sqrt())).sqrt();
    let mut mesh = Mesh::default();
    for i in 0..number {
        let mut state = Xoshiro::start::<f32>(1, i, 0);
        let u = Xoshiro::draw::<f32, 6>(&mut state, Decision::Light, 0).map(f64::from);
        let half = DVec3::new(0.95 - r, 0.95 - r, 0.2 * (1.0 - r));
        let at = DVec3::new(2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0, 2.0 * u[2] - 1.0) * half
            + DVec3::Z * (1.97 - half.z - r / 2.0);
        let tilt = |k: usize| u[k] * std::f64::consts::TAU;
        let (e, f) = if number == 1 {
            (DVec3::X, DVec3::Y)
        } else {
            let e = DVec3::new(tilt(3).cos(), tilt(3).sin(), 0.0);
            let across = DVec3::new(-e.y, e.x, 0.0);
            (e, across * tilt(4).cos() + DVec3::Z * tilt(4).sin())
        };
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([0.0f64, 1.0, 2.0].map(|k| {
            let (sin, cos) = (k * std::f64::consts::TAU / 3.0).sin_cos();
            at + (e * cos + f * sin) * r
        }));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh
}

/// The middle of a mesh's box, to which the scene moves it: where it is.
fn middle(mesh: &Mesh) -> DVec3 {
    let inf = DVec3::splat(f64::INFINITY);
    let (lo, hi) = mesh.positions.iter().fold((inf, -inf), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    (lo + hi) / 2.0
}

fn scene(number: u32, lights: &Mesh) -> String {
    let DVec3 { x, y, z } = middle(lights);
    format!(
        r#"{{
  "camera": {{
    "focalPoint": {{"x": 0, "y": -3.9, "z": 1}}, "direction": {{"x": 0, "y": 3.9, "z": 0}},
    "xReso": 400, "yReso": 400, "xAngle": 38, "yAngle": 38
  }},
  "materials": [
    {{"type": "diffuse", "mattness": 1, "color": {{"r": 0.7, "g": 0.7, "b": 0.7}}, "isLuminous": false}},
    {{"type": "diffuse", "color": {{"r": 1, "g": 0.9, "b": 0.8}}, "isLuminous": true, "radiance": 12}}
  ],
  "objects": [
    {{"comment": "room", "type": "mesh", "path": "room.obj", "materialIndex": 0, "midPoint": {{"x": 0, "y": 0, "z": 1}}, "scale": 1}},
    {{"comment": "lights", "type": "mesh", "path": "lights-{number}.obj", "materialIndex": 1, "midPoint": {{"x": {x}, "y": {y}, "z": {z}}}, "scale": 1}}
  ]
}}
"#
    )
}

fn write(path: &Path, mesh: &Mesh) -> Result<(), Box<dyn Error>> {
    let mut out = BufWriter::new(File::create(path)?);
    write_obj(mesh, &mut out)?;
    Ok(out.flush()?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let Args { folder } = Args::parse();
    fs::create_dir_all(&folder).map_err(|e| format!("{}: cannot create the folder: {e}", folder.display()))?;
    write(&folder.join("room.obj"), &room())?;
    for number in NUMBERS {
        let mesh = lights(number);
        write(&folder.join(format!("lights-{number}.obj")), &mesh)?;
        let file = folder.join(format!("lights-{number}.json"));
        fs::write(&file, scene(number, &mesh))?;
        println!("{}", file.display());
    }
    Ok(())
}
