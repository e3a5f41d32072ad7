//! Renders by programs, this one or another build of it, counted or timed from outside.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;
use wavetrace::error::{Error, Result};

/// A render by a program.
#[derive(Clone, Copy, Debug)]
pub struct Work<'a> {
    /// The program.
    pub program: &'a Path,
    /// The scene file.
    pub scene: &'a Path,
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Samples per pixel, at least 1.
    pub spp: u32,
}

/// What a render took, and what it gave.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Instructions or seconds per sample.
    pub value: f64,
    /// Bytes of the pixels.
    pub pixels: Vec<u8>,
}

/// Whether [`instructions`] can count here: whether valgrind can be started.
pub fn can_count() -> bool {
    Command::new("valgrind").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Instructions per sample on one thread, counted by valgrind's callgrind: reading, building and starting cancel out of two
/// renders, of one sample per pixel and of `spp` more. What tables with random keys take differs from start to start, by some
/// 400,000 instructions for a mesh of 11,000 triangles: many samples make it small.
///
/// # Errors
/// [`Error::Output`] with what the program or valgrind said, [`Error::Io`] where neither starts.
pub fn instructions(work: &Work<'_>) -> Result<Figure> {
    let count = |spp: u32| {
        let mut command = Command::new("valgrind");
        command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(whole(work.program)?);
        command.args(["--threads", "1"]);
        let (output, folder) = render(command, work, spp)?;
        let text = String::from_utf8_lossy(&output.stderr);
        let all = collected(&text).ok_or_else(|| fault(work.program, "expected valgrind to say what it collected"))?;
        Ok((all as f64, pixels(&folder, work)?))
    };
    let ((few, _), (many, pixels)) = (count(1)?, count(work.spp.saturating_add(1))?);
    let samples = f64::from(work.size.0) * f64::from(work.size.1) * f64::from(work.spp);
    Ok(Figure { value: (many - few) / samples, pixels })
}

/// Seconds per sample of the render alone, on all threads.
///
/// # Errors
/// As [`instructions`].
pub fn seconds(work: &Work<'_>) -> Result<Figure> {
    let mut command = Command::new(whole(work.program)?);
    command.args(["--stats", "stats.json"]);
    let (_, folder) = render(command, work, work.spp)?;
    let path = folder.path().join("stats.json");
    let text = std::fs::read_to_string(&path).map_err(|source| Error::Io { file: path, action: "read", source })?;
    let figures: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let rate = figures["samples_per_s"].as_f64().filter(|rate| *rate > 0.0);
    let rate = rate.ok_or_else(|| fault(work.program, "expected samples per second in what --stats writes"))?;
    Ok(Figure { value: 1.0 / rate, pixels: pixels(&folder, work)? })
}

/// The pixels of the image in the folder of a render, behind its head.
fn pixels(folder: &TempDir, work: &Work<'_>) -> Result<Vec<u8>> {
    let path = folder.path().join("image.ppm");
    let mut bytes = std::fs::read(&path).map_err(|source| Error::Io { file: path, action: "read", source })?;
    let head = bytes.len().saturating_sub(3 * work.size.0 as usize * work.size.1 as usize);
    Ok(bytes.split_off(head))
}

/// Runs `command` with what a render is told; it must succeed. Its files are in the folder.
fn render(mut command: Command, work: &Work<'_>, spp: u32) -> Result<(Output, TempDir)> {
    let io = |file: &Path, action, source| Error::Io { file: file.to_owned(), action, source };
    let folder = tempfile::tempdir().map_err(|source| io(&std::env::temp_dir(), "write into", source))?;
    let scene = work.scene.canonicalize().map_err(|source| io(work.scene, "read", source))?;
    let size = format!("{}x{}", work.size.0, work.size.1);
    command.arg("-q").arg(scene).args(["--spp", &spp.to_string(), "--size", &size, "-o", "image.ppm"]);
    let output = command.current_dir(folder.path()).stdin(Stdio::null()).output();
    let output = output.map_err(|source| io(work.program, "start", source))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let line = said.lines().find(|line| !line.starts_with("==") || line.contains("nrecognised")).unwrap_or("");
        return Err(fault(work.program, &format!("ended with {}: {line}", output.status)));
    }
    Ok((output, folder))
}

/// A path that means the same in another folder.
fn whole(program: &Path) -> Result<PathBuf> {
    program.canonicalize().map_err(|source| Error::Io { file: program.to_owned(), action: "start", source })
}

fn fault(program: &Path, reason: &str) -> Error {
    Error::Output { file: program.to_owned(), reason: reason.to_owned() }
}

/// The number behind `Collected :` in what callgrind prints.
fn collected(text: &str) -> Option<u64> {
    text.lines().find_map(|line| line.split_once("Collected :"))?.1.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_count_is_found_in_what_callgrind_prints() {
        let text = "==7== Events    : Ir\n==7== Collected : 49581406\n==7== \n==7== I   refs:      49,581,406\n";
        assert_eq!((collected(text), collected("killed")), (Some(49_581_406), None));
    }

    #[test]
    fn a_program_that_fails_is_told_with_what_it_said() {
        let said = |program: &str| {
            let work = Work { program: Path::new(program), scene: Path::new("Cargo.toml"), size: (8, 8), spp: 1 };
            seconds(&work).unwrap_err().to_string()
        };
        assert!(said("/nowhere/wavetrace").contains("/nowhere/wavetrace: cannot start"));
        #[cfg(unix)]
        assert!(said("/bin/false").contains("/bin/false: ended with"));
    }
}
