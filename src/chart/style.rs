//! How lines are told apart: by colour, by dash and by marker, so that each of the three suffices.

use std::fmt::Write;

/// Colours of lines on white, in their order: those of M. Okabe and K. Ito, "Color Universal Design" (2008), told apart
/// by the colour-blind too; yellow, which white swallows, is left out.
pub const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];
/// Their counterparts on a dark ground: the same hues, as light as it needs.
pub const DARK_COLOURS: [&str; 7] = ["#5cb3e8", "#ff8a3c", "#3fd0a4", "#eba6cb", "#f5c04d", "#a8dcff", "#f2f2f2"];
/// Dashes, as SVG has them; without common divisor with the colours, so that no two of many lines look the same.
const DASHES: [&str; 5] = ["none", "7 3", "2 2.5", "9 3 2 3", "5 2 1.5 2 1.5 2"];

/// Shapes of markers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A disc.
    Circle,
    /// A square.
    Square,
    /// A triangle that points up.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// A triangle that points down.
    Inverted,
    /// A plus sign.
    Plus,
}

const MARKERS: [Marker; 6] =
    [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Inverted, Marker::Plus];

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Which colour of [`COLOURS`].
    pub colour: usize,
    /// Its `stroke-dasharray`.
    pub dash: &'static str,
    /// The shape of its points.
    pub marker: Marker,
    /// Whether its markers are outlines, as those of other programs are.
    pub hollow: bool,
}

impl Style {
    /// The style of the line of that index; `imported` ones have hollow markers.
    pub fn new(index: usize, imported: bool) -> Self {
        let of = |n: usize| index % n;
        Self {
            colour: of(COLOURS.len()),
            dash: DASHES.get(of(DASHES.len())).copied().unwrap_or("none"),
            marker: MARKERS.get(of(MARKERS.len())).copied().unwrap_or(Marker::Circle),
            hollow: imported,
        }
    }
    /// The colour on white.
    pub fn on_white(&self) -> &'static str {
        COLOURS.get(self.colour).copied().unwrap_or("#000000")
    }
}

impl Marker {
    /// Its outline about a point, as path data.
    pub fn path(self, x: f64, y: f64) -> String {
        let corners = |corners: &[(f64, f64)]| {
            let mut path = String::new();
            for (i, (dx, dy)) in corners.iter().enumerate() {
                // Writing to a string cannot fail.
                let _ = write!(path, "{}{:.1} {:.1}", if i == 0 { 'M' } else { 'L' }, x + dx, y + dy);
            }
            path + "Z"
        };
        match self {
            Self::Circle => format!("M{:.1} {y:.1}a3.6 3.6 0 1 0 7.2 0a3.6 3.6 0 1 0 -7.2 0Z", x - 3.6),
            Self::Square => corners(&[(-3.3, -3.3), (3.3, -3.3), (3.3, 3.3), (-3.3, 3.3)]),
            Self::Triangle => corners(&[(0.0, -4.4), (4.2, 3.1), (-4.2, 3.1)]),
            Self::Diamond => corners(&[(0.0, -4.7), (4.7, 0.0), (0.0, 4.7), (-4.7, 0.0)]),
            Self::Inverted => corners(&[(0.0, 4.4), (4.2, -3.1), (-4.2, -3.1)]),
            Self::Plus => {
                let (a, b) = (1.3, 4.4);
                let half = [(-a, -b), (a, -b), (a, -a), (b, -a), (b, a), (a, a)];
                let whole: Vec<_> = half.iter().copied().chain(half.iter().map(|(dx, dy)| (-dx, -dy))).collect();
                corners(&whole)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_of_two_hundred_lines_look_the_same() {
        let styles: Vec<Style> = (0..200).map(|i| Style::new(i, false)).collect();
        for (i, a) in styles.iter().enumerate() {
            assert!(styles[..i].iter().all(|b| a != b), "{i}");
        }
        assert_ne!(Style::new(0, false), Style::new(0, true));
        assert!(styles.iter().all(|style| style.on_white().starts_with('#')));
        // Neighbours differ in each of the three.
        for pair in styles.windows(2) {
            assert!(pair[0].colour != pair[1].colour && pair[0].dash != pair[1].dash, "{pair:?}");
            assert_ne!(pair[0].marker, pair[1].marker);
        }
    }
}
