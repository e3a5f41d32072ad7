//! Names each random number that a path uses.

/// What random numbers are drawn for. A sampler with structure gives each decision dimensions of its own, so that the
/// numbers of one decision are well spread against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// Position within the pixel: 2 numbers.
    Pixel,
    /// Direction of scattering: up to 3 numbers.
    Scatter,
    /// Whether the path goes on: 1 number.
    Roulette,
    /// Which light (2 numbers) and where on it (2 numbers).
    Light,
}

impl Decision {
    /// (set of four dimensions at a vertex, first dimension in the set).
    pub(super) const fn place(self) -> (u32, usize) {
        match self {
            Decision::Pixel => (0, 0),
            Decision::Scatter => (1, 0),
            Decision::Roulette => (1, 3),
            Decision::Light => (2, 0),
        }
    }
    /// Sets per vertex.
    pub(super) const SETS: u32 = 3;
}
