//! Collects every mistake of a scene, each with its place in the file.

use std::path::Path;

use crate::error::Problem;

/// The mistakes and warnings found so far in one scene file and its meshes.
pub(super) struct Problems<'a> {
    file: &'a Path,
    text: &'a str,
    line_starts: Vec<usize>,
    ascii: bool,
    errors: Vec<Problem>,
    warnings: Vec<Problem>,
}

impl<'a> Problems<'a> {
    /// Nothing found yet in `file`, which holds `text`.
    pub fn new(file: &'a Path, text: &'a str) -> Self {
        let newlines = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n').map(|(at, _)| at + 1);
        let line_starts = std::iter::once(0).chain(newlines).collect();
        Self { file, text, line_starts, ascii: text.is_ascii(), errors: Vec::new(), warnings: Vec::new() }
    }

    /// The scene file.
    pub fn file(&self) -> &'a Path {
        self.file
    }

    /// 1-based line and column (in characters) of the byte offset `at`.
    pub fn place(&self, at: usize) -> (usize, usize) {
        let line = self.line_starts.partition_point(|&start| start <= at);
        let start = self.line_starts.get(line.saturating_sub(1)).copied().unwrap_or(0);
        let bytes = at.saturating_sub(start);
        // A long line of plain ASCII need not be walked for each of its mistakes.
        let column = match self.text.get(start..at) {
            Some(before) if !self.ascii => before.chars().count(),
            _ => bytes,
        };
        (line, column + 1)
    }

    /// Byte offset of a 1-based line and a 1-based column in bytes.
    pub fn offset(&self, line: usize, byte_column: usize) -> usize {
        let start = self.line_starts.get(line.saturating_sub(1)).copied().unwrap_or(self.text.len());
        (start + byte_column.saturating_sub(1)).min(self.text.len())
    }

    /// Notes a mistake at byte offset `at`.
    pub fn error(&mut self, at: usize, path: &str, found: impl Into<String>, expected: impl Into<String>) {
        self.error_with_hint(at, path, found, expected, None);
    }

    /// Notes a mistake together with its remedy.
    pub fn error_with_hint(
        &mut self,
        at: usize,
        path: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
        hint: Option<String>,
    ) {
        let problem = self.problem(at, path, found.into(), expected.into(), hint);
        self.errors.push(problem);
    }

    /// Notes a mistake in a file other than the scene.
    pub fn error_elsewhere(&mut self, problem: Problem) {
        self.errors.push(problem);
    }

    /// Notes what is odd but no obstacle.
    pub fn warning(&mut self, at: usize, path: &str, found: &str, expected: String, hint: Option<String>) {
        let problem = self.problem(at, path, found.to_owned(), expected, hint);
        self.warnings.push(problem);
    }

    /// Errors and warnings: those of the scene file in its order, then those of the meshes.
    pub fn into_parts(mut self) -> (Vec<Problem>, Vec<Problem>) {
        let scene = self.file;
        let order = |a: &Problem, b: &Problem| {
            (a.file != scene).cmp(&(b.file != scene)).then_with(|| {
                // The meshes keep the order in which objects name them.
                if a.file == scene { a.place.cmp(&b.place) } else { std::cmp::Ordering::Equal }
            })
        };
        self.errors.sort_by(order);
        self.warnings.sort_by(order);
        (self.errors, self.warnings)
    }

    fn problem(&self, at: usize, path: &str, found: String, expected: String, hint: Option<String>) -> Problem {
        let place = Some(self.place(at));
        Problem { file: self.file.to_owned(), place, path: path.to_owned(), found, expected, hint }
    }
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
}
