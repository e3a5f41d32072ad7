//! PPM: binary (P6), 8-bit sRGB, metadata as comments.

use std::io::Write;

use super::{Image, Metadata, Tone, format::EncodeError};

pub(super) fn encode(
    image: &Image,
    metadata: &Metadata,
    tone: &Tone,
    sink: &mut impl Write,
) -> Result<(), EncodeError> {
    sink.write_all(b"P6\n")?;
    for line in metadata.lines(|_| false) {
        writeln!(sink, "# {line}")?;
    }
    write!(sink, "{} {}\n255\n", image.width, image.height)?;
    sink.write_all(&tone.to_srgb8(image))?;
    Ok(())
}
