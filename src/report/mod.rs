//! Figures of images: how far one is from another. Pure functions over pixels: no files, no printing.
//!
//! An image is a slice of linear RGB pixels, row by row from the top left, as in [`Image`](crate::film::Image). Pixels
//! that are not finite in either image are left out of every figure, and counted.

mod colour;
pub mod errors;
mod filter;
pub mod flip;
pub mod heatmap;
mod student;
pub mod welch;

pub use errors::{Errors, Figure, Flaws, Means, errors};
pub use flip::{Flip, Viewing, flip};
pub use heatmap::Scale;
pub use welch::{Measured, Welch, welch};
