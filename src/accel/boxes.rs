//! A node's eight boxes against one ray, and the order in which their children are visited.
//!
//! The order is the node's own, one for each octant of directions (Ylitie, Karras and Laine 2017, section 3.2, in tables
//! instead of by the places of children): rays meet as many boxes as with children sorted by their distances, without the
//! sort.

use super::layout::Node;
use super::ray::Prepared;
use crate::lanes::{LanesU32, MAX_LANES, Mask, Wide, WideU32};

/// Where a ray enters the boxes of a node and where it leaves them, each as far as rounding may have moved it: it meets
/// those where the first is not above the second.
#[inline(always)]
pub(super) fn enter<W: Wide>(node: &Node, ray: &Prepared, end: f32) -> (W, W) {
    let mut near = W::splat(0.0);
    let mut far = W::splat(end);
    for axis in 0..3 {
        let inv = W::splat(ray.inv(axis));
        let lower = node.row::<W>(axis as u32).mul_add(inv, W::splat(-ray.off(axis)));
        let upper = node.row::<W>(axis as u32 + 3).mul_add(inv, W::splat(-ray.off(axis + 3)));
        near = near.max(lower.min(upper));
        far = far.min(lower.max(upper));
    }
    (near, far)
}

/// An order of lanes: four bits each, those of the lane visited last in the lowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Order(pub u32);

impl Order {
    /// By number.
    pub const ASCENDING: Self = Self(0x0123_4567);

    /// Nearer ones before farther ones.
    pub fn by_distance(distances: [f32; MAX_LANES]) -> Self {
        let mut lanes: [u32; MAX_LANES] = std::array::from_fn(|lane| lane as u32);
        lanes.sort_by(|&a, &b| distances[a as usize].total_cmp(&distances[b as usize]));
        Self(lanes.iter().fold(0, |order, lane| order << 4 | lane))
    }
    /// The lanes, the one visited last first; above their three bits there may be others.
    #[inline(always)]
    pub fn lanes<U: WideU32>(self) -> U {
        U::splat(self.0).shr_each([0, 4, 8, 12, 16, 20, 24, 28])
    }
    /// The lane at place `at` of [`Self::lanes`].
    #[inline(always)]
    pub fn lane(self, at: u32) -> usize {
        (self.0 >> ((4 * at) & 31) & 7) as usize
    }
}

/// The boxes of a node that a ray meets, packed to the front in the order of visits, the last one first.
pub(super) struct Met<W: Wide> {
    /// Places of the order that are met.
    bits: u32,
    /// The order, and where the ray enters the boxes in this order.
    lanes: W::Uint,
    near: W,
}

impl<W: Wide> Met<W> {
    /// From what [`enter`] returns.
    #[inline(always)]
    pub fn new((near, far): (W, W), order: Order) -> Self {
        let lanes = order.lanes::<W::Uint>();
        let (near, far) = (near.permute(lanes), far.permute(lanes));
        Self { bits: near.le(far).bits(), lanes, near }
    }
    /// Number of boxes.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.bits.count_ones() as usize
    }
    /// Their lanes; above three bits there may be others.
    #[inline(always)]
    pub fn lanes(&self) -> W::Uint {
        self.lanes.pack(self.bits)
    }
    /// Where the ray enters them.
    #[inline(always)]
    pub fn near(&self) -> W {
        self.near.pack(self.bits)
    }
    /// Where they lead, if all lead to `children`.
    #[inline(always)]
    pub fn codes(&self, children: W::Uint) -> W::Uint {
        children.permute(self.lanes).pack(self.bits)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Ray;
    use super::*;
    use crate::lanes::{F32x8, Lanes, U32x8};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    #[test]
    fn boxes_are_met_in_their_order() {
        let near = [3.0, 0.0, 2.0, 7.0, 0.5, 9.0, 2.5, 8.0f32];
        let codes: [u32; 8] = std::array::from_fn(|lane| 100 + lane as u32);
        let order = Order::by_distance(near);
        assert_eq!(Order::by_distance(std::array::from_fn(|lane| lane as f32)), Order::ASCENDING);
        for bits in 0..256u32 {
            let far = F32x8::from_fn(|i| if bits >> i & 1 == 1 { 10.0 } else { f32::NAN });
            let met = Met::new((F32x8::load(&near), far), order);
            let mut expected: Vec<usize> = (0..8).filter(|i| bits >> i & 1 == 1).collect();
            expected.sort_by(|&a, &b| near[b].total_cmp(&near[a]));
            let n = met.count();
            assert_eq!(met.lanes().array()[..n].iter().map(|l| (l & 7) as usize).collect::<Vec<_>>(), expected);
            assert_eq!(met.near().array()[..n].to_vec(), expected.iter().map(|&l| near[l]).collect::<Vec<_>>());
            let expected: Vec<u32> = expected.iter().map(|&l| codes[l]).collect();
            assert_eq!(met.codes(U32x8::load(&codes)).array()[..n].to_vec(), expected);
        }
    }

    /// Planes are never entered too late or left too early: against the same in f64, which is exact for the purpose.
    #[test]
    fn slabs_are_padded_for_what_rounding_does() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut unit = || (rng.next_u32() >> 8) as f32 / 16_777_216.0;
        let (mut slabs, mut tight) = (0, 0);
        for _ in 0..100_000 {
            // Places and sizes of all magnitudes; origins beside a plane, where most is cancelled.
            let mut signed = |powers: f32| (unit() - 0.5) * 2f32.powf((unit() - 0.5) * powers);
            let lo: [f32; 3] = std::array::from_fn(|_| signed(40.0));
            let hi = lo.map(|lo| lo + signed(40.0).abs());
            let direction = [signed(20.0), signed(20.0), signed(20.0)];
            let near_plane = signed(1.0) > 0.0;
            let origin = lo.map(|lo| if near_plane { lo + lo.abs() * signed(1.0) * 1e-6 } else { signed(40.0) });
            if direction.contains(&0.0) {
                continue;
            }
            let mut node = Node::empty();
            (0..8).for_each(|lane| node.set(lane, lo, hi, 0));
            let ray = Prepared::new(&Ray { origin, direction, t_max: f32::INFINITY });
            let (near, far) = enter::<F32x8>(&node, &ray, f32::INFINITY);
            let (near, far) = (f64::from(near.array()[0]), f64::from(far.array()[0]));
            let exact =
                |plane: f32, axis: usize| (f64::from(plane) - f64::from(origin[axis])) / f64::from(direction[axis]);
            let (mut enters, mut leaves) = (0.0f64, f64::INFINITY);
            for axis in 0..3 {
                let (a, b) = (exact(lo[axis], axis), exact(hi[axis], axis));
                (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
            }
            assert!(
                near <= enters && far >= leaves,
                "{lo:?} {hi:?} {origin:?} {direction:?}: {near} {enters} {leaves} {far}"
            );
            slabs += 1;
            tight += u32::from(near > enters * 0.999 && enters > 0.0);
        }
        assert!(tight > slabs / 4, "only {tight} of {slabs} are within a thousandth");
    }
}
