//! PNG: 8-bit sRGB, said so in an sRGB chunk; metadata as text chunks. All kinds are read. The only file that names the
//! crate `png`.

use std::io::{Cursor, ErrorKind, Write};

use png::{
    BitDepth, ColorType, Decoder, DecodingError, Encoder, EncodingError, Info, SrgbRenderingIntent, Transformations,
};

use super::read::{DecodeError, Decoded, ImageFile, check_size};
use super::tone::linear;
use super::{Format, Image, Metadata, Tone, format::EncodeError};

/// More than this many bytes do not come out of one byte of DEFLATE's.
const MOST_PER_BYTE: usize = 1032;

/// Most bytes that compressed texts become, all together. What goes beyond is left out.
const MOST_TEXT: usize = 1 << 22;

pub(super) fn encode(
    image: &Image,
    metadata: &Metadata,
    tone: &Tone,
    sink: &mut impl Write,
) -> Result<(), EncodeError> {
    encode_rgb8([image.width, image.height], &tone.to_srgb8(image), metadata, sink)
}

/// `pixels` are three bytes each, `width * height` of them.
pub(super) fn encode_rgb8(
    [width, height]: [u32; 2],
    pixels: &[u8],
    metadata: &Metadata,
    sink: &mut impl Write,
) -> Result<(), EncodeError> {
    let mut encoder = Encoder::new(sink, width, height);
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
    writer.write_image_data(pixels)?;
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

/// Reads any PNG: 1 to 16 bits, grey, colour or palette, interlaced or not; alpha is left out. Of an animation the default
/// image.
///
/// What is encoded how is said by the cICP chunk (sRGB and linear are known), else by a gAMA chunk other than sRGB's 1/2.2;
/// else it is sRGB. Colour profiles and primaries are not heeded, and remarked on.
pub(super) fn decode(bytes: &[u8]) -> Decoded {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder.read_header_info()?;
    let (width, height) = check_size(header.width.into(), header.height.into(), bytes.len())?;
    let least = header.raw_bytes() / MOST_PER_BYTE;
    if bytes.len() < least {
        let expected = format!("at least {least} for an image of {width}x{height} pixels");
        return Err(DecodeError::new(format!("{} bytes", bytes.len()), expected));
    }
    let mut reader = decoder.read_info()?;
    let mut codes = vec![0; reader.output_buffer_size().unwrap_or(0)];
    reader.next_frame(&mut codes)?;
    // Text may come behind the pixels.
    reader.finish()?;
    let (color, depth) = reader.output_color_type();
    let mut remarks = Vec::new();
    let table = table(depth, &Transfer::of(reader.info(), &mut remarks)?);
    let light = |pixel: &[u8], i: usize| match depth {
        BitDepth::Sixteen => table[usize::from(u16::from_be_bytes([pixel[2 * i], pixel[2 * i + 1]]))],
        _ => table[usize::from(pixel[i])],
    };
    let channels = match color {
        ColorType::Grayscale | ColorType::GrayscaleAlpha => [0; 3],
        _ => [0, 1, 2],
    };
    // Expanded, samples are bytes at least.
    let pixels = codes.chunks_exact(color.samples() * if depth == BitDepth::Sixteen { 2 } else { 1 });
    let pixels = pixels.map(|pixel| channels.map(|i| light(pixel, i))).collect();
    let image = Image { width, height, pixels };
    Ok(ImageFile { format: Format::Png, image, variance: None, metadata: texts(reader.info()), remarks })
}

/// How codes stand for light.
enum Transfer {
    Srgb,
    /// Light is the code to this power.
    Power(f64),
}

impl Transfer {
    fn of(info: &Info<'_>, remarks: &mut Vec<String>) -> Result<Self, DecodeError> {
        if let Some(cicp) = &info.coding_independent_code_points {
            if cicp.color_primaries != 1 {
                remarks.push("its primaries are taken as Rec. 709".to_owned());
            }
            return match cicp.transfer_function {
                8 => Ok(Self::Power(1.0)),
                13 => Ok(Self::Srgb),
                other => Err(DecodeError::new(format!("transfer function {other} (cICP)"), "13 (sRGB) or 8 (linear)")),
            };
        }
        if info.icc_profile.is_some() {
            remarks.push("its colour profile is not heeded, it is taken as sRGB".to_owned());
            return Ok(Self::Srgb);
        }
        match info.gama_chunk.map(|gamma| f64::from(gamma.into_value())) {
            Some(gamma) if info.srgb.is_none() && gamma > 0.0 && (gamma * 2.2 - 1.0).abs() > 0.01 => {
                Ok(Self::Power(1.0 / gamma))
            }
            _ => Ok(Self::Srgb),
        }
    }
}

/// Light by code.
fn table(depth: BitDepth, transfer: &Transfer) -> Vec<f32> {
    let top = if depth == BitDepth::Sixteen { u16::MAX } else { u16::from(u8::MAX) };
    let light = |code: u16| {
        let encoded = f64::from(code) / f64::from(top);
        match transfer {
            Transfer::Srgb => linear(encoded),
            Transfer::Power(power) => encoded.powf(*power),
        }
    };
    (0..=top).map(|code| light(code) as f32).collect()
}

/// Takes the text from what is `left`. One that is damaged or does not fit takes half: many would cost time.
fn unpacked(text: Result<String, DecodingError>, left: &mut usize) -> Option<String> {
    *left = text.as_ref().map_or(*left / 2, |text| left.saturating_sub(text.len()));
    text.ok()
}

fn texts(info: &Info<'_>) -> Metadata {
    let mut left = MOST_TEXT;
    let latin = info.uncompressed_latin1_text.iter().map(|chunk| (chunk.keyword.clone(), Some(chunk.text.clone())));
    let packed = info.compressed_latin1_text.iter().map(|chunk| {
        let mut text = chunk.clone();
        (
            text.keyword.clone(),
            unpacked(text.decompress_text_with_limit(left).and_then(|()| text.get_text()), &mut left),
        )
    });
    let packed: Vec<_> = packed.collect();
    let utf8 = info.utf8_text.iter().map(|chunk| {
        let mut text = chunk.clone();
        (
            text.keyword.clone(),
            unpacked(text.decompress_text_with_limit(left).and_then(|()| text.get_text()), &mut left),
        )
    });
    Metadata::from_entries(latin.chain(packed).chain(utf8).filter_map(|(key, text)| Some((key, text?))))
}

impl From<DecodingError> for DecodeError {
    fn from(error: DecodingError) -> Self {
        match error {
            DecodingError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => Self::truncated("PNG"),
            other => Self::new(format!("damage: {other}"), "a whole PNG image"),
        }
    }
}
