//! Choice among a few emitters: the importance of each is evaluated, at every receiver.

use super::FEW;
use super::importance::{Bounds, Receiver, importance};
use crate::lanes::{Lanes, LanesU32};

/// [`Bounds::row`] and [`Bounds::scale`] of an emitter.
type Row = ([f32; 8], [f32; 2]);

/// Emitters that are told apart one by one, [`FEW`] at most.
#[derive(Clone, Debug, Default)]
pub struct Few {
    emitters: Vec<Row>,
}

/// Importance of each emitter, and of all together.
#[inline(always)]
fn weigh<L: Lanes>(emitters: &[Row], from: &Receiver<L>) -> ([L; FEW], L) {
    let (mut own, mut total) = ([L::splat(0.0); FEW], L::splat(0.0));
    for (own, (row, scale)) in own.iter_mut().zip(emitters) {
        *own = importance::<L, false>(row.map(L::splat), scale.map(L::splat), from);
        total = total + *own;
    }
    (own, total)
}

/// As [`Few::pick`].
#[inline(always)]
fn pick<L: Lanes>(emitters: &[Row], from: &Receiver<L>, u: L) -> (L::Uint, L) {
    let (own, total) = weigh(emitters, from);
    let threshold = u * total;
    let (mut sum, mut number, mut chosen) = (L::splat(0.0), L::splat(0.0), L::splat(0.0));
    for (i, (&own, _)) in own.iter().zip(emitters).enumerate() {
        // The last one that begins at or below the threshold and is not empty.
        let here = sum.le(threshold) & own.gt(L::splat(0.0));
        number = L::select(here, L::from_bits(L::Uint::splat(i as u32)), number);
        chosen = L::select(here, own, chosen);
        sum = sum + own;
    }
    (number.to_bits(), probability(chosen, total))
}

impl Few {
    pub fn new(bounds: &[Bounds]) -> Self {
        Self { emitters: bounds.iter().map(|b| (b.row(), b.scale())).collect() }
    }
    /// Chooses an emitter by a uniform number; also its probability, 0 where no emitter can be of use.
    #[inline(always)]
    pub fn pick<L: Lanes>(&self, from: &Receiver<L>, u: L) -> (L::Uint, L) {
        match self.emitters[..] {
            // Of known length, the loops unroll.
            [a, b] => pick(&[a, b], from, u),
            _ => pick(&self.emitters, from, u),
        }
    }
    /// Probability with which [`Self::pick`] chooses the given emitters.
    #[inline(always)]
    pub fn probability<L: Lanes>(&self, from: &Receiver<L>, emitter: L::Uint) -> L {
        let (own, total) = weigh(&self.emitters, from);
        let (wanted, mut chosen) = (L::from_u24(emitter), L::splat(0.0));
        for (i, (&own, _)) in own.iter().zip(&self.emitters).enumerate() {
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
