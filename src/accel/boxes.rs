//! A node's eight boxes against one ray, and the order in which their children are visited.

use super::layout::Node;
use super::ray::{Prepared, SLAB_SLACK};
use crate::lanes::{LanesU32, Wide, WideU32};

/// Where a ray enters the boxes of a node: bits of the lanes that it meets, and the least distances, which are above 0.
#[inline(always)]
pub(super) fn enter<W: Wide>(node: &Node, ray: &Prepared, t_max: f32) -> (W::Mask, W) {
    let mut near = W::splat(LEAST);
    let mut far = W::splat(t_max);
    for axis in 0..3 {
        let inv = W::splat(ray.inv(axis));
        let n = node.row::<W>(ray.near_row(axis)).mul_add(inv, W::splat(-ray.near_off(axis)));
        let f = node.row::<W>(ray.far_row(axis)).mul_add(inv, W::splat(-ray.far_off(axis)));
        near = near.max(n);
        far = far.min(f);
    }
    (near.le(far * W::splat(SLAB_SLACK)), near)
}

/// Bits of a key that hold its lane.
const LANE_BITS: u32 = 7;
/// Where a ray enters the box that it starts in: above 0, so that the key of a hit is above that of any miss.
pub(super) const LEAST: f32 = f32::from_bits(LANE_BITS + 1);
const LANE: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

/// Keys of boxes: of those that are met, the distance with its lowest bits replaced by the lane; of others the lane
/// alone. The order of floats above 0 is that of their bits.
#[inline(always)]
pub(super) fn keys<W: Wide>(hit: W::Mask, near: W) -> W::Uint {
    let met = W::select_u32(hit, near.to_bits().and(W::Uint::splat(!LANE_BITS)), W::Uint::splat(0));
    met.or(W::Uint::load(&LANE))
}

/// Sorts keys by distance, farthest first; those not met, of which `bits` is free, come last in any order.
#[inline(always)]
pub(super) fn order<U: WideU32>(keys: U, bits: u32) -> U {
    // Few are met, mostly: a short network in half of a register, where exchanges are cheap.
    if bits.count_ones() <= 4 { sort4(keys.pack(bits)) } else { sort8(keys) }
}

/// The lane of the nearest box that is met; of some box, if none is.
#[inline(always)]
pub(super) fn nearest<W: Wide>(hit: W::Mask, keys: W::Uint) -> u32 {
    W::select_u32(hit, keys, W::Uint::splat(u32::MAX)).min_lane() & LANE_BITS
}

/// The distance in a key, rounded down.
#[inline(always)]
pub(super) fn distance(key: u32) -> f32 {
    f32::from_bits(key & !LANE_BITS)
}

/// The distances in keys, rounded down.
#[inline(always)]
pub(super) fn distances<W: Wide>(keys: W::Uint) -> W {
    W::from_bits(keys.and(W::Uint::splat(!LANE_BITS)))
}

/// Exchanges partners so that the lanes of `keep_large` hold the larger.
#[inline(always)]
fn layer<U: WideU32>(k: U, partner: [u32; 8], keep_large: u32) -> U {
    let other = k.permute_const(partner);
    let large = std::array::from_fn::<u32, 8, _>(|i| if keep_large >> i & 1 == 1 { u32::MAX } else { 0 });
    let large = U::load(&large);
    let (lo, hi) = (k.min(other), k.max(other));
    hi.and(large).or(lo.and(large.complement()))
}

/// Sorts the first four lanes and the last four, the largest first: 5 comparators in three layers.
#[inline(always)]
fn sort4<U: WideU32>(k: U) -> U {
    let k = layer(k, [1, 0, 3, 2, 5, 4, 7, 6], 0b0101_0101);
    let k = layer(k, [2, 3, 0, 1, 6, 7, 4, 5], 0b0011_0011);
    layer(k, [0, 2, 1, 3, 4, 6, 5, 7], 0b1011_1011)
}

/// Sorts eight lanes, the largest first: Batcher's odd-even merge network, 19 comparators in six layers.
#[inline(always)]
fn sort8<U: WideU32>(k: U) -> U {
    let k = sort4(k);
    let k = layer(k, [4, 5, 6, 7, 0, 1, 2, 3], 0b0000_1111);
    let k = layer(k, [0, 1, 4, 5, 2, 3, 6, 7], 0b1100_1111);
    layer(k, [0, 2, 1, 4, 3, 6, 5, 7], 0b1010_1011)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{F32x8, Lanes, U32x8};

    /// A comparator network sorts everything if it sorts all sequences of zeros and ones (Knuth's 0-1 principle).
    #[test]
    fn networks_sort_all_zero_one_sequences() {
        for bits in 0..256u32 {
            let k = U32x8::from_fn(|i| bits >> i & 1);
            let (four, eight) = (sort4(k).array(), sort8(k).array());
            assert!(eight.is_sorted_by(|a, b| a >= b), "{bits:08b}: {eight:?}");
            assert!(four[..4].is_sorted_by(|a, b| a >= b) && four[4..].is_sorted_by(|a, b| a >= b));
        }
    }

    #[test]
    fn boxes_are_ordered_from_far_to_near() {
        let near = [3.0, LEAST, 2.0, 7.0, 0.5, 9.0, 2.5, 8.0f32];
        for bits in 0..256u32 {
            let hit = F32x8::from_fn(|i| (bits >> i & 1) as f32).gt(F32x8::splat(0.5));
            let (keys, count) = (keys(hit, F32x8::load(&near)), bits.count_ones() as usize);
            let first = nearest::<F32x8>(hit, keys);
            let keys = order(keys, bits);
            let lanes: Vec<usize> = keys.array()[..count].iter().map(|k| (k & 7) as usize).collect();
            let mut expected: Vec<usize> = (0..8).filter(|i| bits >> i & 1 == 1).collect();
            expected.sort_by(|&a, &b| near[b].total_cmp(&near[a]));
            assert_eq!(lanes, expected, "{bits:08b}");
            assert!(expected.last().is_none_or(|&nearest| nearest == first as usize));
            assert!(keys.array()[..count].iter().zip(lanes).all(|(&k, i)| distance(k) <= near[i]));
        }
    }
}
