//! The whole chart as SVG: a legend, and a row of panels for each scene.

use super::curve::{Metric, SceneCurves};
use super::legend::Legend;
use super::panel::{self, Across, panel, text};
use super::svg::shortened;
use std::fmt::Write;

/// Fonts of all text: the one that pictures are made with, then what a browser may have.
pub const FONTS: &str = "'DejaVu Sans', Verdana, sans-serif";
const MARGIN: f64 = 12.0;
const TITLE: f64 = 34.0;
/// Characters of the title at most.
const LONGEST: usize = 80;

/// A document of one row per scene: error against seconds, error against samples.
pub fn document(title: &str, scenes: &[SceneCurves], legend: &Legend, metric: Metric) -> String {
    let panels = scenes
        .iter()
        .flat_map(|scene| Across::ALL.map(|across| (scene.scene.clone(), panel(scene, legend, metric, across))));
    panels_document(title, legend.draw(WIDTH - 2.0 * MARGIN - 20.0), &panels.collect::<Vec<_>>())
}

/// Pixels across a document.
const WIDTH: f64 = 2.0 * panel::WIDTH + 2.0 * MARGIN;

/// A document of panels, two in a row, each with its title, below a legend of some height.
pub fn panels_document(title: &str, (entries, legend_height): (String, f64), panels: &[(String, String)]) -> String {
    let top = MARGIN + TITLE + legend_height + 8.0;
    let height = top + panel::HEIGHT * panels.len().div_ceil(2) as f64 + MARGIN;
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" font-family="{FONTS}" color="#333333"><rect width="{WIDTH}" height="{height}" fill="#ffffff"/>"##
    );
    text(&mut out, (MARGIN + 8.0, MARGIN + 20.0), "start", r#"font-size="19""#, &shortened(title, LONGEST));
    let _ = write!(out, r#"<g transform="translate({} {})">{entries}</g>"#, MARGIN + 8.0, MARGIN + TITLE);
    for (number, (name, content)) in panels.iter().enumerate() {
        let x = MARGIN + panel::WIDTH * (number % 2) as f64;
        let y = top + panel::HEIGHT * (number / 2) as f64;
        let mut content = content.clone();
        text(&mut content, (panel::LEFT, 20.0), "start", r#"font-size="16""#, &shortened(name, 48));
        let _ = write!(out, r#"<g transform="translate({x} {y})">{content}</g>"#);
    }
    out + "</svg>\n"
}

/// A panel as an element of a page, which names the scene by itself.
pub fn element(scene: &SceneCurves, legend: &Legend, metric: Metric, across: Across) -> String {
    panel_element("", &panel(scene, legend, metric, across))
}

/// The content of any panel as an element of a page, with a name for those who do not see it unless that is empty.
pub fn panel_element(name: &str, content: &str) -> String {
    let (top, width, height) = (panel::TITLE, panel::WIDTH, panel::HEIGHT - panel::TITLE);
    let label = if name.is_empty() { String::new() } else { format!(r#" role="group" aria-label="{name}""#) };
    format!(r#"<svg class="panel" viewBox="0 {top} {width} {height}" font-family="{FONTS}"{label}>{content}</svg>"#)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_scene_has_two_panels() {
        let scene = |name: &str| SceneCurves { scene: name.to_owned(), curves: Vec::new() };
        let legend = Legend::new(["a".to_owned()], []);
        let text = document("A & B", &[scene("x"), scene("<y>")], &legend, Metric::Mse);
        assert!(text.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"") && text.ends_with("</svg>\n"));
        assert_eq!(text.matches(">samples per pixel<").count(), 2);
        assert_eq!(text.matches(">seconds of a render<").count(), 2);
        assert!(text.contains("A &amp; B") && text.matches(">&lt;y&gt;<").count() == 2);
        assert!(document("", &[], &Legend::default(), Metric::Mse).ends_with("</svg>\n"));
    }
}
