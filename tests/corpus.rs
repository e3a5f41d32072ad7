//! What the fuzzers found worth keeping, again: no input makes the library panic or take long, and some are read.
//!
//! `tests/corpus` holds inputs that reach different code, and each that was ever answered wrongly. `docs/testing.md` tells how
//! the fuzzers run.

#[path = "common/untrusted.rs"]
mod untrusted;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use std::{fs, path::Path};
use untrusted::{Folder, Verdict};

/// As long as a fuzzer lets an input take.
const LONGEST: Duration = Duration::from_secs(10);

/// Feeds a target's files, each by itself.
fn feed(target: &str, way: fn(&Folder, &[u8]) -> Verdict) {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(target);
    let mut files: Vec<_> = fs::read_dir(corpus).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let folder = Folder::new();
    let (mut verdicts, mut slowest) = (Vec::new(), Duration::ZERO);
    let mut faults = Vec::new();
    for path in &files {
        let (name, bytes) = (path.file_name().unwrap().display(), fs::read(path).unwrap());
        let start = Instant::now();
        // What the library leaves behind when it panics is of no interest: the test has failed.
        match catch_unwind(AssertUnwindSafe(|| way(&folder, &bytes))) {
            Ok(verdict) => verdicts.push(verdict),
            Err(_) => faults.push(format!("{name}: panicked")),
        }
        let time = start.elapsed();
        slowest = slowest.max(time);
        if time > LONGEST {
            faults.push(format!("{name}: took {time:.1?}"));
        }
    }
    let count = |of| verdicts.iter().filter(|&&verdict| verdict == of).count();
    let (accepted, refused) = (count(Verdict::Accepted), count(Verdict::Refused));
    println!("{target}: {} files, {accepted} accepted, {refused} refused, slowest {slowest:.1?}", files.len());
    assert!(faults.is_empty(), "{target}: {faults:#?}");
    // A target that reads nothing, or takes everything, tests nothing.
    assert!(accepted > 0 && refused > 0, "{target}: {accepted} accepted, {refused} refused");
}

#[test]
fn scenes() {
    feed("scene", Folder::scene);
}

#[test]
fn meshes() {
    feed("obj", Folder::obj);
}

#[test]
fn images() {
    feed("image", Folder::image);
}
