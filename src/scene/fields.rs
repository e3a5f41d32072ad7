//! Typed readers of JSON values. Each notes its mistakes and gives `None`, so that the rest is read nonetheless.

use crate::linear::DVec3;

use super::json::{self, Entry, Node, Value};
use super::problems::Problems;

/// Most unknown keys among which a missing one is looked for.
const MAX_STRANGERS: usize = 100;

/// The entries of a JSON object of which the keys are known.
pub(super) struct Fields<'a> {
    entries: &'a [Entry],
    at: usize,
    path: String,
    known: &'static [&'static str],
}

impl<'a> Fields<'a> {
    /// Opens `node`, which must be an object; a key that is not among `known` is a warning.
    pub fn open(node: &'a Node, path: &str, known: &'static [&'static str], problems: &mut Problems) -> Option<Self> {
        let Value::Map(entries) = &node.value else {
            problems.error(node.at, path, node.describe(), format!("an object with {}", list(known, "and")));
            return None;
        };
        for entry in entries.iter().filter(|entry| !known.contains(&entry.key.as_str())) {
            problems.warning(entry.at, json::Path::new(path).key(&entry.key), "an unknown key", || {
                let hint = nearest(&entry.key, known).map(|key| format!("did you mean `{key}`?"));
                (format!("one of {}", list(known, "or")), hint)
            });
        }
        Some(Self { entries, at: node.at, path: path.to_owned(), known })
    }

    /// Path of `key`'s value in the document.
    pub fn path(&self, key: &str) -> String {
        json::Path::new(&self.path).key(key).to_string()
    }

    /// The entry of `key`, where the file has it.
    pub fn entry(&self, key: &str) -> Option<&'a Entry> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    /// The value of `key`, where the file has it.
    pub fn get(&self, key: &str) -> Option<&'a Node> {
        self.entry(key).map(|entry| &entry.node)
    }

    /// The value of `key`; its absence is a mistake.
    pub fn require(&self, key: &str, expected: &str, problems: &mut Problems) -> Option<&'a Node> {
        let node = self.get(key);
        if node.is_none() {
            let strangers = self.entries.iter().filter(|entry| !self.known.contains(&entry.key.as_str()));
            let looked_at = if problems.is_full() { 0 } else { MAX_STRANGERS };
            let misspelt = strangers.take(looked_at).find(|entry| nearest(&entry.key, self.known) == Some(key));
            let hint = misspelt.map(|entry| {
                let (line, column) = problems.place(entry.at);
                format!("did you mean it by `{}` at line {line}, column {column}?", json::shorten(&entry.key))
            });
            problems.error_with_hint(self.at, self.path(key), "no such key", expected, hint);
        }
        node
    }

    /// The number of `key`, or `default` where the file is silent.
    pub fn number(&self, key: &str, range: &Range, default: f64, problems: &mut Problems) -> Option<f64> {
        match self.get(key) {
            Some(node) => number(node, &self.path(key), range, problems),
            None => Some(default),
        }
    }

    /// The number of `key`, which must be there.
    pub fn required_number(&self, key: &str, range: &Range, problems: &mut Problems) -> Option<f64> {
        let node = self.require(key, range.expected, problems)?;
        number(node, &self.path(key), range, problems)
    }

    /// Checks that `comment`, where given, is text.
    pub fn comment(&self, problems: &mut Problems) {
        if let Some(node) = self.get("comment") {
            text(node, &self.path("comment"), "a string", problems);
        }
    }
}

/// The numbers a key takes.
pub(super) struct Range {
    expected: &'static str,
    holds: fn(f64) -> bool,
}

impl Range {
    /// All that single precision can hold.
    pub const ANY: Self = Self { expected: "a number", holds: |_| true };
    /// A share.
    pub const UNIT: Self = Self { expected: "a number in [0, 1]", holds: |x| (0.0..=1.0).contains(&x) };
    /// At least 0.
    pub const NOT_NEGATIVE: Self = Self { expected: "a number >= 0", holds: |x| x >= 0.0 };
    /// Above 0 in single precision as well.
    pub const POSITIVE: Self =
        Self { expected: "a number > 0 (at least 1.2e-38)", holds: |x| x >= f64::from(f32::MIN_POSITIVE) };
    /// A field of view in degrees.
    pub const ANGLE: Self =
        Self { expected: "an angle in degrees above 0 and below 180", holds: |x| x > 0.0 && x < 180.0 };
}

/// Reads a number in `range`; what single precision cannot hold is a mistake everywhere.
pub(super) fn number(node: &Node, path: &str, range: &Range, problems: &mut Problems) -> Option<f64> {
    let Value::Number { value, .. } = node.value else {
        let hint = match &node.value {
            Value::Text(text) if text.trim().parse::<f64>().is_ok() => Some("write it without quotes".to_owned()),
            _ => None,
        };
        problems.error_with_hint(node.at, path, node.describe(), range.expected, hint);
        return None;
    };
    if !fits_single(value) {
        problems.error(node.at, path, node.describe(), "a number between -3.4e38 and 3.4e38");
        return None;
    }
    if !(range.holds)(value) {
        problems.error(node.at, path, node.describe(), range.expected);
        return None;
    }
    Some(value)
}

/// Whether `value` is finite and stays so in single precision.
pub(super) fn fits_single(value: f64) -> bool {
    value.abs() <= f64::from(f32::MAX)
}

/// Reads a whole number of at least `least`; one too large for `u64` is given as `u64::MAX`.
pub(super) fn whole(node: &Node, path: &str, least: u32, expected: &str, problems: &mut Problems) -> Option<u64> {
    match node.value {
        Value::Number { value, .. } if value.fract() == 0.0 && value >= f64::from(least) => Some(value as u64),
        _ => {
            problems.error(node.at, path, node.describe(), expected);
            None
        }
    }
}

/// Reads a string.
pub(super) fn text<'a>(node: &'a Node, path: &str, expected: &str, problems: &mut Problems) -> Option<&'a str> {
    match &node.value {
        Value::Text(text) => Some(text),
        _ => {
            problems.error(node.at, path, node.describe(), expected);
            None
        }
    }
}

/// Reads one of the words `choices`.
pub(super) fn choice(
    node: &Node,
    path: &str,
    choices: &[&'static str],
    problems: &mut Problems,
) -> Option<&'static str> {
    let expected = quoted(choices);
    let word = text(node, path, &expected, problems)?;
    let found = choices.iter().find(|&&choice| choice == word).copied();
    if found.is_none() {
        let near = if problems.is_full() { None } else { nearest(word, choices) };
        let hint = near.map(|choice| format!("did you mean \"{choice}\"?"));
        problems.error_with_hint(node.at, path, node.describe(), expected, hint);
    }
    found
}

/// Reads `true` or `false`, also as strings.
pub(super) fn boolean(node: &Node, path: &str, problems: &mut Problems) -> Option<bool> {
    match &node.value {
        Value::Bool(value) => Some(*value),
        Value::Text(text) if text == "true" => Some(true),
        Value::Text(text) if text == "false" => Some(false),
        _ => {
            problems.error(node.at, path, node.describe(), "true or false");
            None
        }
    }
}

/// Reads a list.
pub(super) fn items<'a>(node: &'a Node, path: &str, problems: &mut Problems) -> Option<&'a [Node]> {
    match &node.value {
        Value::List(items) => Some(items),
        _ => {
            problems.error(node.at, path, node.describe(), "a list");
            None
        }
    }
}

/// Reads `{"x", "y", "z"}`.
pub(super) fn vector(node: &Node, path: &str, problems: &mut Problems) -> Option<DVec3> {
    triple(node, path, &["x", "y", "z"], &Range::ANY, problems).map(DVec3::from_array)
}

/// Reads `{"r", "g", "b"}`, each in `range`.
pub(super) fn color(node: &Node, path: &str, range: &Range, problems: &mut Problems) -> Option<[f64; 3]> {
    triple(node, path, &["r", "g", "b"], range, problems)
}

fn triple(
    node: &Node,
    path: &str,
    keys: &'static [&'static str; 3],
    range: &Range,
    problems: &mut Problems,
) -> Option<[f64; 3]> {
    let fields = Fields::open(node, path, keys, problems)?;
    // All three are read before the first that is missing ends it, so that each gets its message.
    let [a, b, c] = keys.map(|key| fields.required_number(key, range, problems));
    Some([a?, b?, c?])
}

/// The word among `known` that `word` was probably meant to be.
fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    // Words much longer than any key are no misspelling of one, and would make this slow.
    if word.len() > 40 {
        return None;
    }
    let plain = |text: &str| text.to_lowercase().replace(['_', '-', ' '], "");
    let word = plain(word);
    let distance = |key: &str| strsim::damerau_levenshtein(&word, &plain(key));
    let best = known.iter().copied().min_by_key(|key| distance(key))?;
    (distance(best) <= word.len().max(best.len()) / 3).then_some(best)
}

fn list(words: &[&str], last: &str) -> String {
    match words {
        [all @ .., end] if !all.is_empty() => format!("{} {last} {end}", all.join(", ")),
        _ => words.concat(),
    }
}

fn quoted(words: &[&str]) -> String {
    let words: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
    list(&words.iter().map(String::as_str).collect::<Vec<_>>(), "or")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn read<T>(text: &str, reader: impl Fn(&Node, &mut Problems) -> Option<T>) -> Result<T, Vec<String>> {
        let mut problems = Problems::new(Path::new("s"), text);
        let node = json::parse(text, &mut problems).expect("valid JSON");
        let value = reader(&node, &mut problems);
        value.ok_or_else(|| problems.into_parts().0.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn near_words_are_found_and_far_ones_are_not() {
        let known = ["xReso", "yReso", "xAngle", "color", "x"];
        assert_eq!(nearest("xreso", &known), Some("xReso"));
        assert_eq!(nearest("colour", &known), Some("color"));
        assert_eq!(nearest("X_ANGLE", &known), Some("xAngle"));
        assert_eq!(nearest("w", &known), None);
        assert_eq!(nearest("aperture", &known), None);
        assert_eq!(nearest(&"x".repeat(1000), &known), None);
    }

    #[test]
    fn booleans_are_also_read_from_strings() {
        let boolean = |text: &str| read(text, |node, problems| boolean(node, "b", problems));
        assert_eq!(boolean("true"), Ok(true));
        assert_eq!(boolean("\"false\""), Ok(false));
        assert_eq!(boolean("1"), Err(vec!["s:1:1: b: found 1, expected true or false".to_owned()]));
        assert!(boolean("\"True\"").is_err());
    }

    #[test]
    fn numbers_stay_within_single_precision() {
        let number = |text: &str, range: &Range| read(text, |node, problems| number(node, "n", range, problems));
        assert_eq!(number("-1.5e3", &Range::ANY), Ok(-1500.0));
        assert!(number("1e39", &Range::ANY).is_err());
        assert!(number("1e999", &Range::ANY).is_err());
        assert!(number("-1e999", &Range::ANY).is_err());
        assert!(number("1e-50", &Range::POSITIVE).is_err());
        assert_eq!(number("0", &Range::NOT_NEGATIVE), Ok(0.0));
        assert!(number("180", &Range::ANGLE).is_err());
        let quoted = number("\"45\"", &Range::ANGLE).unwrap_err();
        assert!(quoted[0].ends_with("(write it without quotes)"), "{}", quoted[0]);
    }

    #[test]
    fn whole_numbers() {
        let whole = |text: &str| read(text, |node, problems| whole(node, "n", 1, "a whole number >= 1", problems));
        assert_eq!(whole("640"), Ok(640));
        assert_eq!(whole("640.0"), Ok(640));
        for wrong in ["0", "-1", "0.5", "1e999", "\"3\"", "null"] {
            let errors = whole(wrong).unwrap_err();
            assert_eq!(errors.len(), 1);
            assert!(errors[0].ends_with("expected a whole number >= 1"), "{}", errors[0]);
        }
    }

    #[test]
    fn all_components_get_their_message() {
        let color = |text: &str| read(text, |node, problems| color(node, "color", &Range::UNIT, problems));
        assert_eq!(color(r#"{"r": 0, "g": 0.5, "b": 1}"#), Ok([0.0, 0.5, 1.0]));
        assert_eq!(color(r#"{"r": 2, "b": -1}"#).unwrap_err().len(), 3);
    }
}
