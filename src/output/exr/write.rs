//! Writing.

use std::io::{Seek, SeekFrom, Write};

use exr::{
    image::{
        Encoding, Image as ExrImage, Layer, SpecificChannels,
        write::{WritableImage, channels::WritableChannels},
    },
    math::Vec2,
    meta::{
        attribute::{self, AttributeValue, LineOrder, Text},
        header::{LayerAttributes, standard_names},
    },
};

use super::super::{Image, Layers, Metadata, format::EncodeError};
use super::{COLOURS, REC_709, VARIANCES};

/// Bytes before the attributes: magic number and version.
const ATTRIBUTES_START: u64 = 8;

/// `sink` must stand at its start.
pub fn encode(layers: Layers<'_>, metadata: &Metadata, sink: &mut (impl Write + Seek)) -> Result<(), EncodeError> {
    let width = layers.image.width as usize;
    let at = |pixels: &[[f32; 3]], x: usize, y: usize| pixels.get(y * width + x).copied().unwrap_or_default();
    let colour = |x: usize, y: usize| at(&layers.image.pixels, x, y);
    let [r, g, b] = COLOURS;
    let channels = SpecificChannels::build().with_channel(r).with_channel(g).with_channel(b);
    match layers.variance {
        None => {
            let channels = channels.with_pixel_fn(|Vec2(x, y)| {
                let [red, green, blue] = colour(x, y);
                (red, green, blue)
            });
            write(&file(channels, layers.image, metadata), sink)
        }
        Some(variance) => {
            let [r, g, b] = VARIANCES;
            let channels = channels.with_channel(r).with_channel(g).with_channel(b).with_pixel_fn(|Vec2(x, y)| {
                let ([red, green, blue], [r, g, b]) = (colour(x, y), at(variance, x, y));
                (red, green, blue, r, g, b)
            });
            write(&file(channels, layers.image, metadata), sink)
        }
    }
}

fn file<'a, C: WritableChannels<'a> + 'a>(channels: C, image: &Image, metadata: &Metadata) -> ExrImage<Layer<C>> {
    let mut attributes = LayerAttributes::default();
    for (key, value) in metadata.named(|key| standard_names::ALL.contains(&key.as_bytes())) {
        attributes.other.insert(text(&key), AttributeValue::Text(text(&value)));
    }
    let encoding = Encoding {
        compression: attribute::Compression::ZIP16,
        blocks: exr::image::Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = (image.width as usize, image.height as usize);
    let mut file = ExrImage::from_layer(Layer::new(size, attributes, encoding, channels));
    file.attributes.chromaticities = Some(REC_709);
    file
}

fn write<'a, C: WritableChannels<'a>>(
    file: &'a ExrImage<Layer<C>>,
    sink: &mut (impl Write + Seek),
) -> Result<(), EncodeError> {
    // On one thread: the crate would start a pool of its own, whatever thread count the user asked for.
    let writer = file.write().non_parallel();
    let headers = writer.infer_meta_data();
    writer.to_buffered(&mut *sink)?;

    // The crate keeps attributes in a hash map and writes them in an order that differs from run to run. Written over
    // in order of name, the same image gives the same file.
    let mut attributes: Vec<_> = headers.iter().flat_map(|header| header.all_named_attributes()).collect();
    attributes.sort_by_key(|(name, _)| *name);
    let mut sorted = Vec::new();
    for (name, value) in &attributes {
        attribute::write(name, value, &mut sorted)?;
    }
    sink.seek(SeekFrom::Start(ATTRIBUTES_START))?;
    sink.write_all(&sorted)?;
    sink.seek(SeekFrom::End(0))?;
    Ok(())
}

/// UTF-8, as the format's own library writes text.
fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

impl From<exr::error::Error> for EncodeError {
    fn from(error: exr::error::Error) -> Self {
        match error {
            exr::error::Error::Io(source) => Self::Io(source),
            other => Self::Format(other.to_string()),
        }
    }
}
