//! Numbers in lanes: a kernel is written once over [`Lanes`], and runs on one `f32` or on eight at a time.
//!
//! The scalar instance is the oracle of the wide one: both do the same IEEE operations in the same order, so that
//! their results agree bit for bit. This folder is the only place that names `wide`.

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "intrinsics, wrapped here for everyone")]
mod avx2;
mod counting;
#[allow(unsafe_code, reason = "the one call into code for machines that have more than the build asks for")]
mod dispatch;
mod eight;
mod math;
mod portable;
#[allow(unsafe_code, reason = "a hint that reads nothing")]
mod prefetch;
mod scalar;
mod vec3;

pub use counting::{Counting, counting};
pub use dispatch::{Kernel, dispatch, simd};
pub use eight::{Wide, WideU32};
pub use math::{atan2_turns, safe_sqrt, sin_cos_turns};
pub use portable::{F32x8, U32x8};
pub use prefetch::{prefetch_ends, prefetch_lines};
pub use vec3::{Frame, Vec3, largest_coordinate, select3};

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Lanes that one kernel step handles at most.
pub const MAX_LANES: usize = 8;

/// One truth value per lane.
pub trait Mask: Copy + std::fmt::Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// All lanes set to `value`.
    fn splat(value: bool) -> Self;
    /// Bit i is lane i.
    fn bits(self) -> u32;
    /// Whether any lane is set.
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// One `u32` per lane; arithmetic wraps.
pub trait LanesU32: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// How the lanes are stored one by one.
    type Array: AsRef<[u32]> + AsMut<[u32]> + Copy;
    /// All lanes set to `value`.
    fn splat(value: u32) -> Self;
    /// Lane i is `f(i)`.
    fn from_fn(f: impl FnMut(usize) -> u32) -> Self;
    /// Lanes `src[0..N]`.
    fn load(src: &[u32]) -> Self;
    /// The lanes one by one.
    fn array(self) -> Self::Array;
    /// Writes the lanes to `dst[0..N]`.
    fn store(self, dst: &mut [u32]);
    /// Moves the lanes whose bit is set to the front, in order; the rest is unspecified.
    fn pack(self, bits: u32) -> Self;
    /// Wrapping sum.
    fn add(self, other: Self) -> Self;
    /// Wrapping product.
    fn mul(self, other: Self) -> Self;
    /// Bitwise exclusive or.
    fn xor(self, other: Self) -> Self;
    /// Bitwise and.
    fn and(self, other: Self) -> Self;
    /// Bitwise or.
    fn or(self, other: Self) -> Self;
    /// Shift left by a constant < 32.
    fn shl(self, by: u32) -> Self;
    /// Shift right by a constant < 32.
    fn shr(self, by: u32) -> Self;
    /// Rotation left by a constant in 1..32.
    #[inline(always)]
    fn rotl(self, by: u32) -> Self {
        self.shl(by).or(self.shr(32 - by))
    }
}

/// One `f32` per lane.
pub trait Lanes:
    Copy
    + std::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// Number of lanes.
    const N: usize;
    /// Truth values of as many lanes.
    type Mask: Mask;
    /// Unsigned integers of as many lanes.
    type Uint: LanesU32;
    /// How the lanes are stored one by one.
    type Array: AsRef<[f32]> + AsMut<[f32]> + Copy;
    /// All lanes set to `value`.
    fn splat(value: f32) -> Self;
    /// Lane i is `f(i)`.
    fn from_fn(f: impl FnMut(usize) -> f32) -> Self;
    /// Lanes `src[0..N]`.
    fn load(src: &[f32]) -> Self;
    /// Eight columns from a row of eight numbers per lane: lane i of column k is `row(i)[k]`.
    fn columns8<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8];
    /// Four columns from a row of four numbers per lane.
    fn columns4<'a>(row: impl Fn(usize) -> &'a [f32; 4]) -> [Self; 4];
    /// The lanes one by one.
    fn array(self) -> Self::Array;
    /// Writes the lanes to `dst[0..N]`.
    fn store(self, dst: &mut [f32]);
    /// Moves the lanes whose bit is set to the front, in order; the rest is unspecified.
    #[inline(always)]
    fn pack(self, bits: u32) -> Self {
        Self::from_bits(self.to_bits().pack(bits))
    }
    /// `self * a + b`, fused where kernels have the instruction.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// Correctly rounded square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller; `other` if either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger; `other` if either is NaN.
    fn max(self, other: Self) -> Self;
    /// Rounds to the nearest integer, halves to even.
    fn round(self) -> Self;
    /// Whether `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Whether `self == other`; false for NaN.
    fn eq(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is set, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The bits of each float.
    fn to_bits(self) -> Self::Uint;
    /// Floats of these bits.
    fn from_bits(bits: Self::Uint) -> Self;
    /// The upper 24 bits of each integer as a number in [0, 1): a multiple of 2^-24.
    fn unit_from_u32(bits: Self::Uint) -> Self;
    /// Each integer below 2^24 as a float.
    fn from_u24(value: Self::Uint) -> Self;

    /// Whether `self > other`; false for NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// Magnitude of `self`, sign of `sign`.
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let top = Self::Uint::splat(0x8000_0000);
        let rest = Self::Uint::splat(0x7fff_ffff);
        Self::from_bits(self.to_bits().and(rest).or(sign.to_bits().and(top)))
    }
}
