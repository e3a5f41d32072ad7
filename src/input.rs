//! Files in: regular ones whole, what may have no end up to a bound.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Most bytes of a pipe or a device.
pub const MAX_STREAM: u64 = 1 << 28;

/// What a regular file holds.
///
/// # Errors
/// What the system says, and [`ErrorKind::InvalidInput`] for a device or a pipe, which may have no end, or never begin. Of a
/// folder the system says what it is.
pub fn regular(path: &Path) -> io::Result<Vec<u8>> {
    let kind = fs::metadata(path)?.file_type();
    if !kind.is_file() && !kind.is_dir() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is a device or a pipe, no regular file"));
    }
    fs::read(path)
}

/// What a regular file holds, or a pipe or a device of [`MAX_STREAM`] bytes at most.
///
/// # Errors
/// What the system says, and [`ErrorKind::FileTooLarge`].
pub fn bounded(path: &Path) -> io::Result<Vec<u8>> {
    if fs::metadata(path)?.is_file() {
        return fs::read(path);
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(MAX_STREAM + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_STREAM {
        let reason = format!("found more than {MAX_STREAM} bytes, expected at most as many of what is no regular file");
        return Err(io::Error::new(ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}
