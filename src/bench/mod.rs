//! Measuring ray throughput: sets of rays on any mesh, the kernels on them, and the clock.
//!
//! [`make`] makes the sets of a mesh, [`Tracer`] traces them, [`trace`] and [`measure()`] time that; [`suite`] is all that is
//! measured when nothing is named, [`verdict`] holds two series against each other. Rays and hits have the layout of the
//! files in which they are exchanged with other tracers ([`files`]), so that a figure holds the way from such a ray to the
//! kernel's and from its hit to such a hit, as any program that calls a tracer has to go.

pub mod camera;
mod cpu;
pub mod files;
pub mod kernel;
pub mod measure;
pub mod mesh;
pub mod room;
pub mod sets;
pub mod suite;
mod surfaces;
pub mod verdict;
#[cfg(test)]
mod work;

pub use camera::{Axis, View};
pub use files::{HitRecord, RayRecord};
pub use kernel::{Kernel, Tracer};
pub use measure::{Case, Figure, Pace, Unit, measure};
pub use mesh::{Bounds, Corners};
pub use room::room;
pub use sets::{Options, RaySet, SetKind, make};
pub use suite::rays::trace;
