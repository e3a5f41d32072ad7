//! Reading and comparing files of less than 1 MiB takes less than 1 GiB and ends soon, whatever is in them: files that unpack
//! to gigabytes, scenes of nothing but mistakes, devices without an end. The program runs as a user runs it, and its peak of memory
//! is read while it runs.
#![cfg(target_os = "linux")]

use ::exr::prelude::{self as exr, WritableImage as _};
use std::fs;
use std::io::Cursor;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const CAMERA: &str =
    r#""camera": {"focalPoint": {"x": 0, "y": 0, "z": 0}, "direction": {"x": 0, "y": 1, "z": 0}}, "materials": "#;
const GIB: u64 = 1 << 30;
/// Far above what is needed, for machines with other work; what went wrong once took minutes.
const SOON: Duration = Duration::from_secs(5);

struct Folder(TempDir);

struct Ran {
    code: Option<i32>,
    err: String,
    time: Duration,
    /// Most bytes that it held.
    peak: u64,
}

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }
    fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        assert!(bytes.as_ref().len() < 1 << 20, "{name}: {} bytes", bytes.as_ref().len());
        fs::write(&path, bytes).unwrap();
        path
    }
    /// Runs `command` in a shell, where `$W` is the program; with `exec` in front the peak is that of the program.
    fn run(&self, command: &str) -> Ran {
        let start = Instant::now();
        let (out, err) = (self.0.path().join("out"), self.0.path().join("err"));
        let mut child = Command::new("sh")
            .args(["-c", command])
            .env("W", env!("CARGO_BIN_EXE_wavetrace"))
            .current_dir(self.0.path())
            .stdin(Stdio::null())
            .stdout(fs::File::create(out).unwrap())
            .stderr(fs::File::create(&err).unwrap())
            .spawn()
            .unwrap();
        let status = format!("/proc/{}/status", child.id());
        let mut peak = 0;
        let code = loop {
            let text = fs::read_to_string(&status).unwrap_or_default();
            let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
            let kib = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok());
            peak = peak.max(kib.unwrap_or(0) << 10);
            if let Some(status) = child.try_wait().unwrap() {
                break status.code();
            }
            if start.elapsed() > 12 * SOON {
                child.kill().unwrap();
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        let err = String::from_utf8_lossy(&fs::read(err).unwrap()).into_owned();
        let ran = Ran { code, err, time: start.elapsed(), peak };
        println!("{command}: {:.2?}, {} MiB, {:.200}", ran.time, ran.peak >> 20, ran.err.lines().next().unwrap_or(""));
        ran
    }
    /// Runs what must fail soon, with little memory, and with a message that has `part`.
    fn fails(&self, command: &str, part: &str) -> Ran {
        let ran = self.run(command);
        assert_eq!(ran.code, Some(1), "{command}: {:.1000}", ran.err);
        assert!(ran.err.contains(part), "{command}: expected {part:?} in: {:.1000}", ran.err);
        assert!(ran.time < SOON && ran.peak < GIB / 2, "{command}: {:.1?}, {} bytes", ran.time, ran.peak);
        ran
    }
}

#[test]
fn scenes_of_many_mistakes() {
    let folder = Folder::new();
    let many = |piece: &str, length: usize| vec![piece; 950_000 / (length + 1)].join(",");
    let numbered = |piece: &str, length: usize| {
        (0..950_000 / (length + 6)).map(|i| piece.replace('#', &format!("{i:05}"))).collect::<Vec<_>>().join(",")
    };
    let nested: String = (0..60).map(|i| format!("{{\"{}{i:02}\":", "ä".repeat(58))).collect();
    for (name, text) in [
        // One line whose columns are characters, not bytes.
        ("long line", format!("{{\"ä\": 1, {CAMERA} [{}], \"objects\": []}}", many("7", 1))),
        ("deep", format!("{nested}{{{}}}{}", many("\"a\":1", 5), "}".repeat(60))),
        ("missing keys", format!("{{{CAMERA} [{}], \"objects\": []}}", many("{}", 2))),
        ("words", format!("{{{CAMERA} [{}], \"objects\": []}}", many("{\"type\":\"difuse\"}", 17))),
        ("meshes", format!("{{{CAMERA} [], \"objects\": [{}]}}", numbered("{\"path\":\"#\"}", 11))),
    ] {
        folder.put("a.json", text);
        let ran = folder.fails("exec \"$W\" check a.json", " more mistakes, expected none\n");
        assert!(ran.err.lines().count() <= 103 && ran.err.len() < 100_000, "{name}: {} bytes", ran.err.len());
    }
    // Unknown keys, among which each key that is missing is looked for.
    let letter = |i: u32| char::from_u32(0x4E00 + i).unwrap();
    let strangers = (0..60_000).map(|i| format!("\"{}{}mera\":1", letter(i / 250), letter(i % 250)));
    folder.put("a.json", format!("{{{}}}", strangers.collect::<Vec<_>>().join(",")));
    folder.fails("exec \"$W\" check a.json", "did you mean it by `\u{4E00}\u{4E00}mera` at line 1, column 2?");
}

#[test]
fn images_that_unpack_to_gigabytes() {
    let folder = Folder::new();
    let corpus = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus/image");
    for name in ["one_colour.png", "one_colour.hdr", "one_colour.exr"] {
        folder.put(name, fs::read(corpus.join(name)).unwrap());
        folder.fails(&format!("exec \"$W\" compare {name} {name}"), "pixels in ");
    }
    // Texts of nearly 4 MiB each, which come to 400 MB.
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 8, 8);
    let text = "\u{e9}".repeat(2_000_000);
    for i in 0..100 {
        encoder.add_ztxt_chunk(format!("k{i}"), text.clone()).unwrap();
    }
    encoder.write_header().unwrap().write_image_data(&[0; 64]).unwrap();
    folder.put("texts.png", bytes);
    let ran = folder.run("exec \"$W\" compare texts.png texts.png");
    assert!(ran.code == Some(0) && ran.time < SOON && ran.peak < GIB / 8, "{:.1?}, {} bytes", ran.time, ran.peak);
}

/// What is just allowed is read, and compared in less than a gibibyte.
#[test]
fn the_largest_images_of_small_files() {
    let folder = Folder::new();
    let (width, height) = (4096, 2048);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.write_header().unwrap().write_image_data(&vec![0; 8 * (width * height) as usize]).unwrap();
    folder.put("a.png", bytes);
    // Six channels: the colours and their variances.
    let names = ["R", "G", "B", "variance.R", "variance.G", "variance.B"];
    let zeros = || exr::FlatSamples::F32(vec![0.0; (width * height) as usize]);
    let channels = names.map(|name| exr::AnyChannel::new(name, zeros()));
    let channels = exr::AnyChannels::sort(channels.into_iter().collect());
    let encoding = exr::Encoding { compression: exr::Compression::PIZ, ..exr::Encoding::SMALL_LOSSLESS };
    let size = (width as usize, height as usize);
    let layer = exr::Layer::new(size, exr::LayerAttributes::default(), encoding, channels);
    let mut bytes = Cursor::new(Vec::new());
    exr::Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    folder.put("a.exr", bytes.into_inner());
    for command in ["a.png a.png", "a.exr a.exr", "--stddev a.png --stddev a.png a.exr a.exr"] {
        let ran = folder.run(&format!("exec \"$W\" compare {command}"));
        assert!(ran.code == Some(0) && ran.peak < GIB, "{command}: {} bytes, {}", ran.peak, ran.err);
        assert!(ran.peak > GIB / 4, "{command}: only {} bytes: the peak was missed", ran.peak);
    }
}

#[test]
fn what_has_no_end_is_not_read_to_it() {
    let folder = Folder::new();
    folder.put("ok.json", format!("{{{CAMERA} [], \"objects\": []}}"));
    let mesh = |path: &str| {
        let object = format!(r#"{{"path": "{path}", "materialIndex": 0, "scale": 1}}"#);
        let material = r#"{"type": "diffuse", "color": {"r": 1, "g": 1, "b": 1}}"#;
        format!("{{{CAMERA} [{material}], \"objects\": [{object}]}}")
    };
    folder.put("zero.json", mesh("/dev/zero"));
    folder.put("pipe.json", mesh("pipe"));
    assert_eq!(folder.run("mkfifo pipe").code, Some(0));
    let refused = "which cannot be read: it is a device or a pipe, no regular file, expected an OBJ file at";
    folder.fails("exec \"$W\" check zero.json", &format!("objects[0].path: found \"/dev/zero\", {refused} /dev/zero"));
    folder.fails("exec \"$W\" check pipe.json", &format!("objects[0].path: found \"pipe\", {refused} pipe"));
    folder.fails(
        "exec \"$W\" check /dev/zero",
        "/dev/zero: cannot read: found more than 268435456 bytes, expected at most",
    );
    folder.fails("exec \"$W\" compare /dev/zero /dev/zero", "/dev/zero: found a file that begins with");
    let endless = "{ printf '#?RADIANCE\\n'; cat /dev/zero; } | ";
    folder.fails(&format!("{endless} \"$W\" compare /dev/stdin /dev/stdin"), "found a stream without an end");
    // One that ends is read, as a scene and as an image.
    assert_eq!(folder.run("cat ok.json | \"$W\" check /dev/stdin").code, Some(0));
    folder.put("a.ppm", b"P6\n2 1\n255\nabcdef");
    assert_eq!(folder.run("cat a.ppm | \"$W\" compare /dev/stdin a.ppm").code, Some(0));
}
