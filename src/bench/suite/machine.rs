//! What the machine can do, whatever the program does: figures change with the machine's speed, and by these it is known.

use crate::bench::measure::{Case, Pace, Unit};
use crate::lanes::{F32x8, Kernel, MAX_LANES, Wide, dispatch};
use std::hint::black_box;

/// Names of the figures that tell how fast the machine is.
pub const YARDSTICKS: [&str; 2] = ["machine/arithmetic", "machine/memory"];

/// Chains of operations side by side: more than are in flight at once.
const CHAINS: usize = 12;
/// Operations of each chain in a pass.
const STEPS: usize = 1 << 16;
/// Operations of a pass: a fused one is two.
const OPERATIONS: f64 = (2 * CHAINS * STEPS * MAX_LANES) as f64;
/// Bytes that a core's second cache holds, on all machines of the last ten years.
const CACHE: usize = 1 << 17;
/// Tries of which the best counts, where limits are asked for.
const TRIES: usize = 3;
/// Bytes that are summed: far more than any cache holds.
const MEMORY: usize = 1 << 28;

/// Fused multiply-adds in lanes, on values that stay near 1.
struct Arithmetic(f32);

impl Kernel for Arithmetic {
    type Out = f32;
    #[inline(always)]
    fn run<W: Wide>(self) -> f32 {
        let (scale, shift) = (W::splat(black_box(0.999)), W::splat(black_box(0.001)));
        let mut chains = [W::splat(self.0); CHAINS];
        for _ in 0..STEPS {
            for chain in &mut chains {
                *chain = chain.mul_add(scale, shift);
            }
        }
        chains.into_iter().map(|chain| chain.min_lane()).sum()
    }
}

/// The sum of an array, in lanes.
struct Memory<'a>(&'a [[f32; MAX_LANES]]);

impl Kernel for Memory<'_> {
    type Out = f32;
    #[inline(always)]
    fn run<W: Wide>(self) -> f32 {
        let mut sums = [W::splat(0.0); 8];
        for rows in self.0.chunks_exact(sums.len()) {
            for (sum, row) in sums.iter_mut().zip(rows) {
                *sum = *sum + W::load(row);
            }
        }
        sums.into_iter().map(|sum| sum.min_lane()).sum()
    }
}

/// What the machine does at most, on one thread: the best of some tries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// 10^9 floating-point operations per second in eight lanes.
    pub gflops: f64,
    /// 10^9 bytes per second from a cache of the core's own.
    pub cache: f64,
    /// 10^9 bytes per second from memory.
    pub memory: f64,
}

/// Measures the limits; takes about a second.
pub fn limits() -> Limits {
    let best = |work: &mut dyn FnMut(usize)| {
        let mut pace = Pace::default();
        (0..TRIES).map(|_| pace.seconds(&mut *work)).fold(f64::INFINITY, f64::min)
    };
    let sum = |bytes: usize| {
        let rows = vec![[1.0; MAX_LANES]; bytes / size_of::<F32x8>()];
        let seconds = best(&mut |passes| {
            for _ in 0..passes {
                black_box(dispatch(Memory(black_box(&rows))));
            }
        });
        bytes as f64 / seconds / 1e9
    };
    let (cache, memory) = (sum(CACHE), sum(MEMORY));
    let seconds = best(&mut |passes| {
        for _ in 0..passes {
            black_box(dispatch(Arithmetic(black_box(1.0))));
        }
    });
    Limits { gflops: OPERATIONS / seconds / 1e9, cache, memory }
}

/// Both, on one thread.
pub(super) fn cases() -> Vec<Case<'static>> {
    let mut pace = Pace::default();
    let arithmetic = move || {
        let seconds = pace.seconds(|passes| {
            for _ in 0..passes {
                black_box(dispatch(Arithmetic(black_box(1.0))));
            }
        });
        vec![OPERATIONS / seconds / 1e9]
    };
    let mut pace = Pace::default();
    let mut rows = Vec::new();
    let memory = move || {
        rows.resize(MEMORY / size_of::<F32x8>(), [1.0; MAX_LANES]);
        let seconds = pace.seconds(|passes| {
            for _ in 0..passes {
                black_box(dispatch(Memory(black_box(&rows))));
            }
        });
        vec![MEMORY as f64 / seconds / 1e6]
    };
    let [first, second] = YARDSTICKS.map(str::to_owned);
    vec![Case::new(vec![(first, Unit::Gflops)], arithmetic), Case::new(vec![(second, Unit::Megabytes)], memory)]
}
