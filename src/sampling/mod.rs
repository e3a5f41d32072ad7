//! Random numbers: where they come from, what each is for, and how they become directions and points.

mod dims;
mod mis;
mod screen;
mod sobol;
pub mod warp;
mod xoshiro;

pub use dims::Decision;
pub use mis::{power_heuristic, power_heuristic_over_pdf};
pub use screen::Screen;
pub use sobol::Sobol;
pub use xoshiro::Xoshiro;

use crate::lanes::Lanes;

/// State of a path's random numbers: two integers per lane, whose meaning belongs to the sampler.
pub type State<L> = [<L as Lanes>::Uint; 2];

/// Source of the random numbers of a path, keyed by (seed, pixel, sample).
pub trait Sampler: Copy + Default + Send + Sync + 'static {
    /// State of the first number of sample `sample` of pixel number `pixel`, which has nothing to do with those of others.
    fn start<L: Lanes>(seed: u64, pixel: L::Uint, sample: L::Uint) -> State<L>;
    /// State of the first number of a sample of a pixel (x, y) of an image.
    #[inline(always)]
    fn on_screen<L: Lanes>(screen: &Screen, seed: u64, pixel: [L::Uint; 2], sample: L::Uint) -> State<L> {
        Self::start::<L>(seed, screen.number::<L>(pixel), sample)
    }
    /// State of a second path that leaves this one, whose numbers have nothing to do with those of the first.
    fn fork<L: Lanes>(state: &State<L>) -> State<L>;
    /// N numbers in [0, 1), multiples of 2^-24, for a decision at the path's vertex number `depth`.
    fn draw<L: Lanes, const N: usize>(state: &mut State<L>, decision: Decision, depth: L::Uint) -> [L; N];
}
