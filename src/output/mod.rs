//! Image files: PNG and PPM (8 bit, sRGB), OpenEXR and Radiance HDR (linear).
//!
//! One file per format, each the only one that names its crate. [`write()`] never leaves half a file behind:
//! it encodes beside the target and then renames. [`read()`] takes what others wrote, too.

mod embed;
mod exr;
mod file;
mod format;
mod hdr;
mod layers;
mod metadata;
mod name;
mod png;
mod ppm;
mod read;
mod target;
mod tone;

pub use crate::film::Image;
pub use embed::{png_bytes, png_of_rgb8};
pub use file::{check_writable, check_writable_text, write, write_all, write_bytes, write_new, write_text};
pub use format::Format;
pub use layers::Layers;
pub use metadata::{Metadata, PARTIAL};
pub use name::{LocalTime, default_name, local_now};
pub use read::{ImageFile, read};
pub use tone::{Tone, ToneMap, from_srgb8};
