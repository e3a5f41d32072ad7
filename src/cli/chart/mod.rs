//! `wavetrace chart`: error against time and samples, measured, drawn, and put into a page.

mod args;
mod files;
mod plan;
mod progress;
mod subjects;
mod summary;
mod sweep;
mod work;

pub use args::ChartArgs;

use super::Exit;
use super::interrupt::Interrupt;
use super::messages::Console;
use super::units::counted;
use sweep::{Stop, Sweep};
use wavetrace::chart::curve::labels;
use wavetrace::chart::{Folder, Imported, row};

/// Measures, draws and writes.
pub fn run(args: &ChartArgs) -> Result<Exit, Exit> {
    let console = Console::new(args.quiet, false);
    let interrupt = Interrupt::listen();
    let names = subjects::names(args, &console)?;
    let series = args.series();
    let own: Vec<String> = series.iter().map(|series| series.label.clone()).collect();
    let mut imports = Vec::new();
    for path in &args.import {
        imports.push(row::read(path).map_err(|error| console.fail(&error))?);
    }
    let subjects = subjects::load(args, &names, &console)?;
    let folder = Folder::open(&args.output).map_err(|error| console.fail(&error))?;
    let kept = folder.kept().map_err(|error| console.fail(&error))?;

    // From here on whoever interrupts gets what there is by then.
    let control = interrupt.start_render();
    let sweep = Sweep { args, console: &console, control, folder: &folder, subjects: &subjects, series: &series };
    let plan = match sweep.plan(kept) {
        Ok(plan) => plan,
        Err(Stop::Fault(exit)) => return Err(exit),
        Err(Stop::Interrupted) => {
            console.line("interrupted before anything was measured");
            return Ok(Exit::Interrupted);
        }
    };
    let setup = plan.setup.clone();
    let ladders = plan.ladders.clone();
    let outcome = sweep.run(plan)?;

    // An earlier run may have measured series that this one does not.
    let mut taken = own;
    taken.extend(labels(&outcome.rows).into_iter().filter(|label| !taken.contains(label)).collect::<Vec<_>>());
    let mut imported = Imported::default();
    for (path, rows) in args.import.iter().zip(imports) {
        imported.add(path, rows, &names, &taken);
    }
    for (scene, rows) in &imported.others {
        let rows = counted(*rows as u64, "imported row");
        console.warn(format_args!("{rows} of the scene {scene}: left out, this chart has no such scene"));
    }
    let done = files::write(&files::Results {
        sweep: &sweep,
        setup: &setup,
        ladders: &ladders,
        outcome: &outcome,
        imported: &imported,
        labels: &taken,
    })?;
    if interrupt.happened() {
        return Ok(Exit::Interrupted);
    }
    Ok(done)
}
