//! Vectors and matrices of the placement side, in f64; the only file that names glam. The path side uses lanes.

pub use glam::{DMat3, DVec3, Vec3};
