//! OpenEXR: 32-bit float RGB, linear, losslessly compressed; metadata as text attributes. The only folder that names the
//! crate `exr`.
//!
//! Channels are `R`, `G`, `B`, and, where they are known, the variances of the pixels' means: `variance.R`, `variance.G`,
//! `variance.B`.

mod limits;
mod read;
mod write;

use exr::{math::Vec2, meta::attribute::Chromaticities};

pub(super) use read::decode;
pub(super) use write::encode;

/// Channels of the pixels.
const COLOURS: [&str; 3] = ["R", "G", "B"];
/// Channels of the variances.
const VARIANCES: [&str; 3] = ["variance.R", "variance.G", "variance.B"];

const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};
