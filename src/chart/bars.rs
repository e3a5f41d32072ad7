//! Stacked bars as SVG, of the size of [`panel`](super::panel): a part of each bar for each of some series.

use super::panel::{BOTTOM, LEFT, RIGHT, frame, names, text};
use super::plot::heights;
use super::style::Style;
use super::svg::escape;
use std::fmt::Write;

/// A part of a bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Number of its series.
    pub series: usize,
    /// How high it is.
    pub value: f64,
    /// What it stands for, in lines.
    pub tip: String,
}

/// How the parts of a series are filled: colours go round, and are pale the second time.
pub(super) fn fill(series: usize) -> (Style, f64) {
    let style = Style::new(series, false);
    (style, if series >= super::style::COLOURS.len() { 0.5 } else { 0.95 })
}

/// Writes the name of a bar below it.
fn label(out: &mut String, middle: f64, name: &str, askew: bool) {
    let y = BOTTOM + 15.0;
    if !askew {
        return text(out, (middle, y), "middle", r#"font-size="12" opacity="0.85""#, name);
    }
    let turned = format!(r#"font-size="11" opacity="0.85" transform="rotate(-28 {middle:.1} {y:.1})""#);
    text(out, (middle + 6.0, y), "end", &turned, name);
}

/// The bars as the content of an SVG element: each with its name, from left to right.
pub fn bars(across: &str, up: &str, bars: &[(String, Vec<Part>)]) -> String {
    let mut out = String::new();
    names(&mut out, across, up);
    frame(&mut out);
    let most = bars.iter().map(|(_, parts)| parts.iter().map(|part| part.value).sum::<f64>()).fold(0.0, f64::max);
    if !(most > 0.0 && most.is_finite()) {
        return out;
    }
    let height = heights(&mut out, most);
    // Long names of many bars would run into each other.
    let askew = bars.len() > 8 && bars.iter().any(|(name, _)| name.chars().count() > 3);
    let width = (RIGHT - LEFT) / bars.len() as f64;
    for (i, (name, parts)) in bars.iter().enumerate() {
        let (x, middle) = (LEFT + width * (i as f64 + 0.12), LEFT + width * (i as f64 + 0.5));
        label(&mut out, middle, name, askew);
        out.push_str(r#"<g class="line">"#);
        let mut below = 0.0;
        for part in parts.iter().filter(|part| part.value > 0.0) {
            let (bottom, top) = (height(below), height(below + part.value));
            below += part.value;
            let (style, opacity) = fill(part.series);
            // Writing to a string cannot fail.
            let _ = write!(
                out,
                r#"<g class="point s{}" color="{}"><title>{}</title><rect x="{x:.1}" y="{top:.2}" width="{:.1}" height="{:.2}" fill="currentColor" fill-opacity="{opacity}"/><circle cx="{middle:.1}" cy="{:.1}" r="3" fill="none" pointer-events="none"/></g>"#,
                style.colour,
                style.on_white(),
                escape(&part.tip),
                width * 0.76,
                bottom - top,
                (top + bottom) / 2.0
            );
        }
        out.push_str("</g>");
    }
    out
}

/// What the fills stand for, as a list in HTML.
pub fn key(series: &[&str]) -> String {
    let item = |(i, name): (usize, &&str)| {
        let (style, opacity) = fill(i);
        format!(
            r#"<li><svg viewBox="0 0 42 16" class="s{}" color="{}" aria-hidden="true"><rect x="10" y="2" width="22" height="12" fill="currentColor" fill-opacity="{opacity}"/></svg>{}</li>"#,
            style.colour,
            style.on_white(),
            escape(name)
        )
    };
    let items: String = series.iter().enumerate().map(item).collect();
    format!(r#"<div class="bar"><ul aria-label="Colours">{items}</ul></div>"#)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_stacked_in_proportion() {
        let part = |series: usize, value: f64| Part { series, value, tip: format!("<{series}>") };
        let text =
            bars("bounces", "ms", &[("0".into(), vec![part(0, 1.0), part(9, 3.0)]), ("1".into(), vec![part(0, 0.0)])]);
        let rects: Vec<(f64, f64)> = text
            .split("<rect x=")
            .skip(1)
            .map(|piece| piece.split("/>").next().unwrap())
            .filter(|piece| piece.contains("fill=\"currentColor\""))
            .map(|piece| {
                let number = |key: &str| -> f64 {
                    piece.split(&format!(" {key}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
                };
                (number("y"), number("height"))
            })
            .collect();
        let [(y0, h0), (y1, h1)] = rects[..] else { panic!("two parts: {text}") };
        assert!((h1 / h0 - 3.0).abs() < 0.01 && (y1 + h1 - y0).abs() < 0.02, "{rects:?}");
        assert!(text.contains("<title>&lt;9&gt;</title>") && text.contains("fill-opacity=\"0.5\""));
        assert!(!bars("a", "b", &[]).contains("point"));
        assert_eq!(key(&["a", "b"]).matches("<li>").count(), 2);
    }
}
