//! Checks the statements of an OBJ file that make its surface: `v`, `vn` and `f`.

use super::fields::fits_single;
use super::json::shorten;

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

/// What the parser gets of a line.
pub(super) enum Take {
    /// Nothing.
    Skip,
    /// All of it.
    Whole,
    /// The bytes up to this offset.
    Until(usize),
}

pub(super) const POSITION: usize = 0;
pub(super) const NORMAL: usize = 1;

/// Checks line by line. Offsets in its mistakes count from the start of the line.
#[derive(Default)]
pub(super) struct Check {
    /// Positions and normals so far.
    counts: [i64; 2],
    /// Largest index of a position and of a normal so far; they may precede what they name.
    furthest: [i64; 2],
    /// Positions and normals of the whole file; where known, every number is read as well.
    totals: Option<[i64; 2]>,
    smooth: Vec<bool>,
}

impl Check {
    /// Checks a file of so many positions and normals to the last number.
    pub fn strict(totals: [i64; 2]) -> Self {
        Self { totals: Some(totals), ..Self::default() }
    }

    /// Per triangle of the fans so far, whether it has normals.
    pub fn into_smooth(self) -> Vec<bool> {
        self.smooth
    }

    /// Whether no face names what the file does not have.
    pub fn all_in_range(&self) -> bool {
        self.furthest.iter().zip(self.counts).all(|(&furthest, count)| furthest <= count)
    }

    /// What the parser gets of `line`, which is without its end.
    pub fn line(&mut self, line: &[u8]) -> Result<Take, Flaw> {
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
                Self::divisible(words)?;
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
            if self.totals.is_some() || !is_plain(word) {
                number(at, word)?;
            }
        }
        Ok(if words.at_end() { Take::Whole } else { Take::Until(end) })
    }

    /// Whether x, y and z divided by w are still numbers.
    fn divisible(mut words: Words) -> Result<(), Flaw> {
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

/// Whether a number, if it is one, is finite and fits single precision for want of an exponent and of digits.
fn is_plain(word: &[u8]) -> bool {
    word.len() <= 30 && word.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+'))
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
    let mut rest = word;
    for index in &mut indices {
        let negative = rest.first() == Some(&b'-');
        let digits = if negative { rest.get(1..)? } else { rest };
        let mut value = 0_i64;
        let mut count = 0;
        while let Some(digit @ b'0'..=b'9') = digits.get(count) {
            // Far beyond any count, yet safe to negate and to count on from.
            value = (value * 10 + i64::from(digit - b'0')).min(i64::MAX / 100);
            count += 1;
        }
        match count {
            0 if negative => return None,
            0 => {}
            _ => *index = Some(if negative { -value } else { value }),
        }
        rest = match digits.get(count..)? {
            [] => return Some(indices),
            [b'/', rest @ ..] => rest,
            _ => return None,
        };
    }
    // A third `/` follows.
    None
}

/// The words of a line up to its comment, each with its offset.
#[derive(Clone)]
pub(super) struct Words<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    /// The words of `line`.
    pub fn new(line: &'a [u8]) -> Self {
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
}
