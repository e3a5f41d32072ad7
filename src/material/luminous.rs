//! Light that leaves a surface, from both sides; such a surface reflects nothing.

/// One luminous material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Luminous {
    /// Emitted radiance per channel, >= 0.
    pub radiance: [f32; 3],
    /// Density with which light sampling chooses a point on a surface of this material, per area of the world; 0 where
    /// it never does.
    pub pdf_area: f32,
}
