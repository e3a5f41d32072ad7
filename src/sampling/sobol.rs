//! Owen-scrambled Sobol points in pairs of dimensions, padded: each decision at each vertex has a pair of its own, shuffled
//! and scrambled by hashes (Burley 2020, "Practical Hash-based Owen Scrambling"). Each pair is a (0, 2)-sequence: of 2^m
//! points, every cell of every power-of-two grid of 2^m cells holds one.

use super::{Decision, Sampler, Screen, State};
use crate::lanes::{Lanes, LanesU32};

/// Low-discrepancy points: each vertex and decision gets a shuffle and a scramble of its own. Where few samples are asked for,
/// the pixels of a tile share one sequence, along the Z curve: neighbours, too, get points that are well spread, and so errors
/// that cancel out before the eye (Ahmed and Wonka 2020, "Screen-space Blue-noise Diffusion of Monte Carlo Sampling Error via
/// Hierarchical Ordering of Pixels"). Else each pixel has a shuffle and scramble of its own, anew past 2^16 samples, so that
/// no pattern of the hashes can show in more samples than that.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sobol;

/// Samples of a pixel that share one scramble.
const BLOCK_BITS: u32 = 16;

#[inline(always)]
fn constant<U: LanesU32>(value: u32) -> U {
    U::splat(value)
}

/// A well-mixed hash of 32 bits (Wellons 2018, "lowbias32").
#[inline(always)]
pub(super) fn hash<U: LanesU32>(x: U) -> U {
    let x = x.xor(x.shr(16)).mul(constant(0x7feb_352d));
    let x = x.xor(x.shr(15)).mul(constant(0x846c_a68b));
    x.xor(x.shr(16))
}

/// A seed of its own from a hash: the product with an odd number, whose upper half is added to the lower one, because a
/// scramble's first digit depends on the lowest bit.
#[inline(always)]
fn derived<U: LanesU32>(hashed: U, odd: u32) -> U {
    let product = hashed.mul(constant(odd));
    product.xor(product.shr(16))
}

/// Exchanges the bits under `mask` with those `by` above them. No closure, because a closure need not be inlined.
#[inline(always)]
fn swap<U: LanesU32>(x: U, by: u32, mask: u32) -> U {
    x.shr(by).and(constant(mask)).or(x.and(constant(mask)).shl(by))
}

#[inline(always)]
fn reverse_bits<U: LanesU32>(x: U) -> U {
    let x = swap(x, 1, 0x5555_5555);
    let x = swap(x, 2, 0x3333_3333);
    let x = swap(x, 4, 0x0f0f_0f0f);
    let x = swap(x, 8, 0x00ff_00ff);
    x.shl(16).or(x.shr(16))
}

/// Owen scrambling of reversed bits, by a hash in which each bit is changed by lower bits alone (Laine and Karras 2011;
/// the constants are Burley's).
#[inline(always)]
fn owen_reversed<U: LanesU32>(x: U, seed: U) -> U {
    let x = x.add(seed);
    let x = x.xor(x.mul(constant(0x6c50_b47c)));
    let x = x.xor(x.mul(constant(0xb82f_1e52)));
    let x = x.xor(x.mul(constant(0xc7af_e638)));
    x.xor(x.mul(constant(0x8d22_f6e6)))
}

/// Reversed bits of the second dimension of Sobol's sequence. Its matrix is Pascal's triangle modulo 2, in which row i has
/// a one in column j where the binary digits of i are among those of j (Lucas 1878): one step per digit of the positions.
#[inline(always)]
fn second_reversed<U: LanesU32>(index: U) -> U {
    let x = index.xor(index.shr(16));
    let x = x.xor(x.shr(8).and(constant(0x00ff_00ff)));
    let x = x.xor(x.shr(4).and(constant(0x0f0f_0f0f)));
    let x = x.xor(x.shr(2).and(constant(0x3333_3333)));
    x.xor(x.shr(1).and(constant(0x5555_5555)))
}

impl Sobol {
    /// What scrambles are made from: another for each seed of a render, pixel and block.
    #[inline(always)]
    fn key<U: LanesU32>(seed: u64, pixel: U, block: U) -> U {
        let seed = hash(constant::<U>(seed as u32)).add(hash(constant((seed >> 32) as u32 ^ 0x5bd1_e995)));
        hash(hash(pixel.add(seed)).xor(seed).add(block))
    }
}

impl Sampler for Sobol {
    #[inline(always)]
    fn start<L: Lanes>(seed: u64, pixel: L::Uint, sample: L::Uint) -> State<L> {
        let key = Self::key(seed, pixel, hash(sample.shr(BLOCK_BITS)));
        let index = sample.and(constant((1 << BLOCK_BITS) - 1));
        [key, reverse_bits(index)]
    }

    #[inline(always)]
    fn on_screen<L: Lanes>(screen: &Screen, seed: u64, pixel: [L::Uint; 2], sample: L::Uint) -> State<L> {
        match screen.shared::<L>(pixel, sample) {
            Some((tile, index)) => [Self::key(seed, tile, constant(0x27d4_eb2f)), reverse_bits(index)],
            None => Self::start::<L>(seed, screen.number::<L>(pixel), sample),
        }
    }

    #[inline(always)]
    fn fork<L: Lanes>(&[key, reversed_index]: &State<L>) -> State<L> {
        [hash(key.xor(constant(0x85eb_ca6b))), reversed_index]
    }

    #[inline(always)]
    fn draw<L: Lanes, const N: usize>(state: &mut State<L>, decision: Decision, depth: L::Uint) -> [L; N] {
        let [key, reversed_index] = *state;
        let first = depth.mul(constant(Decision::PAIRS)).add(constant(decision.pair()));
        let mut numbers = [L::splat(0.0); N];
        for (k, two) in numbers.chunks_mut(2).enumerate() {
            let pair = first.add(constant(k as u32));
            let seed = hash(key.add(pair.mul(constant(0x9e37_79b9))));
            let index = reverse_bits(owen_reversed(reversed_index, seed));
            // The first dimension is the index with its bits reversed.
            let scrambled = owen_reversed(index, derived(seed, 0x632b_e59b));
            two[0] = L::unit_from_u32(reverse_bits(scrambled));
            if let [_, second] = two {
                let scrambled = owen_reversed(second_reversed(index), derived(seed, 0xc657_cb37));
                *second = L::unit_from_u32(reverse_bits(scrambled));
            }
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Kernel, Wide, dispatch};
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    fn points(pixel: u32, n: u32, decision: Decision) -> Vec<[f32; 3]> {
        (0..n)
            .map(|i| {
                let mut s = Sobol::start::<f32>(1, pixel, i);
                Sobol::draw::<f32, 3>(&mut s, decision, 2)
            })
            .collect()
    }

    /// Sobol's second dimension from its recurrence: column j of the matrix is the one before, xor itself shifted by one.
    #[test]
    fn the_second_dimension_is_that_of_the_direction_numbers() {
        let mut columns = [1u32 << 31; 32];
        for j in 1..32 {
            columns[j] = columns[j - 1] ^ columns[j - 1] >> 1;
        }
        for index in (0..4096).chain((0..1000).map(|i: u32| i.wrapping_mul(0x9e37_79b9))) {
            let expected = (0..32).filter(|j| index >> j & 1 == 1).fold(0, |x, j: usize| x ^ columns[j]);
            assert_eq!(reverse_bits(second_reversed(index)), expected, "index {index}");
        }
    }

    /// The net property: of 2^m scrambled points, each of the 2^m cells of any power-of-two grid holds exactly one.
    #[test]
    fn pairs_of_dimensions_are_nets() {
        for pixel in [0, 1, 77] {
            let p = points(pixel, 256, Decision::Light);
            for log_x in 0..=8u32 {
                let (nx, ny) = (1usize << log_x, 1usize << (8 - log_x));
                let mut cells = vec![0; 256];
                for q in &p {
                    cells[(q[0] * nx as f32) as usize * ny + (q[1] * ny as f32) as usize] += 1;
                }
                assert!(cells.iter().all(|&c| c == 1), "pixel {pixel}, {nx} x {ny}");
            }
        }
    }

    /// Where pixels share a sequence, the points of each aligned square of 2^k x 2^k pixels are a net in all.
    #[test]
    fn neighbours_share_a_net() {
        for (spp, side) in [(1, 16), (4, 8), (16, 2), (64, 1)] {
            let screen = Screen::new(48, spp);
            for corner in [[0, 0], [16, 16], [32, 0]] {
                let p: Vec<[f32; 2]> = (0..spp * side * side)
                    .map(|i| {
                        let (pixel, sample) = (i / spp, i % spp);
                        let at = [corner[0] + pixel % side, corner[1] + pixel / side];
                        let mut s = Sobol::on_screen::<f32>(&screen, 1, at, sample);
                        Sobol::draw::<f32, 2>(&mut s, Decision::Light, 3)
                    })
                    .collect();
                let log = p.len().ilog2();
                for log_x in 0..=log {
                    let (nx, ny) = (1usize << log_x, 1usize << (log - log_x));
                    let mut cells = vec![0; p.len()];
                    for q in &p {
                        cells[(q[0] * nx as f32) as usize * ny + (q[1] * ny as f32) as usize] += 1;
                    }
                    assert!(cells.iter().all(|&c| c == 1), "{spp} samples at {corner:?}, {nx} x {ny}");
                }
            }
        }
    }

    #[test]
    fn each_dimension_is_stratified_and_pixels_differ() {
        for decision in [Decision::Scatter, Decision::Light] {
            for k in 0..3 {
                let mut cells = vec![0; 1024];
                points(5, 1024, decision).iter().for_each(|q| cells[(q[k] * 1024.0) as usize] += 1);
                assert!(cells.iter().all(|&c| c == 1), "dimension {k}");
            }
        }
        assert_ne!(points(0, 4, Decision::Pixel), points(1, 4, Decision::Pixel));
    }

    #[test]
    fn past_the_block_the_scramble_is_new() {
        let at = |i| {
            let mut s = Sobol::start::<f32>(1, 3, i);
            Sobol::draw::<f32, 1>(&mut s, Decision::Pixel, 0)[0]
        };
        let same = (0..256).filter(|&i| at(i) == at(i + (1 << BLOCK_BITS))).count();
        assert!(same <= 1, "{same} of 256 numbers repeat");
    }

    /// Over pixels, a point's digits are independent in both dimensions and between decisions: chi-squared over 32 x 32
    /// cells of their first five. 6 tests at 10^-3 in all (Sidak): each at 1.7e-4.
    #[test]
    fn scrambles_of_pixels_and_dimensions_are_independent() {
        let n = 200_000u32;
        for sample in [0, 5] {
            let mut counts = vec![[0u32; 1024]; 3];
            for pixel in 0..n {
                let mut s = Sobol::start::<f32>(1, pixel, sample);
                let [a, b] = Sobol::draw::<f32, 2>(&mut s, Decision::Light, 1);
                let [c, d] = Sobol::draw::<f32, 2>(&mut s, Decision::Scatter, 1);
                for (k, [x, y]) in [[a, b], [a, c], [b, d]].into_iter().enumerate() {
                    counts[k][(x * 32.0) as usize * 32 + (y * 32.0) as usize] += 1;
                }
            }
            for cells in counts {
                let expected = f64::from(n) / 1024.0;
                let chi2: f64 = cells.iter().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
                let p = ChiSquared::new(1023.0).unwrap().sf(chi2);
                assert!(p > 1.7e-4, "sample {sample}: p = {p}");
            }
        }
    }

    /// Numbers of pixels 0 to 7.
    struct Eight;
    impl Kernel for Eight {
        type Out = [[f32; 8]; 3];
        #[inline(always)]
        fn run<W: Wide>(self) -> Self::Out {
            let mut state = Sobol::start::<W>(9, W::Uint::from_fn(|i| i as u32), W::Uint::splat(70_001));
            Sobol::draw::<W, 3>(&mut state, Decision::Scatter, W::Uint::splat(4)).map(Lanes::array)
        }
    }

    #[test]
    fn wide_matches_scalar() {
        let w = dispatch(Eight);
        for i in 0..8 {
            let mut one = Sobol::start::<f32>(9, i as u32, 70_001);
            let s = Sobol::draw::<f32, 3>(&mut one, Decision::Scatter, 4);
            assert_eq!(w.map(|k| k[i]), s);
        }
    }
}
