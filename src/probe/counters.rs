//! Hardware counters of the thread that reads them, where the system lets a program see its own and the machine has them;
//! virtual machines mostly have none. The only file that names `perf_event`.

use std::io;

/// What is counted, as `--stats` names it: while the program itself runs, not the system.
pub const COUNTED: [&str; 4] = ["cycles", "instructions", "cache_misses", "branch_misses"];

/// How often each of [`COUNTED`] happened.
pub type Counted = [u64; COUNTED.len()];

/// Counters at work.
#[derive(Debug)]
pub struct Counters(system::Group);

impl Counters {
    /// Counts what this thread does from now on.
    ///
    /// # Errors
    /// What the system says where it has no such counters, or none for this program.
    pub fn open() -> io::Result<Self> {
        system::Group::open(system::HARDWARE).map(Self)
    }
    /// Why there are none, in the words of the system; `None` where there are.
    pub fn missing() -> Option<String> {
        Self::open().err().map(|error| format!("this system gives none: {error}"))
    }
    /// What has been counted. Where the machine counts only a part of the time, it is scaled up to all of it.
    #[inline(never)]
    pub fn read(&mut self) -> Counted {
        self.0.read()
    }
}

/// What happened since `before`.
pub fn since(before: &Counted, now: &Counted) -> Counted {
    std::array::from_fn(|k| now[k].saturating_sub(before[k]))
}

#[cfg(target_os = "linux")]
mod system {
    use super::Counted;
    use perf_event::events::{Event, Hardware};
    use perf_event::{Builder, Counter};
    use std::{fmt, io};

    pub const HARDWARE: [Hardware; 4] =
        [Hardware::CPU_CYCLES, Hardware::INSTRUCTIONS, Hardware::CACHE_MISSES, Hardware::BRANCH_MISSES];

    /// Counters that count at the same times.
    pub struct Group {
        group: perf_event::Group,
        counters: [Counter; 4],
    }

    impl fmt::Debug for Group {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            self.counters.fmt(f)
        }
    }

    impl Group {
        pub fn open<E: Event>(events: [E; 4]) -> io::Result<Self> {
            let mut group = perf_event::Group::new()?;
            let counters: Vec<Counter> =
                events.into_iter().map(|event| group.add(&Builder::new(event))).collect::<io::Result<_>>()?;
            group.enable()?;
            let counters = counters.try_into().map_err(|_| io::Error::from(io::ErrorKind::Unsupported))?;
            Ok(Self { group, counters })
        }
        pub fn read(&mut self) -> Counted {
            let Ok(data) = self.group.read() else { return [0; 4] };
            let share = match (data.time_enabled(), data.time_running()) {
                (Some(enabled), Some(running)) if !running.is_zero() => enabled.as_secs_f64() / running.as_secs_f64(),
                _ => 1.0,
            };
            let count = |counter: &Counter| data.get(counter).map_or(0, |entry| entry.value());
            self.counters.each_ref().map(|counter| match share > 1.0 {
                true => (count(counter) as f64 * share) as u64,
                false => count(counter),
            })
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use super::Counted;
    use std::io;

    pub const HARDWARE: () = ();

    /// Nothing can be opened.
    #[derive(Debug)]
    pub enum Group {}

    impl Group {
        pub fn open(_events: ()) -> io::Result<Self> {
            Err(io::Error::from(io::ErrorKind::Unsupported))
        }
        pub fn read(&mut self) -> Counted {
            match *self {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_told_apart() {
        assert_eq!(since(&[1, 2, 3, 9], &[2, 4, 6, 8]), [1, 2, 3, 0]);
    }

    /// Counters of the system itself, which are everywhere, take the same way as those of the machine.
    #[cfg(target_os = "linux")]
    #[test]
    fn each_counter_counts_its_own() {
        use perf_event::events::Software;
        let events = [Software::TASK_CLOCK, Software::PAGE_FAULTS, Software::CONTEXT_SWITCHES, Software::PAGE_FAULTS];
        // Containers may forbid all of it.
        let Ok(mut group) = system::Group::open(events) else { return };
        let before = group.read();
        let page = vec![1u8; 8 << 20];
        let sum: u64 = page.iter().map(|&x| u64::from(x)).sum();
        let passed = since(&before, &group.read());
        assert_eq!(sum, 8 << 20);
        // Nanoseconds of work; new pages, if any, twice.
        assert!(passed[0] > 100_000 && passed[1] == passed[3], "{passed:?}");
    }

    /// Where the machine has counters, work takes cycles and instructions; else the system says why not.
    #[test]
    fn work_is_counted_or_it_is_said_why_not() {
        match Counters::open() {
            Ok(mut counters) => {
                let before = counters.read();
                let sum: f64 = (0..1_000_000).map(f64::from).sum();
                let [cycles, instructions, ..] = since(&before, &counters.read());
                assert!(sum > 0.0 && cycles > 100_000 && instructions > 100_000, "{cycles} {instructions}");
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
}
