//! What goes into an image file besides its text.

use super::Image;

/// The pixels, and what EXR files alone hold beside them. An image without more is `(&image).into()`.
#[derive(Clone, Copy, Debug)]
pub struct Layers<'a> {
    /// The pixels.
    pub image: &'a Image,
    /// Variances of the pixels' means, in their number and order; other formats than EXR leave them out.
    pub variance: Option<&'a [[f32; 3]]>,
}

impl Layers<'_> {
    /// What keeps them from being written, if anything.
    pub(super) fn flaw(&self) -> Option<String> {
        let expected = self.image.pixels.len();
        let found = self.variance.map_or(expected, <[_]>::len);
        let uneven = || {
            (found != expected).then(|| format!("found {found} variances, expected one for each of {expected} pixels"))
        };
        self.image.flaw().or_else(uneven)
    }
}

impl<'a> From<&'a Image> for Layers<'a> {
    fn from(image: &'a Image) -> Self {
        Self { image, variance: None }
    }
}
