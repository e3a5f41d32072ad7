//! Typed errors. The library never prints and never exits; `main.rs` maps these to messages and exit codes.

use std::{fmt, path::PathBuf};

/// One mistake in an input file: where it is, what was found there and what is expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The file at fault.
    pub file: PathBuf,
    /// 1-based line and column in `file`, where known.
    pub place: Option<(usize, usize)>,
    /// Path of the value in the document, such as `materials[2].refIndex`; empty for the document itself.
    pub path: String,
    /// What was found.
    pub found: String,
    /// What is expected instead.
    pub expected: String,
    /// A remedy, such as the nearest known key.
    pub hint: Option<String>,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some((line, column)) = self.place {
            write!(f, ":{line}:{column}")?;
        }
        write!(f, ": ")?;
        if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        write!(f, "found {}, expected {}", self.found, self.expected)?;
        match &self.hint {
            Some(hint) => write!(f, " ({hint})"),
            None => Ok(()),
        }
    }
}

/// Everything that can go wrong between a scene file and an image file.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Mistakes in a scene or a mesh: the first 100 that were found, of each mesh the first 20, and the numbers of the others.
    #[error("{}", join(.0))]
    Scene(Vec<Problem>),
    /// A world built in code breaks a rule of the format.
    #[error("{place}: found {found}, expected {expected}")]
    World {
        /// The component and its index, such as `materials[2].ref_index`.
        place: String,
        /// What was found.
        found: String,
        /// What is expected instead.
        expected: String,
    },
    /// A file could not be read or written.
    #[error("{}: cannot {action}: {source}", .file.display())]
    Io {
        /// The file at fault.
        file: PathBuf,
        /// What was tried, such as `write`.
        action: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// The image format cannot hold this image, or is not known.
    #[error("{}: {reason}", .file.display())]
    Output {
        /// The file that was to be written.
        file: PathBuf,
        /// What is wrong, and what would do.
        reason: String,
    },
    /// An image file cannot be understood.
    #[error("{}: found {found}, expected {expected}", .file.display())]
    Decode {
        /// The file at fault.
        file: PathBuf,
        /// What was found in it.
        found: String,
        /// What is expected instead.
        expected: String,
    },
    /// Images that are compared do not go together.
    #[error("images: found {found}, expected {expected}")]
    Images {
        /// What was found.
        found: String,
        /// What is expected instead.
        expected: String,
    },
    /// A setting of the render is out of its range.
    #[error("{setting}: found {found}, expected {expected}")]
    Setting {
        /// Name of the setting as on the command line, such as `--spp`.
        setting: &'static str,
        /// What was found.
        found: String,
        /// What is expected instead.
        expected: String,
    },
}

fn join(problems: &[Problem]) -> String {
    problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n")
}

/// Result with [`Error`].
pub type Result<T> = std::result::Result<T, Error>;
