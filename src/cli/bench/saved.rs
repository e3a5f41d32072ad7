//! Figures as a document: printed, kept in a file, read again.

use super::args::SuiteArgs;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use wavetrace::bench::{Figure, Unit};
use wavetrace::chart::{Build, Machine};
use wavetrace::error::{Error, Result};
use wavetrace::input;

/// Of what kind the document is; another layout would get another number.
const FORMAT: u64 = 1;
/// What two documents must have in common to be compared: where this differs, a ratio tells nothing of the program.
/// Version and commit are what is compared.
const COMMON: [&str; 7] = [
    "/machine/cpu",
    "/machine/cores",
    "/build/compiler",
    "/build/profile",
    "/build/target",
    "/build/simd",
    "/settings/threads",
];

/// `NAME.json`; a name that ends so already is taken as it is.
pub fn path(name: &Path) -> PathBuf {
    if name.extension().is_some_and(|ending| ending == "json") {
        return name.to_owned();
    }
    let mut path = name.as_os_str().to_owned();
    path.push(".json");
    path.into()
}

/// The document of some figures, measured by this build on this machine.
pub fn document(args: &SuiteArgs, threads: usize, figures: &[Figure]) -> Value {
    let (build, machine) = (Build::this(), Machine::here());
    let figure = |f: &Figure| {
        json!({
            "name": f.name,
            "unit": f.unit.name(),
            "median": f.median(),
            "best": f.best(),
            "spread": f.spread(),
            "busy_cpus": f.busy,
            "repeats": f.values,
        })
    };
    json!({
        "program": "wavetrace",
        "format": FORMAT,
        "build": {
            "version": build.version,
            "commit": build.commit,
            "profile": build.profile,
            "compiler": build.compiler,
            "target": build.target,
            "simd": build.simd,
        },
        "machine": {"cpu": machine.cpu, "cores": machine.cores, "system": machine.system},
        "settings": {"threads": threads, "repeats": args.repeats, "up_to": args.up_to},
        "figures": figures.iter().map(figure).collect::<Vec<_>>(),
    })
}

/// Figures that were kept, and their document.
pub struct Saved {
    /// Where they are.
    pub path: PathBuf,
    document: Value,
    /// The figures.
    pub figures: Vec<Figure>,
}

impl Saved {
    /// Reads what [`document`] made.
    ///
    /// # Errors
    /// [`Error::Io`] where the file cannot be read, [`Error::Decode`] where it is no such document.
    pub fn read(path: PathBuf) -> Result<Self> {
        let fault = |source| Error::Io { file: path.clone(), action: "read", source };
        let bytes = input::regular(&path).map_err(fault)?;
        let no_json = |error| decode(&path, &format!("no JSON: {error}"), "JSON");
        let document: Value = serde_json::from_slice(&bytes).map_err(no_json)?;
        if document["program"] != "wavetrace" || document["format"] != FORMAT {
            return Err(decode(&path, "another document", "one that `wavetrace bench --save` wrote"));
        }
        let list = document["figures"].as_array().map(Vec::as_slice).unwrap_or_default();
        let figures = list.iter().enumerate().map(|(i, value)| {
            let expected = "a name, a unit, and numbers as repeats";
            figure(value).ok_or_else(|| decode(&path, &format!("figures[{i}]: {value}"), expected))
        });
        let figures = figures.collect::<Result<Vec<_>>>()?;
        Ok(Self { path, document, figures })
    }

    /// What differs from `own` of what must not, a line each.
    pub fn differences(&self, own: &Value) -> Vec<String> {
        let at = |document: &Value, pointer: &str| document.pointer(pointer).cloned().unwrap_or_default();
        let differs = |pointer: &&&str| at(&self.document, pointer) != at(own, pointer);
        let line = |pointer: &&str| {
            let name = pointer.trim_start_matches('/').replace('/', ".");
            format!(
                "{}: {name}: found {}, expected {} as of this run",
                self.path.display(),
                at(&self.document, pointer),
                at(own, pointer)
            )
        };
        COMMON.iter().filter(differs).map(line).collect()
    }

    /// Version and commit that it was measured with.
    pub fn build(&self) -> String {
        let text =
            |pointer: &str| self.document.pointer(pointer).and_then(Value::as_str).unwrap_or("unknown").to_owned();
        format!("{} ({})", text("/build/version"), text("/build/commit"))
    }
}

fn figure(value: &Value) -> Option<Figure> {
    let value: &Map<_, _> = value.as_object()?;
    // A run that failed has no number.
    let number = |value: &Value| value.as_f64().or(value.is_null().then_some(f64::NAN));
    let values = value.get("repeats")?.as_array()?.iter().map(number).collect::<Option<_>>()?;
    Some(Figure {
        name: value.get("name")?.as_str()?.to_owned(),
        unit: Unit::from_name(value.get("unit")?.as_str()?)?,
        values,
        busy: value.get("busy_cpus").and_then(Value::as_f64),
    })
}

fn decode(file: &Path, found: &str, expected: &str) -> Error {
    Error::Decode { file: file.to_owned(), found: found.to_owned(), expected: expected.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_files() {
        for (name, file) in [("before", "before.json"), ("a.json", "a.json"), ("dir/v1.2", "dir/v1.2.json")] {
            assert_eq!(path(Path::new(name)), Path::new(file));
        }
    }
}
