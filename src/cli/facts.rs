//! What it takes to repeat a measurement, for pages.

use super::units::counted;
use std::env;
use wavetrace::chart::{Build, Machine};
use wavetrace::output;

/// This build and this machine, or those that a document tells of.
pub fn machine(build: &Build, machine: &Machine) -> Vec<(String, String)> {
    let commit = build.commit.map_or_else(String::new, |commit| format!(", commit {commit}"));
    [
        ("program", format!("wavetrace {}{commit}", build.version)),
        ("build", format!("{}, {}, for {}, SIMD: {}", build.profile, build.compiler, build.target, build.simd)),
        ("processor", format!("{}, {} available", machine.cpu, counted(machine.cores as u64, "core"))),
        ("system", machine.system.clone()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// Date and time of day, to the minute.
pub fn local_time() -> String {
    let now = output::local_now();
    format!("{} {:02}:{:02}", now.date(), now.hour(), now.minute())
}

/// The command line as one would type it.
pub fn command() -> String {
    let words = env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()));
    std::iter::once("wavetrace".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("scenes/a-b_1.json"), "scenes/a-b_1.json");
        assert_eq!(["a b", "", "it's", "$x", "ä"].map(quoted), ["'a b'", "''", r"'it'\''s'", "'$x'", "'ä'"]);
    }
}
