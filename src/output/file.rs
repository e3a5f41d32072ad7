//! Safe writing: a file is there whole or not at all. The only file that names `tempfile`.

use std::{
    fs::{OpenOptions, Permissions},
    io::{self, BufWriter, Cursor, Write},
    path::{Path, PathBuf},
};

use tempfile::{Builder, NamedTempFile};

use super::{Format, Layers, Metadata, Tone, target::Target};
use crate::error::{Error, Result};

/// Highest number that [`write_new`] appends.
const MAX_NUMBER: u32 = 99_999;

/// Writes an image, or [`Layers`] of one, in the format that the ending of `path` names.
///
/// A file that is there already is replaced in one step once the new one is complete, and keeps its permissions; a
/// symbolic link is followed. Devices and pipes are written to directly, as PNG where they have no ending.
///
/// # Errors
/// [`Error::Output`] for an unknown ending, an unusable target or an image whose pixels or variances do not match its size;
/// [`Error::Setting`] for an exposure that is not finite; [`Error::Io`] where the system refuses. Nothing is left
/// behind then, and a file that was there is as it was.
pub fn write<'a>(path: &Path, image: impl Into<Layers<'a>>, metadata: &Metadata, tone: &Tone) -> Result<()> {
    let (target, format) = Target::with_format(path)?;
    let layers = image.into();
    check_image(path, layers, tone)?;
    match target {
        Target::Stream => {
            let mut data = Cursor::new(Vec::new());
            format.encode(layers, metadata, tone, &mut data).map_err(|error| error.of(path))?;
            let stream = OpenOptions::new().write(true).open(path);
            stream.and_then(|mut stream| stream.write_all(data.get_ref())).map_err(|error| failed(path, error))
        }
        Target::File { path: place, folder, permissions } => {
            let file = temporary(&folder).map_err(|error| failed(path, error))?;
            fill(&file, format, path, layers, metadata, tone)?;
            replace(file, &place, permissions).map_err(|error| failed(path, error))
        }
    }
}

/// Writes text, such as figures as JSON, as [`write_bytes`] does.
///
/// # Errors
/// [`Error::Output`] for an unusable target, [`Error::Io`] where the system refuses.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write_bytes(path, text.as_bytes())
}

/// Writes bytes of any kind as [`write()`] writes images: the file is there whole or not at all. The ending is free.
///
/// # Errors
/// [`Error::Output`] for an unusable target, [`Error::Io`] where the system refuses.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    let written = match Target::find(path)? {
        Target::Stream => OpenOptions::new().write(true).open(path).and_then(|mut stream| stream.write_all(bytes)),
        Target::File { path: place, folder, permissions } => temporary(&folder).and_then(|file| {
            file.as_file().write_all(bytes)?;
            file.as_file().sync_all()?;
            replace(file, &place, permissions)
        }),
    };
    written.map_err(|error| failed(path, error))
}

/// Writes an image to each path in turn with [`write()`]; one failure does not keep the others from being written.
/// The results are in the order of `paths`.
pub fn write_all<'a, P: AsRef<Path>>(
    paths: &[P],
    image: impl Into<Layers<'a>>,
    metadata: &Metadata,
    tone: &Tone,
) -> Vec<Result<()>> {
    let layers = image.into();
    paths.iter().map(|path| write(path.as_ref(), layers, metadata, tone)).collect()
}

/// Writes an image as `name` in the folder `dir`, never over anything that is there: where the name is taken, `-2`,
/// `-3`, ... is put before the ending. Two programs at once get two files. Returns the path written.
///
/// # Errors
/// As [`write()`]; also [`Error::Output`] where all names up to `-99999` are taken.
pub fn write_new<'a>(
    dir: &Path,
    name: &str,
    image: impl Into<Layers<'a>>,
    metadata: &Metadata,
    tone: &Tone,
) -> Result<PathBuf> {
    let (first, layers) = (dir.join(name), image.into());
    let format = Format::from_path(&first)?;
    check_image(&first, layers, tone)?;
    let folder = if dir.as_os_str().is_empty() { Path::new(".") } else { dir };
    let mut file = temporary(folder).map_err(|error| failed(&first, error))?;
    fill(&file, format, &first, layers, metadata, tone)?;
    for number in 1..=MAX_NUMBER {
        let path = numbered(&first, number);
        match file.persist_noclobber(&path) {
            Ok(_) => return Ok(path),
            Err(taken) if taken.error.kind() == io::ErrorKind::AlreadyExists => file = taken.file,
            Err(other) => return Err(failed(&path, other.error)),
        }
    }
    Err(Error::Output { file: first, reason: format!("this name and all up to -{MAX_NUMBER} are taken") })
}

/// Finds out whether [`write()`] would be able to write to `path`, before hours are spent on an image. Leaves everything
/// as it is.
///
/// # Errors
/// [`Error::Output`] or [`Error::Io`], as [`write()`].
pub fn check_writable(path: &Path) -> Result<()> {
    check_target(path, &Target::with_format(path)?.0)
}

/// Finds out whether [`write_text`] would be able to write to `path`. Leaves everything as it is.
///
/// # Errors
/// [`Error::Output`] or [`Error::Io`], as [`write_text`].
pub fn check_writable_text(path: &Path) -> Result<()> {
    check_target(path, &Target::find(path)?)
}

fn check_target(path: &Path, target: &Target) -> Result<()> {
    match target {
        Target::Stream => Ok(()),
        Target::File { folder, .. } => temporary(folder).map(drop).map_err(|error| failed(path, error)),
    }
}

fn check_image(path: &Path, layers: Layers<'_>, tone: &Tone) -> Result<()> {
    tone.check()?;
    match layers.flaw() {
        Some(reason) => Err(Error::Output { file: path.to_owned(), reason }),
        None => Ok(()),
    }
}

/// An empty file that vanishes unless it is renamed, with the permissions of any new file: the crate's own default
/// would keep the image from everybody else.
fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let create = |path: &Path| OpenOptions::new().write(true).create_new(true).open(path);
    Builder::new().prefix(".wavetrace-").suffix(".tmp").make_in(folder, create)
}

/// Puts a complete file into its place, with the permissions of the one that was there.
fn replace(file: NamedTempFile, place: &Path, permissions: Option<Permissions>) -> io::Result<()> {
    if let Some(permissions) = permissions {
        // A file system without permissions refuses this; what is in the file matters more.
        let _ = file.as_file().set_permissions(permissions);
    }
    file.persist(place).map(drop).map_err(|error| error.error)
}

/// Writes the image into `file` and waits until it is on the disk: some systems report a full disk only then.
fn fill(
    file: &NamedTempFile,
    format: Format,
    path: &Path,
    layers: Layers<'_>,
    metadata: &Metadata,
    tone: &Tone,
) -> Result<()> {
    let mut sink = BufWriter::new(file.as_file());
    format.encode(layers, metadata, tone, &mut sink).map_err(|error| error.of(path))?;
    sink.flush().and_then(|()| file.as_file().sync_all()).map_err(|error| failed(path, error))
}

/// `a.png` for 1, `a-2.png` for 2.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let (Some(stem), Some(ending), 2..) = (path.file_stem(), path.extension(), number) else {
        return path.to_owned();
    };
    let mut name = stem.to_owned();
    name.push(format!("-{number}."));
    name.push(ending);
    path.with_file_name(name)
}

fn failed(path: &Path, source: io::Error) -> Error {
    Error::Io { file: path.to_owned(), action: "write", source }
}
