//! Messages on standard error. Where nobody reads them any more they are dropped.

use super::Exit;
use std::cell::Cell;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use wavetrace::error::Error;

/// Shows messages as loudly as the user wants.
#[derive(Debug)]
pub struct Console {
    quiet: bool,
    strict: bool,
    warned: Cell<bool>,
}

impl Console {
    /// `quiet` shows errors alone; `strict` makes errors of warnings.
    pub fn new(quiet: bool, strict: bool) -> Self {
        Self { quiet, strict, warned: Cell::new(false) }
    }
    /// Whether errors alone are shown.
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }
    /// Shows an error, or several, one per line.
    pub fn error(&self, message: impl Display) {
        labelled("error", message);
    }
    /// Shows an error of the library; returns the exit code that goes with it.
    pub fn fail(&self, error: &Error) -> Exit {
        self.error(error);
        if matches!(error, Error::Setting { .. }) { Exit::Usage } else { Exit::Fault }
    }
    /// Shows a warning, which is an error where the user is strict.
    pub fn warn(&self, message: impl Display) {
        self.warned.set(true);
        match (self.strict, self.quiet) {
            (true, _) => self.error(message),
            (false, false) => labelled("warning", message),
            (false, true) => {}
        }
    }
    /// An error where there were warnings and the user is strict.
    pub fn settle(&self) -> Result<(), Exit> {
        if self.strict && self.warned.get() { Err(Exit::Fault) } else { Ok(()) }
    }
    /// Shows what is good to know.
    pub fn note(&self, message: impl Display) {
        if !self.quiet {
            labelled("note", message);
        }
    }
    /// Shows a plain line.
    pub fn line(&self, message: impl Display) {
        if !self.quiet {
            plain(message);
        }
    }
    /// Writes the answer that the user asked for to standard output. A reader that has left, such as `head`, is no
    /// fault.
    pub fn answer(&self, text: impl Display) -> Result<(), Exit> {
        let mut out = io::stdout().lock();
        match writeln!(out, "{text}").and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                self.error(format_args!("standard output: cannot write: {error}"));
                Err(Exit::Fault)
            }
            _ => Ok(()),
        }
    }
}

/// Shows a line without a label, whatever the user wants.
pub fn plain(message: impl Display) {
    let _ = writeln!(io::stderr(), "{message}");
}

fn labelled(label: &str, message: impl Display) {
    let lines: String = message.to_string().lines().map(|line| format!("{label}: {line}\n")).collect();
    let _ = io::stderr().write_all(lines.as_bytes());
}
