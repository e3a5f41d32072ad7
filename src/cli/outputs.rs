//! The image files of a render: looked at before it, written after it.

use super::Exit;
use super::args::RenderArgs;
use super::messages::Console;
use std::env;
use std::path::{Path, PathBuf};
use wavetrace::error::{Error, Result as LibraryResult};
use wavetrace::output::{self, Format, Layers, Metadata, Tone};
use wavetrace::render::SamplerKind;

/// What came of writing.
pub struct Written {
    /// The files that are there now.
    pub files: Vec<PathBuf>,
    /// Whether each wanted file is among them.
    pub complete: bool,
}

/// Finds out whether all files can be written, before the work is done; shows all that cannot.
pub fn check(args: &RenderArgs, console: &Console) -> Result<(), Exit> {
    let mut exit = None;
    let mut wrong = |error: &Error, code: Exit| {
        console.error(error);
        // A mistake in the command line is the one to mend first.
        exit = if exit == Some(Exit::Usage) { exit } else { Some(code) };
    };
    let unnamed = if args.output.is_empty() { output::check_writable(Path::new(&default_name())) } else { Ok(()) };
    if let Err(error) = unnamed {
        wrong(&error, Exit::Fault);
    }
    for path in &args.output {
        if let Err(error) = output::check_writable(path) {
            wrong(&error, if Format::from_path(path).is_err() { Exit::Usage } else { Exit::Fault });
        }
    }
    let figures = [("--stats", &args.stats), ("--trace", &args.trace)];
    for (k, (option, path)) in figures.iter().enumerate() {
        let Some(path) = path else { continue };
        let others = args.output.iter().chain([&args.scene]).chain(figures[..k].iter().filter_map(|f| f.1.as_ref()));
        if others.into_iter().any(|other| same_file(other, path)) {
            let reason =
                format!("found the scene, the image or other figures, expected a file of its own for {option}");
            wrong(&Error::Output { file: path.clone(), reason }, Exit::Usage);
        } else if let Err(error) = output::check_writable_text(path) {
            wrong(&error, Exit::Fault);
        }
    }
    if args.variance && !args.output.iter().any(|path| Format::from_path(path).is_ok_and(|f| f == Format::Exr)) {
        let (setting, found) = ("--variance", "no .exr output".to_owned());
        wrong(&Error::Setting { setting, found, expected: "one, such as `-o image.exr`".to_owned() }, Exit::Usage);
    }
    exit.map_or(Ok(()), Err)
}

/// Says where the variances are not what one might take them for.
pub fn warn(args: &RenderArgs, console: &Console) {
    let settings = args.settings();
    if args.variance && settings.sampler == SamplerKind::Sobol {
        console.warn(
            "--variance: Sobol points are not independent, and their spread overestimates the variance of the mean; \
             `--sampler xoshiro` has samples that are",
        );
    }
    if args.variance && settings.spp == 1 {
        console.warn("--variance: one sample per pixel has no spread, all variances are infinite");
    }
}

/// Whether both paths lead to one file, as far as one can tell before it is there.
pub fn same_file(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b && a.is_file())
}

/// Writes the image to each file that the user named, or to a new one. One that fails does not keep the others from
/// being written; if all do, the image goes to where it can.
pub fn write(args: &RenderArgs, image: Layers<'_>, metadata: &Metadata, console: &Console) -> Written {
    let (wanted, tone) = (&args.output, args.tone());
    let mut written = Written { files: Vec::new(), complete: true };
    let mut keep = |result: LibraryResult<PathBuf>| match result {
        Ok(path) => written.files.push(path),
        Err(error) => {
            written.complete = false;
            console.error(error);
        }
    };
    if wanted.is_empty() {
        keep(output::write_new(Path::new(""), &default_name(), image, metadata, &tone));
    }
    for (path, result) in wanted.iter().zip(output::write_all(wanted, image, metadata, &tone)) {
        keep(result.map(|()| path.clone()));
    }
    if written.files.is_empty() {
        rescue(args, image, metadata, &tone, console);
    }
    written
}

/// A finished image must not be lost because its file cannot be written.
fn rescue(args: &RenderArgs, image: Layers<'_>, metadata: &Metadata, tone: &Tone, console: &Console) {
    let format = args.output.first().and_then(|path| Format::from_path(path).ok());
    let ending = match format {
        Some(Format::Exr | Format::Hdr) => "exr",
        _ => "png",
    };
    let name = Path::new(&default_name()).with_extension(ending);
    for folder in [PathBuf::new(), env::temp_dir()] {
        if let Ok(path) = output::write_new(&folder, &name.to_string_lossy(), image, metadata, tone) {
            console.error(format_args!("{}: the image is here instead", path.display()));
            return;
        }
    }
}

fn default_name() -> String {
    output::default_name(output::local_now())
}
