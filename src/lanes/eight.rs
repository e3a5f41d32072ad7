//! What eight lanes can do and one cannot: exchange and compare lanes among each other.

use super::{Lanes, LanesU32};

/// For every set of lanes, where each of its lanes goes when they are packed to the front.
pub(super) const PACK: [[u32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut lane, mut to) = (0, 0);
        while lane < 8 {
            if bits >> lane & 1 == 1 {
                table[bits][to] = lane as u32;
                to += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
};

/// Eight `u32`.
pub trait WideU32: LanesU32<Array = [u32; 8]> {
    /// Lane i becomes lane `index[i] & 7`.
    fn permute(self, index: Self) -> Self;
    /// Lane i becomes lane `index[i]`, each below 8.
    fn permute_const(self, index: [u32; 8]) -> Self;
    /// Lane i shifted right by `by[i]` < 32.
    fn shr_each(self, by: [u32; 8]) -> Self;
}

/// Eight `f32`.
pub trait Wide: Lanes<Array = [f32; 8], Uint: WideU32> {
    /// Whether [`Lanes::mul_add`] rounds once.
    const FUSED: bool;
    /// `yes` where the mask is set, else `no`.
    fn select_u32(mask: Self::Mask, yes: Self::Uint, no: Self::Uint) -> Self::Uint;
    /// Lane i of row k becomes lane k of row i.
    fn transpose(rows: [Self; 8]) -> [Self; 8];
    /// Lane i becomes lane `index[i] & 7`.
    #[inline(always)]
    fn permute(self, index: Self::Uint) -> Self {
        Self::from_bits(self.to_bits().permute(index))
    }
    /// The smallest lane; no lane is NaN.
    #[inline(always)]
    fn min_lane(self) -> f32 {
        #[inline(always)]
        fn least<W: Wide>(v: W, order: [u32; 8]) -> W {
            v.min(W::from_bits(v.to_bits().permute_const(order)))
        }
        let v = least(self, [4, 5, 6, 7, 0, 1, 2, 3]);
        let v = least(v, [2, 3, 0, 1, 6, 7, 4, 5]);
        least(v, [1, 0, 3, 2, 5, 4, 7, 6]).array()[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{F32x8, Kernel, Mask, dispatch};

    const SPECIAL: [f32; 8] = [0.0, -0.0, 1.0, -1.5, 3.0e38, 1.0e-40, f32::NAN, f32::INFINITY];

    type Twin = fn(f32, f32) -> f32;
    type IntegerTwin = fn(u32) -> u32;

    fn same(a: f32, b: f32) -> bool {
        a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
    }

    /// Every operation, on every pair of special values, gives the bits of the scalar twin.
    struct Floats;
    impl Kernel for Floats {
        type Out = ();
        #[inline(always)]
        fn run<W: Wide>(self) {
            let mul_add: Twin = if W::FUSED { |x, y| x.mul_add(y, x) } else { |x, y| x * y + x };
            for shift in 0..8 {
                let x = SPECIAL;
                let y: [f32; 8] = std::array::from_fn(|i| SPECIAL[(i + shift) % 8]);
                let (a, b) = (W::load(&x), W::load(&y));
                let results: [(&str, W, Twin); 13] = [
                    ("add", a + b, |x, y| x + y),
                    ("sub", a - b, |x, y| x - y),
                    ("mul", a * b, |x, y| x * y),
                    ("div", a / b, |x, y| x / y),
                    ("neg", -a, |x, _| -x),
                    ("abs", a.abs(), |x, _| x.abs()),
                    ("fma", a.mul_add(b, a), mul_add),
                    ("min", a.min(b), Lanes::min),
                    ("max", a.max(b), Lanes::max),
                    ("sqrt", a.sqrt(), |x, _| x.sqrt()),
                    ("copysign", a.copysign(b), Lanes::copysign),
                    ("select", W::select(a.lt(b), a, b), |x, y| if x < y { x } else { y }),
                    ("select", W::from_bits(W::select_u32(!a.eq(b), a.to_bits(), b.to_bits())), |x, y| {
                        if x != y { x } else { y }
                    }),
                ];
                for (name, wide, scalar) in results {
                    let wide = wide.array();
                    for i in 0..8 {
                        assert!(same(wide[i], scalar(x[i], y[i])), "{name}({}, {}) = {}", x[i], y[i], wide[i]);
                    }
                }
                let masks = [a.lt(b), a.le(b), a.eq(b), a.gt(b), a.lt(b) | a.eq(b), a.le(b) & !a.eq(b)].map(Mask::bits);
                for i in 0..8 {
                    let (x, y) = (x[i], y[i]);
                    let expected = [x < y, x <= y, x == y, x > y, x <= y, x < y];
                    assert_eq!(masks.map(|m| m >> i & 1 == 1), expected, "{x}, {y}");
                }
            }
            for x in [0.5f32, 1.5, 2.5, -0.5, -1.5, 0.49999997, 8388609.0] {
                assert!(same(W::splat(x).round().array()[0], Lanes::round(x)), "round({x})");
            }
            assert_eq!([true, false].map(|b| W::Mask::splat(b).bits()), [255, 0]);
        }
    }

    /// What moves lanes moves each to its place.
    struct Moves;
    impl Kernel for Moves {
        type Out = ();
        #[inline(always)]
        fn run<W: Wide>(self) {
            let rows: [[f32; 8]; 8] = std::array::from_fn(|i| std::array::from_fn(|k| (10 * i + k) as f32));
            let (columns, transposed) = (W::columns8(|i| &rows[i]), W::transpose(rows.map(|r| W::load(&r))));
            let four = W::columns4(|i| rows[i].last_chunk().expect("eight numbers hold four"));
            for k in 0..4 {
                assert_eq!(four[k].array(), std::array::from_fn(|i| rows[i][k + 4]));
            }
            for k in 0..8 {
                let expected = std::array::from_fn(|i| rows[i][k]);
                assert_eq!((columns[k].array(), transposed[k].array()), (expected, expected));
            }
            assert_eq!(W::load(&[3.0, 8.0, 2.5, 9.0, 7.0, 2.0, 4.0, 6.0]).min_lane(), 2.0);
            for bits in 0..256u32 {
                let packed = W::load(&rows[1]).pack(bits).array();
                let expected = (0..8).filter(|i| bits >> i & 1 == 1).map(|i| rows[1][i]);
                assert!(expected.zip(packed).all(|(a, b)| a == b), "{bits:08b}: {packed:?}");
            }
            let (mut floats, mut integers) = ([0.0; 9], [0; 9]);
            W::load(&rows[2]).store(&mut floats);
            W::Uint::from_fn(|i| 7 * i as u32).store(&mut integers);
            assert_eq!((&floats[..8], floats[8]), (&rows[2][..], 0.0));
            assert_eq!(integers, [0, 7, 14, 21, 28, 35, 42, 49, 0]);
        }
    }

    struct Integers;
    impl Kernel for Integers {
        type Out = ();
        #[inline(always)]
        fn run<W: Wide>(self) {
            let x: [u32; 8] = [0, 1, 7, 0x8000_0000, u32::MAX, 0xdead_beef, 12345, 0x00ff_ff00];
            const Y: u32 = 0x9e37_79b9;
            let (a, b) = (W::Uint::load(&x), W::Uint::splat(Y));
            let results: [(&str, W::Uint, IntegerTwin); 8] = [
                ("add", a.add(b), |x| x.wrapping_add(Y)),
                ("mul", a.mul(b), |x| x.wrapping_mul(Y)),
                ("xor", a.xor(b), |x| x ^ Y),
                ("and", a.and(b), |x| x & Y),
                ("or", a.or(b), |x| x | Y),
                ("shl", a.shl(5), |x| x << 5),
                ("shr", a.shr(31), |x| x >> 31),
                ("rotl", a.rotl(7), |x| x.rotate_left(7)),
            ];
            for (name, wide, scalar) in results {
                assert_eq!(wide.array(), x.map(scalar), "{name}");
            }
            assert_eq!(W::unit_from_u32(a).array(), x.map(<f32 as Lanes>::unit_from_u32));
            assert_eq!(W::from_u24(a.shr(8)).array(), x.map(|x| (x >> 8) as f32));
            let order = [7, 0, 2, 2, 1, 6, 5, 3];
            let expected = order.map(|i| x[i as usize]);
            assert_eq!(a.permute(W::Uint::load(&order)).array(), expected);
            assert_eq!(
                a.permute(W::Uint::load(&order.map(|i| i | !7))).array(),
                expected,
                "the index is taken modulo 8"
            );
            assert_eq!(a.permute_const(order).array(), expected);
            let by = [0, 4, 8, 31, 1, 28, 3, 2];
            assert_eq!(a.shr_each(by).array(), std::array::from_fn(|i| x[i] >> by[i]));
        }
    }

    #[test]
    fn every_form_matches_scalar() {
        Floats.run::<F32x8>();
        Moves.run::<F32x8>();
        Integers.run::<F32x8>();
        dispatch(Floats);
        dispatch(Moves);
        dispatch(Integers);
        assert!(<f32 as Lanes>::unit_from_u32(u32::MAX) < 1.0);
    }

    /// One lane fuses where the eight that kernels run with do.
    struct MulAdd(f32, f32, f32);
    impl Kernel for MulAdd {
        type Out = f32;
        #[inline(always)]
        fn run<W: Wide>(self) -> f32 {
            W::splat(self.0).mul_add(W::splat(self.1), W::splat(self.2)).array()[5]
        }
    }

    #[test]
    fn one_lane_rounds_like_the_form_in_use() {
        let (a, b) = (1.0 + f32::EPSILON, 1.0 - f32::EPSILON);
        assert_eq!(dispatch(MulAdd(a, b, -1.0)), Lanes::mul_add(a, b, -1.0));
    }
}
