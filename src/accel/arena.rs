//! Memory of the tree: one run of 64-byte blocks, on huge pages where the system has them.
//!
//! A ray at a far place of a large tree misses the translation buffer at every step; pages of 2 MiB make it reach 512
//! times as far. Linux gives them to memory that asks for them.

use bytemuck::{Pod, Zeroable};

/// A cache line.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Block([f32; 16]);

/// Zeroed blocks, of a length fixed once.
#[derive(Debug)]
pub(super) struct Arena(Memory);

#[derive(Debug)]
enum Memory {
    Mapped(memmap2::MmapMut),
    Plain(Vec<Block>),
}

impl Arena {
    /// `blocks` zeroed blocks.
    pub fn new(blocks: usize) -> Self {
        let memory = match memmap2::MmapMut::map_anon(blocks * size_of::<Block>()) {
            Ok(map) if blocks > 0 => {
                // Without huge pages the tree is slower, not wrong.
                #[cfg(target_os = "linux")]
                let _ = map.advise(memmap2::Advice::HugePage);
                Memory::Mapped(map)
            }
            _ => Memory::Plain(vec![Block::zeroed(); blocks]),
        };
        Self(memory)
    }
    /// All of them.
    #[inline(always)]
    pub fn blocks(&self) -> &[Block] {
        match &self.0 {
            Memory::Mapped(map) => bytemuck::cast_slice(map),
            Memory::Plain(blocks) => blocks,
        }
    }
    /// All of them, to be written.
    pub fn blocks_mut(&mut self) -> &mut [Block] {
        match &mut self.0 {
            Memory::Mapped(map) => bytemuck::cast_slice_mut(map),
            Memory::Plain(blocks) => blocks,
        }
    }
}

impl Clone for Arena {
    fn clone(&self) -> Self {
        let mut copy = Self::new(self.blocks().len());
        copy.blocks_mut().copy_from_slice(self.blocks());
        copy
    }
}
