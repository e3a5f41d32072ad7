//! One ray at a time (kernel A): the node's eight boxes at once, nearest first. For stragglers and as the oracle.

use super::layout::Node;
use super::ray::{FAR_ROWS, NEAR_ROWS, Prepared, SLAB_SLACK};
use super::triangle::{any_in_leaf, closest_in_leaf};
use super::{Bvh, Hit, LEAF, Ray};
use crate::lanes::{F32x8, Lanes, LanesU32, Mask, U32x8};

/// Traverses a tree with one ray at a time; holds the stack between rays.
#[derive(Clone, Debug)]
pub struct Single {
    keys: Vec<u32>,
    codes: Vec<u32>,
}

/// (lanes whose box the ray meets before `t_max`, where it enters them).
#[inline(always)]
pub(super) fn boxes(node: &Node, ray: &Prepared, t_max: f32) -> (<F32x8 as Lanes>::Mask, F32x8) {
    let mut near = F32x8::splat(0.0);
    let mut far = F32x8::splat(t_max);
    let (near_rows, far_rows) = (NEAR_ROWS[(ray.octant & 7) as usize], FAR_ROWS[(ray.octant & 7) as usize]);
    for a in 0..3 {
        let inv = F32x8::splat(ray.inv[a]);
        let n = node.planes(near_rows[a]).mul_add(inv, F32x8::splat(-ray.near_off[a]));
        let f = node.planes(far_rows[a]).mul_add(inv, F32x8::splat(-ray.far_off[a]));
        near = near.max(n);
        far = far.min(f);
    }
    (near.le(far * F32x8::splat(SLAB_SLACK)), near)
}

const LANE: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];

/// Sort keys: ascending keys are descending distances, misses come last. The lane is in the low bits.
#[inline(always)]
pub(super) fn keys(hit: <F32x8 as Lanes>::Mask, near: F32x8) -> U32x8 {
    let key = near.to_bits().complement().and(U32x8::splat(!7)).or(U32x8::load(&LANE));
    U32x8::select(hit, key, U32x8::splat(u32::MAX))
}

/// A lower bound of the distance in a key.
#[inline(always)]
fn distance(key: u32) -> f32 {
    f32::from_bits(!(key | 7))
}

/// Lower bounds of the distances in keys.
#[inline(always)]
pub(super) fn distances(keys: U32x8) -> F32x8 {
    F32x8::from_bits(keys.or(U32x8::splat(7)).complement())
}

/// Sorts eight keys: Batcher's odd-even merge network, 19 comparators in six layers.
#[inline(always)]
pub(super) fn sort(k: U32x8) -> U32x8 {
    #[inline(always)]
    fn layer(k: U32x8, partner: [u32; 8], keep_small: u32) -> U32x8 {
        let other = k.permute_const(partner);
        let small = std::array::from_fn::<u32, 8, _>(|i| if keep_small >> i & 1 == 1 { u32::MAX } else { 0 });
        let small = U32x8::load(&small);
        let (lo, hi) = (k.min(other), k.max(other));
        lo.and(small).or(hi.and(small.complement()))
    }
    let k = layer(k, [1, 0, 3, 2, 5, 4, 7, 6], 0b0101_0101);
    let k = layer(k, [2, 3, 0, 1, 6, 7, 4, 5], 0b0011_0011);
    let k = layer(k, [0, 2, 1, 3, 4, 6, 5, 7], 0b1011_1011);
    let k = layer(k, [4, 5, 6, 7, 0, 1, 2, 3], 0b0000_1111);
    let k = layer(k, [0, 1, 4, 5, 2, 3, 6, 7], 0b1100_1111);
    layer(k, [0, 2, 1, 4, 3, 6, 5, 7], 0b1010_1011)
}

impl Single {
    /// Room for any traversal of `bvh`.
    pub fn new(bvh: &Bvh) -> Self {
        Self { keys: vec![0; bvh.stack_bound], codes: vec![0; bvh.stack_bound] }
    }

    /// The nearest hit.
    pub fn closest(&mut self, bvh: &Bvh, ray: &Ray) -> Hit {
        let mut hit = Hit::miss(ray.t_max);
        if bvh.nodes.is_empty() {
            return hit;
        }
        let prepared = Prepared::new(ray);
        self.keys[0] = u32::MAX;
        self.codes[0] = 0;
        let mut top = 1;
        while top > 0 {
            top -= 1;
            if distance(self.keys[top]) > hit.t {
                continue;
            }
            let code = self.codes[top];
            if code & LEAF != 0 {
                closest_in_leaf(&bvh.leaves[(code & !LEAF) as usize], &prepared, &mut hit);
            } else {
                top += self.push(&bvh.nodes[code as usize], &prepared, hit.t, top);
            }
        }
        hit
    }

    /// Whether anything is hit.
    pub fn any(&mut self, bvh: &Bvh, ray: &Ray) -> bool {
        if bvh.nodes.is_empty() {
            return false;
        }
        let prepared = Prepared::new(ray);
        self.codes[0] = 0;
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let code = self.codes[top];
            if code & LEAF != 0 {
                if any_in_leaf(&bvh.leaves[(code & !LEAF) as usize], &prepared, ray.t_max) {
                    return true;
                }
            } else {
                let node = &bvh.nodes[code as usize];
                let bits = boxes(node, &prepared, ray.t_max).0.bits();
                node.children().pack(bits).store(&mut self.codes[top..]);
                top += bits.count_ones() as usize;
            }
        }
        false
    }

    /// Pushes the children that the ray meets, the nearest on top, and returns how many.
    #[inline(always)]
    fn push(&mut self, node: &Node, ray: &Prepared, t_max: f32, top: usize) -> usize {
        let (mask, near) = boxes(node, ray, t_max);
        let sorted = sort(keys(mask, near));
        sorted.store(&mut self.keys[top..]);
        node.children().permute(sorted).store(&mut self.codes[top..]);
        mask.bits().count_ones() as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A comparator network sorts everything if it sorts all sequences of zeros and ones (Knuth's 0-1 principle).
    #[test]
    fn network_sorts_all_zero_one_sequences() {
        for bits in 0..256u32 {
            let sorted = sort(U32x8::from_fn(|i| bits >> i & 1)).array();
            assert!(sorted.is_sorted(), "{bits:08b}: {sorted:?}");
        }
    }
}
