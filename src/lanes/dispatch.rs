//! Which form of eight lanes kernels run in. A kernel is written once over [`Wide`]; here it is compiled for each form,
//! and the machine decides when the program runs: [`Avx2`](super::avx2) where it has the instructions, else
//! [`Portable`](super::portable). A build for a machine that has them holds nothing else.
//!
//! # Unsafe code
//!
//! A function with `target_feature` may be called where the processor has the features. [`WithAvx2::with_avx2`] and [`fused`] are
//! called after [`uses_avx2`] said so; a processor does not lose features. Nothing else can name the AVX2 form, which is
//! private to `lanes`: so none of its methods runs without that answer.

#[cfg(target_arch = "x86_64")]
use super::avx2::Avx2;
use super::{F32x8, Wide};
#[cfg(target_arch = "x86_64")]
use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

/// Work on columns, written once for all forms of eight lanes: its fields are what it reads and writes.
pub trait Kernel {
    /// What comes out besides what is written.
    type Out;
    /// Does the work with lanes of form `W`. This function and all that it calls with lanes are `#[inline(always)]`:
    /// instructions of a form are used only in code that is compiled into [`dispatch`].
    fn run<W: Wide>(self) -> Self::Out;
}

/// Runs a kernel in the form that suits the machine. Once per batch: the choice is cheap, but not free.
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Out {
    #[cfg(target_arch = "x86_64")]
    if uses_avx2() {
        // SAFETY: the machine has the features.
        return unsafe { kernel.with_avx2() };
    }
    kernel.run::<F32x8>()
}

/// The instruction set that kernels use on this machine.
pub fn simd() -> &'static str {
    if uses_avx2() {
        "avx2+fma"
    } else if cfg!(target_feature = "avx") {
        "avx"
    } else if cfg!(target_arch = "aarch64") {
        "neon"
    } else if cfg!(target_arch = "x86_64") {
        "sse2"
    } else {
        "scalar"
    }
}

/// `x * a + b`, rounded like the lanes of [`dispatch`].
#[inline(always)]
pub(super) fn mul_add(x: f32, a: f32, b: f32) -> f32 {
    if F32x8::FUSED {
        return x.mul_add(a, b);
    }
    #[cfg(target_arch = "x86_64")]
    if uses_avx2() {
        // SAFETY: the machine has the features.
        return unsafe { fused(x, a, b) };
    }
    // Without the instruction, a fused result would cost a library call.
    x * a + b
}

/// Whether kernels run in the AVX2 form: known when a build is for machines that have it, else asked once.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) fn uses_avx2() -> bool {
    const BUILT_IN: bool = cfg!(all(
        target_feature = "avx2",
        target_feature = "fma",
        target_feature = "bmi1",
        target_feature = "bmi2",
        target_feature = "lzcnt",
        target_feature = "popcnt"
    ));
    BUILT_IN
        || match ANSWER.load(Relaxed) {
            YES => true,
            NO => false,
            _ => detect(),
        }
}

/// What the processor answered: nothing yet, [`NO`] or [`YES`]. Threads that ask at once all store the same.
#[cfg(target_arch = "x86_64")]
static ANSWER: AtomicU8 = AtomicU8::new(0);
#[cfg(target_arch = "x86_64")]
const NO: u8 = 1;
#[cfg(target_arch = "x86_64")]
const YES: u8 = 2;

#[cfg(target_arch = "x86_64")]
#[cold]
#[inline(never)]
fn detect() -> bool {
    use std::arch::is_x86_feature_detected as has;
    let yes = has!("avx2") && has!("fma") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt");
    ANSWER.store(if yes { YES } else { NO }, Relaxed);
    yes
}

#[cfg(not(target_arch = "x86_64"))]
fn uses_avx2() -> bool {
    false
}

/// A method that all kernels are given, not a function: the compiler puts it with its kernel's module and compiles modules side
/// by side, where all instances of a function wait for each other.
#[cfg(target_arch = "x86_64")]
trait WithAvx2: Kernel + Sized {
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    unsafe fn with_avx2(self) -> Self::Out {
        self.run::<Avx2>()
    }
}
#[cfg(target_arch = "x86_64")]
impl<K: Kernel> WithAvx2 for K {}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "fma")]
fn fused(x: f32, a: f32, b: f32) -> f32 {
    x.mul_add(a, b)
}
