//! One column: numbers of 32 bits from the start of a cache line on.
//!
//! Eight rows from a multiple of eight are then never on two lines, wherever the allocator of the thread puts them: where they
//! are, moving rows takes 8 % longer (docs/decisions/threads.md).

use crate::lanes::MAX_LANES;
use bytemuck::{Pod, Zeroable};
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};

/// A cache line of numbers.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u32; 2 * MAX_LANES]);

/// A column of `T`, which is `f32` or `u32`.
#[derive(Clone, Debug, Default)]
pub struct Column<T> {
    lines: Vec<Line>,
    of: PhantomData<T>,
}

impl<T: Pod> Column<T> {
    /// At least `rows` zeros; with no rows nothing is held.
    pub fn zeros(rows: usize) -> Self {
        Self { lines: vec![Line::zeroed(); rows.div_ceil(2 * MAX_LANES)], of: PhantomData }
    }
}

impl<T: Pod> Deref for Column<T> {
    type Target = [T];
    #[inline(always)]
    fn deref(&self) -> &[T] {
        bytemuck::cast_slice(&self.lines)
    }
}

impl<T: Pod> DerefMut for Column<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T] {
        bytemuck::cast_slice_mut(&mut self.lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_start_cache_lines_and_hold_what_is_asked_for() {
        assert!(Column::<u32>::zeros(0).is_empty());
        for rows in [1, 16, 17, 2056] {
            let mut column = Column::<f32>::zeros(rows);
            assert!(column.len() >= rows && column.len() < rows + 16);
            assert_eq!(column.as_ptr() as usize % 64, 0);
            column[rows - 1] = 1.5;
            assert_eq!(column.iter().sum::<f32>(), 1.5);
        }
    }
}
