//! What the crate takes a file's word for, and memory with it: checked before.

use exr::{
    block::chunk::CompressedBlock,
    compression::Compression,
    math::Vec2,
    meta::{attribute::SampleType, header::Header},
};

use super::super::read::{DecodeError, most_pixels};

/// Largest block that a short file may claim, in bytes.
const LARGEST_BLOCK: usize = 1 << 26;
/// Bytes of all channels of a pixel, where a file has as many pixels as it may: eight channels of f32.
const BYTES_PER_PIXEL: u64 = 32;
/// From this third byte on a square of B44 is three bytes of one value.
const B44_FLAT: u8 = 13 << 2;
/// Numbers at the start of a DWA block that say how long its parts become: unknown, run lengths before and after, AC, DC.
const DWA_LENGTHS: [usize; 5] = [1, 6, 7, 8, 9];

/// A block is read into memory of the size that it claims, which is at most that of its pixels.
pub fn check_blocks(header: &Header, length: usize) -> Result<(), DecodeError> {
    let Vec2(width, height) = header.max_block_pixel_size();
    let bytes = width.checked_mul(height).and_then(|area| area.checked_mul(header.channels.bytes_per_pixel));
    if bytes.is_some_and(|bytes| bytes <= LARGEST_BLOCK.max(length)) {
        return Ok(());
    }
    let found = format!("blocks of {width}x{height} pixels in {length} bytes");
    Err(DecodeError::new(found, format!("at most {LARGEST_BLOCK} bytes of pixels in a block")))
}

/// All channels are unpacked, whichever are wanted.
pub fn check_channels(header: &Header, length: usize) -> Result<(), DecodeError> {
    let (Vec2(width, height), bytes) = (header.layer_size, header.channels.bytes_per_pixel);
    let most = most_pixels(length).saturating_mul(BYTES_PER_PIXEL);
    if (width as u64).saturating_mul(height as u64).saturating_mul(bytes as u64) <= most {
        return Ok(());
    }
    let found = format!("{width}x{height} pixels of {bytes} bytes each in {length} bytes");
    Err(DecodeError::new(found, format!("at most {most} bytes of pixels")))
}

/// What in a block the crate does not look at before it unpacks it.
pub fn check_block(header: &Header, block: &CompressedBlock) -> Result<(), DecodeError> {
    let bytes = match block {
        CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
        CompressedBlock::Tile(block) => &block.compressed_pixels_le,
        _ => return Ok(()),
    };
    let size = header.get_absolute_block_pixel_coordinates(header.get_block_data_indices(block)?)?.size;
    if bytes.len() == size.area() * header.channels.bytes_per_pixel {
        // The pixels themselves.
        return Ok(());
    }
    match header.compression {
        Compression::DWAA(_) | Compression::DWAB(_) => check_dwa(header, bytes, size),
        Compression::B44 | Compression::B44A => check_b44(header, bytes, size),
        _ => Ok(()),
    }
}

/// Parts of a DWA block become as long as they say. Each holds at most two bytes for each byte of the pixels, whose squares
/// of 8 x 8 are filled up.
fn check_dwa(header: &Header, bytes: &[u8], Vec2(width, height): Vec2<usize>) -> Result<(), DecodeError> {
    let most = 2 * width.next_multiple_of(8) * height.next_multiple_of(8) * header.channels.bytes_per_pixel;
    let (numbers, _) = bytes.as_chunks::<8>();
    let lengths = DWA_LENGTHS.iter().filter_map(|&i| numbers.get(i)).map(|&number| u64::from_le_bytes(number));
    match lengths.max() {
        Some(length) if length > most as u64 => {
            Err(DecodeError::new(format!("damage: a DWA block of {length} bytes"), format!("at most {most}")))
        }
        _ => Ok(()),
    }
}

/// B44 holds squares of 4 x 4 halves as differences. The crate subtracts without a look whether it can, which panics in builds
/// that check arithmetic.
fn check_b44(header: &Header, bytes: &[u8], Vec2(width, height): Vec2<usize>) -> Result<(), DecodeError> {
    let mut rest = bytes;
    for channel in &header.channels.list {
        if channel.sample_type != SampleType::F16 {
            rest = rest.get(width * height * channel.sample_type.bytes_per_sample()..).unwrap_or_default();
            continue;
        }
        for _ in 0..width.div_ceil(4) * height.div_ceil(4) {
            // Where the block ends early the crate says so.
            let Some(&[.., kind]) = rest.first_chunk::<3>() else { return Ok(()) };
            if kind >= B44_FLAT {
                rest = &rest[3..];
                continue;
            }
            let Some((square, behind)) = rest.split_first_chunk() else { return Ok(()) };
            if !is_b44(square) {
                return Err(DecodeError::new("damage: a B44 block with a sample below 0", "a whole OpenEXR image"));
            }
            rest = behind;
        }
    }
    Ok(())
}

/// Whether no sample of a square is below 0: 16 bits for the first, 6 for a shift, 6 for each difference to a neighbour; first
/// down the first column, then along the rows.
fn is_b44(square: &[u8; 14]) -> bool {
    let mut bits = [0; 16];
    bits[2..].copy_from_slice(square);
    let bits = u128::from_be_bytes(bits);
    let shift = (bits >> 90) as u32 & 63;
    let difference = |i: usize| (bits >> (84 - 6 * i)) as u32 & 63;
    // Above 16 bits it starts anew from 0.
    let next = |from: u16, i: usize| {
        (u32::from(from) + (difference(i) << shift)).checked_sub(32 << shift).map(|sample| sample as u16)
    };
    let mut column = [Some((bits >> 96) as u16); 4];
    for row in 1..4 {
        column[row] = column[row - 1].and_then(|above| next(above, row - 1));
    }
    (0..4).all(|row| (0..3).try_fold(column[row], |left, x| Some(next(left?, 3 + row + 4 * x))).flatten().is_some())
}
