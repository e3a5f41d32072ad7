//! What the crate takes a file's word for, and memory with it: checked before.

use exr::{block::chunk::CompressedBlock, compression::Compression, math::Vec2, meta::header::Header};

use super::super::read::DecodeError;

/// Largest block that a short file may claim, in bytes.
const LARGEST_BLOCK: usize = 1 << 27;
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

/// Parts of a DWA block become as long as they say. Each holds at most two bytes for each byte of the pixels, whose squares
/// of 8 x 8 are filled up.
pub fn check_dwa(header: &Header, block: &CompressedBlock) -> Result<(), DecodeError> {
    let bytes = match block {
        CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
        CompressedBlock::Tile(block) => &block.compressed_pixels_le,
        _ => return Ok(()),
    };
    if !matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
        return Ok(());
    }
    let size = header.get_absolute_block_pixel_coordinates(header.get_block_data_indices(block)?)?.size;
    if bytes.len() == size.area() * header.channels.bytes_per_pixel {
        // The pixels themselves.
        return Ok(());
    }
    let Vec2(width, height) = size;
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
