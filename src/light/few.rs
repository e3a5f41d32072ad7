//! Choice among a few emitters: the importance of each is evaluated, at every receiver.

use super::importance::{Bounds, Receiver, importance};
use crate::lanes::{Lanes, LanesU32};

/// Emitters that are told apart one by one.
#[derive(Clone, Debug, Default)]
pub struct Few {
    /// What bounds each, and its power.
    emitters: Vec<([f32; 8], f32)>,
}

impl Few {
    pub fn new(bounds: &[Bounds]) -> Self {
        Self { emitters: bounds.iter().map(|b| (b.row(), b.power)).collect() }
    }
    #[inline(always)]
    fn importance<L: Lanes>(&self, i: usize, from: &Receiver<L>) -> L {
        let (row, power) = &self.emitters[i];
        importance(row.map(L::splat), L::splat(*power), from)
    }
    #[inline(always)]
    fn total<L: Lanes>(&self, from: &Receiver<L>) -> L {
        let mut total = L::splat(0.0);
        for i in 0..self.emitters.len() {
            total = total + self.importance(i, from);
        }
        total
    }
    /// Chooses an emitter by a uniform number; also its probability, 0 where no emitter can be of use.
    #[inline(always)]
    pub fn pick<L: Lanes>(&self, from: &Receiver<L>, u: L) -> (L::Uint, L) {
        let total = self.total(from);
        let threshold = u * total;
        let (mut sum, mut number, mut chosen) = (L::splat(0.0), L::splat(0.0), L::splat(0.0));
        for i in 0..self.emitters.len() {
            let own = self.importance(i, from);
            // The last one that begins at or below the threshold and is not empty.
            let here = sum.le(threshold) & own.gt(L::splat(0.0));
            number = L::select(here, L::splat(i as f32), number);
            chosen = L::select(here, own, chosen);
            sum = sum + own;
        }
        let numbers = number.array();
        (L::Uint::from_fn(|i| numbers.as_ref()[i] as u32), probability(chosen, total))
    }
    /// Probability with which [`Self::pick`] chooses the given emitters.
    #[inline(always)]
    pub fn probability<L: Lanes>(&self, from: &Receiver<L>, emitter: L::Uint) -> L {
        let wanted = L::from_u24(emitter);
        let (mut total, mut chosen) = (L::splat(0.0), L::splat(0.0));
        for i in 0..self.emitters.len() {
            let own = self.importance(i, from);
            chosen = L::select(wanted.eq(L::splat(i as f32)), own, chosen);
            total = total + own;
        }
        probability(chosen, total)
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.emitters[..])
    }
}

/// `part / whole`; 0 where there is nothing.
#[inline(always)]
pub(super) fn probability<L: Lanes>(part: L, whole: L) -> L {
    L::select(part.gt(L::splat(0.0)), part / whole, L::splat(0.0))
}
