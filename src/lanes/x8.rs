//! Eight lanes, through `wide`.

use super::{Lanes, LanesU32, Mask};
use bytemuck::cast;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use wide::{f32x8, i32x8, u32x8};

/// Eight `f32`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct F32x8(f32x8);

/// Eight `u32`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct U32x8(u32x8);

/// Eight truth values: all bits of a lane are set or none.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Mask8(f32x8);

impl BitAnd for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}
impl BitOr for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}
impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}
impl Mask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(cast(u32x8::splat(if value { u32::MAX } else { 0 })))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.to_bitmask()
    }
}

/// For every set of lanes, where each of its lanes goes when they are packed to the front.
const PACK: [[u32; 8]; 256] = {
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

impl U32x8 {
    /// Lane i becomes lane `index[i] & 7`.
    #[inline(always)]
    pub fn permute(self, index: Self) -> Self {
        Self(self.0.shuffle_wrapping(index.0))
    }
    /// Lane i becomes lane `index[i]`, each below 8.
    #[inline(always)]
    pub fn permute_const(self, index: [u32; 8]) -> Self {
        Self(self.0.shuffle(u32x8::new(index)))
    }
    /// The smaller, lane by lane.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
    /// The larger, lane by lane.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
    /// The complement of all bits.
    #[inline(always)]
    pub fn complement(self) -> Self {
        Self(!self.0)
    }
    /// `yes` where the mask is set, else `no`.
    #[inline(always)]
    pub fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        let mask: u32x8 = cast(mask.0);
        Self(mask.bitselect(yes.0, no.0))
    }
}

impl LanesU32 for U32x8 {
    type Array = [u32; 8];
    #[inline(always)]
    fn splat(value: u32) -> Self {
        Self(u32x8::splat(value))
    }
    #[inline(always)]
    fn from_fn(f: impl FnMut(usize) -> u32) -> Self {
        Self(u32x8::new(std::array::from_fn(f)))
    }
    #[inline(always)]
    fn load(src: &[u32]) -> Self {
        let lanes: &[u32; 8] = src[..8].try_into().expect("eight lanes");
        Self(u32x8::new(*lanes))
    }
    #[inline(always)]
    fn array(self) -> [u32; 8] {
        self.0.to_array()
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        Self(self.0 ^ other.0)
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        Self(self.0 << by)
    }
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        Self(self.0 >> by)
    }
    #[inline(always)]
    fn store(self, dst: &mut [u32]) {
        dst[..8].copy_from_slice(&self.0.to_array());
    }
    #[inline(always)]
    fn pack(self, bits: u32) -> Self {
        self.permute_const(PACK[(bits & 255) as usize])
    }
}

macro_rules! arithmetic {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait for F32x8 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    )*};
}
arithmetic!(Add add, Sub sub, Mul mul, Div div);

impl F32x8 {
    /// Lane i of row k becomes lane k of row i.
    #[inline(always)]
    pub fn transpose(rows: [Self; 8]) -> [Self; 8] {
        f32x8::transpose(rows.map(|r| r.0)).map(Self)
    }
    /// The smallest lane; no lane is NaN.
    #[inline(always)]
    pub fn min_lane(self) -> f32 {
        let bits = self.to_bits();
        let swap = |v: Self, order: [u32; 8]| v.min(Self::from_bits(v.to_bits().permute_const(order)));
        let v = swap(Self::from_bits(bits), [4, 5, 6, 7, 0, 1, 2, 3]);
        let v = swap(v, [2, 3, 0, 1, 6, 7, 4, 5]);
        swap(v, [1, 0, 3, 2, 5, 4, 7, 6]).array()[0]
    }
}

impl Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Lanes for F32x8 {
    const N: usize = 8;
    type Mask = Mask8;
    type Uint = U32x8;
    type Array = [f32; 8];
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(f32x8::splat(value))
    }
    #[inline(always)]
    fn from_fn(f: impl FnMut(usize) -> f32) -> Self {
        Self(f32x8::new(std::array::from_fn(f)))
    }
    #[inline(always)]
    fn load(src: &[f32]) -> Self {
        let lanes: &[f32; 8] = src[..8].try_into().expect("eight lanes");
        Self(f32x8::new(*lanes))
    }
    #[inline(always)]
    fn columns8<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8] {
        f32x8::transpose(std::array::from_fn(|i| f32x8::new(*row(i)))).map(Self)
    }
    #[inline(always)]
    fn array(self) -> [f32; 8] {
        self.0.to_array()
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.mul_add(a.0, b.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.fast_min(other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.fast_max(other.0))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(self.0.round_ties_even())
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        Mask8(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        Mask8(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        Mask8(self.0.simd_eq(other.0))
    }
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(mask.0.select(yes.0, no.0))
    }
    #[inline(always)]
    fn to_bits(self) -> U32x8 {
        U32x8(cast(self.0))
    }
    #[inline(always)]
    fn from_bits(bits: U32x8) -> Self {
        Self(cast(bits.0))
    }
    #[inline(always)]
    fn unit_from_u32(bits: U32x8) -> Self {
        let high: i32x8 = cast(bits.0 >> 8u32);
        Self(f32x8::from_i32x8(high) * f32x8::splat(1.0 / 16_777_216.0))
    }
    #[inline(always)]
    fn from_u24(value: U32x8) -> Self {
        let signed: i32x8 = cast(value.0);
        Self(f32x8::from_i32x8(signed))
    }
    #[inline(always)]
    fn store(self, dst: &mut [f32]) {
        dst[..8].copy_from_slice(&self.0.to_array());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECIAL: [f32; 8] = [0.0, -0.0, 1.0, -1.5, 3.0e38, 1.0e-40, f32::NAN, f32::INFINITY];

    /// Every operation, on every pair of special values, gives the bits of the scalar twin.
    #[test]
    fn wide_matches_scalar() {
        let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        for shift in 0..8 {
            let x = SPECIAL;
            let y: [f32; 8] = std::array::from_fn(|i| SPECIAL[(i + shift) % 8]);
            let (a, b) = (F32x8::load(&x), F32x8::load(&y));
            type Twin = fn(f32, f32) -> f32;
            let results: [(&str, [f32; 8], Twin); 10] = [
                ("add", (a + b).array(), |x, y| x + y),
                ("sub", (a - b).array(), |x, y| x - y),
                ("mul", (a * b).array(), |x, y| x * y),
                ("div", (a / b).array(), |x, y| x / y),
                ("fma", a.mul_add(b, a).array(), |x, y| Lanes::mul_add(x, y, x)),
                ("min", a.min(b).array(), |x, y| Lanes::min(x, y)),
                ("max", a.max(b).array(), |x, y| Lanes::max(x, y)),
                ("sqrt", a.sqrt().array(), |x, _| x.sqrt()),
                ("copysign", a.copysign(b).array(), |x, y| Lanes::copysign(x, y)),
                ("select", F32x8::select(a.lt(b), a, b).array(), |x, y| if x < y { x } else { y }),
            ];
            for (name, wide, scalar) in results {
                for i in 0..8 {
                    assert!(same(wide[i], scalar(x[i], y[i])), "{name}({}, {}) = {}", x[i], y[i], wide[i]);
                }
            }
            for i in 0..8 {
                let bit = |m: Mask8| m.bits() >> i & 1 == 1;
                assert_eq!(
                    (bit(a.lt(b)), bit(a.le(b)), bit(a.eq(b)), bit(a.gt(b))),
                    (x[i] < y[i], x[i] <= y[i], x[i] == y[i], x[i] > y[i]),
                );
            }
        }
        let rows: [[f32; 8]; 8] = std::array::from_fn(|i| std::array::from_fn(|k| (10 * i + k) as f32));
        let columns = F32x8::columns8(|i| &rows[i]);
        for (k, column) in columns.iter().enumerate() {
            assert_eq!(column.array(), std::array::from_fn(|i| rows[i][k]));
        }
        assert_eq!(F32x8::load(&[3.0, 8.0, 2.5, 9.0, 7.0, 2.0, 4.0, 6.0]).min_lane(), 2.0);
        for x in [0.5f32, 1.5, 2.5, -0.5, -1.5, 0.49999997, 8388609.0] {
            assert!(same(F32x8::splat(x).round().array()[0], Lanes::round(x)), "round({x})");
        }
    }

    #[test]
    fn integers_match_scalar() {
        let x: [u32; 8] = [0, 1, 7, 0x8000_0000, u32::MAX, 0xdead_beef, 12345, 0x00ff_ff00];
        let (a, b) = (U32x8::load(&x), U32x8::splat(0x9e37_79b9));
        for i in 0..8 {
            assert_eq!(a.add(b).array()[i], LanesU32::add(x[i], 0x9e37_79b9));
            assert_eq!(a.mul(b).array()[i], LanesU32::mul(x[i], 0x9e37_79b9));
            assert_eq!(a.rotl(7).array()[i], x[i].rotate_left(7));
            assert_eq!(F32x8::unit_from_u32(a).array()[i], <f32 as Lanes>::unit_from_u32(x[i]));
            assert_eq!(a.complement().array()[i], !x[i]);
            let packed = a.pack(0b1010_0110).array();
            assert_eq!(packed[..4], [x[1], x[2], x[5], x[7]]);
            assert_eq!(a.permute(U32x8::from_fn(|j| 7 - j as u32)).array()[i], x[7 - i]);
        }
        assert!(<f32 as Lanes>::unit_from_u32(u32::MAX) < 1.0);
    }
}
