//! Functions that `wide` and the scalar library round differently: written once, so that one lane and eight agree.

use super::{Lanes, LanesU32};

/// Square root of `x`, 0 where `x` is negative or NaN.
#[inline(always)]
pub fn safe_sqrt<L: Lanes>(x: L) -> L {
    x.max(L::splat(0.0)).sqrt()
}

/// (sin(2 pi u), cos(2 pi u)) for u in [0, 1]; absolute error below 2e-7.
///
/// The turn is reduced exactly to [-1/8, 1/8] about a multiple of a quarter, then Taylor polynomials of degree 9 and 8
/// in the angle (the next terms are below 2^-24 there).
#[inline(always)]
pub fn sin_cos_turns<L: Lanes>(u: L) -> (L, L) {
    let quarter = (u * L::splat(4.0)).round();
    let x = (u - quarter * L::splat(0.25)) * L::splat(std::f32::consts::TAU);
    let x2 = x * x;
    let c = |v: f64| L::splat(v as f32);
    let s = x2.mul_add(c(1.0 / 362_880.0), c(-1.0 / 5_040.0));
    let s = x2.mul_add(s, c(1.0 / 120.0));
    let s = x2.mul_add(s, c(-1.0 / 6.0));
    let sin = (x2 * x).mul_add(s, x);
    let t = x2.mul_add(c(1.0 / 40_320.0), c(-1.0 / 720.0));
    let t = x2.mul_add(t, c(1.0 / 24.0));
    let t = x2.mul_add(t, c(-0.5));
    let cos = x2.mul_add(t, L::splat(1.0));
    // Adding 2^23 leaves the integer in the low bits of the float.
    let q = (quarter + L::splat(8_388_608.0)).to_bits();
    let odd = L::from_u24(q.and(L::Uint::splat(1))).gt(L::splat(0.5));
    let (s, c) = (L::select(odd, cos, sin), L::select(odd, sin, cos));
    let flip = |v: L, bits: L::Uint| L::from_bits(v.to_bits().xor(bits.and(L::Uint::splat(2)).shl(30)));
    (flip(s, q), flip(c, q.add(L::Uint::splat(1))))
}

/// The angle of the point (x, y), y >= 0, in turns: in [0, 1/2]; absolute error below 6e-8, 0 at the origin.
///
/// The arc tangent of the smaller over the larger coordinate, a polynomial of degree 7 in its square, fitted at Chebyshev
/// nodes (largest error 7.5e-8 rad, 1.2e-8 turns); rounding adds as much as an angle near 1/2 can hold.
#[inline(always)]
pub fn atan2_turns<L: Lanes>(y: L, x: L) -> L {
    let (zero, size) = (L::splat(0.0), x.abs());
    let (small, large) = (y.min(size), y.max(size));
    let t = small / large.max(L::splat(f32::MIN_POSITIVE));
    let t2 = t * t;
    let mut sum = L::splat(-0.004_668_773);
    for c in [0.024_166_19, -0.059_367_1, 0.099_060_97, -0.140_165_85, 0.199_692_35, -0.333_319_6, 0.999_999_9] {
        sum = t2.mul_add(sum, L::splat(c));
    }
    let eighth = t * sum * L::splat(1.0 / std::f32::consts::TAU);
    let quarter = L::select(size.lt(y), L::splat(0.25) - eighth, eighth);
    L::select(x.lt(zero), L::splat(0.5) - quarter, quarter)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Kernel, Wide, dispatch};

    /// The first lane of eight equal ones.
    struct SinCos(f32);
    impl Kernel for SinCos {
        type Out = (f32, f32);
        #[inline(always)]
        fn run<W: Wide>(self) -> (f32, f32) {
            let (sin, cos) = sin_cos_turns(W::splat(self.0));
            (sin.array()[0], cos.array()[0])
        }
    }

    /// The first lane of eight equal ones.
    struct Atan2(f32, f32);
    impl Kernel for Atan2 {
        type Out = f32;
        #[inline(always)]
        fn run<W: Wide>(self) -> f32 {
            atan2_turns(W::splat(self.0), W::splat(self.1)).array()[0]
        }
    }

    /// An interpreter takes a thousand times as long.
    const STEP: usize = if cfg!(miri) { 1000 } else { 1 };

    #[test]
    fn atan2_is_accurate_and_wide_matches_scalar() {
        let mut worst = 0.0f64;
        for i in (0..=100_000u32).step_by(STEP) {
            let angle = f64::from(i) / 100_000.0 * std::f64::consts::PI;
            let (y, x) = ((0.37 * angle.sin()).abs() as f32, (0.37 * angle.cos()) as f32);
            let found = atan2_turns(y, x);
            let exact = f64::from(y).atan2(f64::from(x)) / std::f64::consts::TAU;
            worst = worst.max((f64::from(found) - exact).abs());
            if i % 1000 == 0 {
                assert_eq!(dispatch(Atan2(y, x)).to_bits(), found.to_bits(), "{y}, {x}");
            }
        }
        assert!(worst < 6e-8, "worst error {worst:e}");
        assert_eq!((atan2_turns(0.0, 0.0), atan2_turns(0.0, -1.0), atan2_turns(2.0, 0.0)), (0.0, 0.5, 0.25));
    }

    #[test]
    fn sin_cos_is_accurate_and_wide_matches_scalar() {
        let mut worst = 0.0f64;
        for i in (0..=1_000_000u32).step_by(STEP) {
            let u = i as f32 / 1_000_000.0;
            let (s, c) = sin_cos_turns(u);
            let angle = f64::from(u) * std::f64::consts::TAU;
            worst = worst.max((f64::from(s) - angle.sin()).abs()).max((f64::from(c) - angle.cos()).abs());
            if i % 1000 == 0 {
                let (ws, wc) = dispatch(SinCos(u));
                assert_eq!((ws.to_bits(), wc.to_bits()), (s.to_bits(), c.to_bits()), "u = {u}");
            }
        }
        assert!(worst < 2e-7, "worst error {worst:e}");
    }
}
