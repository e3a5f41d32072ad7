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
    let width = 2.0 * panel::WIDTH + 2.0 * MARGIN;
    let (entries, legend_height) = legend.draw(width - 2.0 * MARGIN - 20.0);
    let top = MARGIN + TITLE + legend_height + 8.0;
    let height = top + panel::HEIGHT * scenes.len() as f64 + MARGIN;
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-family="{FONTS}" color="#333333"><rect width="{width}" height="{height}" fill="#ffffff"/>"##
    );
    text(&mut out, (MARGIN + 8.0, MARGIN + 20.0), "start", r#"font-size="19""#, &shortened(title, LONGEST));
    let _ = write!(out, r#"<g transform="translate({} {})">{entries}</g>"#, MARGIN + 8.0, MARGIN + TITLE);
    for (row, scene) in scenes.iter().enumerate() {
        for (column, across) in Across::ALL.into_iter().enumerate() {
            let x = MARGIN + panel::WIDTH * column as f64;
            let y = top + panel::HEIGHT * row as f64;
            let mut content = panel(scene, legend, metric, across);
            text(&mut content, (panel::LEFT, 20.0), "start", r#"font-size="16""#, &shortened(&scene.scene, 48));
            let _ = write!(out, r#"<g transform="translate({x} {y})">{content}</g>"#);
        }
    }
    out + "</svg>\n"
}

/// A panel as an element of a page, which names the scene by itself.
pub fn element(scene: &SceneCurves, legend: &Legend, metric: Metric, across: Across) -> String {
    let (top, width, height) = (panel::TITLE, panel::WIDTH, panel::HEIGHT - panel::TITLE);
    let content = panel(scene, legend, metric, across);
    format!(r#"<svg class="panel" viewBox="0 {top} {width} {height}" font-family="{FONTS}">{content}</svg>"#)
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
