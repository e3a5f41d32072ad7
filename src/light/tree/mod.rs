//! Choice among many emitters: a binary tree of their bounds, descended by importance at the receiver (Conty Estevez and
//! Kulla 2018). An emitter is chosen, and the probability of its choice found, in as many steps as the tree is deep.

mod build;

use super::few::probability;
use super::importance::{Bounds, Receiver, importance};
use crate::lanes::{Lanes, LanesU32, MAX_LANES, Mask};

/// Bit of a child that is an emitter; the rest is its number.
const LEAF: u32 = 1 << 31;

/// An inner node: what its two children hold, on two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(128))]
struct Node {
    bounds: [[f32; 8]; 2],
    /// [`Bounds::scale`] of both children; the rest is unused.
    scales: [f32; 8],
    /// Numbers of both children: nodes, or emitters with the [`LEAF`] bit.
    children: [u32; 2],
}

/// A tree over two emitters or more.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    nodes: Vec<Node>,
    /// Per emitter, the way to it from the root: bit k says to which child to go at level k.
    ways: Vec<u32>,
}

/// Lanes on their way down.
struct Descent<L> {
    at: [u32; MAX_LANES],
    /// Bits of the lanes that have not arrived at an emitter.
    open: u32,
    /// Probability of the way so far.
    chance: L,
}

impl<L: Lanes> Descent<L> {
    #[inline(always)]
    fn new() -> Self {
        Self { at: [0; MAX_LANES], open: (1 << L::N) - 1, chance: L::splat(1.0) }
    }
    /// Probability of the left child of each lane's node, and of any.
    #[inline(always)]
    fn left(&self, tree: &Tree, from: &Receiver<L>) -> (L, L) {
        let node = |i: usize| &tree.nodes[self.at[i] as usize];
        let [p, sin_p, q, sin_q, ..] = L::columns8(|i| &node(i).scales);
        let left = importance::<L, true>(L::columns8(|i| &node(i).bounds[0]), [p, sin_p], from);
        let total = left + importance::<L, true>(L::columns8(|i| &node(i).bounds[1]), [q, sin_q], from);
        (probability(left, total), L::select(total.gt(L::splat(0.0)), L::splat(1.0), L::splat(0.0)))
    }
    /// Takes each open lane to one child, `right` by its bits, that had probability `share`; what has arrived at an emitter
    /// is given to `arrived`.
    #[inline(always)]
    fn step(&mut self, tree: &Tree, right: u32, share: L, mut arrived: impl FnMut(usize, u32)) {
        let (shares, mut chances) = (share.array(), self.chance.array());
        for (i, (chance, &share)) in chances.as_mut().iter_mut().zip(shares.as_ref()).enumerate() {
            if self.open >> i & 1 == 0 {
                continue;
            }
            *chance *= share;
            let child = tree.nodes[self.at[i] as usize].children[(right >> i & 1) as usize];
            if child & LEAF == 0 {
                self.at[i] = child;
            } else {
                self.open &= !(1 << i);
                arrived(i, child & !LEAF);
            }
        }
        self.chance = L::load(chances.as_ref());
    }
}

impl Tree {
    pub fn new(bounds: &[Bounds]) -> Self {
        build::build(bounds)
    }
    /// Chooses an emitter by a uniform number; also its probability, 0 where no emitter was found that can be of use.
    #[inline(always)]
    pub fn pick<L: Lanes>(&self, from: &Receiver<L>, mut u: L) -> (L::Uint, L) {
        let one = L::splat(1.0);
        let mut chosen = [0; MAX_LANES];
        let mut descent = Descent::new();
        while descent.open != 0 {
            let (left, any) = descent.left(self, from);
            let goes_left = u.lt(left);
            let share = L::select(goes_left, left, one - left);
            // What is left of the number once it has decided is uniform again.
            let rest = L::select(goes_left, u, u - left) / share.max(L::splat(f32::MIN_POSITIVE));
            u = rest.min(L::splat(1.0 - f32::EPSILON / 2.0));
            descent.step(self, !goes_left.bits(), share * any, |i, emitter| chosen[i] = emitter);
        }
        (L::Uint::load(&chosen), descent.chance)
    }
    /// Probability with which [`Self::pick`] chooses the given emitters.
    #[inline(always)]
    pub fn probability<L: Lanes>(&self, from: &Receiver<L>, emitter: L::Uint) -> L {
        let numbers = emitter.array();
        let mut ways = [0; MAX_LANES];
        for (way, &number) in ways.iter_mut().zip(numbers.as_ref()) {
            *way = self.ways[number as usize];
        }
        let mut descent = Descent::new();
        while descent.open != 0 {
            let (left, any) = descent.left(self, from);
            let mut right = 0;
            for (i, way) in ways.iter_mut().enumerate() {
                right |= (*way & 1) << i;
                *way >>= 1;
            }
            let sides: [f32; MAX_LANES] = std::array::from_fn(|i| (right >> i & 1) as f32);
            let goes_right = L::load(&sides).gt(L::splat(0.0));
            let share = L::select(goes_right, L::splat(1.0) - left, left);
            descent.step(self, right, share * any, |_, _| ());
        }
        descent.chance
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.ways[..])
    }
}
