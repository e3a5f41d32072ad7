//! OpenEXR: 32-bit float RGB, linear, losslessly compressed; metadata as text attributes. The only file that names the
//! crate `exr`.

use std::io::{Seek, SeekFrom, Write};

use exr::{
    image::{Encoding, Image as ExrImage, Layer, SpecificChannels, write::WritableImage},
    math::Vec2,
    meta::{
        attribute::{self, AttributeValue, Chromaticities, LineOrder, Text},
        header::{LayerAttributes, standard_names},
    },
};

use super::{Image, Metadata, format::EncodeError};

/// Bytes before the attributes: magic number and version.
const ATTRIBUTES_START: u64 = 8;

/// `sink` must stand at its start.
pub(super) fn encode(image: &Image, metadata: &Metadata, sink: &mut (impl Write + Seek)) -> Result<(), EncodeError> {
    let (width, height) = (image.width as usize, image.height as usize);
    let pixel = |Vec2(x, y): Vec2<usize>| {
        let [red, green, blue] = image.pixels.get(y * width + x).copied().unwrap_or_default();
        (red, green, blue)
    };
    let mut layer_attributes = LayerAttributes::default();
    for (key, value) in metadata.named(|key| standard_names::ALL.contains(&key.as_bytes())) {
        layer_attributes.other.insert(text(&key), AttributeValue::Text(text(&value)));
    }
    let encoding = Encoding {
        compression: attribute::Compression::ZIP16,
        blocks: exr::image::Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new((width, height), layer_attributes, encoding, SpecificChannels::rgb(pixel));
    let mut file = ExrImage::from_layer(layer);
    file.attributes.chromaticities = Some(REC_709);

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

const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

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
