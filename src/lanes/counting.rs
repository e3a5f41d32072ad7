//! A lane that counts: how much arithmetic a kernel does for a row is found by running it.

use super::Lanes;
use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// An `f32` whose operations are counted: sums, products, quotients, roots, minima, maxima and roundings are one each, a fused
/// product and sum two; signs, comparisons, selections and conversions none.
#[derive(Clone, Copy, Debug)]
pub struct Counting(f32);

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// What `run` returns, and the operations of [`Counting`] that it took on this thread.
pub fn counting<T>(run: impl FnOnce() -> T) -> (T, u64) {
    let before = OPERATIONS.get();
    let out = run();
    (out, OPERATIONS.get() - before)
}

/// Not in line: kernels are full of it.
#[inline(never)]
fn count(operations: u64) {
    OPERATIONS.set(OPERATIONS.get() + operations);
}

macro_rules! operators {
    ($($trait:ident $method:ident),*) => {
        $(impl $trait for Counting {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                count(1);
                Self($trait::$method(self.0, other.0))
            }
        })*
    };
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Counting {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Lanes for Counting {
    const N: usize = 1;
    type Mask = bool;
    type Uint = u32;
    type Array = [f32; 1];
    fn splat(value: f32) -> Self {
        Self(value)
    }
    fn from_fn(mut f: impl FnMut(usize) -> f32) -> Self {
        Self(f(0))
    }
    fn load(src: &[f32]) -> Self {
        Self(src[0])
    }
    fn columns8<'a>(row: impl Fn(usize) -> &'a [f32; 8]) -> [Self; 8] {
        row(0).map(Self)
    }
    fn columns4<'a>(row: impl Fn(usize) -> &'a [f32; 4]) -> [Self; 4] {
        row(0).map(Self)
    }
    fn array(self) -> [f32; 1] {
        [self.0]
    }
    fn store(self, dst: &mut [f32]) {
        dst[0] = self.0;
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        count(2);
        Self(Lanes::mul_add(self.0, a.0, b.0))
    }
    fn sqrt(self) -> Self {
        count(1);
        Self(Lanes::sqrt(self.0))
    }
    fn abs(self) -> Self {
        Self(Lanes::abs(self.0))
    }
    fn min(self, other: Self) -> Self {
        count(1);
        Self(Lanes::min(self.0, other.0))
    }
    fn max(self, other: Self) -> Self {
        count(1);
        Self(Lanes::max(self.0, other.0))
    }
    fn round(self) -> Self {
        count(1);
        Self(Lanes::round(self.0))
    }
    fn lt(self, other: Self) -> bool {
        self.0 < other.0
    }
    fn le(self, other: Self) -> bool {
        self.0 <= other.0
    }
    fn eq(self, other: Self) -> bool {
        self.0 == other.0
    }
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    fn to_bits(self) -> u32 {
        self.0.to_bits()
    }
    fn from_bits(bits: u32) -> Self {
        Self(f32::from_bits(bits))
    }
    fn unit_from_u32(bits: u32) -> Self {
        Self(Lanes::unit_from_u32(bits))
    }
    fn from_u24(value: u32) -> Self {
        Self(Lanes::from_u24(value))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Vec3;
    use super::*;

    #[test]
    fn numbers_are_those_of_a_lane_and_operations_are_counted() {
        let a = [0.3f32, -1.7, 2.9];
        let (unit, operations) = counting(|| Vec3::<Counting>::splat(a).normalize());
        assert_eq!(unit.lane(0), Vec3::<f32>::splat(a).normalize().lane(0));
        // Three squares, summed; a root, its reciprocal, three products.
        assert_eq!(operations, 3 + 2 + 2 + 3);
        let x = Counting::splat(0.75);
        assert_eq!(counting(|| -x.mul_add(x, x).max(x).abs()).1, 3);
        assert_eq!(counting(|| x.lt(-x)), (false, 0));
    }
}
