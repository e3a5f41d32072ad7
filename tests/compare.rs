//! `wavetrace compare` as a user meets it: renders against renders, files of other programs, faults.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use tempfile::TempDir;
use wavetrace::output::{self, Image, Metadata, Tone};
use wavetrace::report::{self, Scale, Viewing};

/// Renders of the Cornell box that the tests share: 16 samples per pixel, 128 x 128 pixels.
struct Renders {
    folder: TempDir,
}

impl Renders {
    fn get() -> &'static Self {
        static RENDERS: OnceLock<Renders> = OnceLock::new();
        RENDERS.get_or_init(|| {
            let renders = Self { folder: tempfile::tempdir().unwrap() };
            let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.json");
            let text = fs::read_to_string(&scene).unwrap();
            let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes").display().to_string();
            let text = text.replace("../meshes", &meshes.replace('\\', "/"));
            fs::write(renders.path("cornell.json"), &text).unwrap();
            fs::write(renders.path("brighter.json"), scaled(&text, 1.02)).unwrap();
            for (name, scene, seed) in [("a", "cornell", "0"), ("b", "cornell", "1"), ("brighter", "brighter", "2")] {
                renders.render(&[
                    &format!("{scene}.json"),
                    "16",
                    "--seed",
                    seed,
                    "-o",
                    &format!("{name}.exr"),
                    "--variance",
                ]);
            }
            renders.render(&["cornell.json", "16", "--seed", "0", "-o", "a.png", "-o", "a.hdr", "-o", "a.ppm"]);
            renders.render(&["cornell.json", "64", "--seed", "3", "-o", "more.exr", "--variance"]);
            renders.render(&[
                "cornell.json",
                "16",
                "--seed",
                "4",
                "-o",
                "sobol.exr",
                "--variance",
                "--sampler",
                "sobol",
            ]);
            renders.render(&["cornell.json", "2", "-o", "small.exr", "--size", "64x32"]);
            renders
        })
    }
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
    fn render(&self, args: &[&str]) {
        let size = if args.contains(&"--size") { &[][..] } else { &["--size", "128x128"] };
        let sampler = if args.contains(&"--sampler") { &[][..] } else { &["--sampler", "xoshiro"] };
        let ran = run(self.folder.path(), &[args, size, sampler, &["-q"]].concat());
        assert_eq!(ran.code, Some(0), "{args:?}: {}", ran.err);
    }
}

/// All diffuse colours of a scene times a factor.
fn scaled(scene: &str, by: f64) -> String {
    let mut scene: Value = serde_json::from_str(scene).unwrap();
    for material in scene["materials"].as_array_mut().unwrap() {
        if material["isLuminous"] != Value::Bool(true) {
            for channel in ["r", "g", "b"] {
                let value = material["color"][channel].as_f64().unwrap();
                material["color"][channel] = (value * by).into();
            }
        }
    }
    scene.to_string()
}

struct Ran {
    code: Option<i32>,
    out: String,
    err: String,
}

fn run(folder: &Path, args: &[&str]) -> Ran {
    let output = Command::new(env!("CARGO_BIN_EXE_wavetrace")).current_dir(folder).args(args).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Ran { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

/// A folder of a test's own, with links to the shared renders.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let (folder, renders) = (Self(tempfile::tempdir().unwrap()), Renders::get());
        for entry in fs::read_dir(renders.folder.path()).unwrap() {
            let entry = entry.unwrap();
            fs::copy(entry.path(), folder.0.path().join(entry.file_name())).unwrap();
        }
        folder
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn compare(&self, args: &[&str]) -> Ran {
        run(self.0.path(), &[&["compare"], args].concat())
    }
    /// What must succeed, for people.
    fn table(&self, args: &[&str]) -> String {
        let ran = self.compare(args);
        assert_eq!(ran.code, Some(0), "{args:?}: {}", ran.err);
        ran.out
    }
    /// What must succeed, as JSON.
    fn json(&self, args: &[&str]) -> Value {
        serde_json::from_str(&self.table(&[args, &["--json"]].concat())).unwrap()
    }
    /// What must fail with an exit code and a message.
    fn fails(&self, code: i32, args: &[&str], parts: &[&str]) {
        let ran = self.compare(args);
        assert_eq!(ran.code, Some(code), "{args:?}: {}", ran.err);
        assert!(ran.err.starts_with("error: ") && ran.out.is_empty(), "{args:?}: {}{}", ran.err, ran.out);
        for part in parts {
            assert!(ran.err.contains(part), "{args:?}: expected {part:?} in: {}", ran.err);
        }
    }
    fn write(&self, name: &str, image: &Image) {
        output::write(&self.path(name), image, &Metadata::default(), &Tone::default()).unwrap();
    }
    fn read(&self, name: &str) -> Image {
        output::read(&self.path(name)).unwrap().image
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn an_image_agrees_with_itself() {
    let folder = Folder::new();
    let ran = folder.compare(&["a.exr", "a.exr", "--heatmap", "h.png"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert!(ran.err.contains("same scene and seed"), "{}", ran.err);
    assert!(ran.err.contains("wrote h.png: relative squared error, black 1e-5 to yellow 1"), "{}", ran.err);
    assert!(ran.out.contains("the images agree, at the significance 0.001"), "{}", ran.out);
    let found = folder.json(&["a.exr", "a.exr"]);
    for metric in ["relmse", "mse", "flip"] {
        assert_eq!((number(&found[metric]["raw"]), number(&found[metric]["trimmed"])), (0.0, 0.0), "{metric}");
    }
    assert_eq!(found["psnr"]["raw"], Value::Null, "infinite");
    assert_eq!(found["mean"]["image"], found["mean"]["reference"]);
    assert_eq!((&found["pixels"], &found["trimmed_pixels"]), (&16384.into(), &16.into()));
    let black = Tone::default().to_srgb8(&folder.read("h.png"));
    assert!(black.chunks(3).all(|pixel| pixel == Scale::RelativeError.colour(0.0)));
}

#[test]
fn another_seed_agrees_and_another_colour_differs() {
    let folder = Folder::new();
    let found = folder.json(&["b.exr", "a.exr"]);
    let test = &found["t_test"];
    assert_eq!((test["verdict"].as_str(), &test["block"], &test["below"]), (Some("agree"), &1.into(), &0.into()));
    let tests: u64 = test["histogram"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).sum();
    assert_eq!(tests, test["tests"].as_u64().unwrap());
    let components = ["tests", "exact", "unequal", "unknown"].map(|key| test[key].as_u64().unwrap());
    assert_eq!(components.iter().sum::<u64>(), 3 * 128 * 128);
    // The lamp and nothing else is exact.
    assert!((1..1000).contains(&components[1]) && components[2..] == [0, 0], "{components:?}");

    // 2 % on each bounce: no pixel shows it, all of them together do.
    let found = folder.json(&["brighter.exr", "a.exr"]);
    let test = &found["t_test"];
    assert_eq!((test["verdict"].as_str(), &test["below"]), (Some("differ"), &0.into()));
    let level = number(&test["channel_level"]);
    assert!(test["mean_p"].as_array().unwrap().iter().any(|p| number(p) < level), "{test}");
    let ratio =
        number(&found["mean"]["image"]["luminance"]["raw"]) / number(&found["mean"]["reference"]["luminance"]["raw"]);
    assert!((1.01..1.08).contains(&ratio), "{ratio}");
    assert!(folder.table(&["brighter.exr", "a.exr"]).contains("the images differ"));
}

/// Where the samples are not as many, single pixels of few samples prove nothing: they are taken together.
#[test]
fn unequal_renders_are_compared_by_squares() {
    let folder = Folder::new();
    let found = folder.json(&["a.exr", "more.exr"]);
    assert_eq!((found["t_test"]["verdict"].as_str(), &found["t_test"]["block"]), (Some("agree"), &64.into()));
    assert_eq!(found["t_test"]["tests"], 12);
    assert!(folder.table(&["a.exr", "more.exr"]).contains("by square of 64x64 pixels: 0 below p = "));
    assert_eq!(folder.json(&["a.exr", "more.exr", "--block", "32"])["t_test"]["tests"], 48);
    // What the squares are for.
    assert_eq!(folder.json(&["a.exr", "more.exr", "--block", "1"])["t_test"]["verdict"], "differ");
    let ran = folder.compare(&["sobol.exr", "a.exr"]);
    assert!(ran.code == Some(0) && ran.err.contains("sobol.exr: its samples are Sobol points"), "{}", ran.err);
    // The reference's own noise: the corrected error of a fine image is below that of a coarse one.
    let less = |a: &str, b: &str| number(&folder.json(&[a, b])["relmse_less_noise"]["trimmed"]);
    let raw = |a: &str, b: &str| number(&folder.json(&[a, b])["relmse"]["trimmed"]);
    assert!(less("a.exr", "more.exr") < raw("a.exr", "more.exr"));
}

#[test]
fn standard_deviations_stand_for_variances() {
    let folder = Folder::new();
    for name in ["a", "b"] {
        let file = output::read(&folder.path(&format!("{name}.exr"))).unwrap();
        let deviations = file.variance.unwrap().iter().map(|v| v.map(f32::sqrt)).collect();
        output::write(&folder.path(&format!("bare-{name}.exr")), &file.image, &file.metadata, &Tone::default())
            .unwrap();
        folder.write(&format!("sd-{name}.exr"), &Image { pixels: deviations, ..file.image });
    }
    let p = |args: &[&str]| number(&folder.json(args)["t_test"]["smallest_p"]);
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
    let expected = p(&["a.exr", "b.exr"]);
    close(p(&["bare-a.exr", "bare-b.exr", "--stddev", "sd-a.exr", "--stddev", "sd-b.exr"]), expected);
    // One file is that of the image without variances.
    close(p(&["a.exr", "bare-b.exr", "--stddev", "sd-b.exr"]), expected);
    close(p(&["bare-a.exr", "b.exr", "--stddev", "sd-a.exr"]), expected);
    // Without any, one image is taken as exact, and the program says so.
    let ran = folder.compare(&["bare-a.exr", "bare-b.exr", "--stddev", "sd-b.exr"]);
    assert!(ran.err.contains("bare-a.exr: found no variances, it is taken as exact"), "{}", ran.err);
    assert!(ran.out.contains("t-test: the images "), "{}", ran.out);
    assert_eq!(folder.json(&["bare-a.exr", "bare-b.exr"])["t_test"], Value::Null);
    let ran = folder.compare(&["a.exr", "bare-b.exr"]);
    assert!(ran.err.contains("note: bare-b.exr: found no variances: no t-test without `--stddev`"), "{}", ran.err);
    assert!(!ran.out.contains("t-test"), "{}", ran.out);
    folder.fails(2, &["a.exr", "b.exr", "--stddev", "sd-a.exr"], &["--stddev: found one file, and variances in both"]);
    folder.fails(2, &["a.exr", "b.exr", "--stddev", "1", "--stddev", "2", "--stddev", "3"], &["found 3 files"]);
    folder.fails(
        1,
        &["a.exr", "b.exr", "--stddev", "small.exr", "--stddev", "sd-b.exr"],
        &["small.exr: found 64x32 pixels"],
    );
    folder.fails(1, &["a.exr", "b.exr", "--stddev", "none.exr"], &["none.exr: cannot read"]);
}

#[test]
fn pixels_without_a_colour_are_counted() {
    let folder = Folder::new();
    let mut image = folder.read("a.exr");
    image.pixels[5][1] = f32::NAN;
    image.pixels[6] = [f32::NAN, f32::INFINITY, 0.0];
    image.pixels[7][2] = f32::NEG_INFINITY;
    folder.write("odd.exr", &image);
    let found = folder.json(&["odd.exr", "b.exr", "--heatmap", "h.png"]);
    assert_eq!((&found["nan_pixels"]["image"], &found["infinite_pixels"]["image"]), (&2.into(), &1.into()));
    assert_eq!((&found["nan_pixels"]["reference"], &found["infinite_pixels"]["reference"]), (&0.into(), &0.into()));
    assert_eq!(found["pixels"], 16384 - 3);
    assert!(["relmse", "mse", "psnr", "flip"].iter().all(|metric| found[metric]["raw"].is_f64()), "{found}");
    let table = folder.table(&["b.exr", "odd.exr"]);
    assert!(table.contains("16,381 compared; 2 NaN in B; 1 infinite in B"), "{table}");
    let codes = Tone::default().to_srgb8(&folder.read("h.png"));
    let green: Vec<usize> = (0..16384).filter(|i| codes[3 * i..3 * i + 3] == [0, 255, 0]).collect();
    assert_eq!(green, [5, 6, 7]);
}

/// One render in all formats: rounding is all that they differ by, where nothing is brighter than white.
#[test]
fn eight_bits_against_floats() {
    let folder = Folder::new();
    let exact = folder.read("a.exr");
    for (name, largest_step) in [("a.png", 1.0 / 255.0), ("a.ppm", 1.0 / 255.0), ("a.hdr", 1.0 / 256.0)] {
        let found = folder.json(&[name, "a.exr"]);
        // The slope of sRGB's inverse is at most 2.28; half a step of it, or of a mantissa, whatever the brightness.
        let rounded = folder.read(name);
        let bright = |pixel: &[f32; 3]| pixel.iter().any(|&c| c > 1.0);
        for (a, b) in rounded.pixels.iter().zip(&exact.pixels).filter(|(_, b)| !bright(b)) {
            let far = (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
            assert!(far < 0.5 * 2.28 * largest_step as f32 + 1e-6, "{name}: {a:?} {b:?}");
        }
        let err = folder.compare(&[name, "a.exr"]).err;
        let noted = err.contains(&format!("note: {name}: its format holds nothing above 1; in a.exr "));
        assert_eq!(noted, name != "a.hdr", "{err}");
        // FLIP looks at what a screen shows, where the brightest pixels are white in both.
        assert!(number(&found["flip"]["raw"]) < 0.01, "{name}: {}", found["flip"]);
    }
}

#[test]
fn figures_are_those_of_the_library() {
    let folder = Folder::new();
    let (a, b) = (folder.read("a.exr"), folder.read("b.exr"));
    let errors = report::errors(&a.pixels, &b.pixels).unwrap();
    let viewing = Viewing { exposure_ev: -1.5, ..Viewing::default() };
    let flip = report::flip(&a.pixels, &b.pixels, 128, &viewing).unwrap();
    let found = folder.json(&["a.exr", "b.exr", "--exposure", "-1.5"]);
    let same =
        |value: &Value, expected: f64| assert!((number(value) / expected - 1.0).abs() < 1e-12, "{value} {expected}");
    same(&found["relmse"]["raw"], errors.rel_mse.raw);
    same(&found["relmse"]["trimmed"], errors.rel_mse.trimmed);
    same(&found["mse"]["raw"], errors.mse.raw);
    same(&found["psnr"]["trimmed"], errors.psnr.trimmed);
    same(&found["flip"]["raw"], flip.mean.raw);
    same(&found["mean"]["image"]["luminance"]["raw"], errors.means[0].luminance.raw);
    same(&found["mean"]["reference"]["rgb"][2]["trimmed"], errors.means[1].rgb[2].trimmed);
    // Exposure changes FLIP alone.
    let unexposed = folder.json(&["a.exr", "b.exr"]);
    assert!(found["flip"] != unexposed["flip"] && found["psnr"] == unexposed["psnr"]);
}

#[test]
fn metrics_are_picked() {
    let folder = Folder::new();
    let found = folder.json(&["a.exr", "b.exr", "--metric", "mse,flip"]);
    let given = ["relmse", "relmse_less_noise", "mse", "psnr", "flip", "mean"].map(|key| !found[key].is_null());
    assert_eq!(given, [false, false, true, false, true, false]);
    let table = folder.table(&["a.exr", "b.exr", "--metric", "psnr"]);
    assert!(table.contains("PSNR") && !table.contains("FLIP") && !table.contains("relMSE"), "{table}");
    // The map shows FLIP where that alone is asked for.
    folder.table(&["a.exr", "b.exr", "--metric", "flip", "--heatmap", "flip.png"]);
    folder.table(&["a.exr", "b.exr", "--metric", "mse,flip", "--heatmap", "error.png"]);
    let (a, b) = (folder.read("a.exr").pixels, folder.read("b.exr").pixels);
    let map = report::flip(&a, &b, 128, &Viewing::default()).unwrap().map;
    let flip: Vec<u8> = map.iter().flat_map(|&value| Scale::Flip.colour(value.into())).collect();
    assert!(Tone::default().to_srgb8(&folder.read("flip.png")) == flip);
    let errors = a.iter().zip(&b).map(|(&a, &b)| report::errors::relative_squared_error(a, b));
    let errors: Vec<u8> = errors.flat_map(|value| Scale::RelativeError.colour(value)).collect();
    assert!(Tone::default().to_srgb8(&folder.read("error.png")) == errors);
}

/// Each fault has its message and exit code, and leaves a heat map that was there as it was.
#[test]
fn faults_leave_no_heat_map() {
    let folder = Folder::new();
    let whole = fs::read(folder.path("a.exr")).unwrap();
    fs::write(folder.path("cut.exr"), &whole[..whole.len() / 2]).unwrap();
    fs::write(folder.path("empty.png"), "").unwrap();
    fs::write(folder.path("text.png"), "not an image").unwrap();
    fs::create_dir(folder.path("folder.png")).unwrap();
    fs::write(folder.path("old.png"), "precious").unwrap();
    let faults: [(&[&str], i32, &[&str]); 14] = [
        (&["none.exr", "b.exr"], 1, &["none.exr: cannot read: "]),
        (&["a.exr", "none.exr"], 1, &["none.exr: cannot read: "]),
        (&["folder.png", "b.exr"], 1, &["folder.png: found a folder, expected a PNG"]),
        (&["empty.png", "b.exr"], 1, &["empty.png: found an empty file"]),
        (&["text.png", "b.exr"], 1, &["text.png: found a file that begins with \"not an i\""]),
        (&["cut.exr", "b.exr"], 1, &["cut.exr: found a file that ends early, expected a whole OpenEXR image"]),
        (&["cornell.json", "b.exr"], 1, &["cornell.json: found a file that begins with"]),
        (&["small.exr", "b.exr"], 1, &["small.exr: found 64x32 pixels, expected 128x128 pixels as in b.exr"]),
        (&["a.exr", "b.exr", "--metric", "ssim"], 2, &["'ssim'", "relmse, mse, psnr, flip, mean"]),
        (&["a.exr", "b.exr", "--exposure", "nan"], 2, &["finite"]),
        (&["a.exr", "b.exr", "--block", "0"], 2, &["1..=65536"]),
        (&["a.exr"], 2, &["<B>"]),
        (&["a.exr", "b.exr", "c.exr"], 2, &["unexpected argument 'c.exr'"]),
        (&["a.exr", "b.exr", "--no-such"], 2, &["unexpected argument '--no-such'"]),
    ];
    for (args, code, parts) in faults {
        folder.fails(code, &[args, &["--heatmap", "new.png"]].concat(), parts);
        folder.fails(code, &[args, &["--heatmap", "old.png"]].concat(), parts);
    }
    let targets: [(&str, i32, &str); 6] = [
        ("a.bmp", 2, "a.bmp: found the ending .bmp"),
        ("a", 2, "a: found no ending"),
        ("a.exr", 2, "a.exr: found an image that is compared, expected a file of its own for --heatmap"),
        ("./b.exr", 2, "expected a file of its own"),
        ("folder.png", 1, "folder.png: found a folder, expected a file"),
        ("none/h.png", 1, "there is no folder none"),
    ];
    for (target, code, part) in targets {
        folder.fails(code, &["a.exr", "b.exr", "--heatmap", target], &[part]);
    }
    assert_eq!(fs::read(folder.path("old.png")).unwrap(), b"precious");
    assert_eq!(fs::read(folder.path("a.exr")).unwrap(), whole);
    assert!(!folder.path("new.png").exists());
    let left: Vec<_> = fs::read_dir(folder.0.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().contains("tmp")), "{left:?}");
}
