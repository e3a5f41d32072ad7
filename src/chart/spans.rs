//! Rows of spans of time as SVG, as wide as two panels: what each worker did when.

use super::bars::fill;
use super::draw::FONTS;
use super::panel::{LEFT, text};
use super::svg::escape;
use std::fmt::Write;

const WIDTH: f64 = 1000.0;
const RIGHT: f64 = WIDTH - 14.0;
const ROW: f64 = 34.0;
const TOP: f64 = 8.0;

/// A span of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Number of its series.
    pub series: usize,
    /// When it began, in milliseconds.
    pub from: f64,
    /// When it ended, in milliseconds.
    pub to: f64,
    /// What it stands for, in lines.
    pub tip: String,
}

/// The rows as an SVG element: each with its name, from `from` to `to`.
pub fn spans(name: &str, from: f64, to: f64, rows: &[(String, Vec<Span>)]) -> String {
    let bottom = TOP + ROW * rows.len() as f64;
    let height = bottom + 40.0;
    let mut out = format!(
        r#"<svg class="panel wide" viewBox="0 0 {WIDTH} {height}" font-family="{FONTS}" role="group" aria-label="{}">"#,
        escape(name)
    );
    let place = |time: f64| LEFT + (RIGHT - LEFT) * ((time - from) / (to - from)).clamp(0.0, 1.0);
    for k in 0..=5 {
        let time = from + (to - from) * f64::from(k) / 5.0;
        let x = place(time);
        // Writing to a string cannot fail.
        let _ = write!(out, r#"<path d="M{x:.1} {TOP}V{bottom}" stroke="currentColor" stroke-opacity="0.2"/>"#);
        let anchor = if k == 5 { "end" } else { "middle" };
        text(&mut out, (x, bottom + 16.0), anchor, r#"font-size="12" opacity="0.85""#, &format!("{time:.2}"));
    }
    text(&mut out, ((LEFT + RIGHT) / 2.0, bottom + 33.0), "middle", r#"font-size="13""#, "milliseconds of the render");
    for (k, (name, row)) in rows.iter().enumerate() {
        let y = TOP + ROW * k as f64 + 4.0;
        text(&mut out, (LEFT - 7.0, y + 17.0), "end", r#"font-size="12" opacity="0.85""#, name);
        out.push_str(r#"<g class="line">"#);
        for span in row.iter().filter(|span| span.to > from && span.from < to) {
            let (x0, x1) = (place(span.from), place(span.to));
            let ((style, opacity), middle) = (fill(span.series), (x0 + x1) / 2.0);
            let _ = write!(
                out,
                r#"<g class="point s{}" color="{}"><title>{}</title><rect x="{x0:.2}" y="{y}" width="{:.2}" height="{}" fill="currentColor" fill-opacity="{opacity}"/><circle cx="{middle:.2}" cy="{}" r="3" fill="none" pointer-events="none"/></g>"#,
                style.colour,
                style.on_white(),
                escape(&span.tip),
                (x1 - x0).max(0.1),
                ROW - 8.0,
                y + ROW / 2.0 - 4.0
            );
        }
        out.push_str("</g>");
    }
    out + "</svg>"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_in_sight_is_drawn() {
        let span = |from: f64, to: f64| Span { series: 1, from, to, tip: format!("{from} & {to}") };
        let rows = [("worker 1".to_owned(), vec![span(0.0, 1.0), span(4.0, 6.0), span(9.0, 12.0)])];
        let text = spans("a", 2.0, 10.0, &rows);
        assert_eq!(text.matches("class=\"point").count(), 2);
        assert!(
            text.contains("<title>4 &amp; 6</title>") && text.contains(">worker 1</text>") && !text.contains("NaN")
        );
    }
}
