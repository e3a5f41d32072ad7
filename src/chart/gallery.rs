//! The pictures of a scene: side by side behind a split that can be dragged, and all of them with their heat maps.

use super::svg::escape;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use std::fmt::Write;

/// Pixels that a picture in the split has across at least.
const SMALLEST: u32 = 480;
/// Pixels that other pictures are shown with, at least. Smaller ones are enlarged, and show their pixels.
const THUMBNAIL: u32 = 220;

/// Pictures of a scene at one budget.
#[derive(Clone, Debug, Default)]
pub struct Gallery {
    /// Name of the scene.
    pub scene: String,
    /// Pixels across each picture.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// What they have in common, such as `64 samples per pixel, seed 1`.
    pub caption: String,
    /// One for each series.
    pub pictures: Vec<Picture>,
    /// What they are held against, as PNG.
    pub reference: Option<Vec<u8>>,
    /// The colours of the heat maps.
    pub scale: Option<Scale>,
}

/// A picture and its errors.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// Which series.
    pub label: String,
    /// What there is to say of it.
    pub note: String,
    /// The picture as PNG.
    pub picture: Vec<u8>,
    /// Its heat map as PNG.
    pub heat: Vec<u8>,
}

/// What the colours of heat maps stand for.
#[derive(Clone, Debug, Default)]
pub struct Scale {
    /// The colours from left to right, as PNG.
    pub colours: Vec<u8>,
    /// What the left end stands for.
    pub low: String,
    /// What the right end stands for.
    pub high: String,
}

/// A picture of the page.
struct Entry<'a> {
    id: String,
    name: String,
    png: &'a [u8],
}

// Writing to a string cannot fail: what `write!` returns is dropped throughout.
impl Gallery {
    /// The gallery as HTML; nothing where there are no pictures.
    pub fn html(&self) -> String {
        let Some(reference) = self.reference.as_deref().filter(|_| !self.pictures.is_empty()) else {
            return String::new();
        };
        let id = |kind: &str, i: usize| format!("{kind}{i} {}", self.scene).replace(char::is_whitespace, "␣");
        let reference = Entry { id: id("reference", 0), name: "reference".to_owned(), png: reference };
        let entries: Vec<[Entry<'_>; 2]> = self
            .pictures
            .iter()
            .enumerate()
            .map(|(i, picture)| {
                let heat = format!("error of {}", picture.label);
                [
                    Entry { id: id("picture", i), name: picture.label.clone(), png: &picture.picture },
                    Entry { id: id("heat", i), name: heat, png: &picture.heat },
                ]
            })
            .collect();
        let caption = escape(&self.caption);
        let mut out = format!("<h3>Pictures</h3><p>{caption}</p>");
        let choices: Vec<&Entry<'_>> = entries
            .iter()
            .map(|[picture, _]| picture)
            .chain([&reference])
            .chain(entries.iter().map(|[_, heat]| heat))
            .collect();
        out.push_str(&self.split(&choices));
        if let Some(scale) = &self.scale {
            let _ = write!(
                out,
                r#"<p class="scale"><span>squared relative error</span> <span>{}</span><img src="{}" alt="from dark to bright"><span>{}</span></p>"#,
                escape(&scale.low),
                data(&scale.colours),
                escape(&scale.high)
            );
        }
        let enlarged = if self.width < THUMBNAIL { " enlarged" } else { "" };
        let _ = write!(out, r#"<ul class="pictures{enlarged}">"#);
        for (picture, [image, heat]) in self.pictures.iter().zip(&entries) {
            let (label, note) = (escape(&picture.label), escape(&picture.note));
            let _ = write!(
                out,
                "<li><div>{label}<br><span class=\"quiet\">{note}</span></div>{}{}</li>",
                self.image(image),
                self.image(heat)
            );
        }
        let _ = write!(
            out,
            "<li><div>reference<br><span class=\"quiet\">&nbsp;</span></div>{}</li></ul>",
            self.image(&reference)
        );
        out
    }

    fn image(&self, entry: &Entry<'_>) -> String {
        format!(
            r#"<img id="{}" src="{}" alt="{}" width="{}" height="{}">"#,
            escape(&entry.id),
            data(entry.png),
            escape(&format!("{}, {}", self.scene, entry.name)),
            self.width,
            self.height
        )
    }

    /// Two pictures, one left and one right of a line that the reader moves. It is there once the script runs.
    fn split(&self, choices: &[&Entry<'_>]) -> String {
        let select = |name: &str, chosen: usize| {
            let option = |(i, entry): (usize, &&Entry<'_>)| {
                let selected = if i == chosen { " selected" } else { "" };
                format!(r#"<option value="{}"{selected}>{}</option>"#, escape(&entry.id), escape(&entry.name))
            };
            let options: String = choices.iter().enumerate().map(option).collect();
            format!(r#"<label>{name} <select autocomplete="off">{options}</select></label>"#)
        };
        let (left, right) = (select("left", 0), select("right", self.pictures.len()));
        let scene = escape(&self.scene);
        // Small pictures are enlarged by whole pixels.
        let wide = self.width.max(1) * SMALLEST.div_ceil(self.width.max(1));
        let enlarged = if wide > self.width { " enlarged" } else { "" };
        format!(
            r#"<div class="viewer" hidden><div class="choices">{left}{right}</div><div class="split{enlarged}" style="max-width:{wide}px;--at:50%"><img alt="" draggable="false"><img alt="" draggable="false"><div class="handle" role="slider" tabindex="0" aria-label="Split of the pictures of {scene}" aria-orientation="horizontal" aria-valuemin="0" aria-valuemax="100" aria-valuenow="50"></div></div></div>"#
        )
    }
}

fn data(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_picture_stands_in_the_page_once() {
        let picture = |label: &str, byte: u8| Picture {
            label: label.to_owned(),
            note: "relMSE 0.1".to_owned(),
            picture: vec![byte; 3],
            heat: vec![byte + 1; 3],
        };
        let gallery = Gallery {
            scene: "a \"room\"".to_owned(),
            width: 100,
            height: 50,
            caption: "64 samples".to_owned(),
            pictures: vec![picture("x", 1), picture("y", 3)],
            reference: Some(vec![9; 3]),
            scale: Some(Scale { colours: vec![8; 3], low: "<10⁻³".to_owned(), high: "1".to_owned() }),
        };
        let html = gallery.html();
        for bytes in [[1; 3], [2; 3], [3; 3], [4; 3], [8; 3], [9; 3]] {
            assert_eq!(html.matches(&data(&bytes)).count(), 1, "{bytes:?}");
        }
        // Two lists of two series, their heat maps and the reference; the reference is chosen on the right.
        assert_eq!(html.matches("<option").count(), 10);
        assert!(html.contains(r#"<option value="reference0␣a␣&quot;room&quot;" selected>"#), "{html}");
        assert!(html.contains("max-width:500px") && html.contains("&lt;10⁻³"));
        assert_eq!(Gallery::default().html(), "");
    }
}
