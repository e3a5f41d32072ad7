//! PNG: 8-bit sRGB, said so in an sRGB chunk; metadata as text chunks. The only file that names the crate `png`.

use std::io::Write;

use png::{BitDepth, ColorType, Encoder, EncodingError, SrgbRenderingIntent};

use super::{Image, Metadata, Tone, format::EncodeError};

pub(super) fn encode(
    image: &Image,
    metadata: &Metadata,
    tone: &Tone,
    sink: &mut impl Write,
) -> Result<(), EncodeError> {
    let mut encoder = Encoder::new(sink, image.width, image.height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    for (key, value) in metadata.named(|_| false) {
        // tEXt is Latin-1 and read by more programs; iTXt is UTF-8.
        if value.is_ascii() {
            encoder.add_text_chunk(key, value)?;
        } else {
            encoder.add_itxt_chunk(key, value)?;
        }
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&tone.to_srgb8(image))?;
    writer.finish()?;
    Ok(())
}

impl From<EncodingError> for EncodeError {
    fn from(error: EncodingError) -> Self {
        match error {
            EncodingError::IoError(source) => Self::Io(source),
            other => Self::Format(other.to_string()),
        }
    }
}
