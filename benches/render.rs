//! Whole renders, interleaved: `cargo bench --bench render [-- SCENE.json ...]`.
//!
//! For each scene the scalar and the reference integrator and the wavefront on one thread, and the wavefront on two and
//! on one again, in turn; prints samples per second (median of the repeats) and the medians of the ratios pair by pair. Then the
//! stages' shares, the bytes of a path, the time from the file to the first ray, and the same for a mesh of one million
//! triangles, written to a temporary folder.

use std::path::Path;
use std::time::{Duration, Instant};
use wavetrace::probe::StageRow;
use wavetrace::render::{Control, Integrator, Renderer, SamplerKind, Settings};
use wavetrace::scene;

const REPEATS: usize = 7;
const SPP: u32 = 8;

fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}

fn open(file: &Path) -> (Renderer, Duration) {
    let clock = Instant::now();
    let world = scene::load(file).and_then(|l| l.builder.build()).expect("a scene that loads");
    (Renderer::new(world), clock.elapsed())
}

fn seconds(renderer: &Renderer, settings: &Settings) -> f64 {
    renderer.render(settings, &Control::default()).expect("settings in range").time.as_secs_f64()
}

fn compare(name: &str, renderer: &Renderer) {
    let wave = Settings { spp: SPP, threads: 1, sampler: SamplerKind::Xoshiro, ..Settings::default() };
    let reference = Settings { integrator: Integrator::Reference, ..wave.clone() };
    let scalar = Settings { integrator: Integrator::Scalar, ..wave.clone() };
    let two = Settings { threads: 2, ..wave.clone() };
    let samples = f64::from(renderer.world().width()) * f64::from(renderer.world().height()) * f64::from(SPP);
    let (mut s, mut r, mut w, mut t) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut over_scalar, mut gain, mut scaling) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..REPEATS {
        let (a, b) = (seconds(renderer, &reference), seconds(renderer, &wave));
        let e = seconds(renderer, &scalar);
        let (c, d) = (seconds(renderer, &two), seconds(renderer, &wave));
        over_scalar.push(e / b);
        gain.push(a / b);
        scaling.push(d / c);
        s.push(samples / e / 1e6);
        r.push(samples / a / 1e6);
        w.extend([samples / b / 1e6, samples / d / 1e6]);
        t.push(samples / c / 1e6);
    }
    println!(
        "{name:16} scalar {:6.3}  reference {:6.3}  wavefront {:6.3}  two threads {:6.3} Msamples/s\n{:16} wavefront/scalar {:.2}  wavefront/reference {:.2}  two/one {:.2}",
        median(s),
        median(r),
        median(w),
        median(t),
        "",
        median(over_scalar),
        median(gain),
        median(scaling)
    );
}

fn stages(renderer: &Renderer) {
    let settings =
        Settings { spp: SPP, threads: 1, sampler: SamplerKind::Xoshiro, time_stages: true, ..Settings::default() };
    let out = renderer.render(&settings, &Control::default()).expect("settings in range");
    let total: f64 = out.stages.iter().map(|s| s.time.as_secs_f64()).sum();
    for row in out.stages.iter().filter(|s| s.items > 0) {
        let StageRow { stage, items, time, .. } = row;
        let (s, full) = (time.as_secs_f64(), 100.0 * row.occupancy());
        let (share, each) = (100.0 * s / total, s * 1e9 / *items as f64);
        println!("    {:11} {share:5.1} %  {each:6.1} ns per item  lanes {full:5.1} % full", stage.name());
    }
    let plan = renderer.plan(&settings).expect("settings in range");
    println!(
        "    a path takes {} bytes in all queues; {:.2} Mrays/s",
        plan.path_bytes(),
        out.counts.rays() as f64 / out.time.as_secs_f64() / 1e6
    );
}

/// A wavy sheet of 2 n^2 triangles under a lamp, written to `dir`.
fn sheet(dir: &Path, n: usize) -> std::io::Result<std::path::PathBuf> {
    use std::fmt::Write;
    let mut obj = String::new();
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (i as f64 / n as f64 * 2.0 - 1.0, j as f64 / n as f64 * 2.0 - 1.0);
            let z = 0.2 * (9.0 * x).sin() * (7.0 * y).cos() + 0.02 * (90.0 * x + 70.0 * y).sin();
            writeln!(obj, "v {x:.6} {y:.6} {z:.6}").expect("a string takes all");
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i + 1;
            writeln!(obj, "f {a} {} {}\nf {a} {} {}", a + 1, a + n + 2, a + n + 2, a + n + 1)
                .expect("a string takes all");
        }
    }
    std::fs::write(dir.join("sheet.obj"), obj)?;
    std::fs::write(dir.join("lamp.obj"), "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")?;
    let scene = r#"{"camera": {"focalPoint": {"x": 0, "y": -3, "z": 1.5}, "direction": {"x": 0, "y": 2, "z": -1},
        "xReso": 640, "yReso": 480},
        "materials": [{"type": "diffuse", "color": {"r": 0.7, "g": 0.7, "b": 0.7}, "isLuminous": false},
            {"type": "diffuse", "color": {"r": 1, "g": 1, "b": 1}, "isLuminous": true, "radiance": 5}],
        "objects": [{"type": "mesh", "path": "sheet.obj", "materialIndex": 0, "scale": 1},
            {"type": "mesh", "path": "lamp.obj", "materialIndex": 1, "scale": 1, "midPoint": {"x": 0, "y": 0, "z": 2}}]}"#;
    let file = dir.join("sheet.json");
    std::fs::write(&file, scene)?;
    Ok(file)
}

fn start(name: &str, file: &Path) {
    let times: Vec<f64> = (0..5).map(|_| open(file).1.as_secs_f64() * 1e3).collect();
    println!("{name:16} from the file to the first ray: {:.1} ms", median(times));
}

fn main() -> std::io::Result<()> {
    let mut files: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let all = files.is_empty();
    if all {
        files = ["cornell", "demo3"].map(|n| format!("{}/scenes/{n}.json", env!("CARGO_MANIFEST_DIR"))).to_vec();
    }
    for file in &files {
        let path = Path::new(file);
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let (renderer, _) = open(path);
        compare(&name, &renderer);
        stages(&renderer);
        start(&name, path);
    }
    if all {
        let dir = tempfile::tempdir()?;
        start("1M triangles", &sheet(dir.path(), 708)?);
    }
    Ok(())
}
