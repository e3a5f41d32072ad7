//! Russian roulette: which paths go on, and with what weight.

use super::queues::Path;
use crate::lanes::{Lanes, LanesU32};
use crate::sampling::{Decision, Sampler};

/// Bounces before roulette begins: what a dark mirror shows is not left to chance.
const FROM: u32 = 2;
/// It plays where less than one part in this many is left of a path's energy. Sooner, the paths that survive weigh
/// so much that they add more noise than the time of the others is worth (docs/decisions/roulette.md).
const PARTS: f32 = 3.0;

/// Counts a bounce, and plays Russian roulette by the share of energy that is left (Arvo and Kirk 1990): what throughput is
/// to `scale`, which refraction changes along with it. Which paths go on, with the weight of the others.
#[inline(always)]
pub(super) fn alive<S: Sampler, L: Lanes>(path: &mut Path<L>, scale: L) -> L::Mask {
    let one = L::splat(1.0);
    let [coin] = S::draw::<L, 1>(&mut path.rng, Decision::Roulette, path.depth);
    let energy = path.throughput.max_component();
    path.depth = path.depth.add(L::Uint::splat(1));
    let plays = L::from_u24(path.depth).gt(L::splat(FROM as f32));
    // One over the chance to go on.
    let weight = L::select(plays, (scale / (energy * L::splat(PARTS))).max(one), one);
    path.throughput = path.throughput * weight;
    (coin * weight).lt(one) & energy.gt(L::splat(0.0))
}
