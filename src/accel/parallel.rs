//! Threads for the build. All of it gives the same bits on any number of threads.

use crate::error::{Error, Result};
pub(super) use rayon::join;
pub(super) use rayon::prelude::*;

/// Runs `work` on `threads` threads of its own, 0 for all cores.
///
/// # Errors
/// [`Error::Setting`] if the system cannot start them.
pub(super) fn within<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| Error::Setting {
        setting: "--threads",
        found: threads.to_string(),
        expected: format!("as many as the system can start ({e})"),
    })?;
    Ok(pool.install(work))
}
