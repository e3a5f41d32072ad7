//! Hints to the memory system.

/// Asks for the line at `address`, without waiting.
#[inline(always)]
fn prefetch(address: *const i8) {
    // SAFETY: a prefetch reads nothing, whatever the address.
    #[cfg(target_arch = "x86_64")]
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(address);
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}

/// Asks for `values[at..at + N]`, each no larger than a cache line, without waiting. Any `at` will do.
#[inline(always)]
pub fn prefetch_lines<T, const N: usize>(values: &[T], at: usize) {
    for line in 0..N {
        prefetch(values.as_ptr().wrapping_add(at.wrapping_add(line)).cast());
    }
}

/// Asks for the lines in which `values[at]` begins and ends, without waiting. Any `at` will do.
#[inline(always)]
pub fn prefetch_ends<T>(values: &[T], at: usize) {
    let first = values.as_ptr().wrapping_add(at).cast::<i8>();
    prefetch(first);
    prefetch(first.wrapping_add(size_of::<T>() - 1));
}
