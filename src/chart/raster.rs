//! The chart as a picture of pixels. The only file that names `resvg` and `dejavu`: text looks the same on a machine
//! without fonts.

use crate::error::{Error, Result};
use crate::output::{self, Metadata};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};
use std::path::Path;
use std::sync::Arc;

/// Pixels of the picture per pixel of the drawing.
const SCALE: f32 = 2.0;
/// Most pixels down, whatever the number of scenes.
const TALLEST: f32 = 30_000.0;

/// Draws SVG of this crate on white and writes it as PNG; the file is there whole or not at all. Two pixels are drawn for
/// one of the drawing, fewer where that is very tall.
///
/// # Errors
/// [`Error::Output`] where the text is no SVG, or too large to be drawn; else as [`output::write_bytes`].
pub fn write(path: &Path, svg: &str, metadata: &Metadata) -> Result<()> {
    let fail = |reason: String| Error::Output { file: path.to_owned(), reason };
    let tree = Tree::from_str(svg, &options()).map_err(|error| fail(format!("the chart cannot be drawn: {error}")))?;
    let size = tree.size();
    let scale = SCALE.min(TALLEST / size.height());
    let [width, height] = [size.width(), size.height()].map(|side| (side * scale).ceil() as u32);
    let too_large = || fail(format!("a chart of {width}x{height} pixels cannot be drawn"));
    let mut picture = Pixmap::new(width, height).ok_or_else(too_large)?;
    picture.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut picture.as_mut());
    // On a white ground every pixel is opaque: nothing was multiplied by its opacity.
    let rgb: Vec<u8> = picture.data().chunks_exact(4).flat_map(|pixel| pixel.iter().take(3).copied()).collect();
    output::write_bytes(path, &output::png_of_rgb8(width, height, &rgb, metadata)?)
}

fn options() -> Options<'static> {
    let mut fonts = Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    Options { font_family: "DejaVu Sans".to_owned(), fontdb: Arc::new(fonts), ..Options::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// The picture as pixels across and down, and its bytes.
    fn drawn(content: &str) -> (u32, u32, Vec<u8>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let svg = format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20" color="#ff0000">{content}</svg>"##
        );
        write(&path, &svg, &Metadata::default()).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(fs::read(&path).unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        (reader.info().width, reader.info().height, bytes)
    }

    #[test]
    fn shapes_and_text_are_drawn_without_fonts_of_the_system() {
        let (width, height, empty) = drawn("");
        assert_eq!((width, height), (80, 40));
        assert!(empty.iter().all(|&byte| byte == 255));
        let (_, _, half) = drawn(r#"<rect width="20" height="20" fill="currentColor"/>"#);
        assert_eq!(half[..3], [255, 0, 0]);
        assert_eq!(half[79 * 3..80 * 3], [255; 3]);
        for text in ["A", "10⁻³", "∝", "·"] {
            let (_, _, bytes) = drawn(&format!(r#"<text x="2" y="15" font-size="14">{text}</text>"#));
            let ink = bytes.chunks(3).filter(|pixel| pixel[0] < 128).count();
            assert!(ink > 8, "{text}: {ink} dark pixels");
        }
    }

    #[test]
    fn what_is_no_drawing_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        for svg in ["", "<svg", "text"] {
            let error = write(&path, svg, &Metadata::default()).unwrap_err().to_string();
            assert!(error.contains("a.png") && error.contains("cannot be drawn"), "{error}");
        }
        assert!(!path.exists());
    }
}
