//! How much of trees a thread visits, for tests: what changes no hit may still make rays visit more.

use std::cell::Cell;

/// Place of nodes among what is counted.
pub const NODES: usize = 0;
/// Place of leaves.
pub const LEAVES: usize = 1;

thread_local! {
    static VISITS: Cell<[u64; 2]> = const { Cell::new([0; 2]) };
}

/// Counts a visit.
pub fn note(what: usize) {
    VISITS.with(|visits| {
        let mut all = visits.get();
        all[what] += 1;
        visits.set(all);
    });
}

/// Visits of nodes and of leaves by this thread while `run` runs.
pub fn visits(run: impl FnOnce()) -> [u64; 2] {
    VISITS.set([0; 2]);
    run();
    VISITS.get()
}
