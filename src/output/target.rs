//! Where an image goes: what stands at its path, and whether it may be written.

use std::{
    fs::{self, Permissions},
    io,
    path::{self, Path, PathBuf},
};

use super::Format;
use crate::error::{Error, Result};

/// Links followed before a chain of them counts as endless, as on Linux.
const MAX_LINKS: usize = 40;

/// Folders whose files stand for something open already, even where that is a regular file.
const STREAM_FOLDERS: [&str; 3] = ["/dev", "/dev/fd", "/proc/self/fd"];

/// What stands at a path.
pub(super) enum Target {
    /// A device, a pipe or the like: it is written to, not replaced.
    Stream,
    /// A file, or a free name for one.
    File {
        /// Where it is, links followed.
        path: PathBuf,
        /// The folder it is in.
        folder: PathBuf,
        /// Permissions of the file that is there already.
        permissions: Option<Permissions>,
    },
}

impl Target {
    /// Looks at what is there; changes nothing.
    pub(super) fn find(path: &Path) -> Result<Self> {
        let output = |reason: &str| Error::Output { file: path.to_owned(), reason: reason.to_owned() };
        let failed = |source| Error::Io { file: path.to_owned(), action: "write", source };
        if path.to_string_lossy().ends_with(path::is_separator) {
            return Err(output("found a folder, expected a file"));
        }
        let permissions = match fs::metadata(path) {
            Ok(found) if found.is_dir() => return Err(output("found a folder, expected a file")),
            Ok(found) if !found.is_file() || is_stream_name(path) => return Ok(Self::Stream),
            Ok(found) => Some(found.permissions()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(failed(error)),
        };
        if permissions.as_ref().is_some_and(Permissions::readonly) {
            return Err(output("the file is read-only"));
        }
        if permissions.is_some() {
            fs::OpenOptions::new().write(true).open(path).map_err(failed)?;
        }
        let path = follow_links(path).map_err(failed)?;
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        if !folder.is_dir() {
            return Err(output(&format!("there is no folder {}", folder.display())));
        }
        Ok(Self::File { path, folder, permissions })
    }

    /// What stands at `path` and the format to write. A stream without an ending, such as `/dev/stdout`, gets PNG.
    pub(super) fn with_format(path: &Path) -> Result<(Self, Format)> {
        let target = Self::find(path);
        match (Format::from_path(path), target) {
            (Err(_), Ok(Self::Stream)) if path.extension().is_none() => Ok((Self::Stream, Format::Png)),
            (format, target) => {
                let format = format?;
                Ok((target?, format))
            }
        }
    }
}

fn is_stream_name(path: &Path) -> bool {
    path.parent().is_some_and(|parent| STREAM_FOLDERS.iter().any(|folder| parent == Path::new(folder)))
}

/// The path that the last component leads to, also where nothing is there yet.
fn follow_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::symlink_metadata(&path) {
            Ok(found) if found.is_symlink() => {
                let next = fs::read_link(&path)?;
                path = path.parent().map_or(next.clone(), |parent| parent.join(next));
            }
            Ok(_) => return Ok(path),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(path),
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}
