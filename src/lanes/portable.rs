//! Eight lanes on any machine, through `wide`, which takes the instructions that the build may use: SSE2, AVX2, NEON.

use super::eight::PACK;
use super::{Lanes, LanesU32, Mask, Wide, WideU32};
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

impl WideU32 for U32x8 {
    #[inline(always)]
    fn permute(self, index: Self) -> Self {
        Self(self.0.shuffle_wrapping(index.0))
    }
    #[inline(always)]
    fn permute_const(self, index: [u32; 8]) -> Self {
        Self(self.0.shuffle(u32x8::new(index)))
    }
    #[inline(always)]
    fn shr_each(self, by: [u32; 8]) -> Self {
        Self(self.0 >> u32x8::new(by))
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

impl Wide for F32x8 {
    const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));
    #[inline(always)]
    fn select_u32(mask: Mask8, yes: U32x8, no: U32x8) -> U32x8 {
        let mask: u32x8 = cast(mask.0);
        U32x8(mask.bitselect(yes.0, no.0))
    }
    #[inline(always)]
    fn transpose(rows: [Self; 8]) -> [Self; 8] {
        f32x8::transpose(rows.map(|r| r.0)).map(Self)
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
    fn columns4<'a>(row: impl Fn(usize) -> &'a [f32; 4]) -> [Self; 4] {
        let rows: [&[f32; 4]; 8] = std::array::from_fn(row);
        std::array::from_fn(|k| Self::from_fn(|i| rows[i][k]))
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
        // With SSE2, `wide` gives 0 for numbers that round to -0.
        Self(self.0.round_ties_even()).copysign(self)
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
