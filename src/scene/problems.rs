//! Collects every mistake of a scene, each with its place in the file.

use std::fmt::Display;
use std::path::Path;

use crate::error::Problem;

/// Most mistakes that are kept of a scene, and most warnings: of the others there is only the number.
pub(super) const MAX_PROBLEMS: usize = 100;
/// Most characters of a path; of a longer one the middle is left out.
const MAX_PATH: usize = 240;
/// Bytes from one count of characters to the next.
const STRIDE: usize = 1024;

/// The mistakes and warnings found so far in one scene file and its meshes.
pub(super) struct Problems<'a> {
    file: &'a Path,
    text: &'a str,
    line_starts: Vec<usize>,
    /// Characters that begin before each multiple of [`STRIDE`]: a long line is not walked for each of its mistakes.
    characters: Vec<usize>,
    errors: Kept,
    warnings: Kept,
}

impl<'a> Problems<'a> {
    /// Nothing found yet in `file`, which holds `text`.
    pub fn new(file: &'a Path, text: &'a str) -> Self {
        let newlines = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n').map(|(at, _)| at + 1);
        let line_starts = std::iter::once(0).chain(newlines).collect();
        let mut characters = vec![0];
        let mut sum = 0;
        for bytes in text.as_bytes().chunks(STRIDE) {
            sum += beginning(bytes);
            characters.push(sum);
        }
        Self { file, text, line_starts, characters, errors: Kept::default(), warnings: Kept::default() }
    }

    /// The scene file.
    pub fn file(&self) -> &'a Path {
        self.file
    }

    /// Whether no further mistake is kept, so that none need be explained.
    pub fn is_full(&self) -> bool {
        self.errors.is_full()
    }

    /// 1-based line and column (in characters) of the byte offset `at`.
    pub fn place(&self, at: usize) -> (usize, usize) {
        let line = self.line_starts.partition_point(|&start| start <= at);
        let start = self.line_starts.get(line.saturating_sub(1)).copied().unwrap_or(0);
        (line, self.characters_before(at).saturating_sub(self.characters_before(start)) + 1)
    }

    /// Characters that begin before the byte offset `at`.
    fn characters_before(&self, at: usize) -> usize {
        let at = at.min(self.text.len());
        let counted = self.characters.get(at / STRIDE).copied().unwrap_or(0);
        counted + beginning(&self.text.as_bytes()[at - at % STRIDE..at])
    }

    /// Byte offset of a 1-based line and a 1-based column in bytes.
    pub fn offset(&self, line: usize, byte_column: usize) -> usize {
        let start = self.line_starts.get(line.saturating_sub(1)).copied().unwrap_or(self.text.len());
        (start + byte_column.saturating_sub(1)).min(self.text.len())
    }

    /// Notes a mistake at byte offset `at`.
    pub fn error(&mut self, at: usize, path: impl Display, found: impl Into<String>, expected: impl Into<String>) {
        self.error_with_hint(at, path, found, expected, None);
    }

    /// Notes a mistake together with its remedy.
    pub fn error_with_hint(
        &mut self,
        at: usize,
        path: impl Display,
        found: impl Into<String>,
        expected: impl Into<String>,
        hint: Option<String>,
    ) {
        let kept = (!self.is_full()).then(|| self.problem(at, &path, found.into(), expected.into(), hint));
        self.errors.add(kept);
    }

    /// Notes a mistake in a file other than the scene.
    pub fn error_elsewhere(&mut self, problem: Problem) {
        self.errors.add(Some(problem));
    }

    /// Notes what is odd but no obstacle: what is expected, and a remedy, are made where they are kept.
    pub fn warning(
        &mut self,
        at: usize,
        path: impl Display,
        found: &str,
        rest: impl FnOnce() -> (String, Option<String>),
    ) {
        let kept = (!self.warnings.is_full()).then(|| {
            let (expected, hint) = rest();
            self.problem(at, &path, found.to_owned(), expected, hint)
        });
        self.warnings.add(kept);
    }

    /// Errors and warnings: those of the scene file in its order, then those of the meshes, then the number of those that were
    /// not kept.
    pub fn into_parts(self) -> (Vec<Problem>, Vec<Problem>) {
        (self.errors.into_sorted(self.file, "mistakes"), self.warnings.into_sorted(self.file, "warnings"))
    }

    fn problem(&self, at: usize, path: &dyn Display, found: String, expected: String, hint: Option<String>) -> Problem {
        let (place, path) = (Some(self.place(at)), shorten_path(path.to_string()));
        Problem { file: self.file.to_owned(), place, path, found, expected, hint }
    }
}

/// The first [`MAX_PROBLEMS`] that are found, and the number of the others.
#[derive(Default)]
struct Kept {
    first: Vec<Problem>,
    others: usize,
}

impl Kept {
    fn is_full(&self) -> bool {
        self.first.len() >= MAX_PROBLEMS
    }

    fn add(&mut self, problem: Option<Problem>) {
        match problem {
            Some(problem) if !self.is_full() => self.first.push(problem),
            _ => self.others += 1,
        }
    }

    fn into_sorted(mut self, scene: &Path, what: &str) -> Vec<Problem> {
        self.first.sort_by(|a, b| {
            (a.file != scene).cmp(&(b.file != scene)).then_with(|| {
                // The meshes keep the order in which objects name them.
                if a.file == scene { a.place.cmp(&b.place) } else { std::cmp::Ordering::Equal }
            })
        });
        if self.others > 0 {
            let (found, expected) = (format!("{} more {what}", self.others), "none".to_owned());
            let (file, path) = (scene.to_owned(), String::new());
            self.first.push(Problem { file, place: None, path, found, expected, hint: None });
        }
        self.first
    }
}

/// How many characters begin in `bytes` of UTF-8: bytes 10xxxxxx go on with one.
fn beginning(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte & 0xC0 != 0x80).count()
}

fn shorten_path(path: String) -> String {
    let characters = path.chars().count();
    if characters <= MAX_PATH {
        return path;
    }
    let start: String = path.chars().take(MAX_PATH / 2).collect();
    let end: String = path.chars().skip(characters - MAX_PATH / 2).collect();
    format!("{start}...{end}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let problems = Problems::new(Path::new("s"), "{\n \"ä\": 1\n}");
        assert_eq!(problems.place(0), (1, 1));
        assert_eq!(problems.place(2), (2, 1));
        assert_eq!(problems.place(9), (2, 7), "the digit, after a letter of two bytes");
        assert_eq!(problems.place(11), (3, 1));
        assert_eq!(problems.offset(3, 1), 11);
        assert_eq!(problems.offset(9, 9), 12, "beyond the end is the end");
    }
    #[test]
    fn columns_of_long_lines_are_those_of_short_ones() {
        let text = format!("{}\n{}", "äb".repeat(3000), "b€".repeat(3000));
        let problems = Problems::new(Path::new("s"), &text);
        for (line, start) in [(1, 0), (2, 9001)] {
            for (column, (at, _)) in text[start..].lines().next().unwrap().char_indices().enumerate() {
                assert_eq!(problems.place(start + at), (line, column + 1));
            }
        }
        assert_eq!(problems.place(text.len()), (2, 6001));
    }

    #[test]
    fn the_first_are_kept_and_the_others_counted() {
        let mut problems = Problems::new(Path::new("s"), "12");
        for i in 0..MAX_PROBLEMS + 5 {
            problems.error(1 - i.min(1), "a", "b", "c");
            problems.warning(0, "a", "b", || ("c".to_owned(), None));
        }
        problems.warning(0, "a", "b", || unreachable!("it is not kept"));
        let (errors, warnings) = problems.into_parts();
        assert_eq!((errors.len(), warnings.len()), (MAX_PROBLEMS + 1, MAX_PROBLEMS + 1));
        assert_eq!(errors[MAX_PROBLEMS - 1].to_string(), "s:1:2: a: found b, expected c", "sorted");
        assert_eq!(errors[MAX_PROBLEMS].to_string(), "s: found 5 more mistakes, expected none");
        assert_eq!(warnings[MAX_PROBLEMS].to_string(), "s: found 6 more warnings, expected none");
    }

    #[test]
    fn long_paths_lose_their_middle() {
        assert_eq!(shorten_path("ä".repeat(MAX_PATH)), "ä".repeat(MAX_PATH));
        let short = shorten_path(format!("start{}end", "ä".repeat(MAX_PATH)));
        assert_eq!(short.chars().count(), MAX_PATH + 3);
        assert!(short.starts_with("startä") && short.contains("ä...ä") && short.ends_with("äend"), "{short}");
    }
}
