//! Names each random number that a path uses.

/// What random numbers are drawn for. A sampler with structure gives each decision pairs of dimensions of its own: two
/// numbers of a pair are well spread against each other, the first and second of a decision, then the third and fourth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// Position within the pixel: 2 numbers.
    Pixel,
    /// Direction of scattering: up to 3 numbers.
    Scatter,
    /// Whether the path goes on: 1 number.
    Roulette,
    /// Which light (1 number).
    Pick,
    /// Where on the light: 2 numbers.
    Light,
}

impl Decision {
    /// Number of the decision's first pair among those of a vertex.
    pub(super) const fn pair(self) -> u32 {
        match self {
            Decision::Pixel => 0,
            Decision::Scatter => 1,
            Decision::Roulette => 3,
            Decision::Pick => 4,
            Decision::Light => 5,
        }
    }
    /// Pairs per vertex.
    pub(super) const PAIRS: u32 = 6;
}
