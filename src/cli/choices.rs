//! Options whose value is one of a few words. The words appear in `--help`, in `--stats` and in image files.

use clap::ValueEnum;
use wavetrace::{accel, bench, output, render, wave};

/// Light transport, `--method`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// BSDF sampling alone: light is found by chance
    Path,
    /// Next-event estimation alone; lobes that it cannot reach are still followed
    Nee,
    /// Both, combined by multiple importance sampling
    #[default]
    Mis,
}

/// Source of random numbers, `--sampler`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Sampler {
    /// Independent streams
    Xoshiro,
    /// Owen-scrambled Sobol points
    #[default]
    Sobol,
}

/// Which tiles get how many samples, `--effort`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Effort {
    /// All the same
    #[default]
    Even,
    /// More where there is more error, as eight samples per pixel tell that are traced before
    Tiles,
}

/// Whether something is done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// Yes
    #[default]
    On,
    /// No
    Off,
}

/// How camera rays are traced, `--camera-rays`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum CameraRays {
    /// Tiles of neighbours that run the same way
    #[default]
    Tile,
    /// Like other rays
    Stream,
}

/// How rays after a bounce and shadow rays are traced, `--bounce-rays`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum BounceRays {
    /// Put in order and traced in streams, where that pays
    #[default]
    Stream,
    /// Many in flight, in their order
    Many,
}

/// When rows are sorted into lists, `--sort`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Sort {
    /// Where surfaces are of several kinds
    #[default]
    Auto,
    /// Also where they are of one kind
    Always,
}

/// Which integrator runs, `--integrator`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Integrator {
    /// Waves of paths through batched SIMD stages
    #[default]
    Wavefront,
    /// One path after the other: the same image, slowly
    Reference,
    /// One path, box and triangle after the other, without SIMD: the same image, still more slowly
    Scalar,
}

/// What the tree is built for, `--bvh`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Quality {
    /// Little time before the first ray
    Fast,
    /// Pays for itself within a preview
    #[default]
    Balanced,
    /// Pays for itself in long renders
    Best,
}

/// What becomes of values above 1 in 8-bit images, `--tonemap`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ToneMap {
    /// They become 1
    #[default]
    Clamp,
    /// The image is divided by its largest component
    Max,
}

/// Which axis points up, `--up`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum UpAxis {
    /// The first
    X,
    /// The second
    #[default]
    Y,
    /// The third
    Z,
}

/// How far images are apart, `--metric`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Metric {
    /// Mean of (A - B)^2 / (B^2 + 0.01)
    Relmse,
    /// Mean of (A - B)^2
    Mse,
    /// -10 log10(MSE), in dB
    Psnr,
    /// How visible the differences are, from 0 to 1
    Flip,
    /// Mean luminance and channels of both
    Mean,
}

/// The word that stands for a choice.
pub fn word(choice: impl ValueEnum) -> String {
    choice.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

impl From<Method> for wave::Method {
    fn from(method: Method) -> Self {
        match method {
            Method::Path => Self::Path,
            Method::Nee => Self::Nee,
            Method::Mis => Self::Mis,
        }
    }
}

impl From<Sampler> for render::SamplerKind {
    fn from(sampler: Sampler) -> Self {
        match sampler {
            Sampler::Xoshiro => Self::Xoshiro,
            Sampler::Sobol => Self::Sobol,
        }
    }
}

impl From<Effort> for render::Effort {
    fn from(effort: Effort) -> Self {
        match effort {
            Effort::Even => Self::Even,
            Effort::Tiles => Self::Tiles,
        }
    }
}

impl From<Integrator> for render::Integrator {
    fn from(integrator: Integrator) -> Self {
        match integrator {
            Integrator::Wavefront => Self::Wavefront,
            Integrator::Reference => Self::Reference,
            Integrator::Scalar => Self::Scalar,
        }
    }
}

impl From<Quality> for accel::Quality {
    fn from(quality: Quality) -> Self {
        match quality {
            Quality::Fast => Self::Fast,
            Quality::Balanced => Self::Balanced,
            Quality::Best => Self::Best,
        }
    }
}

impl From<ToneMap> for output::ToneMap {
    fn from(map: ToneMap) -> Self {
        match map {
            ToneMap::Clamp => Self::Clamp,
            ToneMap::Max => Self::Max,
        }
    }
}

impl From<UpAxis> for bench::Axis {
    fn from(axis: UpAxis) -> Self {
        match axis {
            UpAxis::X => Self::X,
            UpAxis::Y => Self::Y,
            UpAxis::Z => Self::Z,
        }
    }
}
