//! Light that leaves a surface, from both sides; such a surface reflects nothing.

/// One luminous material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Luminous {
    /// Emitted radiance per channel, >= 0.
    pub radiance: [f32; 3],
}
