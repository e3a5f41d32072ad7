//! Reading: any compression that the crate knows, half and float, scan lines and tiles, the first part with colours.

use std::io::Cursor;

use exr::{
    block::{self, UncompressedBlock, chunk::CompressedBlock, lines::LineRef},
    error::Error,
    math::Vec2,
    meta::{
        attribute::{AttributeValue, Chromaticities, SampleType, Text},
        header::Header,
    },
    prelude::f16,
};

use super::super::read::{DecodeError, Decoded, ImageFile, check_size};
use super::super::{Format, Image, Metadata};
use super::limits::{check_block, check_blocks, check_channels};
use super::{COLOURS, REC_709, VARIANCES};

/// How far chromaticities may be from those of Rec. 709 to be called them.
const SAME_PRIMARIES: f32 = 0.005;

/// Reads colours from the channels `R`, `G` and `B`, else `Y`, else those of the first layer that has them
/// (`layer.R`, ...), and variances where there are any.
pub fn decode(bytes: &[u8]) -> Decoded {
    let reader = block::read(Cursor::new(bytes), false)?;
    let meta = reader.meta_data().clone();
    let Some((number, colours)) = choose(&meta.headers) else {
        let channels = meta.headers.iter().flat_map(|header| &header.channels.list);
        let names: Vec<String> = channels.map(|channel| channel.name.to_string()).collect();
        return Err(DecodeError::new(format!("the channels {}", names.join(", ")), "R, G and B, or Y"));
    };
    let header = &meta.headers[number];
    let Vec2(width, height) = header.layer_size;
    let (width, height) = check_size(width as u64, height as u64, bytes.len())?;
    if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(DecodeError::new("subsampled channels", "one sample per pixel in every channel"));
    }
    meta.headers.iter().try_for_each(|header| check_blocks(header, bytes.len()))?;
    check_channels(header, bytes.len())?;

    let mut chunks = Vec::new();
    for chunk in reader.all_chunks(false)? {
        let chunk = chunk?;
        if chunk.layer_index == number && is_largest_level(&chunk.compressed_block) {
            check_block(header, &chunk.compressed_block)?;
            let place = header.get_block_data_indices(&chunk.compressed_block)?.tile_index;
            chunks.push((place.y(), place.x(), chunk));
        }
    }
    chunks.sort_by_key(|&(y, x, _)| (y, x));
    chunks.dedup_by_key(|&mut (y, x, _)| (y, x));
    let Vec2(across, down) = header.max_block_pixel_size();
    let blocks = (width as usize).div_ceil(across.max(1)) * (height as usize).div_ceil(down.max(1));
    if chunks.len() != blocks {
        return Err(DecodeError::new(
            format!("{} blocks of pixels", chunks.len()),
            format!("{blocks}, a whole OpenEXR image"),
        ));
    }
    let mut layers: Vec<Layer> =
        [Some(colours), find(header, VARIANCES)].into_iter().flatten().map(Layer::new).collect();
    for (.., chunk) in chunks {
        let block = UncompressedBlock::decompress_chunk(chunk, &meta, false)?;
        fill(&mut layers, header, &block)?;
    }
    let mut layers = layers.into_iter().map(|layer| layer.values);
    let image = Image { width, height, pixels: layers.next().unwrap_or_default() };
    let (metadata, remarks) = (texts(header), remarks(header, colours));
    Ok(ImageFile { format: Format::Exr, image, variance: layers.next(), metadata, remarks })
}

/// Three channels by their number in the header, and their values.
struct Layer {
    channels: [usize; 3],
    values: Vec<[f32; 3]>,
}

impl Layer {
    fn new(channels: [usize; 3]) -> Self {
        Self { channels, values: Vec::new() }
    }
}

/// The part with the colours, and the numbers of their channels.
fn choose(headers: &[Header]) -> Option<(usize, [usize; 3])> {
    let first = |find: &dyn Fn(&Header) -> Option<[usize; 3]>| {
        headers.iter().enumerate().find_map(|(number, header)| Some((number, find(header)?)))
    };
    let layered = |header: &Header| {
        let names = header.channels.list.iter().map(|channel| channel.name.to_string());
        let layers = names.filter_map(|name| Some(name.strip_suffix(".R")?.to_owned()));
        layers
            .filter(|layer| layer != "variance")
            .find_map(|layer| find(header, COLOURS.map(|c| format!("{layer}.{c}"))))
    };
    first(&|header| find(header, COLOURS))
        .or_else(|| first(&|header| find(header, ["Y"; 3])))
        .or_else(|| first(&layered))
}

/// The numbers of the channels with these names.
fn find<T: AsRef<str>>(header: &Header, names: [T; 3]) -> Option<[usize; 3]> {
    let number = |name: &T| header.channels.list.iter().position(|c| c.name.to_string() == name.as_ref());
    Some([number(&names[0])?, number(&names[1])?, number(&names[2])?])
}

fn is_largest_level(block: &CompressedBlock) -> bool {
    !matches!(block, CompressedBlock::Tile(tile) if !tile.coordinates.is_largest_resolution_level())
}

/// Takes from a block what the layers want.
fn fill(layers: &mut [Layer], header: &Header, block: &UncompressedBlock) -> Result<(), DecodeError> {
    let damage = || DecodeError::new("damage: a block of another size", "a whole OpenEXR image");
    if block.data.len() != block.index.pixel_size.area() * header.channels.bytes_per_pixel {
        return Err(damage());
    }
    let width = header.layer_size.width();
    // From the top: memory is taken row by row of blocks that are there.
    let end = (block.index.pixel_position.y() + block.index.pixel_size.height()) * width;
    layers.iter_mut().for_each(|layer| layer.values.resize(end.max(layer.values.len()), [0.0; 3]));
    for line in block.lines(&header.channels) {
        let (at, channel) = (line.location.position, line.location.channel);
        let wanted = |layer: &Layer| layer.channels.contains(&channel);
        if !layers.iter().any(wanted) {
            continue;
        }
        let samples = samples(&line, header.channels.list[channel].sample_type)?;
        if at.x() + samples.len() > width {
            return Err(damage());
        }
        let start = at.y() * width + at.x();
        for layer in layers.iter_mut().filter(|layer| wanted(layer)) {
            let pixels = layer.values.get_mut(start..start + samples.len()).ok_or_else(damage)?;
            for (pixel, &sample) in pixels.iter_mut().zip(&samples) {
                for (value, &own) in pixel.iter_mut().zip(&layer.channels) {
                    if own == channel {
                        *value = sample;
                    }
                }
            }
        }
    }
    Ok(())
}

fn samples(line: &LineRef<'_>, kind: SampleType) -> Result<Vec<f32>, Error> {
    match kind {
        SampleType::F16 => line.read_samples::<f16>().map(|sample| sample.map(f16::to_f32)).collect(),
        SampleType::F32 => line.read_samples::<f32>().collect(),
        SampleType::U32 => line.read_samples::<u32>().map(|sample| sample.map(|whole| whole as f32)).collect(),
    }
}

fn texts(header: &Header) -> Metadata {
    let attributes = header.own_attributes.other.iter().chain(&header.shared_attributes.other);
    let utf8 = |text: &Text| String::from_utf8_lossy(text.bytes()).into_owned();
    let texts = attributes.filter_map(|(key, value)| match value {
        AttributeValue::Text(value) => Some((utf8(key), utf8(value))),
        _ => None,
    });
    // The crate keeps them in a hash map.
    let mut texts: Vec<(String, String)> = texts.collect();
    texts.sort();
    Metadata::from_entries(texts)
}

fn remarks(header: &Header, colours: [usize; 3]) -> Vec<String> {
    let mut remarks = Vec::new();
    let name = &header.channels.list[colours[0]].name;
    if name.to_string().contains('.') {
        remarks.push(format!("its colours are those of the layer of {name}"));
    }
    let attributes = &header.shared_attributes;
    let pairs = |c: &Chromaticities| [c.red, c.green, c.blue, c.white];
    let same = |found: &Chromaticities| {
        let mut both = pairs(found).into_iter().zip(pairs(&REC_709));
        both.all(|(f, own)| (f.x() - own.x()).abs() < SAME_PRIMARIES && (f.y() - own.y()).abs() < SAME_PRIMARIES)
    };
    if attributes.chromaticities.as_ref().is_some_and(|found| !same(found)) {
        remarks.push("its primaries are taken as Rec. 709".to_owned());
    }
    if header.data_window() != attributes.display_window {
        remarks.push("its data window is taken, not its display window".to_owned());
    }
    remarks
}

impl From<Error> for DecodeError {
    fn from(error: Error) -> Self {
        match error {
            Error::NotSupported(what) => Self::new(what, "an OpenEXR image of flat pixels"),
            // The crate's word for an end of the file.
            Error::Invalid(what) if what == "reference to missing bytes" => Self::truncated("OpenEXR"),
            other => Self::new(format!("damage: {other}"), "a whole OpenEXR image"),
        }
    }
}
