//! Hints to the memory system.

/// Asks for `values[at..at + N]`, each no larger than a cache line, without waiting. Any `at` will do.
#[inline(always)]
pub fn prefetch_lines<T, const N: usize>(values: &[T], at: usize) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..N {
        let line = values.as_ptr().wrapping_add(at.wrapping_add(line)).cast::<i8>();
        // SAFETY: a prefetch reads nothing, whatever the address.
        unsafe { std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(line) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (values, at);
}

/// Asks for the lines in which `values[at]` begins and ends, without waiting.
#[inline(always)]
pub fn prefetch_ends<T>(values: &[T], at: usize) {
    #[cfg(target_arch = "x86_64")]
    for byte in [0, size_of::<T>() - 1] {
        let line = values.as_ptr().wrapping_add(at).cast::<i8>().wrapping_add(byte);
        // SAFETY: a prefetch reads nothing, whatever the address.
        unsafe { std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(line) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (values, at);
}
