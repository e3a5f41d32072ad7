//! Which line looks how: one style per label, for all panels.

use super::panel::text;
use super::style::Style;
use super::svg::shortened;
use std::fmt::Write;

/// Most characters of a label that are shown.
const MOST: usize = 40;
/// Pixels that a character takes at most in the mean.
const CHARACTER: f64 = 7.6;
/// Pixels of line and marker before a label.
const SAMPLE: f64 = 46.0;
/// Pixels down a row.
const ROW: f64 = 22.0;

/// Labels in their order, each with a style.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Legend(Vec<(String, Style)>);

impl Legend {
    /// Styles for this program's own labels and for imported ones.
    pub fn new(own: impl IntoIterator<Item = String>, imported: impl IntoIterator<Item = String>) -> Self {
        let labels = own.into_iter().map(|l| (l, false)).chain(imported.into_iter().map(|l| (l, true)));
        Self(labels.enumerate().map(|(i, (label, imported))| (label, Style::new(i, imported))).collect())
    }
    /// The style of a label; that of the first one for a label that is not in the legend.
    pub fn style(&self, label: &str) -> Style {
        self.0.iter().find(|(known, _)| known == label).map_or(Style::new(0, false), |(_, style)| *style)
    }
    /// Labels and styles.
    pub fn entries(&self) -> &[(String, Style)] {
        &self.0
    }

    /// The legend as SVG within `width` pixels from the top left of where it stands, and its height in pixels.
    pub fn draw(&self, width: f64) -> (String, f64) {
        let (mut out, mut x, mut y) = (String::new(), 0.0, 0.0);
        for (label, style) in &self.0 {
            let label = shortened(label, MOST);
            let wide = SAMPLE + CHARACTER * label.chars().count() as f64 + 18.0;
            if x > 0.0 && x + wide > width {
                (x, y) = (0.0, y + ROW);
            }
            let middle = y + ROW / 2.0;
            out.push_str(&sample(style, x, middle));
            text(&mut out, (x + SAMPLE, middle + 4.5), "start", r#"font-size="13""#, &label);
            x += wide;
        }
        (out, if self.0.is_empty() { 0.0 } else { y + ROW })
    }
}

/// A piece of a line with its marker, from `x` on.
pub fn sample(style: &Style, x: f64, middle: f64) -> String {
    let mut out = String::new();
    let fill = if style.hollow { r##"class="hollow" fill="#ffffff""## } else { r#"fill="currentColor""# };
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        r#"<g class="s{}" color="{}"><path d="M{x:.1} {middle:.1}h38" fill="none" stroke="currentColor" stroke-width="1.8" stroke-dasharray="{}"/><path {fill} stroke="currentColor" stroke-width="1.2" d="{}"/></g>"#,
        style.colour,
        style.on_white(),
        style.dash,
        style.marker.path(x + 19.0, middle),
    );
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imported_labels_come_last_and_look_different() {
        let legend = Legend::new(["a".to_owned(), "b".to_owned()], ["c".to_owned()]);
        assert_eq!(
            legend.entries().iter().map(|(l, s)| (&**l, s.hollow)).collect::<Vec<_>>(),
            [("a", false), ("b", false), ("c", true)]
        );
        assert_ne!(legend.style("a"), legend.style("b"));
        assert_eq!(legend.style("unknown"), legend.style("a"));
    }

    #[test]
    fn rows_break_where_they_are_full() {
        let labels = ["mis xoshiro", "mis sobol", "a label that is rather long, longer than what anybody would read"];
        let legend = Legend::new(labels.map(str::to_owned), []);
        assert_eq!(legend.draw(1000.0).1, ROW);
        let (text, height) = legend.draw(200.0);
        assert_eq!(height, 3.0 * ROW);
        assert!(text.contains('…') && text.contains("mis sobol"));
        assert_eq!(Legend::default().draw(100.0), (String::new(), 0.0));
    }
}
