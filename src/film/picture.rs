//! The finished picture.

/// A linear RGB picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Pixels across, at least 1.
    pub width: u32,
    /// Pixels down, at least 1.
    pub height: u32,
    /// `width * height` radiances, linear RGB with Rec. 709 primaries, row by row from the top left corner.
    pub pixels: Vec<[f32; 3]>,
}

impl Image {
    /// What keeps this image from being written, if anything: no pixels, a side beyond the 2^31 - 1 that PNG and
    /// OpenEXR can state, or a pixel count that does not match the sides.
    pub(crate) fn flaw(&self) -> Option<String> {
        let (width, height) = (self.width, self.height);
        let side = 1..=i32::MAX as u32;
        if !side.contains(&width) || !side.contains(&height) {
            return Some(format!("found an image of {width}x{height} pixels, expected sides from 1 to {}", i32::MAX));
        }
        let expected = u64::from(width) * u64::from(height);
        let found = self.pixels.len();
        (found as u64 != expected).then(|| format!("found {found} pixels, expected {width}x{height} = {expected}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixel_count_must_match_the_sides() {
        let image = |width, height, count| Image { width, height, pixels: vec![[0.0; 3]; count] };
        assert_eq!(image(3, 2, 6).flaw(), None);
        assert!(image(3, 2, 5).flaw().is_some_and(|flaw| flaw.contains("found 5 pixels, expected 3x2 = 6")));
        assert!(image(0, 2, 0).flaw().is_some());
        assert!(image(2, 0, 0).flaw().is_some());
        assert!(image(u32::MAX, u32::MAX, 1).flaw().is_some());
    }
}
