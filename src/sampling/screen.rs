//! The pixels of an image, as samplers see them.

use crate::lanes::{Lanes, LanesU32};

/// Samples of a pixel up to which pixels share one sequence, as a power of two: with more, noise is hardly seen.
const MOST: u32 = 8;

/// An image, and how many samples its pixels will have, if that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Screen {
    /// Pixels across.
    width: u32,
    /// The number of samples as a power of two, rounded up, where pixels share one sequence of points.
    shared: Option<u32>,
}

impl Screen {
    /// An image of `width` x `height` pixels; `spp` samples of each, or nobody knows how many.
    pub fn new([width, height]: [u32; 2], spp: Option<u32>) -> Self {
        let bits = |n: u32| u32::BITS - n.saturating_sub(1).leading_zeros();
        let place = 2 * bits(width.max(height));
        // One index holds the place of the pixel and the number of the sample.
        let shared = spp.map(bits).filter(|&samples| samples <= MOST && place + samples <= 32);
        Self { width, shared }
    }
    /// A number for each pixel.
    #[inline(always)]
    pub fn number<L: Lanes>(&self, [x, y]: [L::Uint; 2]) -> L::Uint {
        y.mul(L::Uint::splat(self.width)).add(x)
    }
    /// Where pixels share one sequence of points, the index of a sample in it: along the Z curve, so that the samples of each
    /// aligned square of 2^k x 2^k pixels are an aligned part of the sequence.
    #[inline(always)]
    pub fn index<L: Lanes>(&self, [x, y]: [L::Uint; 2], sample: L::Uint) -> Option<L::Uint> {
        let place = spread(x).or(spread(y).shl(1));
        // A shift of lanes is by a constant.
        self.shared.map(|samples| place.mul(L::Uint::splat(1 << samples)).or(sample))
    }
}

/// The lower 16 bits, with a zero after each.
#[inline(always)]
fn spread<U: LanesU32>(x: U) -> U {
    let x = x.and(U::splat(0xffff));
    let x = x.or(x.shl(8)).and(U::splat(0x00ff_00ff));
    let x = x.or(x.shl(4)).and(U::splat(0x0f0f_0f0f));
    let x = x.or(x.shl(2)).and(U::splat(0x3333_3333));
    x.or(x.shl(1)).and(U::splat(0x5555_5555))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_all_pixels_have_indices_of_their_own() {
        for (size, spp) in [([5, 3], 6), ([16, 9], 1), ([2, 40], 8)] {
            let screen = Screen::new(size, Some(spp));
            let mut seen = std::collections::HashSet::new();
            for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
                for sample in 0..spp {
                    assert!(seen.insert(screen.index::<f32>([x, y], sample).unwrap()), "{size:?}: {x}, {y}, {sample}");
                }
            }
        }
        // A square of 4 x 4 pixels, not at the corner, is an aligned block.
        let screen = Screen::new([64, 64], Some(4));
        let at = |x, y, s| screen.index::<f32>([x, y], s).unwrap();
        let mut block: Vec<_> = (0..64).map(|i| at(8 + i % 4, 12 + i / 4 % 4, i / 16)).collect();
        block.sort_unstable();
        assert_eq!(block[0] % 64, 0);
        assert!(block.iter().enumerate().all(|(i, &index)| index == block[0] + i as u32));
    }

    #[test]
    fn pixels_share_nothing_where_the_index_is_too_short_or_nobody_would_see_it() {
        let shared = |size, spp| Screen::new([size, 2], spp).index::<f32>([0, 0], 0).is_some();
        assert!(shared(4096, Some(256)) && shared(65_536, Some(1)) && shared(1, Some(1)));
        assert!(
            !shared(4097, Some(256))
                && !shared(65_536, Some(2))
                && !shared(64, Some(257))
                && !shared(64, Some(u32::MAX))
                && !shared(64, None)
        );
        assert_eq!(Screen::new([640, 480], None).number::<f32>([7, 2]), 1287);
    }
}
