//! The page of a chart: charts, figures, pictures and settings.

use super::curve::{Metric, SceneCurves, curves};
use super::draw::element;
use super::gallery::Gallery;
use super::legend::{Legend, sample};
use super::number::count;
use super::panel::Across;
use super::sheet::Sheet;
use super::svg::escape;
use super::{Row, table};
use std::fmt::Write;

/// What the page shows.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Its heading.
    pub title: String,
    /// What is missing, where the sweep is not complete.
    pub unfinished: Option<String>,
    /// All measurements, imported ones too.
    pub rows: Vec<Row>,
    /// How lines look.
    pub legend: Legend,
    /// Scenes in their order, with their pictures.
    pub galleries: Vec<Gallery>,
    /// What it takes to repeat the measurements: names and values.
    pub facts: Vec<(String, String)>,
    /// The command line.
    pub command: String,
}

impl Page {
    /// The page as HTML.
    pub fn html(&self) -> String {
        let drawn: Vec<(Metric, Vec<SceneCurves>)> = Metric::ALL
            .into_iter()
            .map(|metric| (metric, curves(&self.rows, metric)))
            .filter(|(_, scenes)| scenes.iter().any(|scene| !scene.curves.is_empty()))
            .collect();
        let scenes: String = self.galleries.iter().map(|gallery| self.scene(gallery, &drawn)).collect();
        let sheet = Sheet {
            title: &self.title,
            summary: self.summary(),
            bar: self.bar(&drawn),
            sections: scenes,
            facts: &self.facts,
            command: &self.command,
        };
        sheet.html()
    }

    fn summary(&self) -> String {
        let mut out = format!(
            "<p>{} renders. Lines are medians over seeds, bands hold the middle 80 %. Both axes are logarithmic; dotted \
             is the slope of independent samples.</p>",
            count(self.rows.len() as u64)
        );
        if let Some(missing) = &self.unfinished {
            // Writing to a string cannot fail.
            let _ = write!(out, r#"<p class="warning" role="note">Not complete: {}.</p>"#, escape(missing));
        }
        out
    }

    fn bar(&self, drawn: &[(Metric, Vec<SceneCurves>)]) -> String {
        let mut out = r#"<div class="bar"><ul aria-label="Lines">"#.to_owned();
        for (label, style) in self.legend.entries() {
            let line = sample(style, 2.0, 8.0);
            let _ =
                write!(out, r#"<li><svg viewBox="0 0 42 16" aria-hidden="true">{line}</svg>{}</li>"#, escape(label));
        }
        out.push_str("</ul>");
        if drawn.len() > 1 {
            out.push_str(r#"<fieldset class="metrics"><legend>Error</legend>"#);
            for (i, (metric, _)) in drawn.iter().enumerate() {
                let (name, checked) = (escape(metric.name()), if i == 0 { " checked" } else { "" });
                let _ = write!(
                    out,
                    r#"<label><input type="radio" name="metric" value="{i}" autocomplete="off"{checked}> {name}</label>"#
                );
            }
            out.push_str("</fieldset>");
        }
        out + "</div>"
    }

    fn scene(&self, gallery: &Gallery, drawn: &[(Metric, Vec<SceneCurves>)]) -> String {
        let name = escape(&gallery.scene);
        let mut out = format!(r#"<section aria-label="{name}"><h2>{name}</h2>"#);
        for (i, (metric, scenes)) in drawn.iter().enumerate() {
            let hidden = if i == 0 { "" } else { " hidden" };
            let none = SceneCurves { scene: gallery.scene.clone(), curves: Vec::new() };
            let scene = scenes.iter().find(|scene| scene.scene == gallery.scene).unwrap_or(&none);
            let panels = Across::ALL.map(|across| element(scene, &self.legend, *metric, across)).concat();
            let _ = write!(out, r#"<div class="panels" data-metric="{i}"{hidden}>{panels}</div>"#);
        }
        out.push_str(&table::html(&gallery.scene, &self.rows));
        out + &gallery.html() + "</section>"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_needs_nothing_beside_it_and_names_are_text() {
        let scene = "<script>alert(1)</script>".to_owned();
        let row = Row {
            scene: scene.clone(),
            label: "a & b".to_owned(),
            spp: 4,
            seed: Some(1),
            seconds: 0.5,
            relmse: 0.25,
            relmse_trimmed: None,
            mse: None,
            flip: Some(0.1),
        };
        let page = Page {
            title: "</title>".to_owned(),
            unfinished: Some("1 of 2 renders".to_owned()),
            rows: vec![row],
            legend: Legend::new(["a & b".to_owned()], []),
            galleries: vec![Gallery { scene, ..Gallery::default() }],
            facts: vec![("cpu".to_owned(), "<fast>".to_owned())],
            command: "wavetrace chart '<x>'".to_owned(),
        };
        let html = page.html();
        assert_eq!(html.matches("<script>").count(), 1);
        assert!(html.contains("<title>&lt;/title&gt;</title>"));
        for part in ["&lt;script&gt;alert(1)", "a &amp; b", "1 of 2 renders", "&lt;fast&gt;", "Content-Security-Policy"]
        {
            assert!(html.contains(part), "{part}");
        }
        for outside in ["http://", "https://", "src=\"//", "@import", "url("] {
            assert!(!html.contains(outside), "{outside}");
        }
        // Only what was measured can be chosen.
        assert_eq!(html.matches("name=\"metric\"").count(), 2);
        assert!(!html.contains("{{") && Page::default().html().contains("<h1></h1>"));
    }
}
