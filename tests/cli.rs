//! The program as a user meets it: options, messages, files and exit codes.

use serde_json::Value;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A square of side 2 in the plane z = 0.
const QUAD: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n";
const CAMERA: &str = r#"{"focalPoint": {"x": 0, "y": -4, "z": 1}, "direction": {"x": 0, "y": 1, "z": 0},
    "xReso": 16, "yReso": 12, "xAngle": 45}"#;
const GREY: &str = r#"{"type": "diffuse", "color": {"r": 0.5, "g": 0.5, "b": 0.5}}"#;
const LAMP: &str = r#"{"type": "diffuse", "color": {"r": 1, "g": 1, "b": 1}, "isLuminous": true, "radiance": 3}"#;

/// A scene of a floor and what may be a lamp over it.
fn scene_text(camera: &str, lamp: &str) -> String {
    format!(
        r#"{{"camera": {camera}, "materials": [{GREY}, {lamp}], "objects": [
    {{"type": "mesh", "path": "quad.obj", "materialIndex": 0, "midPoint": {{"x": 0, "y": 0, "z": 0}}, "scale": 1.5}},
    {{"type": "mesh", "path": "quad.obj", "materialIndex": 1, "midPoint": {{"x": 0, "y": 0, "z": 2}}, "scale": 0.5}}
]}}"#
    )
}

/// A folder with scenes, in which the program runs.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.put("quad.obj", QUAD);
        folder.put("lit.json", &scene_text(CAMERA, LAMP));
        folder.put("dark.json", &scene_text(CAMERA, GREY));
        folder.put("odd.json", &scene_text(&CAMERA.replace("\"xReso\"", "\"colour\": 1, \"xReso\""), LAMP));
        folder
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn put(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }
    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_wavetrace"));
        command.current_dir(self.0.path()).args(args);
        command
    }
    fn run(&self, args: &[&str]) -> Ran {
        Ran::from(self.command(args).output().unwrap())
    }
    /// Runs what must succeed.
    fn ok(&self, args: &[&str]) -> Ran {
        let ran = self.run(args);
        assert_eq!(ran.code, Some(0), "{args:?}: {}", ran.err);
        ran
    }
    /// Runs what must fail with an exit code and a message that has all of `parts`.
    fn fails(&self, code: i32, args: &[&str], parts: &[&str]) -> Ran {
        let ran = self.run(args);
        assert_eq!(ran.code, Some(code), "{args:?}: {}", ran.err);
        assert!(ran.err.starts_with("error: "), "{args:?}: {}", ran.err);
        for part in parts {
            assert!(ran.err.contains(part), "{args:?}: expected {part:?} in: {}", ran.err);
        }
        ran
    }
    /// Names of the files that are not inputs.
    fn made(&self) -> Vec<String> {
        let names = fs::read_dir(self.0.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        let inputs = ["quad.obj", "lit.json", "dark.json", "odd.json"];
        let mut made: Vec<_> = names.filter(|name| !inputs.contains(&name.as_str())).collect();
        made.sort();
        made
    }
    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }
}

struct Ran {
    code: Option<i32>,
    out: String,
    err: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

fn read_exr(path: &Path) -> (u32, u32, Vec<[u32; 3]>) {
    use exr::prelude::*;
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size, vec![[0f32; 3]; size.area()]),
            |(size, pixels), at, rgb: (f32, f32, f32)| pixels[at.y() * size.width() + at.x()] = [rgb.0, rgb.1, rgb.2],
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .unwrap();
    let (size, pixels) = file.layer_data.channel_data.pixels;
    (size.width() as u32, size.height() as u32, pixels.into_iter().map(|p| p.map(f32::to_bits)).collect())
}

fn read_png(path: &Path) -> (png::Info<'static>, Vec<u8>) {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    reader.finish().unwrap();
    (reader.info().clone(), bytes)
}

/// Text entries of a PNG, whichever way they are stored.
fn png_texts(info: &png::Info<'_>) -> Vec<(String, String)> {
    let latin = info.uncompressed_latin1_text.iter().map(|t| (t.keyword.clone(), t.text.clone()));
    let utf8 = info.utf8_text.iter().map(|t| (t.keyword.clone(), t.get_text().unwrap()));
    latin.chain(utf8).collect()
}

/// The image that options give, as bits of linear floats.
fn pixels(folder: &Folder, args: &[&str]) -> Vec<[u32; 3]> {
    folder.ok(&[&["lit.json", "-o", "p.exr"], args].concat());
    read_exr(&folder.path("p.exr")).2
}

#[test]
fn help_and_version_go_to_standard_output() {
    let folder = Folder::new();
    let help = folder.ok(&["--help"]);
    for option in [
        "--spp",
        "--output",
        "--size",
        "--threads",
        "--seed",
        "--max-depth",
        "--method",
        "--sampler",
        "--exposure",
        "--tonemap",
        "--variance",
        "--stats",
        "--explain",
        "--quiet",
        "--strict",
        "--wave",
        "--integrator",
        "SCENE.json",
        "check",
        "compare",
    ] {
        assert!(help.out.contains(option), "{option} in {}", help.out);
    }
    let version = folder.ok(&["--version"]).out;
    assert_eq!(version.trim(), format!("wavetrace {} (SIMD: {})", env!("CARGO_PKG_VERSION"), wavetrace::lanes::simd()));
    assert!(folder.run(&[]).err.contains("Usage:"));
    assert_eq!(folder.run(&[]).code, Some(2));
}

#[test]
fn mistakes_in_the_command_line_exit_with_2_and_render_nothing() {
    let folder = Folder::new();
    let cases: &[(&[&str], &str)] = &[
        (&["--spp", "0"], "1..=4294967295"),
        (&["0"], "1..=4294967295"),
        (&["-5"], "1..=4294967295"),
        (&["--spp", "-5"], "1..=4294967295"),
        (&["--spp", "4294967296"], "4294967296 is not in"),
        (&["--spp", "1e3"], "'1e3'"),
        (&["many"], "'many'"),
        (&["4", "--spp", "4"], "cannot be used with"),
        (&["--spp", "4", "--spp", "4"], "cannot be used multiple times"),
        (&["--size", "0x5"], "1 to 65536 pixels each way"),
        (&["--size", "65537x1"], "1 to 65536 pixels each way"),
        (&["--size", "65536x65536"], "268435456 in all"),
        (&["--size", "-4x4"], "such as 640x480"),
        (&["--size", "640"], "such as 640x480"),
        (&["--threads", "0"], "1..=1024"),
        (&["--threads", "1025"], "1..=1024"),
        (&["--threads", "-1"], "1..=1024"),
        (&["--seed", "-1"], "'-1'"),
        (&["--seed", "18446744073709551616"], "'18446744073709551616'"),
        (&["--max-depth", "-1"], "'-1'"),
        (&["--method", "bdpt"], "path, nee, mis"),
        (&["--sampler", "halton"], "xoshiro, sobol"),
        (&["--integrator", "x"], "wavefront, reference, scalar"),
        (&["--tonemap", "filmic"], "clamp, max"),
        (&["--exposure", "nan"], "finite"),
        (&["--exposure", "-inf"], "finite"),
        (&["--exposure", "1e39"], "finite"),
        (&["--wave", "0"], "1..="),
        (&["--wave", "99999999"], "1..="),
        (&["-o", "a.bmp"], "a.bmp: found the ending .bmp"),
        (&["-o", "a"], "a: found no ending"),
        (&["--variance"], "--variance: found no .exr output, expected one"),
        (&["--variance", "-o", "a.png", "-o", "a.hdr"], "--variance: found no .exr output"),
        (&["--stats", "lit.json"], "a file of its own"),
        (&["-o", "a.png", "--stats", "a.png"], "a file of its own"),
        (&["--time", "0"], "more than 0 and at most 1000000"),
        (&["--time", "-1"], "more than 0"),
        (&["--time", "x"], "more than 0"),
        (&["--target-error", "0"], "above 0, such as 0.001"),
        (&["--target-error", "nan"], "above 0"),
        (&["3", "--target-error", "0.1"], "--spp: found 3, expected at least 4"),
        (&["--stats", "t.json", "--trace", "t.json"], "a file of its own for --trace"),
        (&["--leaf", "9"], "1..=8"),
        (&["--job", "0"], "0"),
        (&["--refill", "maybe"], "maybe"),
        (&["--no-such-option"], "unexpected argument"),
        (&["4", "5"], "unexpected argument '5'"),
    ];
    for (args, part) in cases {
        folder.fails(2, &[&["lit.json"], *args].concat(), &[part]);
    }
    folder.fails(2, &["--spp", "4"], &["SCENE.json"]);
    folder.fails(2, &["check"], &["SCENE.json"]);
    folder.fails(2, &["check", "lit.json", "--spp", "4"], &["unexpected argument '--spp'"]);
    assert_eq!(folder.made(), [""; 0]);
}

#[test]
fn scenes_at_fault_exit_with_1_and_name_file_and_place() {
    let folder = Folder::new();
    let lit = scene_text(CAMERA, LAMP);
    let case = |name: &str, text: &str, parts: &[&str]| {
        folder.put(name, text);
        folder.fails(1, &[name, "-o", "out.png"], parts);
        folder.fails(1, &["check", name], parts);
    };
    case("cut.json", &lit[..lit.len() - 5], &["cut.json:4:", "expected"]);
    case("empty.json", "", &["empty.json:1:1", "an empty file"]);
    case("mesh.json", &lit.replace("quad.obj", "none.obj"), &["objects[0].path", "none.obj"]);
    case("type.json", &lit.replace("\"xReso\": 16", "\"xReso\": \"wide\""), &["camera.xReso", "wide"]);
    case("range.json", &lit.replace("\"r\": 0.5", "\"r\": 1.5"), &["materials[0].color", "1.5"]);
    case("zero.json", &lit.replace("\"xReso\": 16", "\"xReso\": 0"), &["camera.xReso", "found 0"]);
    case("huge.json", &lit.replace("\"xReso\": 16", "\"xReso\": 99999999"), &["camera.xReso", "99999999"]);
    case("index.json", &lit.replace("\"materialIndex\": 1", "\"materialIndex\": 7"), &["objects[1].materialIndex"]);
    case("flat.json", &lit.replace("\"scale\": 1.5", "\"height\": 1.5"), &["objects[0].height", "flat"]);
    folder.fails(1, &["nowhere.json"], &["nowhere.json: cannot read"]);
    folder.fails(1, &["check", "nowhere.json"], &["nowhere.json: cannot read"]);
    assert!(!folder.path("out.png").exists());
}

#[test]
fn all_mistakes_are_shown_one_per_line() {
    let folder = Folder::new();
    let text = scene_text(CAMERA, LAMP).replace("\"r\": 0.5", "\"r\": 1.5").replace("\"xReso\": 16", "\"xReso\": 0");
    folder.put("two.json", &text);
    let err = folder.fails(1, &["two.json", "--quiet"], &["materials[0].color.r", "camera.xReso"]).err;
    assert_eq!(err.lines().count(), 2, "{err}");
    assert!(err.lines().all(|line| line.starts_with("error: two.json:")), "{err}");
}

#[test]
fn an_empty_scene_renders_black_and_says_so() {
    let folder = Folder::new();
    folder.put("nothing.json", &format!(r#"{{"camera": {CAMERA}, "materials": [], "objects": []}}"#));
    for scene in ["nothing.json", "dark.json"] {
        let err = folder.ok(&[scene, "2", "-o", "black.exr"]).err;
        assert!(err.contains("warning: ") && err.contains("the image is black"), "{err}");
        assert!(read_exr(&folder.path("black.exr")).2.iter().all(|p| *p == [0; 3]));
        let check = folder.ok(&["check", scene]);
        assert!(check.err.contains("the image is black"), "{}", check.err);
        folder.fails(1, &["check", scene, "--strict"], &["the image is black"]);
    }
    let err = folder.ok(&["lit.json", "2", "-o", "lit.exr"]).err;
    assert!(!err.contains("warning"), "{err}");
    assert!(read_exr(&folder.path("lit.exr")).2.iter().any(|p| *p != [0; 3]));
}

#[test]
fn strict_makes_errors_of_warnings() {
    let folder = Folder::new();
    let err = folder.ok(&["odd.json", "-o", "a.png"]).err;
    assert!(err.contains("warning: odd.json:2:") && err.contains("camera.colour"), "{err}");
    folder.fails(1, &["odd.json", "-o", "b.png", "--strict"], &["error: odd.json:2:", "camera.colour"]);
    folder.fails(1, &["odd.json", "-o", "b.png", "--strict", "--quiet"], &["camera.colour"]);
    folder.fails(1, &["check", "odd.json", "--strict"], &["camera.colour"]);
    assert_eq!(folder.made(), ["a.png"]);
    folder.ok(&["lit.json", "-o", "b.png", "--strict"]);
}

#[test]
fn quiet_prints_nothing_but_errors() {
    let folder = Folder::new();
    for scene in ["lit.json", "odd.json", "dark.json"] {
        let ran = folder.ok(&[scene, "-o", "a.png", "--quiet"]);
        assert_eq!((ran.out.as_str(), ran.err.as_str()), ("", ""));
    }
    folder.fails(1, &["none.json", "-q"], &["none.json"]);
}

#[test]
fn the_last_lines_name_file_times_and_rates() {
    let folder = Folder::new();
    let err = folder.ok(&["lit.json", "3", "-o", "a.png"]).err;
    for part in
        ["wrote a.png: 16x12, 3 samples per pixel", "load ", "build ", "render ", "write ", "samples/s", "Mrays/s"]
    {
        assert!(err.contains(part), "{part} in {err}");
    }
    assert!(err.contains("4 triangles, 2 lights"), "{err}");
    assert!(!err.contains('%'), "no progress of what takes no time: {err}");
    assert!(!err.contains("--spp"), "{err}");
    let err = folder.ok(&["lit.json", "-o", "a.png"]).err;
    assert!(err.contains("--spp 64"), "a preview says how to ask for more: {err}");
}

#[test]
fn dropped_triangles_and_cut_paths_are_told() {
    let folder = Folder::new();
    folder.put("quad.obj", &format!("{QUAD}f 1 1 2\n"));
    let err = folder.ok(&["lit.json", "16", "--max-depth", "0", "-o", "a.png", "--stats", "s.json"]).err;
    assert!(err.contains("2 degenerate triangles left out"), "{err}");
    assert!(err.contains("cut at 0 bounces;"), "{err}");
    let stats = folder.json("s.json");
    assert_eq!(stats["dropped_triangles"], 2);
    assert!(stats["cut_paths"].as_u64().unwrap() > 0);
    let out = folder.ok(&["check", "lit.json"]).out;
    assert!(out.contains("4; 2 degenerate ones dropped"), "{out}");
}

#[test]
fn size_overrides_the_camera_and_each_ending_its_format() {
    let folder = Folder::new();
    folder.ok(&["lit.json", "--size", "20x10", "-o", "a.exr", "-o", "a.png", "--output", "a.ppm", "-o", "a.hdr"]);
    let (width, height, exr) = read_exr(&folder.path("a.exr"));
    assert_eq!((width, height, exr.len()), (20, 10, 200));
    let (info, bytes) = read_png(&folder.path("a.png"));
    assert_eq!((info.width, info.height), (20, 10));
    assert!(fs::read(folder.path("a.ppm")).unwrap().ends_with(&bytes));
    assert!(fs::read(folder.path("a.hdr")).unwrap().starts_with(b"#?RADIANCE"));
}

#[test]
fn same_seed_same_image_whatever_the_threads_and_the_wave() {
    let folder = Folder::new();
    let one = pixels(&folder, &["8", "--threads", "1"]);
    assert_eq!(one, pixels(&folder, &["--spp", "8", "--threads", "2"]));
    assert_eq!(one, pixels(&folder, &["8", "--wave", "7", "--seed", "0"]));
    assert_eq!(one, pixels(&folder, &["8", "--integrator", "reference"]));
    assert_eq!(one, pixels(&folder, &["8", "--integrator", "scalar"]));
    for other in
        [["--seed", "1"], ["--sampler", "xoshiro"], ["--method", "path"], ["--method", "nee"], ["--max-depth", "0"]]
    {
        assert_ne!(one, pixels(&folder, &[&["8"], &other[..]].concat()), "{other:?}");
    }
    assert_ne!(one, pixels(&folder, &["9"]));
}

#[test]
fn exposure_and_tone_map_change_the_8_bit_image_alone() {
    let folder = Folder::new();
    let shown = |args: &[&str]| {
        folder.ok(&[&["lit.json", "8", "-o", "a.png", "-o", "a.exr"], args].concat());
        (read_png(&folder.path("a.png")).1, read_exr(&folder.path("a.exr")).2)
    };
    let (plain, linear) = shown(&[]);
    let (darker, same) = shown(&["--exposure", "-2"]);
    assert_eq!(linear, same);
    assert!(darker.iter().zip(&plain).all(|(a, b)| a <= b) && darker != plain);
    let (max, same) = shown(&["--tonemap", "max"]);
    assert_eq!(linear, same);
    assert!(max != plain && max.contains(&255));
    assert_eq!(shown(&["--exposure", "0", "--tonemap", "clamp"]).0, plain);
}

#[test]
fn images_say_what_they_are() {
    let folder = Folder::new();
    folder.ok(&[
        "./lit.json",
        "3",
        "--seed",
        "7",
        "--method",
        "nee",
        "--sampler=xoshiro",
        "--max-depth=4",
        "-o",
        "a.png",
    ]);
    let texts = png_texts(&read_png(&folder.path("a.png")).0);
    let version = format!("wavetrace {}", env!("CARGO_PKG_VERSION"));
    for (key, value) in [
        ("Software", &*version),
        ("scene", "./lit.json"),
        ("spp", "3"),
        ("seed", "7"),
        ("method", "nee"),
        ("sampler", "xoshiro"),
        ("effort", "even"),
        ("max_depth", "4"),
        ("light_paths", "0.1"),
    ] {
        assert!(texts.contains(&(key.to_owned(), value.to_owned())), "{key} in {texts:?}");
    }
    assert!(texts.iter().any(|(key, value)| key == "seconds_render" && value.parse::<f64>().is_ok()));
    assert!(!texts.iter().any(|(key, _)| key == wavetrace::output::PARTIAL));
}

#[test]
fn an_unnamed_image_is_named_after_the_time_and_never_replaces_another() {
    let folder = Folder::new();
    for n in 1..=3 {
        folder.ok(&["lit.json"]);
        let made = folder.made();
        assert_eq!(made.len(), n, "{made:?}");
        for name in made {
            let shape: String = name.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect();
            assert!(shape == "00_00_00-00_00_00.png" || shape == "00_00_00-00_00_00-0.png", "{name}");
        }
    }
}

#[test]
fn outputs_that_cannot_be_written_are_all_named_before_rendering() {
    let folder = Folder::new();
    fs::create_dir(folder.path("dir.png")).unwrap();
    let args = ["lit.json", "1000000", "-o", "none/a.png", "-o", "dir.png", "-o", "ok.png", "--stats", "none/s.json"];
    let ran = folder.fails(1, &args, &["none/a.png: ", "dir.png: ", "none/s.json: "]);
    assert_eq!(ran.err.lines().count(), 3, "{}", ran.err);
    assert_eq!(folder.made(), ["dir.png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn one_bad_output_does_not_keep_the_others_from_being_written() {
    let folder = Folder::new();
    folder.fails(
        1,
        &["lit.json", "-q", "-o", "/dev/full", "-o", "a.png", "--stats", "s.json"],
        &["/dev/full: cannot write"],
    );
    assert_eq!(folder.made(), ["a.png", "s.json"]);
    folder.fails(1, &["lit.json", "-q", "-o", "a.png", "--stats", "/dev/full"], &["/dev/full: cannot write"]);
}

#[cfg(target_os = "linux")]
#[test]
fn finished_work_is_not_lost_on_a_full_disk() {
    let folder = Folder::new();
    let err = folder.fails(1, &["lit.json", "4", "-q", "-o", "/dev/full"], &["/dev/full: cannot write"]).err;
    let [name] = &folder.made()[..] else { panic!("{:?}", folder.made()) };
    assert!(err.contains(&format!("{name}: the image is here instead")), "{err}");
    let (info, bytes) = read_png(&folder.path(name));
    assert_eq!((info.width, info.height), (16, 12));
    assert!(bytes.iter().any(|&b| b > 0));
}

#[test]
fn stats_are_complete_and_consistent() {
    let folder = Folder::new();
    folder.ok(&["lit.json", "5", "--threads", "2", "--seed", "9", "-o", "a.png", "--stats", "s.json"]);
    let stats = folder.json("s.json");
    let n = |path: &str| stats.pointer(path).and_then(Value::as_u64).unwrap_or_else(|| panic!("{path} in {stats:#}"));
    let f = |path: &str| stats.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {stats:#}"));
    let t = |path: &str| stats.pointer(path).and_then(Value::as_str).unwrap_or_else(|| panic!("{path} in {stats:#}"));
    assert_eq!(
        (t("/version"), t("/scene"), t("/simd")),
        (env!("CARGO_PKG_VERSION"), "lit.json", wavetrace::lanes::simd())
    );
    assert_eq!((t("/method"), t("/sampler"), t("/integrator")), ("mis", "sobol", "wavefront"));
    assert_eq!([n("/width"), n("/height"), n("/spp"), n("/threads"), n("/seed")], [16, 12, 5, 2, 9]);
    assert_eq!(
        [n("/triangles"), n("/lights"), n("/dropped_triangles"), n("/cut_paths"), n("/bad_samples")],
        [4, 2, 0, 0, 0]
    );
    assert_eq!(n("/wave"), wavetrace::render::DEFAULT_WAVE as u64);
    assert_eq!((&stats["max_depth"], &stats["first_bad_samples"]), (&Value::Null, &Value::Array(Vec::new())));
    assert_eq!(stats["partial"], false);

    assert_eq!(n("/rays/camera"), 16 * 12 * 5);
    assert!(n("/rays/bounce") > 0 && n("/rays/shadow") > 0);
    assert_eq!(n("/rays/total"), n("/rays/camera") + n("/rays/bounce") + n("/rays/shadow") + n("/rays/light"));
    let rate = n("/rays/total") as f64 / f("/seconds/render") / 1e6;
    assert!((f("/mrays_per_s") / rate - 1.0).abs() < 1e-9);
    let rate = n("/rays/camera") as f64 / f("/seconds/render");
    assert!((f("/samples_per_s") / rate - 1.0).abs() < 1e-9);

    let parts: f64 = ["load", "build", "render", "write"].iter().map(|k| f(&format!("/seconds/{k}"))).sum();
    assert!(parts <= f("/seconds/total") + 1e-6, "{stats:#}");
    for key in ["world", "bvh", "waves", "film"] {
        assert!(n(&format!("/bytes/{key}")) > 0, "{key}");
    }
    if cfg!(target_os = "linux") {
        assert!(n("/bytes/peak_rss") > n("/bytes/waves"));
    }
    let stages = stats["stages"].as_array().unwrap();
    let names: Vec<_> = stages.iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert!(names.starts_with(&["generate", "intersect"]) && names.contains(&"accumulate"), "{names:?}");
    for stage in stages {
        let (items, seconds) = (stage["items"].as_u64().unwrap(), stage["seconds"].as_f64().unwrap());
        assert!(stage["calls"].is_u64());
        assert!((stage["ns_per_item"].as_f64().unwrap() * items as f64 - seconds * 1e9).abs() <= 1e-6 * seconds * 1e9);
    }
    // Each ray but the shadow rays is intersected once.
    assert_eq!(stages[1]["items"].as_u64().unwrap(), n("/rays/camera") + n("/rays/bounce"));
}

#[test]
fn goals_end_a_render_and_are_told() {
    let folder = Folder::new();
    let ran = folder.ok(&["lit.json", "--target-error", "0.02", "-o", "a.png", "--stats", "s.json"]);
    assert!(ran.err.contains("down to a relMSE of 0.02") && ran.err.contains("estimated relMSE "), "{}", ran.err);
    let stats = folder.json("s.json");
    assert!(stats["estimated_relmse"].as_f64().is_some_and(|error| error < 0.03), "{stats:#}");
    let spp = stats["spp"].as_u64().unwrap();
    assert_eq!(stats["rays"]["camera"].as_u64().unwrap(), 16 * 12 * spp);
    let text = ("spp".to_owned(), spp.to_string());
    assert!(png_texts(&read_png(&folder.path("a.png")).0).contains(&text));

    let ran = folder.ok(&["lit.json", "--time", "0.2", "-o", "b.png", "--stats", "t.json"]);
    assert!(
        ran.err.contains("for 0.2 s") && !ran.err.contains("partial") && !ran.err.contains("preview"),
        "{}",
        ran.err
    );
    let stats = folder.json("t.json");
    assert!(stats["seconds"]["render"].as_f64().is_some_and(|seconds| seconds >= 0.2), "{stats:#}");
    assert_eq!(
        (&stats["partial"], &stats["time"], &stats["estimated_relmse"]),
        (&Value::Bool(false), &0.2.into(), &Value::Null)
    );

    // The bound on samples holds.
    let ran = folder.ok(&["lit.json", "8", "--time", "1000", "--target-error", "1e-9", "-o", "c.png"]);
    assert!(
        ran.err.contains("at most 8 samples per pixel") && ran.err.contains("c.png: 16x12, 8 samples"),
        "{}",
        ran.err
    );
}

/// Light that no connection can find is announced before the render, by `check` too, and not where there is none.
#[test]
fn what_is_left_to_chance_is_said_before_rendering() {
    let folder = Folder::new();
    let scene = |name: &str| format!("{}/scenes/{name}", env!("CARGO_MANIFEST_DIR"));
    let (glass, plain) = (scene("cornell-balls.json"), scene("cornell.json"));
    assert!(
        folder.ok(&["check", &glass]).out.contains("by chance  no light; what mirrors and glass focus is found by")
    );
    assert!(folder.ok(&["check", &plain]).out.contains("by chance  no light\n"));
    let render = |scene: &str, more: &[&str]| {
        let mut args = vec![scene, "1", "--size", "8x8", "-o", "a.png"];
        args.extend(more);
        folder.ok(&args).err
    };
    assert!(!render(&glass, &[]).contains("by chance"));
    let all = render(&glass, &["--light-paths", "0"]);
    assert!(all.contains("by chance alone: all light that mirrors or glass focus"), "{all}");
    assert!(!render(&plain, &[]).contains("by chance"));
}

#[test]
fn check_shows_what_is_in_a_scene() {
    let folder = Folder::new();
    let ran = folder.ok(&["check", "lit.json"]);
    assert_eq!(ran.err, "");
    for part in [
        "lit.json: no mistakes",
        "16 x 12",
        "at (0, -4, 1), towards (0, 1, 0)",
        "2 luminous triangles",
        "1 diffuse, 1 luminous",
        "(-1.5, -1.5, 0) to (1.5, 1.5, 2)",
    ] {
        assert!(ran.out.contains(part), "{part} in {}", ran.out);
    }
    assert_eq!(folder.made(), [""; 0]);
}

#[test]
fn a_scene_may_be_called_like_a_verb() {
    let folder = Folder::new();
    folder.put("check", &scene_text(CAMERA, LAMP));
    folder.ok(&["./check", "-o", "a.png"]);
    folder.ok(&["-o", "b.png", "--", "check"]);
    folder.ok(&["check", "check"]);
    assert_eq!(folder.made(), ["a.png", "b.png", "check"]);
}

#[test]
fn explain_shows_what_runs_and_renders_nothing() {
    let folder = Folder::new();
    let line = |out: &str, part: &str| {
        let found = out.lines().find(|line| line.contains(part)).unwrap_or_else(|| panic!("{part} in {out}"));
        found.trim_start().to_owned()
    };
    let ran = folder.ok(&["lit.json", "--explain"]);
    assert_eq!(ran.err, "");
    for part in ["shade       transparent", "shade       specular", "shade       matt", "escape", "scale"] {
        assert!(line(&ran.out, part).starts_with('-'), "a Lambertian box builds no such stage: {part} in {}", ran.out);
    }
    for part in ["shade       diffuse", "connect", "emit"] {
        assert!(line(&ran.out, part).starts_with('+'), "{part} in {}", ran.out);
    }
    assert!(line(&ran.out, "triangles").contains('4') && line(&ran.out, "bvh").contains("leaves"));
    let out = folder.ok(&["lit.json", "--explain", "--method", "path", "--max-depth", "5", "-o", "a.png"]).out;
    assert!(line(&out, "connect").starts_with('-') && out.contains("at most 5"), "{out}");
    folder.put(
        "glass.json",
        &scene_text(CAMERA, LAMP).replace(
            "\"type\": \"diffuse\", \"color\": {\"r\": 0.5",
            "\"type\": \"transparent\", \"refIndex\": 1.5, \"color\": {\"r\": 0.5",
        ),
    );
    assert!(line(&folder.ok(&["glass.json", "--explain"]).out, "shade       transparent").starts_with('+'));
    assert_eq!(folder.made(), ["glass.json"]);
}

#[test]
fn variances_are_written_beside_the_colours() {
    let folder = Folder::new();
    folder.ok(&["lit.json", "8", "--sampler", "xoshiro", "--variance", "-o", "a.exr", "-o", "a.png"]);
    folder.ok(&["lit.json", "8", "--sampler", "xoshiro", "-o", "b.exr", "-o", "b.png"]);
    assert_eq!(read_exr(&folder.path("a.exr")), read_exr(&folder.path("b.exr")), "colours are the same");
    assert_eq!(read_png(&folder.path("a.png")).1, read_png(&folder.path("b.png")).1);
    let read = |name: &str| wavetrace::output::read(&folder.path(name)).unwrap();
    assert_eq!(read("b.exr").variance, None);
    let (file, variance) = (read("a.exr"), read("a.exr").variance.unwrap());
    assert_eq!(variance.len(), 16 * 12);
    // The background is black in all samples, the floor is not.
    assert!(variance.contains(&[0.0; 3]) && variance.iter().any(|v| v.iter().all(|&c| c > 0.0)));
    // Eight samples of which at most eight are not 0: the variance of their mean is at most its square.
    for (value, variance) in file.image.pixels.as_flattened().iter().zip(variance.as_flattened()) {
        assert!((0.0..=1.001 * value * value).contains(variance), "{value} {variance}");
    }
    let ran = folder.ok(&["lit.json", "8", "--variance", "-o", "a.exr"]);
    assert!(ran.err.contains("warning: --variance: Sobol points are not independent"), "{}", ran.err);
    let ran = folder.ok(&["lit.json", "--variance", "-o", "a.exr"]);
    assert!(ran.err.contains("warning: --variance: one sample per pixel has no spread"), "{}", ran.err);
    assert!(read("a.exr").variance.unwrap().iter().flatten().all(|v| *v == f32::INFINITY));
    folder.fails(1, &["lit.json", "--variance", "-o", "a.exr", "--strict"], &["--variance: one sample per pixel"]);
    let ran = folder.ok(&["compare", "a.exr", "a.exr"]);
    assert!(ran.out.contains("the images are not tested"), "{}", ran.out);
}

/// Starts a render that would take hours, and waits until it runs.
#[cfg(unix)]
fn endless(folder: &Folder, args: &[&str]) -> (std::process::Child, BufReader<std::process::ChildStderr>) {
    let args = [&["lit.json", "4000000000", "--threads", "1"], args].concat();
    let mut child = folder.command(&args).stderr(Stdio::piped()).spawn().unwrap();
    let mut err = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    err.read_line(&mut line).unwrap();
    assert!(line.starts_with("rendering lit.json: 16x12 pixels"), "{line}");
    (child, err)
}

/// Gives a render that has been announced the time to take up its first jobs: nothing outside tells when it has.
#[cfg(unix)]
fn settle() {
    std::thread::sleep(std::time::Duration::from_millis(700));
}

#[cfg(unix)]
fn signal(child: &std::process::Child, name: &str) {
    let pid = child.id().to_string();
    assert!(Command::new("kill").args([name, &pid]).status().unwrap().success());
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_leaves_a_partial_image() {
    for name in ["-INT", "-TERM"] {
        let folder = Folder::new();
        let (mut child, mut err) = endless(&folder, &["-o", "a.png", "-o", "a.exr", "--stats", "s.json"]);
        settle();
        signal(&child, name);
        let mut rest = String::new();
        err.read_to_string(&mut rest).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{rest}");
        assert!(rest.contains("partial"), "{rest}");
        let texts = png_texts(&read_png(&folder.path("a.png")).0);
        assert!(texts.contains(&(wavetrace::output::PARTIAL.to_owned(), "true".to_owned())), "{texts:?}");
        assert!(read_exr(&folder.path("a.exr")).2.iter().any(|p| *p != [0; 3]));
        let stats = folder.json("s.json");
        assert_eq!(stats["partial"], true);
        assert_eq!(folder.made(), ["a.exr", "a.png", "s.json"]);
    }
}

/// A box of perfect mirrors around the camera: each path runs into the limit of bounces, each job takes seconds.
#[cfg(unix)]
fn mirror_box() -> String {
    let wall = |[x, y, z]: [i32; 3], [xrot, yrot]: [i32; 2]| {
        format!(
            r#"{{"type": "mesh", "path": "quad.obj", "materialIndex": 0, "scale": 5, "xrot": {xrot}, "yrot": {yrot},
                "midPoint": {{"x": {x}, "y": {y}, "z": {z}}}}}"#
        )
    };
    let walls = [
        wall([0, 0, -5], [0, 0]),
        wall([0, 0, 5], [0, 0]),
        wall([0, -5, 0], [90, 0]),
        wall([0, 5, 0], [90, 0]),
        wall([-5, 0, 0], [0, 90]),
        wall([5, 0, 0], [0, 90]),
    ];
    let mirror = r#"{"type": "specular", "color": {"r": 1, "g": 1, "b": 1}}"#;
    // A background that no path reaches: a scene without any light would not be traced at all.
    let background = r#"{"r": 1, "g": 1, "b": 1}"#;
    format!(
        r#"{{"camera": {CAMERA}, "background": {background}, "materials": [{mirror}], "objects": [{}]}}"#,
        walls.join(", ")
    )
}

#[cfg(unix)]
#[test]
fn a_second_interruption_ends_at_once() {
    let folder = Folder::new();
    folder.put("mirrors.json", &mirror_box());
    let mut child = folder.command(&["mirrors.json", "64000", "-o", "a.png"]).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.starts_with("rendering mirrors.json")));
    settle();
    signal(&child, "-INT");
    assert!(lines.any(|line| line.starts_with("interrupted")), "the first interruption waits for the jobs under way");
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(lines.next(), None);
    assert_eq!(folder.made(), ["mirrors.json"]);
}

#[cfg(unix)]
#[test]
fn an_interruption_before_the_render_ends_at_once() {
    let folder = Folder::new();
    assert!(Command::new("mkfifo").arg(folder.path("pipe.json")).status().unwrap().success());
    let mut child = folder.command(&["pipe.json", "-o", "a.png"]).stderr(Stdio::piped()).spawn().unwrap();
    // Opening waits for the reader, which then waits for a scene.
    let scene = File::options().write(true).open(folder.path("pipe.json")).unwrap();
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    drop(scene);
    assert_eq!(folder.made(), ["pipe.json"]);
}

#[cfg(unix)]
#[test]
fn readers_that_leave_do_no_harm() {
    let folder = Folder::new();
    for args in [&["check", "lit.json"][..], &["lit.json", "--explain"], &["lit.json", "-o", "a.png"], &["--help"]] {
        let mut child = folder.command(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(child.wait().unwrap().code(), Some(0), "{args:?}");
    }
    assert!(folder.path("a.png").exists());
}
