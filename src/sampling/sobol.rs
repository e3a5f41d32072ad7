//! Owen-scrambled Sobol points, shuffled and padded in sets of four dimensions: Burley 2020, "Practical Hash-based Owen
//! Scrambling", listings 1 to 5. Direction numbers: Joe and Kuo 2008.

use super::{Decision, Sampler, State};
use crate::lanes::{Lanes, LanesU32};

/// Low-discrepancy points: each pixel, vertex and decision gets a scramble of its own. Past 2^16 samples of a pixel the
/// scramble is seeded anew, for the direction numbers hold no more structure than a 32-bit index gives.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sobol;

/// Samples of a pixel that share one scramble.
const BLOCK_BITS: u32 = 16;

/// Generator matrices of the first four dimensions, a column per index bit.
const MATRICES: [[u32; 32]; 4] = [
    directions(0, 0, [1, 0, 0]),
    directions(1, 0, [1, 0, 0]),
    directions(2, 1, [1, 3, 0]),
    directions(3, 1, [1, 3, 1]),
];

/// Columns from a primitive polynomial of degree `s` with inner coefficients `a`, and initial numbers `m`. Degree 0
/// stands for van der Corput's sequence.
const fn directions(s: usize, a: u32, m: [u32; 3]) -> [u32; 32] {
    let mut v = [0; 32];
    let mut i = 0;
    while i < 32 {
        v[i] = if s == 0 {
            1 << (31 - i)
        } else if i < s {
            m[i] << (31 - i)
        } else {
            let mut x = v[i - s] ^ (v[i - s] >> s);
            let mut k = 1;
            while k < s {
                if (a >> (s - 1 - k)) & 1 == 1 {
                    x ^= v[i - k];
                }
                k += 1;
            }
            x
        };
        i += 1;
    }
    v
}

#[inline(always)]
fn constant<U: LanesU32>(value: u32) -> U {
    U::splat(value)
}

/// A well-mixed hash of 32 bits (Wellons 2018, "lowbias32").
#[inline(always)]
fn hash<U: LanesU32>(x: U) -> U {
    let x = x.xor(x.shr(16)).mul(constant(0x7feb_352d));
    let x = x.xor(x.shr(15)).mul(constant(0x846c_a68b));
    x.xor(x.shr(16))
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

/// Owen scrambling by a hash in which each bit is changed by lower bits alone, applied to reversed bits.
#[inline(always)]
fn owen<U: LanesU32>(x: U, seed: U) -> U {
    let x = reverse_bits(x).add(seed);
    let x = x.xor(x.mul(constant(0x6c50_b47c)));
    let x = x.xor(x.mul(constant(0xb82f_1e52)));
    let x = x.xor(x.mul(constant(0xc7af_e638)));
    let x = x.xor(x.mul(constant(0x8d22_f6e6)));
    reverse_bits(x)
}

#[inline(always)]
fn sobol<U: LanesU32>(index: U, matrix: &[u32; 32]) -> U {
    let one = constant::<U>(1);
    let mut x = constant::<U>(0);
    for (bit, &column) in matrix.iter().enumerate() {
        let set = index.shr(bit as u32).and(one);
        let all = set.xor(constant(u32::MAX)).add(one);
        x = x.xor(all.and(constant(column)));
    }
    x
}

impl Sampler for Sobol {
    #[inline(always)]
    fn start<L: Lanes>(seed: u64, pixel: L::Uint, sample: L::Uint) -> State<L> {
        let seed = hash(constant::<L::Uint>(seed as u32)).add(hash(constant((seed >> 32) as u32 ^ 0x5bd1_e995)));
        let block = hash(sample.shr(BLOCK_BITS));
        let key = hash(hash(pixel.add(seed)).xor(seed).add(block));
        let index = sample.and(constant((1 << BLOCK_BITS) - 1));
        [key, index, constant(0), constant(0)]
    }

    #[inline(always)]
    fn draw<L: Lanes, const N: usize>(state: &mut State<L>, decision: Decision, depth: L::Uint) -> [L; N] {
        let (set, first) = decision.place();
        let set = depth.mul(constant(Decision::SETS)).add(constant(set));
        let seed = hash(state[0].xor(hash(set.add(constant(0x9e37_79b9)))));
        let index = owen(state[1], seed);
        let mut numbers = [L::splat(0.0); N];
        for (k, number) in numbers.iter_mut().enumerate() {
            let dimension = (first + k) % 4;
            let scramble = hash(seed.add(constant(0x632b_e59b_u32.wrapping_mul(dimension as u32 + 1))));
            *number = L::unit_from_u32(owen(sobol(index, &MATRICES[dimension]), scramble));
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Kernel, Wide, dispatch};

    fn points(pixel: u32, n: u32, decision: Decision) -> Vec<[f32; 3]> {
        (0..n)
            .map(|i| {
                let mut s = Sobol::start::<f32>(1, pixel, i);
                Sobol::draw::<f32, 3>(&mut s, decision, 2)
            })
            .collect()
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
