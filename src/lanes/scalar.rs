//! One lane: the oracle of eight.

use super::{Lanes, LanesU32, Mask};

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

impl LanesU32 for u32 {
    type Array = [u32; 1];
    #[inline(always)]
    fn splat(value: u32) -> Self {
        value
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> u32) -> Self {
        f(0)
    }
    #[inline(always)]
    fn load(src: &[u32]) -> Self {
        src[0]
    }
    #[inline(always)]
    fn array(self) -> [u32; 1] {
        [self]
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.wrapping_mul(other)
    }
    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        self ^ other
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self | other
    }
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        self << by
    }
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        self >> by
    }
    #[inline(always)]
    fn store(self, dst: &mut [u32]) {
        dst[0] = self;
    }
    #[inline(always)]
    fn pack(self, _bits: u32) -> Self {
        self
    }
}

impl Lanes for f32 {
    const N: usize = 1;
    type Mask = bool;
    type Uint = u32;
    type Array = [f32; 1];
    #[inline(always)]
    fn splat(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f32) -> Self {
        f(0)
    }
    #[inline(always)]
    fn load(src: &[f32]) -> Self {
        src[0]
    }
    #[inline(always)]
    fn columns8<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8] {
        *row(0)
    }
    #[inline(always)]
    fn columns4<'a>(row: impl Fn(usize) -> &'a [f32; 4]) -> [Self; 4] {
        *row(0)
    }
    #[inline(always)]
    fn array(self) -> [f32; 1] {
        [self]
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        super::dispatch::mul_add(self, a, b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn round(self) -> Self {
        f32::round_ties_even(self)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        f32::to_bits(self)
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        f32::from_bits(bits)
    }
    #[inline(always)]
    fn unit_from_u32(bits: u32) -> Self {
        (bits >> 8) as f32 * (1.0 / 16_777_216.0)
    }
    #[inline(always)]
    fn from_u24(value: u32) -> Self {
        value as f32
    }
    #[inline(always)]
    fn store(self, dst: &mut [f32]) {
        dst[0] = self;
    }
}
