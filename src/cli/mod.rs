//! The command line. All that the program prints is printed here; the library is silent.

mod args;
mod args_compare;
mod bench;
mod chart;
mod check;
mod choices;
mod closing;
mod compare;
mod comparison;
mod explain;
mod facts;
mod interrupt;
mod load;
mod messages;
mod outputs;
mod profile;
mod progress;
mod render;
mod stats;
mod trace;
mod units;
mod values;

use args::{Cli, Verb};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};
use std::ffi::OsString;
use std::process::ExitCode;

/// How the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All is done.
    Done = 0,
    /// The scene or a file is at fault.
    Fault = 1,
    /// The command line is at fault.
    Usage = 2,
    /// Something is slower than it was.
    Slower = 3,
    /// The user, or the system, asked for the end; what was rendered so far is written.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit as u8)
    }
}

/// Understands the command line. Help, version and mistakes are printed.
pub fn parse(args: impl IntoIterator<Item = OsString>) -> Result<Cli, Exit> {
    Cli::try_parse_from(args).map_err(plain_error).map_err(|error| {
        // Where nobody listens any more there is nobody to tell.
        let _ = error.print();
        if error.use_stderr() { Exit::Usage } else { Exit::Done }
    })
}

/// A word too many after the scene counts as a verb in the wrong place, which nobody meant.
fn plain_error(error: clap::Error) -> clap::Error {
    match (error.kind(), error.get(ContextKind::InvalidSubcommand)) {
        (ErrorKind::ArgumentConflict, Some(ContextValue::String(word))) => {
            Cli::command().error(ErrorKind::UnknownArgument, format!("unexpected argument '{word}' found"))
        }
        _ => error,
    }
}

/// Does what the command line asks for.
pub fn run(command: &Cli) -> Exit {
    let result = match (&command.verb, &command.render) {
        (Some(Verb::Check(args)), _) => check::run(args),
        (Some(Verb::Compare(args)), _) => compare::run(args),
        (Some(Verb::Bench(args)), _) => bench::run(args),
        (Some(Verb::Chart(args)), _) => chart::run(args),
        (Some(Verb::Profile(args)), _) => profile::run(args),
        (None, Some(args)) if args.explain => explain::run(args),
        (None, Some(args)) => render::run(args),
        (None, None) => Err(Exit::Usage),
    };
    result.unwrap_or_else(|exit| exit)
}
