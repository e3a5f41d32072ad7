//! Choice among a few emitters: the importance of each is evaluated, at every receiver.

use super::FEW;
use super::importance::{Bounds, Receiver, importance};
use crate::lanes::{Lanes, LanesU32};

/// Emitters that are told apart one by one, [`FEW`] at most.
#[derive(Clone, Debug, Default)]
pub struct Few {
    /// What bounds each, and its power.
    emitters: Vec<([f32; 8], f32)>,
}

impl Few {
    pub fn new(bounds: &[Bounds]) -> Self {
        Self { emitters: bounds.iter().map(|b| (b.row(), b.power)).collect() }
    }
    /// Importance of each emitter, and of all together.
    #[inline(always)]
    fn weigh<L: Lanes>(&self, from: &Receiver<L>) -> ([L; FEW], L) {
        let (mut own, mut total) = ([L::splat(0.0); FEW], L::splat(0.0));
        for (own, (row, power)) in own.iter_mut().zip(&self.emitters) {
            *own = importance::<L, false>(row.map(L::splat), L::splat(*power), from);
            total = total + *own;
        }
        (own, total)
    }
    /// Chooses an emitter by a uniform number; also its probability, 0 where no emitter can be of use.
    #[inline(always)]
    pub fn pick<L: Lanes>(&self, from: &Receiver<L>, u: L) -> (L::Uint, L) {
        let (own, total) = self.weigh(from);
        let threshold = u * total;
        let (mut sum, mut number, mut chosen) = (L::splat(0.0), L::splat(0.0), L::splat(0.0));
        for (i, &own) in own[..self.emitters.len()].iter().enumerate() {
            // The last one that begins at or below the threshold and is not empty.
            let here = sum.le(threshold) & own.gt(L::splat(0.0));
            number = L::select(here, L::from_bits(L::Uint::splat(i as u32)), number);
            chosen = L::select(here, own, chosen);
            sum = sum + own;
        }
        (number.to_bits(), probability(chosen, total))
    }
    /// Probability with which [`Self::pick`] chooses the given emitters.
    #[inline(always)]
    pub fn probability<L: Lanes>(&self, from: &Receiver<L>, emitter: L::Uint) -> L {
        let (own, total) = self.weigh(from);
        let (wanted, mut chosen) = (L::from_u24(emitter), L::splat(0.0));
        for (i, &own) in own[..self.emitters.len()].iter().enumerate() {
            chosen = L::select(wanted.eq(L::splat(i as f32)), own, chosen);
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
