//! Settings of a render by name, for sweeps. Each knob is an option of a render, understood as on the command line: what an
//! option allows and how a mistake is told is written once.

use crate::cli::args::{Cli, RenderArgs};
use clap::Parser;
use std::ffi::OsString;
use std::path::Path;

/// Options that a sweep may change: those that shape throughput.
const KNOBS: [&str; 15] = [
    "wave",
    "job",
    "refill",
    "camera-rays",
    "bounce-rays",
    "sort",
    "bvh",
    "leaf",
    "integrator",
    "threads",
    "sampler",
    "method",
    "light-paths",
    "max-depth",
    "spp",
];
/// Values of a range at most.
const MOST: usize = 64;

/// A knob and the values that it takes in turn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Knob {
    /// Its name: that of the option without dashes.
    pub name: String,
    /// The values, as on the command line.
    pub values: Vec<String>,
}

impl Knob {
    /// Whether all values are numbers above 0, for an axis.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        self.values.iter().map(|value| value.parse().ok().filter(|x: &f64| *x > 0.0)).collect()
    }
}

/// `NAME=A,B,C` or `NAME=A..B`, which is A, 2 A, 4 A, ... up to B.
pub fn knob(text: &str) -> Result<Knob, String> {
    let (name, list) = text.split_once('=').ok_or("expected KNOB=VALUES, such as wave=64..65536")?;
    if !KNOBS.contains(&name) {
        return Err(format!("expected one of the knobs {}", KNOBS.join(", ")));
    }
    let values = match list.split_once("..") {
        Some((from, to)) => range(from, to)?,
        None => list.split(',').map(str::to_owned).collect(),
    };
    let knob = Knob { name: name.to_owned(), values };
    for (i, value) in knob.values.iter().enumerate() {
        settings(Path::new("scene"), &[(name, value)])?;
        if knob.values[..i].contains(value) {
            return Err(format!("expected each value once, found {value} twice"));
        }
    }
    Ok(knob)
}

fn range(from: &str, to: &str) -> Result<Vec<String>, String> {
    let number = |text: &str| text.parse::<u64>().map_err(|_| format!("expected whole numbers A..B, found {text:?}"));
    let (from, to) = (number(from)?, number(to)?);
    let values: Vec<u64> =
        std::iter::successors(Some(from), |x| x.checked_mul(2)).take_while(|x| *x <= to).take(MOST + 1).collect();
    if from == 0 || values.is_empty() || values.len() > MOST {
        return Err(format!("expected A..B with A above 0 and not above B, found {from}..{to}"));
    }
    Ok(values.iter().map(u64::to_string).collect())
}

/// A knob that is named more than once.
pub fn twice<'a>(knobs: impl IntoIterator<Item = &'a Knob>) -> Option<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    knobs.into_iter().find_map(|knob| {
        let seen = names.contains(&knob.name.as_str());
        names.push(&knob.name);
        seen.then_some(knob.name.as_str())
    })
}

/// What a render of `scene` is told by knobs and values.
///
/// # Errors
/// What is wrong with a value, in the words of the command line.
pub fn settings(scene: &Path, knobs: &[(&str, &str)]) -> Result<RenderArgs, String> {
    let options = knobs.iter().map(|(name, value)| OsString::from(format!("--{name}={value}")));
    let words = [OsString::from("wavetrace"), scene.as_os_str().to_owned()].into_iter().chain(options);
    let parsed = Cli::try_parse_from(words).map_err(|error| {
        let text = error.to_string();
        text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned()
    })?;
    parsed.render.ok_or_else(|| "expected a render".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_knob_is_an_option_of_a_render() {
        let command = Cli::command();
        let options: Vec<_> = command.get_arguments().filter_map(|arg| arg.get_long()).collect();
        assert!(KNOBS.iter().all(|name| options.contains(name)), "{options:?}");
    }

    #[test]
    fn values_are_lists_or_powers_of_two() {
        let of = |text: &str| knob(text).map(|knob| knob.values.join(" "));
        assert_eq!(of("wave=64..1000"), Ok("64 128 256 512".to_owned()));
        assert_eq!(of("leaf=1,4,8"), Ok("1 4 8".to_owned()));
        assert_eq!(of("bvh=fast,best"), Ok("fast best".to_owned()));
        assert_eq!(knob("leaf=1,4").unwrap().numbers(), Some(vec![1.0, 4.0]));
        assert_eq!(knob("bvh=fast,best").unwrap().numbers(), None);
        for (text, part) in [
            ("wave", "KNOB=VALUES"),
            ("colour=1", "one of the knobs wave"),
            ("wave=0..4", "above 0"),
            ("wave=8..4", "not above B"),
            ("wave=a..4", "whole numbers"),
            ("leaf=9", "9"),
            ("bvh=good", "good"),
            ("wave=1,1", "twice"),
            ("wave=", "wave"),
        ] {
            let error = of(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn knobs_are_named_once() {
        let of = |texts: &[&str]| {
            let knobs: Vec<Knob> = texts.iter().map(|text| knob(text).unwrap()).collect();
            twice(&knobs).map(str::to_owned)
        };
        assert_eq!(of(&["wave=64", "leaf=1", "job=64"]), None);
        assert_eq!(of(&["wave=64", "leaf=1", "wave=128"]), Some("wave".to_owned()));
    }

    #[test]
    fn knobs_become_settings() {
        let args = settings(Path::new("a.json"), &[("wave", "64"), ("leaf", "2"), ("refill", "off")]).unwrap();
        assert_eq!(
            (args.settings().wave_size, args.build_options().leaf, args.settings().tuning.refill),
            (64, 2, false)
        );
    }
}
