//! wavetrace: a wavefront CPU path tracer for triangle scenes.
pub mod accel;
pub mod camera;
pub mod columns;
pub mod error;
pub mod film;
pub mod ids;
pub mod lanes;
pub mod light;
pub mod material;
pub mod output;
pub mod probe;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod wave;
pub mod world;
