//! Reading a mesh: bytes per second from an OBJ file that the system keeps in memory to triangles.

use super::{Room, short};
use crate::bench::measure::{Case, Pace, Unit};
use crate::bench::mesh;
use crate::error::{Error, Result};
use crate::scene;
use std::hint::black_box;
use std::io::{BufWriter, Write};
use tempfile::NamedTempFile;

/// Most triangles: a larger mesh is read no faster, and its file takes a gigabyte.
const MOST: usize = 1_000_000;

/// A mesh in a file.
pub(super) struct File {
    size: usize,
    bytes: u64,
    file: NamedTempFile,
}

/// The largest mesh up to [`MOST`] in a temporary file; none where there is none.
pub(super) fn file(rooms: &[Room]) -> Result<Option<File>> {
    let Some(room) = rooms.iter().rfind(|room| room.size <= MOST) else { return Ok(None) };
    let written = || -> std::io::Result<File> {
        let file = tempfile::Builder::new().suffix(".obj").tempfile()?;
        let mut out = BufWriter::new(file.as_file());
        mesh::write_obj(&room.mesh, &mut out)?;
        out.flush()?;
        drop(out);
        Ok(File { size: room.size, bytes: file.as_file().metadata()?.len(), file })
    };
    written().map(Some).map_err(|source| Error::Io { file: std::env::temp_dir(), action: "write a mesh into", source })
}

/// Reading it.
pub(super) fn case(file: &File) -> Case<'_> {
    let mut pace = Pace::default();
    let run = move || {
        let seconds = pace.seconds(|passes| {
            (0..passes).for_each(|_| drop(black_box(scene::load_mesh(file.file.path()))));
        });
        vec![file.bytes as f64 / seconds / 1e6]
    };
    Case::new(vec![(format!("load/{}", short(file.size)), Unit::Megabytes)], run)
}
