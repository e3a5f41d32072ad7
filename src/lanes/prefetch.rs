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
