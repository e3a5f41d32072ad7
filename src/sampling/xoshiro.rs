//! Independent streams: xoroshiro64* (Blackman and Vigna 2021), one per (seed, pixel, sample), in lanes.

use super::sobol::hash;
use super::{Decision, Sampler, State};
use crate::lanes::{Lanes, LanesU32, MAX_LANES};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Independent pseudo-random streams. Lane i gives the very stream of `rand_xoshiro::Xoroshiro64Star`, whose upper bits make
/// the numbers; its state is that of two columns. Different samples begin at different states: what mixes the key is
/// one-to-one. (One state of 2^64 is all zeros and stays so.)
#[derive(Clone, Copy, Debug, Default)]
pub struct Xoshiro;

/// Distinct for distinct (pixel, sample) of one seed; unrelated between seeds.
fn key(seed: u64, pixel: u32, sample: u32) -> u64 {
    (u64::from(pixel) << 32 | u64::from(sample)) ^ SplitMix64::seed_from_u64(seed).next_u64()
}

impl Sampler for Xoshiro {
    #[inline(always)]
    fn start<L: Lanes>(seed: u64, pixel: L::Uint, sample: L::Uint) -> State<L> {
        let (pixel, sample) = (pixel.array(), sample.array());
        let mut states = [[0u32; MAX_LANES]; 2];
        for (i, (&pixel, &sample)) in pixel.as_ref().iter().zip(sample.as_ref()).enumerate() {
            let mixed = SplitMix64::seed_from_u64(key(seed, pixel, sample)).next_u64();
            (states[0][i], states[1][i]) = (mixed as u32, (mixed >> 32) as u32);
        }
        states.map(|s| L::Uint::load(&s))
    }

    #[inline(always)]
    fn fork<L: Lanes>(&[a, b]: &State<L>) -> State<L> {
        // One-to-one, so that different states stay different.
        [hash(a.xor(L::Uint::splat(0x85eb_ca6b))), hash(b.xor(L::Uint::splat(0xc2b2_ae35)))]
    }

    #[inline(always)]
    fn draw<L: Lanes, const N: usize>(s: &mut State<L>, _decision: Decision, _depth: L::Uint) -> [L; N] {
        let mut numbers = [L::splat(0.0); N];
        for number in &mut numbers {
            let result = s[0].mul(L::Uint::splat(0x9e37_79bb));
            let both = s[0].xor(s[1]);
            s[0] = s[0].rotl(26).xor(both).xor(both.shl(9));
            s[1] = both.rotl(13);
            *number = L::unit_from_u32(result);
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{F32x8, U32x8};
    use rand_xoshiro::Xoroshiro64Star;

    #[test]
    fn lanes_give_the_stream_of_rand_xoshiro() {
        let pixels = U32x8::from_fn(|i| 1000 * i as u32 + 7);
        let mut state = Xoshiro::start::<F32x8>(42, pixels, U32x8::splat(3));
        let mut oracles: Vec<_> = (0..8u32).map(|i| Xoroshiro64Star::seed_from_u64(key(42, 1000 * i + 7, 3))).collect();
        for draw in 0..1000 {
            let [x] = Xoshiro::draw::<F32x8, 1>(&mut state, Decision::Scatter, U32x8::splat(0));
            for (i, oracle) in oracles.iter_mut().enumerate() {
                assert_eq!(x.array()[i], <f32 as Lanes>::unit_from_u32(oracle.next_u32()), "draw {draw}, lane {i}");
            }
        }
    }

    #[test]
    fn neighbouring_seeds_pixels_and_samples_are_unrelated() {
        let first = |seed, pixel, sample| {
            let mut s = Xoshiro::start::<f32>(seed, pixel, sample);
            Xoshiro::draw::<f32, 1>(&mut s, Decision::Pixel, 0)[0] as f64
        };
        // Correlation of n uniform pairs has standard deviation 1/sqrt(n): five of them are the bound.
        let n = 100_000u32;
        for (name, pairs) in [
            ("seed", (0..n).map(|i| (first(5, i, 0), first(6, i, 0))).collect::<Vec<_>>()),
            ("pixel", (0..n).map(|i| (first(5, i, 0), first(5, i + 1, 0))).collect()),
            ("sample", (0..n).map(|i| (first(5, 9, i), first(5, 9, i + 1))).collect()),
        ] {
            let r = pairs.iter().map(|(a, b)| (a - 0.5) * (b - 0.5)).sum::<f64>() * 12.0 / f64::from(n);
            assert!(r.abs() < 5.0 / f64::from(n).sqrt(), "{name}: correlation {r}");
        }
    }
}
