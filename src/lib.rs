//! wavetrace: a wavefront CPU path tracer for triangle scenes.
pub mod camera;
pub mod error;
pub mod output;
pub mod scene;
pub mod world;
