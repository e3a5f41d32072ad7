//! How surfaces scatter light. A lobe is one file; the list of lobes is in `materials!` below and nowhere else.
//!
//! A lobe works in a frame whose third axis is the shading normal on the side of `wo`; `wo` and `wi` point away from
//! the surface. Its parameters are columns of a dense table, reached statically: there is no `dyn` and no per-ray enum.

mod diffuse;
mod luminous;
mod matt;
mod specular;
mod transparent;

pub use diffuse::{Diffuse, DiffuseRow};
pub use luminous::Luminous;
pub use matt::{Matt, MattRow};
pub use specular::{Specular, SpecularRow};
pub use transparent::{Transparent, TransparentRow, fresnel_dielectric};

use crate::ids::LobeId;
use crate::lanes::{Lanes, Vec3};

/// A direction that a lobe chose.
#[derive(Clone, Copy, Debug)]
pub struct Scattered<L: Lanes> {
    /// The direction, local.
    pub wi: Vec3<L>,
    /// f cos(theta) / pdf.
    pub weight: Vec3<L>,
    /// Squared ratio of the refractive indices where the path crossed the surface, else 1: by how much radiance was
    /// scaled without energy being lost. Roulette takes it out again.
    pub radiance_scale: L,
    /// Whether the path went through the surface.
    pub transmitted: L::Mask,
}

/// What a lobe reflects from `wi` to `wo`.
#[derive(Clone, Copy, Debug)]
pub struct Evaluated<L: Lanes> {
    /// f cos(theta).
    pub f_cos: Vec3<L>,
    /// Density of sampling `wi`, per solid angle.
    pub pdf: L,
}

/// A way to scatter light.
pub trait Lobe: Copy + Default + Send + Sync + 'static {
    /// Whether all light leaves in finitely many directions, so that no light can be connected to.
    const DELTA: bool;
    /// Whether light passes through the surface.
    const TRANSMITS: bool;
    /// Random numbers that a direction takes.
    const NUMBERS: usize;
    /// Name for people.
    const NAME: &'static str;
    /// One material: up to four numbers, which shading reads at once.
    type Row: Copy + Into<[f32; 4]>;
    /// The materials of a group of rows.
    type Params<L: Lanes>: Copy;
    /// The materials of a group from their numbers.
    fn params<L: Lanes>(numbers: [L; 4]) -> Self::Params<L>;
    /// Chooses a direction by `u`. `outside` tells where `wo` is on the front side of the surface.
    fn sample<L: Lanes>(p: &Self::Params<L>, wo: Vec3<L>, outside: L::Mask, u: [L; 3]) -> Scattered<L>;
    /// Evaluates a direction; zero for delta lobes and below the surface.
    fn eval<L: Lanes>(p: &Self::Params<L>, wo: Vec3<L>, wi: Vec3<L>) -> Evaluated<L>;
}

/// Makes the list of lobes: `Kind`, the tables, and the way from a kind to its type.
macro_rules! materials {
    ($($kind:ident: $table:ident,)*) => {
        /// Kind of what a surface does with light.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Kind {
            $(#[doc = concat!("See [`struct@", stringify!($kind), "`].")] $kind,)*
            /// See [`Luminous`]; scatters nothing.
            Luminous,
        }

        impl Kind {
            /// Kinds that scatter, in the order of their numbers.
            pub const SCATTERING: &[Kind] = &[$(Kind::$kind),*];
            /// Number of kinds.
            pub const COUNT: usize = Self::SCATTERING.len() + 1;
            /// Name for people.
            pub fn name(self) -> &'static str {
                match self {
                    $(Kind::$kind => <$kind as Lobe>::NAME,)*
                    Kind::Luminous => "luminous",
                }
            }
            /// Whether it is a delta lobe.
            pub fn is_delta(self) -> bool {
                match self {
                    $(Kind::$kind => <$kind as Lobe>::DELTA,)*
                    Kind::Luminous => false,
                }
            }
        }

        /// All materials: one dense table per kind.
        #[derive(Clone, Debug, Default)]
        pub struct Materials {
            $($table: Vec<[f32; 4]>,)*
            luminous: Vec<Luminous>,
        }

        $(
            impl Table<$kind> for Materials {
                #[inline(always)]
                fn rows(&self) -> &[[f32; 4]] {
                    &self.$table
                }
                fn add(&mut self, row: <$kind as Lobe>::Row) -> Option<LobeId> {
                    self.$table.push(row.into());
                    LobeId::new(Kind::$kind as usize, self.$table.len() - 1)
                }
            }
        )*

        impl Materials {
            /// Number of materials of a kind.
            pub fn count(&self, kind: Kind) -> usize {
                match kind {
                    $(Kind::$kind => self.$table.len(),)*
                    Kind::Luminous => self.luminous.len(),
                }
            }
        }

        /// Runs `$body` with the type alias `$M` set to the lobe of `$k`, a scattering kind.
        macro_rules! for_kind {
            ($k:expr, $M:ident => $body:expr) => {
                match $k {
                    $($crate::material::Kind::$kind => { type $M = $crate::material::$kind; $body })*
                    $crate::material::Kind::Luminous => {}
                }
            };
        }
        pub(crate) use for_kind;
    };
}

materials! {
    Diffuse: diffuse,
    Matt: matt,
    Specular: specular,
    Transparent: transparent,
}

/// The table of a lobe's materials.
pub trait Table<M: Lobe> {
    /// All rows, each as its numbers.
    fn rows(&self) -> &[[f32; 4]];
    /// Adds a row and returns its id; `None` past 2^28 rows.
    fn add(&mut self, row: M::Row) -> Option<LobeId>;
}

impl Materials {
    /// All luminous materials.
    #[inline(always)]
    pub fn luminous(&self) -> &[Luminous] {
        &self.luminous
    }
    /// Adds a luminous material and returns its id; `None` past 2^28 rows.
    pub fn add_luminous(&mut self, row: Luminous) -> Option<LobeId> {
        self.luminous.push(row);
        LobeId::new(Kind::Luminous as usize, self.luminous.len() - 1)
    }
}

#[cfg(test)]
pub(crate) mod test_util {
    //! The mirrored test of every lobe: samples against the stated density.
    use super::*;
    use crate::sampling::{Decision, Sampler, Xoshiro};
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    pub fn direction(theta_degrees: f64, phi: f64) -> Vec3<f32> {
        let t = theta_degrees.to_radians();
        Vec3::new((t.sin() * phi.cos()) as f32, (t.sin() * phi.sin()) as f32, t.cos() as f32)
    }

    pub fn numbers(i: u32) -> [f32; 3] {
        let mut s = Xoshiro::start::<f32>(11, i, 1);
        Xoshiro::draw(&mut s, Decision::Scatter, 0)
    }

    /// p-value of the chi-squared test of `n` samples against the lobe's density, over a grid in (cos^2, phi) about the
    /// direction `about`, where narrow lobes are resolved by a power law in the angle. Cells with expectation below 5
    /// are pooled; a sample in a cell of zero density fails.
    pub fn chi_squared<M: Lobe>(p: &M::Params<f32>, wo: Vec3<f32>, about: Vec3<f32>, n: u32) -> f64 {
        use crate::lanes::Frame;
        const RINGS: usize = 40;
        const SECTORS: usize = 16;
        const STEPS: usize = 48;
        let frame = Frame::about(about);
        // Ring k spans angles pi (k/RINGS)^3, so that a narrow peak at `about` fills many rings.
        let edge = |k: f64| std::f64::consts::PI * (k / RINGS as f64).powi(3);
        let mut seen = vec![0u32; RINGS * SECTORS];
        for i in 0..n {
            let w = frame.to_local(M::sample(p, wo, true, numbers(i)).wi);
            let angle = f64::from((w.x * w.x + w.y * w.y).sqrt()).atan2(f64::from(w.z));
            let ring = ((angle / std::f64::consts::PI).cbrt() * RINGS as f64).min(RINGS as f64 - 1.0) as usize;
            let turn = f64::from(w.y).atan2(f64::from(w.x)) / std::f64::consts::TAU + 0.5;
            seen[ring * SECTORS + (turn * SECTORS as f64).min(SECTORS as f64 - 1.0) as usize] += 1;
        }
        let (mut chi2, mut cells, mut rest_seen, mut rest_expected, mut total) = (0.0, 0, 0.0, 0.0, 0.0);
        for ring in 0..RINGS {
            for sector in 0..SECTORS {
                let mut integral = 0.0;
                for a in 0..STEPS {
                    for b in 0..STEPS {
                        let angle = edge(ring as f64 + (a as f64 + 0.5) / STEPS as f64);
                        let width = edge(ring as f64 + (a as f64 + 1.0) / STEPS as f64)
                            - edge(ring as f64 + a as f64 / STEPS as f64);
                        let step = std::f64::consts::TAU / SECTORS as f64 / STEPS as f64;
                        let phi = (sector * STEPS + b) as f64 * step + 0.5 * step - std::f64::consts::PI;
                        let wi = frame.to_world(direction(angle.to_degrees(), phi));
                        integral += f64::from(M::eval(p, wo, wi).pdf) * angle.sin() * width * step;
                    }
                }
                let (observed, expected) = (f64::from(seen[ring * SECTORS + sector]), integral * f64::from(n));
                total += integral;
                assert!(expected > 0.0 || observed == 0.0, "{observed} samples where the density is zero");
                if expected < 5.0 {
                    rest_seen += observed;
                    rest_expected += expected;
                } else {
                    chi2 += (observed - expected).powi(2) / expected;
                    cells += 1;
                }
            }
        }
        assert!((total - 1.0).abs() < 2e-3, "the density integrates to {total}");
        if rest_expected >= 5.0 {
            chi2 += (rest_seen - rest_expected).powi(2) / rest_expected;
            cells += 1;
        }
        1.0 - ChiSquared::new(f64::from(cells - 1)).expect("at least two cells").cdf(chi2)
    }
}
