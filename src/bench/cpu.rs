//! CPUs: which there are, how to stay on one, and how long they have worked. Known on Linux alone; elsewhere threads go
//! where the system puts them. The only file that names `rustix`.

use std::time::Duration;

/// Numbers of the CPUs that this thread may use; empty where that is not known.
#[cfg(target_os = "linux")]
pub(super) fn allowed() -> Vec<usize> {
    use rustix::thread::{CpuSet, sched_getaffinity};
    let Ok(set) = sched_getaffinity(None) else { return Vec::new() };
    (0..CpuSet::MAX_CPU).filter(|&cpu| set.is_set(cpu)).collect()
}

/// Keeps this thread on a CPU; where the system refuses, the thread stays as it is.
#[cfg(target_os = "linux")]
pub(super) fn pin(cpu: usize) {
    let mut set = rustix::thread::CpuSet::new();
    set.set(cpu);
    let _ = rustix::thread::sched_setaffinity(None, &set);
}

/// Time that CPUs have spent on this program so far, all threads together.
#[cfg(target_os = "linux")]
pub(super) fn time() -> Option<Duration> {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Some(Duration::new(time.tv_sec.try_into().ok()?, time.tv_nsec.try_into().ok()?))
}

/// Numbers of the CPUs that this thread may use; empty where that is not known.
#[cfg(not(target_os = "linux"))]
pub(super) fn allowed() -> Vec<usize> {
    Vec::new()
}

/// Keeps this thread on a CPU, where that can be had.
#[cfg(not(target_os = "linux"))]
pub(super) fn pin(_cpu: usize) {}

/// Time that CPUs have spent on this program so far, where that is known.
#[cfg(not(target_os = "linux"))]
pub(super) fn time() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn threads_stay_where_they_are_put_and_time_passes() {
        let cpus = allowed();
        let &last = cpus.last().unwrap();
        std::thread::spawn(move || {
            pin(last);
            assert_eq!(allowed(), [last]);
        })
        .join()
        .unwrap();
        assert_eq!(allowed(), cpus, "other threads are as they were");
        let start = time().unwrap();
        let sum: f64 = (0..1_000_000).map(f64::from).map(f64::sqrt).sum();
        assert!(std::hint::black_box(sum) > 0.0 && time().unwrap() > start);
    }
}
