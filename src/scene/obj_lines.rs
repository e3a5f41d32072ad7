//! The statements of an OBJ file that make its surface, checked and in a form that every OBJ parser agrees upon.
//!
//! [`Lines`] stands between the file and the parser: it lets `v`, `vn` and `f` through and nothing else, without
//! comments, continuations and vertex colours, and ends in an error before the parser meets an index that is out of
//! range. It checks no more than costs little; [`diagnose`] finds all mistakes once it is known that there is one.

use std::io::{self, BufRead, Read};
use std::ops::Range;

use super::fields::fits_single;
use super::json::shorten;

/// Most mistakes that are named of one mesh.
const MAX_FLAWS: usize = 20;

/// A mistake and the byte offset at which it stands; none where it concerns the whole file.
#[derive(Debug)]
pub(super) struct Flaw {
    pub at: Option<usize>,
    pub found: String,
    pub expected: String,
}

impl Flaw {
    fn new(at: usize, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { at: Some(at), found: found.into(), expected: expected.into() }
    }
}

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
        self.check.smooth
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
    let mut check = Check { totals: Some([0; 2]), ..Check::default() };
    let mut totals = [0; 2];
    for_each_line(text, &mut scratch, |_, line| match Words::new(line).next() {
        Some((_, b"v")) => totals[POSITION] += 1,
        Some((_, b"vn")) => totals[NORMAL] += 1,
        _ => {}
    });
    check.totals = Some(totals);
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
    let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
    rest.get(..end).unwrap_or_default()
}

/// Where the `\` stands that joins this line with the next; one in a comment joins nothing.
fn continuation(line: &[u8]) -> Option<usize> {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    let (last, before) = line.split_last()?;
    (*last == b'\\' && !before.contains(&b'#')).then_some(before.len())
}

/// What the parser gets of a line.
enum Take {
    Skip,
    Whole,
    Until(usize),
}

const POSITION: usize = 0;
const NORMAL: usize = 1;

/// Checks line by line. Offsets in its mistakes count from the start of the line.
#[derive(Default)]
struct Check {
    /// Positions and normals so far.
    counts: [i64; 2],
    /// Largest index of a position and of a normal so far; they may precede what they name.
    furthest: [i64; 2],
    /// Positions and normals of the whole file; where known, numbers are checked as well.
    totals: Option<[i64; 2]>,
    smooth: Vec<bool>,
}

impl Check {
    fn all_in_range(&self) -> bool {
        self.furthest.iter().zip(self.counts).all(|(&furthest, count)| furthest <= count)
    }

    fn line(&mut self, line: &[u8]) -> Result<Take, Flaw> {
        let mut words = Words::new(line);
        match words.next() {
            Some((_, b"v")) => {
                self.counts[POSITION] += 1;
                self.position(words)
            }
            Some((_, b"vn")) => {
                self.counts[NORMAL] += 1;
                self.numbers(words, 3, "x, y and z of a normal")
            }
            Some((_, b"f")) => self.face(words),
            _ => Ok(Take::Skip),
        }
    }

    fn position(&self, words: Words) -> Result<Take, Flaw> {
        let expected = "x, y and z, alone or with w or with a colour";
        match words.clone().count() {
            4 => {
                let take = self.numbers(words.clone(), 4, expected)?;
                self.divisible(words)?;
                Ok(take)
            }
            5 => Err(Flaw::new(words.start(), "5 numbers", expected)),
            _ => self.numbers(words, 3, expected),
        }
    }

    /// Takes the first `count` words, which are numbers.
    fn numbers(&self, mut words: Words, count: usize, expected: &str) -> Result<Take, Flaw> {
        let start = words.start();
        let mut end = 0;
        for i in 0..count {
            let Some((at, word)) = words.next() else {
                let found = if i == 1 { "1 number".to_owned() } else { format!("{i} numbers") };
                return Err(Flaw::new(start, found, expected));
            };
            end = at + word.len();
            if self.totals.is_some() {
                number(at, word)?;
            }
        }
        Ok(if words.at_end() { Take::Whole } else { Take::Until(end) })
    }

    /// Whether x, y and z divided by w are still numbers.
    fn divisible(&self, mut words: Words) -> Result<(), Flaw> {
        if self.totals.is_none() {
            return Ok(());
        }
        let mut xyzw = [0.0; 4];
        let mut last = (0, &b""[..]);
        for value in &mut xyzw {
            last = words.next().unwrap_or(last);
            *value = number(last.0, last.1)?;
        }
        let [x, y, z, w] = xyzw;
        if w == 0.0 || [x, y, z].iter().any(|value| !fits_single(value / w)) {
            return Err(Flaw::new(last.0, quote(last.1), "a w by which x, y and z can be divided"));
        }
        Ok(())
    }

    fn face(&mut self, mut words: Words) -> Result<Take, Flaw> {
        let start = words.start();
        let mut corners = 0_usize;
        let mut end = 0;
        let mut smooth = false;
        for (at, word) in words.by_ref() {
            let Some([position, _, normal]) = corner(word) else {
                return Err(Flaw::new(at, quote(word), "a corner as v, v/vt, v//vn or v/vt/vn"));
            };
            let Some(position) = position else {
                return Err(Flaw::new(at, quote(word), "a corner that begins with the index of its vertex"));
            };
            self.index(POSITION, at, position)?;
            if let Some(normal) = normal {
                self.index(NORMAL, at, normal)?;
            }
            if corners > 0 && smooth != normal.is_some() {
                let (this, others) = if smooth { ("without", "with") } else { ("with", "without") };
                let found = format!("a corner {this} a normal after one {others}");
                return Err(Flaw::new(at, found, "all corners of a face with a normal or none"));
            }
            smooth = normal.is_some();
            corners += 1;
            end = at + word.len();
        }
        if corners < 3 {
            let found = format!("a face of {corners} {}", if corners == 1 { "corner" } else { "corners" });
            return Err(Flaw::new(start, found, "at least 3 corners"));
        }
        self.smooth.extend(std::iter::repeat_n(smooth, corners - 2));
        Ok(if words.at_end() { Take::Whole } else { Take::Until(end) })
    }

    fn index(&mut self, of: usize, at: usize, index: i64) -> Result<(), Flaw> {
        let name = ["vertex", "normal"][of];
        let count = self.counts[of];
        if index == 0 {
            return Err(Flaw::new(at, format!("{name} 0"), "indices counted from 1, or from -1 backwards"));
        }
        if index < 0 && index < -count {
            let expected = format!("-1 back to -{count}, as {count} are given above");
            let expected = if count == 0 { format!("a positive index, as no {name} is given above") } else { expected };
            return Err(Flaw::new(at, format!("{name} {index}"), expected));
        }
        match self.totals {
            Some(totals) if index > totals[of] => {
                let expected = match totals[of] {
                    0 => format!("none, as the file has no {name}"),
                    total => format!("1 to {total}, as many as the file has"),
                };
                Err(Flaw::new(at, format!("{name} {index}"), expected))
            }
            _ => {
                self.furthest[of] = self.furthest[of].max(index);
                Ok(())
            }
        }
    }
}

fn number(at: usize, word: &[u8]) -> Result<f64, Flaw> {
    let value = std::str::from_utf8(word).ok().and_then(|word| word.parse::<f64>().ok());
    match value {
        Some(value) if fits_single(value) => Ok(value),
        Some(_) => Err(Flaw::new(at, quote(word), "a finite number between -3.4e38 and 3.4e38")),
        None => Err(Flaw::new(at, quote(word), "a number")),
    }
}

fn quote(word: &[u8]) -> String {
    format!("`{}`", shorten(&String::from_utf8_lossy(word)))
}

/// The indices of `v/vt/vn`, each of which may be left out; none where it has another form.
fn corner(word: &[u8]) -> Option<[Option<i64>; 3]> {
    let mut indices = [None; 3];
    let mut field = 0;
    let mut negative = false;
    let mut digits = false;
    for &byte in word {
        match byte {
            b'0'..=b'9' => {
                digits = true;
                let index = indices.get_mut(field)?;
                // Far beyond any count, yet safe to negate and to count on from.
                *index = Some((index.unwrap_or(0) * 10 + i64::from(byte - b'0')).min(i64::MAX / 100));
            }
            b'-' if !negative && !digits => negative = true,
            b'/' => {
                sign(indices.get_mut(field)?, negative, digits)?;
                (field, negative, digits) = (field + 1, false, false);
            }
            _ => return None,
        }
    }
    sign(indices.get_mut(field)?, negative, digits)?;
    Some(indices)
}

fn sign(index: &mut Option<i64>, negative: bool, digits: bool) -> Option<()> {
    if negative {
        *index = index.map(|index| -index);
    }
    (digits || !negative).then_some(())
}

/// The words of a line up to its comment, each with its offset.
#[derive(Clone)]
struct Words<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    fn new(line: &'a [u8]) -> Self {
        let mut words = Self { line, at: 0 };
        words.skip_space();
        words
    }

    /// Where the next word begins, or the line ends.
    fn start(&self) -> usize {
        self.at
    }

    /// Whether nothing follows, not even a comment.
    fn at_end(&self) -> bool {
        self.at >= self.line.len()
    }

    fn skip_space(&mut self) {
        while self.line.get(self.at).is_some_and(is_space) {
            self.at += 1;
        }
    }
}

fn is_space(byte: &u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\x0b' | b'\x0c')
}

impl<'a> Iterator for Words<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let start = self.at;
        while self.line.get(self.at).is_some_and(|byte| !is_space(byte) && *byte != b'#') {
            self.at += 1;
        }
        let word = self.line.get(start..self.at)?;
        self.skip_space();
        (!word.is_empty()).then_some((start, word))
    }
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
    fn corners() {
        assert_eq!(corner(b"1"), Some([Some(1), None, None]));
        assert_eq!(corner(b"-1//-23"), Some([Some(-1), None, Some(-23)]));
        assert_eq!(corner(b"4/5/6"), Some([Some(4), Some(5), Some(6)]));
        assert_eq!(corner(b"4/5/"), Some([Some(4), Some(5), None]));
        assert_eq!(corner(b"/1"), Some([None, Some(1), None]));
        for wrong in ["1/2/3/4", "a", "1.0", "--1", "-", "1-", "1/-/2", "+1"] {
            assert_eq!(corner(wrong.as_bytes()), None, "{wrong}");
        }
    }

    #[test]
    fn offsets_hold_across_continued_lines() {
        let flaws = diagnose(b"v 0 0 0\nv 1 0 \\\n nan\n");
        assert_eq!(flaws.len(), 1);
        assert_eq!(flaws[0].at, Some(17));
        assert_eq!(flaws[0].found, "`nan`");
    }
}
