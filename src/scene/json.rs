//! JSON as a tree that knows where each key and value stands. The only file that names `serde_json`.
//!
//! `serde_json` checks the grammar and splits each level into raw slices of the source text; a slice's position in the
//! text is the value's place, so that mistakes of meaning get a line and column as well as those of grammar.

use std::{collections::HashMap, fmt};

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;

use super::problems::Problems;

/// Deepest nesting of lists and objects that is read; a scene needs four levels.
const MAX_DEPTH: usize = 64;

/// A value and the byte offset at which it begins.
#[derive(Debug)]
pub(super) struct Node {
    pub at: usize,
    pub value: Value,
}

/// What a [`Node`] is.
#[derive(Debug)]
pub(super) enum Value {
    Null,
    Bool(bool),
    /// Infinite where the text is beyond the range of `f64`.
    Number {
        value: f64,
        text: String,
    },
    Text(String),
    List(Vec<Node>),
    /// Entries in the order of the file.
    Map(Vec<Entry>),
}

/// A key, the byte offset at which it begins, and its value.
#[derive(Debug)]
pub(super) struct Entry {
    pub key: String,
    pub at: usize,
    pub node: Node,
}

impl Node {
    /// How a message names this value.
    pub fn describe(&self) -> String {
        match &self.value {
            Value::Null => "null".to_owned(),
            Value::Bool(value) => value.to_string(),
            Value::Number { text, .. } => shorten(text),
            Value::Text(text) => format!("{:?}", shorten(text)),
            Value::List(_) => "a list".to_owned(),
            Value::Map(_) => "an object".to_owned(),
        }
    }
}

/// At most 60 characters of `text`, so that a message stays readable.
pub(super) fn shorten(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}...", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}

/// Reads the document `text`; `None` where it is not JSON, with the mistake noted in `problems`. A key that is given
/// twice is a mistake, too, but leaves the document readable: the first counts.
pub(super) fn parse(text: &str, problems: &mut Problems) -> Option<Node> {
    match serde_json::from_str::<&RawValue>(text) {
        Ok(raw) => Tree { text, problems }.node(raw, Path::new(""), 0),
        Err(error) => {
            grammar(text, &error, problems);
            None
        }
    }
}

/// Notes a mistake of grammar.
fn grammar(text: &str, error: &serde_json::Error, problems: &mut Problems) {
    let at = problems.offset(error.line(), error.column());
    let message = message(error);
    if error.is_eof() {
        problems.error(at, "", message, "a complete JSON document");
        return;
    }
    let (before, rest) = text.split_at_checked(at).unwrap_or((text, ""));
    let (found, hint) = match rest.chars().next() {
        Some(']' | '}') if before.trim_end().ends_with(',') => (None, "the comma before it is one too many"),
        Some('/' | '#') => (None, "JSON has no comments, but every object may have a `comment`"),
        _ if message.starts_with("expected") || message.starts_with("key must") => (None, message.as_str()),
        _ => (Some(message.clone()), ""),
    };
    let found = found.or_else(|| rest.chars().next().map(|character| format!("`{character}`")));
    let hint = (!hint.is_empty()).then(|| hint.to_owned());
    problems.error_with_hint(at, "", found.unwrap_or_else(|| message.clone()), "valid JSON", hint);
}

/// What `serde_json` says, without the place.
fn message(error: &serde_json::Error) -> String {
    let message = error.to_string();
    message.split(" at line ").next().unwrap_or_default().to_owned()
}

struct Tree<'a, 'p, 'f> {
    text: &'a str,
    problems: &'p mut Problems<'f>,
}

impl<'a> Tree<'a, '_, '_> {
    fn node(&mut self, raw: &'a RawValue, path: Path, depth: usize) -> Option<Node> {
        let at = self.offset(raw);
        let text = raw.get();
        if depth > MAX_DEPTH {
            self.problems.error(at, path, "deeper nesting", format!("at most {MAX_DEPTH} levels"));
            return None;
        }
        let value = match text.as_bytes().first() {
            Some(b'{') => Value::Map(self.map(raw, path, depth)?),
            Some(b'[') => {
                let items = self.read::<Vec<&'a RawValue>>(raw, path)?.into_iter().enumerate();
                let nodes = items.map(|(i, item)| self.node(item, path.item(i), depth + 1));
                Value::List(nodes.collect::<Option<_>>()?)
            }
            Some(b'"') => Value::Text(self.read(raw, path)?),
            Some(b't') => Value::Bool(true),
            Some(b'f') => Value::Bool(false),
            Some(b'n') | None => Value::Null,
            Some(_) => {
                // `f64`'s own parser turns what is too large into infinity, which the readers then name.
                Value::Number { value: text.parse().unwrap_or(f64::NAN), text: text.to_owned() }
            }
        };
        Some(Node { at, value })
    }

    fn map(&mut self, raw: &'a RawValue, path: Path, depth: usize) -> Option<Vec<Entry>> {
        let mut entries = Vec::new();
        let mut places = HashMap::new();
        for (raw_key, raw_value) in self.read::<Pairs>(raw, path)?.0 {
            let at = self.offset(raw_key);
            let key: String = self.read(raw_key, path)?;
            let path = path.key(&key);
            let node = self.node(raw_value, path, depth + 1)?;
            if let Some(&first) = places.get(&key) {
                let (line, column) = self.problems.place(first);
                let found = format!("the key a second time, after line {line}, column {column}");
                self.problems.error(at, path, found, "each key once");
                continue;
            }
            places.insert(key.clone(), at);
            entries.push(Entry { key, at, node });
        }
        Some(entries)
    }

    /// Reads one level. The grammar is known to be right; what can fail is a string with half a surrogate pair.
    fn read<T: Deserialize<'a>>(&mut self, raw: &'a RawValue, path: Path) -> Option<T> {
        serde_json::from_str(raw.get())
            .map_err(|error| {
                self.problems.error(self.offset(raw), path, message(&error), "valid JSON");
            })
            .ok()
    }

    fn offset(&self, raw: &RawValue) -> usize {
        (raw.get().as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize)
    }
}

/// Where a value stands in the document, such as `materials[2].color`: spelt out only in messages, of which there are few.
#[derive(Clone, Copy)]
pub(super) struct Path<'p> {
    parent: Option<&'p Path<'p>>,
    step: Step<'p>,
}

#[derive(Clone, Copy)]
enum Step<'p> {
    /// Spelt out already; empty for the document itself.
    Spelt(&'p str),
    Key(&'p str),
    Item(usize),
}

impl<'p> Path<'p> {
    /// What `path` says.
    pub fn new(path: &'p str) -> Self {
        Self { parent: None, step: Step::Spelt(path) }
    }

    /// The value of `key` in it.
    pub fn key(&'p self, key: &'p str) -> Self {
        Self { parent: Some(self), step: Step::Key(key) }
    }

    /// One of its items.
    fn item(&'p self, i: usize) -> Self {
        Self { parent: Some(self), step: Step::Item(i) }
    }

    fn is_empty(&self) -> bool {
        self.parent.is_none() && matches!(self.step, Step::Spelt(""))
    }
}

impl fmt::Display for Path<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if let Some(parent) = self.parent {
            parent.fmt(f)?;
        }
        match self.step {
            Step::Spelt(path) => f.write_str(path),
            Step::Key(key) if self.parent.is_none_or(Path::is_empty) => f.write_str(&shorten(key)),
            Step::Key(key) => write!(f, ".{}", shorten(key)),
            Step::Item(i) => write!(f, "[{i}]"),
        }
    }
}

/// An object's keys and values in the order of the file, repeated keys included.
struct Pairs<'a>(Vec<(&'a RawValue, &'a RawValue)>);

impl<'de: 'a, 'a> Deserialize<'de> for Pairs<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Vec<(&'de RawValue, &'de RawValue)>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("an object")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(pairs)
            }
        }
        deserializer.deserialize_map(InOrder).map(Pairs)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path as FilePath;

    use super::*;

    fn errors(text: &str) -> Vec<String> {
        let mut problems = Problems::new(FilePath::new("s"), text);
        let _ = parse(text, &mut problems);
        problems.into_parts().0.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn values_and_keys_know_their_offsets() {
        let text = " {\"a\": [1, {\"b\\n\": \"x\"}], \"c\": null}";
        let mut problems = Problems::new(FilePath::new("s"), text);
        let Some(Node { at: 1, value: Value::Map(entries) }) = parse(text, &mut problems) else { panic!() };
        assert_eq!((entries[0].key.as_str(), entries[0].at, entries[0].node.at), ("a", 2, 7));
        let Value::List(items) = &entries[0].node.value else { panic!() };
        let Value::Map(inner) = &items[1].value else { panic!() };
        assert_eq!((inner[0].key.as_str(), inner[0].at), ("b\n", 12));
        assert_eq!((entries[1].key.as_str(), entries[1].at, entries[1].node.at), ("c", 26, 31));
        assert!(problems.into_parts().0.is_empty());
    }

    #[test]
    fn repeated_keys_are_named_with_both_places() {
        assert_eq!(
            errors("{\"a\": 1,\n \"a\": 2}"),
            ["s:2:2: a: found the key a second time, after line 1, column 2, expected each key once"]
        );
    }

    #[test]
    fn deep_nesting_is_refused_without_deep_recursion() {
        let text = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
        let errors = errors(&text);
        assert_eq!(errors.len(), 1);
        assert!(errors[0].starts_with("s:1:66: [0][0]"), "{}", &errors[0][..40]);
        assert!(errors[0].ends_with("[0]: found deeper nesting, expected at most 64 levels"));
    }

    #[test]
    fn half_a_surrogate_pair_is_a_mistake() {
        let errors = errors("{\"a\":\n \"\\ud800\"}");
        assert_eq!(errors.len(), 1);
        assert!(errors[0].starts_with("s:2:2: a: found "), "{}", errors[0]);
    }

    #[test]
    fn common_slips_of_grammar_have_a_remedy() {
        assert_eq!(errors("[1, ]"), ["s:1:5: found `]`, expected valid JSON (the comma before it is one too many)"]);
        assert_eq!(errors("{1: 2}"), ["s:1:2: found `1`, expected valid JSON (key must be a string)"]);
        assert_eq!(errors("[01]"), ["s:1:3: found invalid number, expected valid JSON"]);
        assert!(
            errors("[1, // one\n 2]")[0].starts_with("s:1:5: found `/`, expected valid JSON (JSON has no comments")
        );
    }

    #[test]
    fn grammar_is_placed_in_characters() {
        assert_eq!(errors("{\"ä\" 1}"), ["s:1:6: found `1`, expected valid JSON (expected `:`)"]);
        assert_eq!(errors("[1,\n"), ["s:2:1: found EOF while parsing a value, expected a complete JSON document"]);
    }
}
