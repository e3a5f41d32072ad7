//! wavetrace: a wavefront CPU path tracer for triangle scenes.
//!
//! What it aims at, in this order:
//!
//! 1. the image is right;
//! 2. the time to a given error is short;
//! 3. the code is small enough to hold in one head.
//!
//! # Flow
//!
//! ```text
//! scene.json --scene--> WorldBuilder --build--> World --> Bvh, Plan
//! for each job (tile x sample range; one worker owns one wave):
//!   generate -> intersect -> route -+- escape  (background)
//!                                   +- emit    (lights that were hit)
//!                                   +- shade   (one kind of surface after the other)
//!               connect (shadow rays) -> compact, and again until the wave is empty
//!   -> accumulate -> Film --output--> PNG, PPM, EXR, HDR
//! ```
//!
//! Paths move in batches from stage to stage, in queues of columns, eight lanes at a time. Threads share nothing but the
//! scene and the film. The same seed gives the same image to the bit, on any number of threads.
//! `docs/architecture.md` tells how the program is built, `docs/scene-format.md` what a scene file says.
//!
//! # Use
//!
//! Everything needed to build, render and write a scene is re-exported here or in [`scene`] and [`output`]:
//!
//! ```
//! use wavetrace::{Camera, Control, DVec3, MaterialInput, Mesh, Object, Renderer, Settings, Size, WorldBuilder};
//!
//! # fn main() -> wavetrace::Result<()> {
//! // A tilted floor under a white sky, seen from above.
//! let mut world = WorldBuilder::new(Camera {
//!     focal_point: DVec3::new(0.0, 0.0, 2.0),
//!     direction: DVec3::new(0.0, 0.0, -1.0),
//!     width: 8,
//!     height: 8,
//!     x_angle: 45.0,
//!     y_angle: 45.0,
//! });
//! let material = world.material(MaterialInput::Diffuse { color: [0.5, 0.25, 0.0], mattness: 1.0 });
//! let mesh = world.mesh(Mesh {
//!     positions: vec![DVec3::new(-5.0, -5.0, 0.0), DVec3::new(5.0, -5.0, 0.0), DVec3::new(0.0, 10.0, 0.0)],
//!     triangles: vec![[0, 1, 2]],
//!     ..Mesh::default()
//! });
//! let (rotation, size, mid_point) = (DVec3::new(30.0, 0.0, 0.0), Size::Scale(1.0), DVec3::ZERO);
//! world.object(Object { mesh, material, rotation, size, mid_point });
//! world.background([2.0; 3]);
//!
//! let renderer = Renderer::new(world.build()?);
//! let rendered = renderer.render(&Settings { spp: 4, ..Settings::default() }, &Control::default())?;
//! let image = rendered.film.image();
//!
//! // Linear RGB, row by row from the top left. What the floor reflects of the sky is exactly its colour.
//! let pixels: &[[f32; 3]] = &image.pixels;
//! assert_eq!(pixels.len(), 8 * 8);
//! assert!(pixels.iter().all(|p| (p[0] - 1.0).abs() < 1e-5 && (p[1] - 0.5).abs() < 1e-5 && p[2] == 0.0));
//! # Ok(())
//! # }
//! ```
//!
//! [`scene::load`] reads a scene file into a [`WorldBuilder`], [`output::write()`] writes an [`Image`] in the format that
//! its file's ending names. Another thread follows a render and stops it through its [`Control`]. Nothing here prints,
//! exits or panics on any input: what goes wrong comes back as an [`Error`]. `examples/library.rs` is a longer example.

#![deny(unsafe_code)]

pub mod accel;
pub mod bench;
pub mod camera;
pub mod chart;
pub mod columns;
pub mod error;
pub mod film;
pub mod ids;
pub mod input;
pub mod lanes;
pub mod light;
pub mod linear;
pub mod material;
pub mod output;
pub mod probe;
pub mod render;
pub mod report;
pub mod sampling;
pub mod scene;
pub mod wave;
pub mod world;

pub use crate::linear::DVec3;
pub use camera::Camera;
pub use error::{Error, Problem, Result};
pub use film::Film;
pub use output::Image;
pub use render::{Control, Integrator, Rendered, Renderer, SamplerKind, Settings};
pub use wave::{Method, Plan};
pub use world::{MaterialInput, Mesh, Object, Size, World, WorldBuilder};
