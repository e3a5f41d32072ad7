//! Files that are written halfway.

use crate::common::meshes::repository;
use crate::common::random::Random;
use crate::common::samples;
use crate::row::{Finding, Part, Row};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use wavetrace::Error;
use wavetrace::output::{self, Image, Metadata, Tone, ToneMap};

pub const ROW: Row = Row {
    part: Part::Input,
    name: "whole_files",
    title: "A full disk or Ctrl-C leaves half an image, and the old one is gone",
    fails: "Textbooks open the file, which empties it, and write. Until they are done the file is half an image; if \
        the disk is full or the program is ended it stays so, and what was there before is lost.",
    remedy: "An image is written to a new file in the same folder, brought to the disk, and then renamed, which \
        replaces what was there in one step. Where anything fails the new file is removed. Ctrl-C ends the render, \
        not the writing: the image so far is written whole, and marked as partial. A program that is killed, or \
        interrupted again while it writes, can leave a hidden file `.wavetrace-*.tmp`; the image itself is never \
        half. Devices and pipes are written to directly.",
    source: "Pillai, Chidambaram, Alagappan, Al-Kiswany, Arpaci-Dusseau and Arpaci-Dusseau 2014",
    run,
};

const ENDINGS: [&str; 4] = ["png", "ppm", "exr", "hdr"];
const OLD: &[u8] = b"precious";
/// Bytes that a textbook writes at once.
const CHUNK: usize = 8192;

/// Names and contents of a folder.
fn listing(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
    files.map(|path| (path.clone(), fs::read(&path).unwrap())).collect()
}

/// A folder with an old image of each format.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    ENDINGS.iter().for_each(|ending| fs::write(folder.path().join("old").with_extension(ending), OLD).unwrap());
    folder
}

/// Noise, which does not compress.
fn noise(side: u32, seed: u64) -> Image {
    let mut random = Random(seed);
    let pixels = (0..side * side).map(|_| [random.unit(), random.unit(), random.unit()]).collect();
    Image { width: side, height: side, pixels }
}

fn write(path: &Path, image: &Image) -> Result<(), Error> {
    output::write(path, image, &Metadata::default(), &Tone::default())
}

/// Ways to fail through the library: how many there were. None changes the folder.
fn failures() -> usize {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("folder.png")).unwrap();
    fs::write(at("locked.png"), OLD).unwrap();
    let mut permissions = fs::metadata(at("locked.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(at("locked.png"), permissions).unwrap();
    let before = listing(folder.path());
    let image = noise(8, 1);
    let mut paths =
        ["folder.png", "missing/a.png", "old.png/a.png", "locked.png", "new.png/", "a.jpg", "old", "a.png.tmp"]
            .map(at)
            .to_vec();
    // A full device, and a folder that not even root may write to.
    paths.extend(
        ["/dev/full", "/proc/wavetrace.png"].map(PathBuf::from).into_iter().filter(|_| cfg!(target_os = "linux")),
    );
    let mut count = paths.len();
    for path in paths {
        let message = write(&path, &image).expect_err(&path.to_string_lossy()).to_string();
        assert!(message.starts_with(&*path.to_string_lossy()), "{message}");
    }
    let flawed = Image { pixels: Vec::new(), ..image.clone() };
    let dark = Tone { exposure_ev: f32::NAN, map: ToneMap::Clamp };
    for path in before.keys().filter(|path| !path.ends_with("locked.png")) {
        assert!(write(path, &flawed).is_err() && output::write(path, &image, &Metadata::default(), &dark).is_err());
        count += 2;
    }
    assert_eq!(listing(folder.path()), before, "a failure changed the folder");
    count
}

/// Looks at a file while two images are written to it in turn: how often, and whether each time it was either.
fn looks() -> usize {
    let folder = TempDir::new().unwrap();
    let (path, done) = (folder.path().join("a.ppm"), AtomicBool::new(false));
    let images = [noise(96, 1), noise(160, 2)];
    let whole = images.each_ref().map(|image| {
        write(&path, image).unwrap();
        fs::read(&path).unwrap()
    });
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let mut looks = 0;
            while !done.load(Ordering::Relaxed) {
                let found = fs::read(&path).unwrap();
                assert!(whole.contains(&found), "{} bytes are none of the images", found.len());
                looks += 1;
            }
            looks
        });
        (0..samples(40)).for_each(|i| write(&path, &images[i as usize % 2]).unwrap());
        done.store(true, Ordering::Relaxed);
        reader.join().unwrap()
    })
}

/// Moments at which a textbook's file is half an image, of all that there are between its writes, open and end
/// included.
fn halves() -> (usize, usize) {
    let folder = folder();
    let [path, new] = ["old.ppm", "new.ppm"].map(|name| folder.path().join(name));
    write(&new, &noise(160, 2)).unwrap();
    let whole = fs::read(&new).unwrap();
    let mut file = File::create(&path).unwrap();
    let mut sizes = vec![fs::metadata(&path).unwrap().len()];
    for chunk in whole.chunks(CHUNK) {
        file.write_all(chunk).unwrap();
        sizes.push(fs::metadata(&path).unwrap().len());
    }
    (sizes.iter().filter(|&&size| size < whole.len() as u64).count(), sizes.len())
}

/// The program on a scene of the repository, in a folder of its own.
fn program(folder: &Path, first: &[&str], args: &[&str]) -> Command {
    let exe = env!("CARGO_BIN_EXE_wavetrace");
    let mut words = first.iter().copied().chain([exe]);
    let mut command = Command::new(words.next().unwrap());
    command.args(words).arg(repository("scenes/cornell.json")).args(args).current_dir(folder).env("TMPDIR", folder);
    command.stdin(Stdio::null()).stdout(Stdio::null());
    command
}

/// A shell whose files may not grow past 4 or 8 KiB, and live on when they try.
const SMALL_DISK: [&str; 3] = ["sh", "-c", r#"trap '' XFSZ; ulimit -f 8; exec "$0" "$@""#];

/// The program and a textbook on a disk that is full after a few KiB: what is left of the textbook's old image, and the
/// bytes that it should have.
fn full_disk() -> [usize; 2] {
    let folder = folder();
    let before = listing(folder.path());
    let outputs = ["old", "new"].iter().flat_map(|stem| ENDINGS.map(|ending| format!("{stem}.{ending}")));
    let args: Vec<String> = outputs.flat_map(|file| ["-o".to_owned(), file]).collect();
    let args: Vec<&str> = ["1", "--size", "96x96"].into_iter().chain(args.iter().map(String::as_str)).collect();
    let run = program(folder.path(), &SMALL_DISK, &args).output().unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    assert_eq!(said.matches("cannot write").count(), 2 * ENDINGS.len(), "{said}");
    assert!(run.status.code() == Some(1) && listing(folder.path()) == before, "{said}");

    let [old, new] = ["old.ppm", "new.ppm"].map(|name| folder.path().join(name));
    write(&new, &noise(96, 1)).unwrap();
    let copy = r#"trap '' XFSZ; ulimit -f 8; cat "$0" > "$1""#;
    let textbook = Command::new("sh").args(["-c", copy]).args([&new, &old]).stderr(Stdio::null()).status().unwrap();
    assert!(!textbook.success());
    [&old, &new].map(|path| fs::read(path).unwrap().len())
}

fn kill(child: &Child, signal: &str) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// Kills the program at many moments: how often it had not replaced the old image, how often it had, and the hidden
/// files that it left.
fn killed() -> [usize; 3] {
    let folder = folder();
    let path = folder.path().join("old.exr");
    let start = || program(folder.path(), &[], &["1", "--size", "256x256", "-q", "-o", "old.exr"]).spawn().unwrap();
    let begin = Instant::now();
    assert!(start().wait().unwrap().success());
    let (time, expected) = (begin.elapsed(), output::read(&path).unwrap().image);
    let (mut random, mut seen) = (Random(1), [0; 3]);
    for _ in 0..samples(10) {
        fs::write(&path, OLD).unwrap();
        let mut child = start();
        // Most of the time goes into writing, which comes last.
        std::thread::sleep(time.mul_f32(random.within(0.3, 1.1)));
        let _ = child.kill();
        child.wait().unwrap();
        let old = fs::read(&path).unwrap() == OLD;
        assert!(old || output::read(&path).unwrap().image == expected, "half an image is left");
        seen[usize::from(!old)] += 1;
    }
    let strange = |path: &PathBuf| path.file_stem().is_none_or(|stem| stem != "old");
    let left: Vec<PathBuf> = listing(folder.path()).into_keys().filter(strange).collect();
    assert!(left.iter().all(|path| path.file_name().unwrap().to_string_lossy().starts_with(".wavetrace-")), "{left:?}");
    seen[2] = left.len();
    seen
}

/// Ctrl-C: the image so far, whole and marked.
fn interrupted() {
    let folder = folder();
    let args = ["4000000000", "--size", "16x16", "--threads", "1", "-o", "old.png", "-o", "old.exr"];
    let mut child = program(folder.path(), &[], &args).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.starts_with("rendering ")));
    // Until the first jobs are under way: nothing outside tells when.
    std::thread::sleep(Duration::from_millis(300));
    kill(&child, "-INT");
    let said: Vec<String> = lines.collect();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said:?}");
    for name in ["old.png", "old.exr"] {
        let file = output::read(&folder.path().join(name)).unwrap();
        assert_eq!((file.image.width, file.metadata.partial), (16, true), "{name}");
    }
    assert_eq!(listing(folder.path()).len(), ENDINGS.len());
}

fn run() -> Finding {
    let (failures, looks, (half, moments)) = (failures(), looks(), halves());
    assert!(
        looks > 0 && half + 1 == moments,
        "{looks} looks; the textbook's file should be half at {half} of {moments}"
    );
    let (mut textbook, mut ours) = (
        format!("half an image at {half} of {moments} moments"),
        format!("{failures} failures change no file and leave none; {looks} looks while writing find whole images"),
    );
    if cfg!(unix) {
        let [left, all] = full_disk();
        assert!(left > OLD.len() && left < all / 2, "the textbook should leave a part: {left} of {all} bytes");
        interrupted();
        let [old, new, hidden] = killed();
        println!("killed: {old} times the old image, {new} times the new one, {hidden} hidden files");
        textbook += &format!("; on a full disk {left} of {all} bytes, and the old image lost");
        ours += &format!(
            "; on a full disk all old images kept; killed {} times, {old} times the old image, {new} times the new \
             one, {hidden} hidden files left",
            old + new
        );
    }
    Finding {
        textbook,
        ours,
        how: "Unusable targets, a full device, images and settings with mistakes, through the library; a reader that \
            looks at a file while images are written to it; and the program with a limit on the size of files, \
            interrupted, and killed at random moments. The textbook's form opens the file and writes."
            .into(),
        picture: None,
    }
}
