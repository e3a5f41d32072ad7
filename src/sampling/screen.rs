//! The pixels of an image, as samplers see them.

use crate::lanes::{Lanes, LanesU32};

/// Samples of a pixel up to which pixels share one sequence, as a power of two: with more, noise is hardly seen.
const MOST: u32 = 8;
/// Pixels across and down that do, as a power of two: what lies further apart the eye does not average.
const TILE: u32 = 4;

/// An image, and how its pixels share points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Screen {
    /// Pixels across.
    width: u32,
    /// The number of samples as a power of two, rounded up, where pixels share one sequence of points.
    shared: Option<u32>,
}

impl Screen {
    /// An image `width` pixels across; `spp` samples of each pixel at most.
    pub fn new(width: u32, spp: u32) -> Self {
        let samples = u32::BITS - spp.saturating_sub(1).leading_zeros();
        Self { width, shared: (samples <= MOST).then_some(samples) }
    }
    /// A number for each pixel.
    #[inline(always)]
    pub fn number<L: Lanes>(&self, [x, y]: [L::Uint; 2]) -> L::Uint {
        y.mul(L::Uint::splat(self.width)).add(x)
    }
    /// Where the pixels of a tile share one sequence of points, a number for the tile, that of its first pixel, and the index of
    /// a sample in the sequence: along the Z curve, so that the samples of each aligned square of 2^k x 2^k pixels are an
    /// aligned part of it.
    #[inline(always)]
    pub fn shared<L: Lanes>(&self, [x, y]: [L::Uint; 2], sample: L::Uint) -> Option<(L::Uint, L::Uint)> {
        let samples = self.shared?;
        let (within, beyond) = (L::Uint::splat((1 << TILE) - 1), L::Uint::splat(!0 << TILE));
        let place = spread(x.and(within)).or(spread(y.and(within)).shl(1));
        // A shift of lanes is by a constant.
        let index = place.mul(L::Uint::splat(1 << samples)).or(sample);
        Some((self.number::<L>([x.and(beyond), y.and(beyond)]), index))
    }
}

/// A number below 2^4 with a zero after each digit.
#[inline(always)]
fn spread<U: LanesU32>(x: U) -> U {
    let x = x.or(x.shl(2)).and(U::splat(0x3333_3333));
    x.or(x.shl(1)).and(U::splat(0x5555_5555))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_all_pixels_have_indices_of_their_own() {
        for (size, spp) in [([5, 3], 6), ([36, 9], 1), ([2, 40], 8)] {
            let screen = Screen::new(size[0], spp);
            let mut seen = std::collections::HashSet::new();
            for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
                for sample in 0..spp {
                    let shared = screen.shared::<f32>([x, y], sample).unwrap();
                    assert!(seen.insert(shared), "{size:?}: {x}, {y}, {sample}");
                }
            }
        }
        // A square of 4 x 4 pixels, not at the corner, is an aligned block.
        let screen = Screen::new(64, 4);
        let at = |x, y, s| screen.shared::<f32>([x, y], s).unwrap().1;
        let mut block: Vec<_> = (0..64).map(|i| at(8 + i % 4, 12 + i / 4 % 4, i / 16)).collect();
        block.sort_unstable();
        assert_eq!(block[0] % 64, 0);
        assert!(block.iter().enumerate().all(|(i, &index)| index == block[0] + i as u32));
    }

    #[test]
    fn pixels_share_nothing_where_nobody_would_see_it() {
        let shared = |spp| Screen::new(640, spp).shared::<f32>([0, 0], 0).is_some();
        assert!(shared(1) && shared(256) && !shared(257) && !shared(u32::MAX));
        assert_eq!(Screen::new(640, u32::MAX).number::<f32>([7, 2]), 1287);
    }
}
