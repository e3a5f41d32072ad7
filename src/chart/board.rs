//! A map of a figure against two settings as SVG, of the size of [`panel`](super::panel): a cell for each pair, the darker the more.

use super::number::figure;
use super::panel::{BOTTOM, LEFT, RIGHT, TOP, names, text};
use super::svg::escape;
use std::fmt::Write;

/// A pair of settings and what was measured with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// The figure.
    pub value: f64,
    /// What it stands for, in lines.
    pub tip: String,
}

/// Colours of the least and the largest value, as shares of red, green and blue.
const ENDS: [[f64; 3]; 2] = [[0.93, 0.96, 0.99], [0.0, 0.35, 0.62]];

/// The map as the content of an SVG element: `rows[k]` stands above `rows[k - 1]` and has a cell for each of `across`.
pub fn board(titles: [&str; 2], across: &[String], up: &[String], rows: &[Vec<Cell>]) -> String {
    let mut out = String::new();
    names(&mut out, titles[0], "");
    text(&mut out, (LEFT - 7.0, TOP - 5.0), "end", r#"font-size="13""#, titles[1]);
    let (width, height) = ((RIGHT - LEFT) / across.len().max(1) as f64, (BOTTOM - TOP) / up.len().max(1) as f64);
    let values = || rows.iter().flatten().map(|cell| cell.value).filter(|value| value.is_finite());
    let (low, high) = values().fold((f64::INFINITY, 0.0f64), |(a, b), x| (a.min(x), b.max(x)));
    for (i, name) in across.iter().enumerate() {
        let place = (LEFT + width * (i as f64 + 0.5), BOTTOM + 17.0);
        text(&mut out, place, "middle", r#"font-size="12" opacity="0.85""#, name);
    }
    for (k, (name, row)) in up.iter().zip(rows).enumerate() {
        let y = BOTTOM - height * (k as f64 + 1.0);
        text(&mut out, (LEFT - 7.0, y + height / 2.0 + 4.0), "end", r#"font-size="12" opacity="0.85""#, name);
        out.push_str(r#"<g class="line">"#);
        for (i, cell) in row.iter().enumerate() {
            let share = if high > low { (cell.value - low) / (high - low) } else { 1.0 };
            let (x, ink) = (LEFT + width * i as f64, if share > 0.5 { "#ffffff" } else { "#222222" });
            let (cx, cy) = (x + width / 2.0, y + height / 2.0);
            // Writing to a string cannot fail.
            let _ = write!(
                out,
                r##"<g class="point"><title>{}</title><rect x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}" fill="{}" stroke="#888888" stroke-width="0.5"/><text x="{cx:.1}" y="{:.1}" text-anchor="middle" font-size="11" fill="{ink}">{}</text><circle cx="{cx:.1}" cy="{cy:.1}" r="9" fill="none" pointer-events="all"/></g>"##,
                escape(&cell.tip),
                colour(share),
                cy + 4.0,
                figure(cell.value)
            );
        }
        out.push_str("</g>");
    }
    out
}

fn colour(share: f64) -> String {
    let [from, to] = ENDS;
    let byte = |k: usize| (255.0 * (from[k] + (to[k] - from[k]) * share.clamp(0.0, 1.0))).round() as u8;
    format!("#{:02x}{:02x}{:02x}", byte(0), byte(1), byte(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_has_its_cell_and_more_is_darker() {
        let words = |all: &[&str]| all.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let row = |values: [f64; 2]| values.map(|value| Cell { value, tip: format!("{value} & more") }).to_vec();
        let text =
            board(["wave", "leaf"], &words(&["64", "128"]), &words(&["4", "8"]), &[row([1.0, 2.0]), row([3.0, 4.0])]);
        assert_eq!((text.matches("class=\"point\"").count(), text.matches("class=\"line\"").count()), (4, 2));
        for part in
            ["<title>3 &amp; more</title>", ">128</text>", ">leaf</text>", "fill=\"#00599e\"", "fill=\"#edf5fc\""]
        {
            assert!(text.contains(part), "{part} in {text}");
        }
        assert!(!board(["a", "b"], &[], &[], &[]).contains("point"));
    }
}
