//! Where path tracers fail: each mode with a test that fails with the textbook's method and holds with ours.
//!
//! One file per failure mode, whose [`ROW`](row::Row) says what fails, what the remedy is, and measures both. The page
//! `docs/stability.md` is made from what the tests found, by
//! `WAVETRACE_FULL=1 WAVETRACE_STABILITY_PAGE=docs cargo test --test stability -- --test-threads 1`. The test `page` holds the page
//! to the rows' texts.

#[path = "../common/mod.rs"]
mod common;
mod curve;
mod lambert;
mod lobe;
mod page;
mod row;
mod textbook;
mod walk;

use libtest_mimic::{Arguments, Trial, run};
use row::{Finding, Row};
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::{Arc, Mutex};

/// Names each failure mode once.
macro_rules! rows {
    ($($mode:ident,)*) => {
        $(mod $mode;)*
        /// All failure modes, in the order of the page.
        const ROWS: &[Row] = &[$($mode::ROW),*];
    };
}

rows! {
    self_hits,
    scale,
    watertight,
    grazing,
    order,
    builds,
    mattness,
    fresnel,
    slabs,
    silhouettes,
    normals,
    terminator,
    dielectrics,
    lossless,
    weights,
    small_lights,
    near_lights,
    light_range,
    methods,
    film_sums,
    seeds,
    threads,
    bad_samples,
    stopping,
    bright_pixel,
    long_sobol,
    whole_files,
}

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let findings: Arc<Mutex<BTreeMap<&str, Finding>>> = Arc::default();
    let mut trials: Vec<Trial> = ROWS
        .iter()
        .map(|row| {
            let findings = Arc::clone(&findings);
            Trial::test(row.name, move || {
                let finding = (row.run)();
                println!("{}: textbook {}; here {}. {}", row.name, finding.textbook, finding.ours, finding.how);
                findings.lock().map_err(|e| e.to_string())?.insert(row.name, finding);
                Ok(())
            })
        })
        .collect();
    trials.push(Trial::test("page", || page::check(ROWS).map_err(Into::into)));
    let folder = std::env::var_os("WAVETRACE_STABILITY_PAGE");
    let conclusion = run(&arguments, trials);
    if let (Some(folder), Ok(findings)) = (folder, findings.lock())
        && let Err(error) = page::write(ROWS, &findings, folder.as_ref())
    {
        eprintln!("error: {error}");
        return ExitCode::FAILURE;
    }
    conclusion.exit_code()
}
