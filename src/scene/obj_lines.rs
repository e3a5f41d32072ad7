//! The statements of an OBJ file that make its surface, checked and in a form that every OBJ parser agrees upon.
//!
//! [`Lines`] stands between the file and the parser: it lets `v`, `vn` and `f` through and nothing else, without
//! comments, continuations and vertex colours, and ends in an error before the parser meets an index that is out of
//! range. It checks no more than costs little; [`diagnose`] finds all mistakes once it is known that there is one.

use std::io::{self, BufRead, Read};
use std::ops::Range;

use super::obj_check::{Check, Flaw, NORMAL, POSITION, Take, Words};

/// Most mistakes that are named of one mesh.
const MAX_FLAWS: usize = 20;

/// The surface statements of an OBJ file, as a reader.
pub(super) struct Lines<'a> {
    text: &'a [u8],
    /// Where the next line begins.
    next: usize,
    /// What of `text` is still to be read, else of `scratch`.
    pending: Range<usize>,
    from_scratch: bool,
    scratch: Vec<u8>,
    check: Check,
}

impl<'a> Lines<'a> {
    /// Reads `text` from its start.
    pub fn new(text: &'a [u8]) -> Self {
        let scratch = Vec::new();
        Self { text, next: 0, pending: 0..0, from_scratch: false, scratch, check: Check::default() }
    }

    /// Per triangle of the fans read so far, whether it has normals.
    pub fn into_smooth(self) -> Vec<bool> {
        self.check.into_smooth()
    }

    /// Makes the next surface statement pending; nothing is pending after the last one.
    fn advance(&mut self) -> io::Result<()> {
        while self.next < self.text.len() {
            let start = self.next;
            let (line, joined) = logical_line(self.text, start, &mut self.scratch);
            self.next = (start + line.len() + 1).min(self.text.len());
            let take = self.check.line(line).map_err(|_| io::Error::from(io::ErrorKind::InvalidData))?;
            let end = match take {
                Take::Skip => continue,
                Take::Whole if !joined => {
                    self.from_scratch = false;
                    self.pending = start..self.next;
                    return Ok(());
                }
                Take::Whole => line.len(),
                Take::Until(end) => end,
            };
            if !joined {
                self.scratch.clear();
                self.scratch.extend_from_slice(self.text.get(start..start + end).unwrap_or_default());
            }
            self.scratch.truncate(end);
            self.scratch.push(b'\n');
            self.from_scratch = true;
            self.pending = 0..self.scratch.len();
            return Ok(());
        }
        match self.check.all_in_range() {
            true => Ok(()),
            false => Err(io::Error::from(io::ErrorKind::InvalidData)),
        }
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.pending.is_empty() {
            self.advance()?;
        }
        let from = if self.from_scratch { &self.scratch } else { self.text };
        Ok(from.get(self.pending.clone()).unwrap_or_default())
    }

    fn consume(&mut self, amount: usize) {
        self.pending.start = (self.pending.start + amount).min(self.pending.end);
    }
}

impl Read for Lines<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(out)?;
        self.consume(read);
        Ok(read)
    }
}

/// All mistakes of an OBJ file in their order; of very many the first ones and a count.
pub(super) fn diagnose(text: &[u8]) -> Vec<Flaw> {
    let mut scratch = Vec::new();
    let mut totals = [0; 2];
    for_each_line(text, &mut scratch, |_, line| match Words::new(line).next() {
        Some((_, b"v")) => totals[POSITION] += 1,
        Some((_, b"vn")) => totals[NORMAL] += 1,
        _ => {}
    });
    let mut check = Check::strict(totals);
    let mut flaws = Vec::new();
    let mut more = 0_usize;
    for_each_line(text, &mut scratch, |start, line| {
        if let Err(flaw) = check.line(line) {
            if flaws.len() < MAX_FLAWS {
                flaws.push(Flaw { at: flaw.at.map(|at| start + at), ..flaw });
            } else {
                more += 1;
            }
        }
    });
    if more > 0 {
        flaws.push(Flaw { at: None, found: format!("{more} more mistakes"), expected: "none".to_owned() });
    }
    flaws
}

fn for_each_line(text: &[u8], scratch: &mut Vec<u8>, mut visit: impl FnMut(usize, &[u8])) {
    let mut start = 0;
    while start < text.len() {
        let (line, _) = logical_line(text, start, scratch);
        visit(start, line);
        start += line.len() + 1;
    }
}

/// The line that begins at `start`, without its end. Where a surface statement goes on behind a `\`, the lines are
/// joined in `scratch`, byte for byte, so that offsets stay what they are.
fn logical_line<'t>(text: &'t [u8], start: usize, scratch: &'t mut Vec<u8>) -> (&'t [u8], bool) {
    let rest = text.get(start..).unwrap_or_default();
    let line = physical_line(rest);
    if continuation(line).is_none() || !matches!(Words::new(line).next(), Some((_, b"v" | b"vn" | b"f"))) {
        return (line, false);
    }
    scratch.clear();
    let mut line = line;
    loop {
        let from = scratch.len();
        scratch.extend_from_slice(line);
        let Some(backslash) = continuation(line) else { break };
        if let Some(gap) = scratch.get_mut(from + backslash..) {
            gap.fill(b' ');
        }
        if scratch.len() >= rest.len() {
            break;
        }
        scratch.push(b' ');
        line = physical_line(rest.get(scratch.len()..).unwrap_or_default());
    }
    (scratch, true)
}

fn physical_line(rest: &[u8]) -> &[u8] {
    // Reading from a slice never fails; it is the standard library's fast search for a byte.
    let end = { rest }.skip_until(b'\n').unwrap_or(rest.len());
    let line = rest.get(..end).unwrap_or_default();
    line.strip_suffix(b"\n").unwrap_or(line)
}

/// Where the `\` stands that joins this line with the next; one in a comment joins nothing.
fn continuation(line: &[u8]) -> Option<usize> {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    let (last, before) = line.split_last()?;
    (*last == b'\\' && !before.contains(&b'#')).then_some(before.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passed(text: &str) -> io::Result<String> {
        let mut out = String::new();
        Lines::new(text.as_bytes()).read_to_string(&mut out).map(|_| out)
    }

    #[test]
    fn only_the_surface_passes() {
        let text = "# C:\\models\\\nmtllib no.mtl\r\no a\nv 1 2 3\r\n\tv\t1 2 3 0.5 0.5 0.5\nv 1 2 3 # c\nvt 0 0\ns off\n\
                    l 1 2 3\np 1\nf 1 2 3 #c\nf 1 \\\n2 \\\r\n 3\nf 1 2 3";
        assert_eq!(passed(text).unwrap(), "v 1 2 3\r\n\tv\t1 2 3\nv 1 2 3\nf 1 2 3\nf 1   2     3\nf 1 2 3");
    }

    #[test]
    fn what_the_parser_would_trip_over_ends_in_an_error() {
        let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        for face in ["f 1 2 4", "f 0 1 2", "f -4 1 2", "f 1//1 2//1 3//1", "f 1 2", "f 1//9223372036854775808 2 3", "f"]
        {
            assert!(passed(&format!("{vertices}{face}\n")).is_err(), "{face}");
            assert_eq!(diagnose(format!("{vertices}{face}\n").as_bytes()).len(), 1, "{face}");
        }
        assert!(passed("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").is_ok(), "a face may precede its vertices");
    }

    #[test]
    fn offsets_hold_across_continued_lines() {
        let flaws = diagnose(b"v 0 0 0\nv 1 0 \\\n nan\n");
        assert_eq!(flaws.len(), 1);
        assert_eq!(flaws[0].at, Some(17));
        assert_eq!(flaws[0].found, "`nan`");
    }
}
