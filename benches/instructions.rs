//! Instructions per ray of each kernel and per sample of whole renders, counted by callgrind:
//! `RUSTFLAGS="-C target-cpu=x86-64-v3" cargo bench --bench instructions`.
//!
//! A count does not depend on the machine's speed, or on what else runs there; it is not a time. All work is done on one
//! thread. Callgrind knows no AVX-512, so that a build for a machine that has it cannot be counted. Each count is the
//! difference of two runs, one of which does more passes over the same rays, or takes more samples, over what it has more of:
//! reading, building and starting cancel out, but for what is at random in them, as the keys of hash tables.

use std::process::{Command, ExitCode};
use wavetrace::accel::{BuildOptions, Bvh, MAX_LEAF, Quality};
use wavetrace::bench::{self, HitRecord, Kernel, Options, SetKind, Tracer, mesh, room};
use wavetrace::render::{Control, Integrator, Renderer, SamplerKind, Settings};
use wavetrace::scene;

/// Triangles of the rooms; the largest that callgrind takes through in little time.
const ROOMS: [usize; 3] = [36, 3_000, 37_488];
const RES: u32 = 128;
const ONE_THREAD: BuildOptions = BuildOptions { quality: Quality::Balanced, threads: 1, leaf: MAX_LEAF };
const SCENES: [&str; 2] = ["cornell", "demo3"];
/// Pixels across and down of a scene.
const SIDE: u32 = 96;
/// Passes over a set: a room of 36 triangles takes few instructions, and what is at random is shared out over them.
const PASSES: usize = 9;

/// Traces a set `passes` times; returns the number of its rays.
fn trace(triangles: usize, kernel: Kernel, kind: SetKind, passes: usize) -> usize {
    let corners = mesh::corners(&room(triangles, 1));
    let bvh = Bvh::build_with(&corners, &ONE_THREAD).expect("a thread");
    let make = Tracer { bvh: &bvh, kernel: Kernel::Many, threads: 1 };
    let options = Options { res: RES, ..Options::default() };
    let (sets, _) = bench::make(&corners, &make, &options, &[kind]).expect("options in range");
    let rays = &sets[0].rays;
    let mut hits = vec![HitRecord::MISS; rays.len()];
    Tracer { bvh: &bvh, kernel, threads: 1 }.trace(rays, &mut hits, kind.query(), passes);
    rays.len()
}

/// Renders a scene with `spp` samples per pixel; returns the number of its pixels.
fn render(name: &str, integrator: Integrator, spp: usize) -> usize {
    let file = format!("{}/scenes/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let mut builder = scene::load(file.as_ref()).expect("a scene that loads").builder;
    (builder.camera_mut().width, builder.camera_mut().height) = (SIDE, SIDE);
    let world = builder.build().expect("a scene that builds");
    let renderer = Renderer::with_options(world, &ONE_THREAD).expect("a thread");
    let settings =
        Settings { spp: spp as u32, threads: 1, integrator, sampler: SamplerKind::Xoshiro, ..Settings::default() };
    renderer.render(&settings, &Control::default()).expect("settings in range");
    (SIDE * SIDE) as usize
}

/// Does what is named, `times` times; returns how many rays or pixels that was each time.
fn work(what: &[String], times: usize) -> usize {
    match what {
        [room, kernel, kind] => {
            let (kernel, kind) = (Kernel::from_name(kernel), SetKind::from_name(kind));
            let (kernel, kind) = kernel.zip(kind).expect("a kernel and a set");
            trace(room.parse().expect("a number"), kernel, kind, times)
        }
        [scene, integrator] => {
            let reference = integrator == "reference";
            render(scene, if reference { Integrator::Reference } else { Integrator::Wavefront }, times)
        }
        _ => panic!("nothing to do"),
    }
}

/// Instructions of a run of this program under callgrind, and its last line.
fn count(what: &[&str], times: usize) -> Result<(u64, f64), String> {
    let own = std::env::current_exe().map_err(|e| e.to_string())?;
    let out = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(own)
        .arg("--work")
        .args(what)
        .arg(times.to_string())
        .output()
        .map_err(|e| format!("valgrind: {e}"))?;
    let (text, log) = (String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
    let collected = log.lines().find_map(|l| l.split("Collected :").nth(1)?.trim().parse().ok());
    let each = text.lines().last().and_then(|l| l.parse().ok());
    match collected.zip(each) {
        Some(pair) if out.status.success() => Ok(pair),
        _ => Err(format!("callgrind gave no count; is this build for a machine with AVX-512?\n{log}")),
    }
}

fn per_item(what: &[&str], once: usize, more: usize) -> Result<f64, String> {
    let ((a, each), (b, _)) = (count(what, once)?, count(what, more)?);
    Ok((b as f64 - a as f64) / (each * (more - once) as f64))
}

fn table() -> Result<(), String> {
    println!(
        "| instructions per ray | kernel | primary | bounce | shuffled | shadow | deep |\n|---|---|---|---|---|---|---|"
    );
    for room in ROOMS {
        for &(_, kernel) in Kernel::ALL {
            let counts = SetKind::ALL.map(|kind| per_item(&[&room.to_string(), kernel, kind.name()], 1, PASSES));
            let cells = counts.into_iter().collect::<Result<Vec<f64>, _>>()?;
            let cells: Vec<String> = cells.iter().map(|c| format!("{c:.0}")).collect();
            println!("| about {room} triangles | {kernel} | {} |", cells.join(" | "));
        }
    }
    println!("\n| instructions per sample | wavefront | reference |\n|---|---|---|");
    for scene in SCENES {
        let count = |integrator| per_item(&[scene, integrator], 16, 32);
        println!("| `{scene}` | {:.0} | {:.0} |", count("wavefront")?, count("reference")?);
    }
    Ok(())
}

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if let [first, what @ .., times] = args.as_slice()
        && first == "--work"
    {
        println!("{}", work(what, times.parse().expect("a number")));
        return ExitCode::SUCCESS;
    }
    match table() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
