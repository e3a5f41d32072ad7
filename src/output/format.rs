//! The formats, told apart by a file name's ending.

use std::{
    io::{self, Seek, Write},
    path::Path,
};

use super::{Layers, Metadata, Tone, exr, hdr, png, ppm};
use crate::error::{Error, Result};

/// An image file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `.png`: 8-bit sRGB.
    Png,
    /// `.ppm`: 8-bit sRGB, uncompressed.
    Ppm,
    /// `.exr`: 32-bit float, linear, lossless; ignores [`Tone`], and alone holds variances.
    Exr,
    /// `.hdr`: 8-bit mantissas with a shared exponent, linear; ignores [`Tone`].
    Hdr,
}

impl Format {
    /// The format that a path's ending names, in upper or lower case.
    ///
    /// # Errors
    /// [`Error::Output`] where the path has no ending or an unknown one.
    pub fn from_path(path: &Path) -> Result<Self> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("ppm") => Ok(Self::Ppm),
            Some("exr") => Ok(Self::Exr),
            Some("hdr") => Ok(Self::Hdr),
            other => {
                let found = other.map_or("no ending".to_owned(), |ending| format!("the ending .{ending}"));
                let reason = format!("found {found}, expected .png, .ppm, .exr or .hdr");
                Err(Error::Output { file: path.to_owned(), reason })
            }
        }
    }

    /// Writes a whole file into `sink`, which must stand at its start. The image must have no flaw.
    pub(super) fn encode<W: Write + Seek>(
        self,
        layers: Layers<'_>,
        metadata: &Metadata,
        tone: &Tone,
        sink: &mut W,
    ) -> std::result::Result<(), EncodeError> {
        match self {
            Self::Png => png::encode(layers.image, metadata, tone, sink),
            Self::Ppm => ppm::encode(layers.image, metadata, tone, sink),
            Self::Exr => exr::encode(layers, metadata, sink),
            Self::Hdr => hdr::encode(layers.image, metadata, sink),
        }
    }
}

/// An encoder's failure, which does not know the file's name.
#[derive(Debug)]
pub(super) enum EncodeError {
    /// The sink failed.
    Io(io::Error),
    /// The format cannot hold this.
    Format(String),
}

impl EncodeError {
    pub(super) fn of(self, file: &Path) -> Error {
        let file = file.to_owned();
        match self {
            Self::Io(source) => Error::Io { file, action: "write", source },
            Self::Format(reason) => Error::Output { file, reason },
        }
    }
}

impl From<io::Error> for EncodeError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, SeekFrom};

    use super::super::Image;
    use super::*;

    const ALL: [Format; 4] = [Format::Png, Format::Ppm, Format::Exr, Format::Hdr];

    /// A disk with `free` bytes left.
    struct Disk {
        data: Cursor<Vec<u8>>,
        free: u64,
    }

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.data.position() + bytes.len() as u64 > self.free {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.data.write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Seek for Disk {
        fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
            self.data.seek(position)
        }
    }

    fn image() -> Image {
        Image { width: 5, height: 40, pixels: (0..200).map(|i| [i as f32, 0.5, 1.0 / (i as f32 + 1.0)]).collect() }
    }

    #[test]
    fn every_encoder_reports_a_full_disk() {
        let metadata = Metadata { entries: vec![("scene".into(), "a.json".into())], partial: true };
        for format in ALL {
            let encode = |free| {
                let mut disk = Disk { data: Cursor::default(), free };
                format
                    .encode((&image()).into(), &metadata, &Tone::default(), &mut disk)
                    .map(|()| disk.data.into_inner().len())
            };
            let size = encode(u64::MAX).expect("an endless disk") as u64;
            assert_eq!(encode(size).expect("a disk that just suffices") as u64, size);
            for free in 0..size {
                assert!(
                    matches!(encode(free), Err(EncodeError::Io(error)) if error.kind() == io::ErrorKind::StorageFull),
                    "{format:?} with {free} of {size} bytes"
                );
            }
        }
    }

    #[test]
    fn the_same_image_gives_the_same_file() {
        let entries = ["Software", "scene", "spp", "seed"].map(|key| (key.to_owned(), "value".to_owned()));
        let metadata = Metadata { entries: entries.to_vec(), partial: true };
        for format in ALL {
            let encode = || {
                let mut data = Cursor::new(Vec::new());
                format.encode((&image()).into(), &metadata, &Tone::default(), &mut data).expect("memory suffices");
                data.into_inner()
            };
            let first = encode();
            assert!((0..8).all(|_| encode() == first), "{format:?}");
        }
    }

    #[test]
    fn endings() {
        for (name, format) in
            [("a.png", Format::Png), ("b.c.PPM", Format::Ppm), ("/d/e.Exr", Format::Exr), ("f.hDR", Format::Hdr)]
        {
            assert_eq!(Format::from_path(Path::new(name)).ok(), Some(format), "{name}");
        }
        for name in ["", "a", "a.", ".png", "a.jpg", "a.png.gz", "/", "a.pn\u{f6}"] {
            let message = Format::from_path(Path::new(name)).map_err(|error| error.to_string()).unwrap_err();
            assert!([".png", ".ppm", ".exr", ".hdr"].iter().all(|ending| message.contains(ending)), "{message}");
        }
    }
}
