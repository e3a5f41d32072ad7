//! Eight lanes in the registers of x86-64 machines with AVX2 and FMA.
//!
//! # Unsafe code
//!
//! The intrinsics are safe to run where the processor has AVX2 and FMA. The types here are private to `lanes`, and
//! [`dispatch`](super::dispatch()) is the only place that runs code with them, after it has asked the processor. All
//! methods are `#[inline(always)]`, so that they end up in its function for such processors: there each is one or two
//! instructions. Whatever only moves lanes is a cast of bytes, and safe.

#[cfg(not(target_feature = "avx512vl"))]
use super::eight::PACK;
use super::{Lanes, LanesU32, Mask, Wide, WideU32};
use bytemuck::cast;
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Eight `f32`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Avx2(__m256);

/// Eight `u32`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Avx2U32(__m256i);

/// Eight truth values: all bits of a lane are set or none.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Avx2Mask(__m256);

/// Makes methods that are one intrinsic: `method(arguments) = intrinsic` for arguments of the type itself.
macro_rules! one_instruction {
    ($($method:ident($($other:ident),*) = $intrinsic:ident;)*) => {$(
        #[inline(always)]
        fn $method(self, $($other: Self),*) -> Self {
            // SAFETY: see the module's documentation.
            Self(unsafe { $intrinsic(self.0, $($other.0),*) })
        }
    )*};
}

/// Makes operators that are one intrinsic.
macro_rules! operators {
    ($($type:ident: $trait:ident $method:ident = $intrinsic:ident;)*) => {$(
        impl $trait for $type {
            type Output = Self;
            one_instruction! { $method(other) = $intrinsic; }
        }
    )*};
}

operators! {
    Avx2: Add add = _mm256_add_ps;
    Avx2: Sub sub = _mm256_sub_ps;
    Avx2: Mul mul = _mm256_mul_ps;
    Avx2: Div div = _mm256_div_ps;
    Avx2Mask: BitAnd bitand = _mm256_and_ps;
    Avx2Mask: BitOr bitor = _mm256_or_ps;
}

impl Not for Avx2Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: see the module's documentation.
        Self(unsafe { _mm256_xor_ps(self.0, Self::splat(true).0) })
    }
}

impl Mask for Avx2Mask {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(cast([if value { u32::MAX } else { 0 }; 8]))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see the module's documentation.
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }
}

impl WideU32 for Avx2U32 {
    one_instruction! {
        permute(index) = _mm256_permutevar8x32_epi32;
    }
    #[inline(always)]
    fn permute_const(self, index: [u32; 8]) -> Self {
        self.permute(Self(cast(index)))
    }
    #[inline(always)]
    fn shr_each(self, by: [u32; 8]) -> Self {
        // SAFETY: see the module's documentation.
        Self(unsafe { _mm256_srlv_epi32(self.0, cast(by)) })
    }
}

impl LanesU32 for Avx2U32 {
    type Array = [u32; 8];
    one_instruction! {
        add(other) = _mm256_add_epi32;
        mul(other) = _mm256_mullo_epi32;
        xor(other) = _mm256_xor_si256;
        and(other) = _mm256_and_si256;
        or(other) = _mm256_or_si256;
    }
    #[inline(always)]
    fn splat(value: u32) -> Self {
        Self(cast([value; 8]))
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> u32) -> Self {
        let mut lanes = [0; 8];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = f(i);
        }
        Self(cast(lanes))
    }
    #[inline(always)]
    fn load(src: &[u32]) -> Self {
        Self(cast(*src.first_chunk::<8>().expect("eight lanes")))
    }
    #[inline(always)]
    fn array(self) -> [u32; 8] {
        cast(self.0)
    }
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        // SAFETY: see the module's documentation.
        Self(unsafe { _mm256_sll_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        // SAFETY: see the module's documentation.
        Self(unsafe { _mm256_srl_epi32(self.0, _mm_cvtsi32_si128(by as i32)) })
    }
    #[inline(always)]
    fn store(self, dst: &mut [u32]) {
        *dst.first_chunk_mut::<8>().expect("eight lanes") = self.array();
    }
    #[inline(always)]
    #[cfg(target_feature = "avx512vl")]
    fn pack(self, bits: u32) -> Self {
        // SAFETY: the build asks for it.
        Self(unsafe { _mm256_maskz_compress_epi32(bits as u8, self.0) })
    }
    #[inline(always)]
    #[cfg(not(target_feature = "avx512vl"))]
    fn pack(self, bits: u32) -> Self {
        self.permute_const(PACK[(bits & 255) as usize])
    }
}

impl Wide for Avx2 {
    const FUSED: bool = true;
    #[inline(always)]
    fn select_u32(mask: Avx2Mask, yes: Avx2U32, no: Avx2U32) -> Avx2U32 {
        Self::select(mask, Self::from_bits(yes), Self::from_bits(no)).to_bits()
    }
    #[inline(always)]
    fn transpose(rows: [Self; 8]) -> [Self; 8] {
        let [r0, r1, r2, r3, r4, r5, r6, r7] = rows;
        // SAFETY: see the module's documentation.
        unsafe {
            // Pairs of rows, then quarters, then halves.
            let (a0, a1) = (_mm256_unpacklo_ps(r0.0, r1.0), _mm256_unpackhi_ps(r0.0, r1.0));
            let (a2, a3) = (_mm256_unpacklo_ps(r2.0, r3.0), _mm256_unpackhi_ps(r2.0, r3.0));
            let (a4, a5) = (_mm256_unpacklo_ps(r4.0, r5.0), _mm256_unpackhi_ps(r4.0, r5.0));
            let (a6, a7) = (_mm256_unpacklo_ps(r6.0, r7.0), _mm256_unpackhi_ps(r6.0, r7.0));
            let (b0, b1) = (_mm256_shuffle_ps::<0x44>(a0, a2), _mm256_shuffle_ps::<0xee>(a0, a2));
            let (b2, b3) = (_mm256_shuffle_ps::<0x44>(a1, a3), _mm256_shuffle_ps::<0xee>(a1, a3));
            let (b4, b5) = (_mm256_shuffle_ps::<0x44>(a4, a6), _mm256_shuffle_ps::<0xee>(a4, a6));
            let (b6, b7) = (_mm256_shuffle_ps::<0x44>(a5, a7), _mm256_shuffle_ps::<0xee>(a5, a7));
            let (c0, c4) = (_mm256_permute2f128_ps::<0x20>(b0, b4), _mm256_permute2f128_ps::<0x31>(b0, b4));
            let (c1, c5) = (_mm256_permute2f128_ps::<0x20>(b1, b5), _mm256_permute2f128_ps::<0x31>(b1, b5));
            let (c2, c6) = (_mm256_permute2f128_ps::<0x20>(b2, b6), _mm256_permute2f128_ps::<0x31>(b2, b6));
            let (c3, c7) = (_mm256_permute2f128_ps::<0x20>(b3, b7), _mm256_permute2f128_ps::<0x31>(b3, b7));
            [Self(c0), Self(c1), Self(c2), Self(c3), Self(c4), Self(c5), Self(c6), Self(c7)]
        }
    }
}

impl Neg for Avx2 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the module's documentation.
        Self(unsafe { _mm256_xor_ps(self.0, Self::splat(-0.0).0) })
    }
}

impl Lanes for Avx2 {
    const N: usize = 8;
    type Mask = Avx2Mask;
    type Uint = Avx2U32;
    type Array = [f32; 8];
    one_instruction! {
        mul_add(a, b) = _mm256_fmadd_ps;
        sqrt() = _mm256_sqrt_ps;
        min(other) = _mm256_min_ps;
        max(other) = _mm256_max_ps;
    }
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(cast([value; 8]))
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f32) -> Self {
        let mut lanes = [0.0; 8];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = f(i);
        }
        Self(cast(lanes))
    }
    #[inline(always)]
    fn load(src: &[f32]) -> Self {
        Self(cast(*src.first_chunk::<8>().expect("eight lanes")))
    }
    #[inline(always)]
    fn columns8<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8] {
        let load = |i: usize| Self(cast(*row(i)));
        Self::transpose([load(0), load(1), load(2), load(3), load(4), load(5), load(6), load(7)])
    }
    #[inline(always)]
    fn columns4<'a>(row: impl Fn(usize) -> &'a [f32; 4]) -> [Self; 4] {
        // Rows i and i + 4 side by side.
        let (r0, r1): (__m256, __m256) = (cast([*row(0), *row(4)]), cast([*row(1), *row(5)]));
        let (r2, r3): (__m256, __m256) = (cast([*row(2), *row(6)]), cast([*row(3), *row(7)]));
        // SAFETY: see the module's documentation.
        unsafe {
            let (a0, a1) = (_mm256_unpacklo_ps(r0, r1), _mm256_unpackhi_ps(r0, r1));
            let (a2, a3) = (_mm256_unpacklo_ps(r2, r3), _mm256_unpackhi_ps(r2, r3));
            let (b0, b1) = (_mm256_shuffle_ps::<0x44>(a0, a2), _mm256_shuffle_ps::<0xee>(a0, a2));
            let (b2, b3) = (_mm256_shuffle_ps::<0x44>(a1, a3), _mm256_shuffle_ps::<0xee>(a1, a3));
            [Self(b0), Self(b1), Self(b2), Self(b3)]
        }
    }
    #[inline(always)]
    fn array(self) -> [f32; 8] {
        cast(self.0)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the module's documentation.
        Self(unsafe { _mm256_andnot_ps(Self::splat(-0.0).0, self.0) })
    }
    #[inline(always)]
    fn round(self) -> Self {
        // SAFETY: see the module's documentation.
        Self(unsafe { _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0) })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Avx2Mask {
        // SAFETY: see the module's documentation.
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn le(self, other: Self) -> Avx2Mask {
        // SAFETY: see the module's documentation.
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Avx2Mask {
        // SAFETY: see the module's documentation.
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn select(mask: Avx2Mask, yes: Self, no: Self) -> Self {
        // SAFETY: see the module's documentation.
        Self(unsafe { _mm256_blendv_ps(no.0, yes.0, mask.0) })
    }
    #[inline(always)]
    fn to_bits(self) -> Avx2U32 {
        Avx2U32(cast(self.0))
    }
    #[inline(always)]
    fn from_bits(bits: Avx2U32) -> Self {
        Self(cast(bits.0))
    }
    #[inline(always)]
    fn unit_from_u32(bits: Avx2U32) -> Self {
        Self::from_u24(bits.shr(8)) * Self::splat(1.0 / 16_777_216.0)
    }
    #[inline(always)]
    fn from_u24(value: Avx2U32) -> Self {
        // SAFETY: see the module's documentation.
        Self(unsafe { _mm256_cvtepi32_ps(value.0) })
    }
    #[inline(always)]
    fn store(self, dst: &mut [f32]) {
        *dst.first_chunk_mut::<8>().expect("eight lanes") = self.array();
    }
}
