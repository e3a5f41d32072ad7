//! What shading is compiled for. Most scenes are plain: their groups of rows are not asked for what the scene lacks, and carry none of it
//! through registers.

use super::plan::Plan;
use crate::world::World;

/// Which features a group of rows may have.
pub trait Form {
    /// Interpolated normals, refraction, lights chosen by where they are needed.
    const EXTRAS: bool;
    /// Light that mirrors and glass focus, found by light paths and by paths that look for it.
    const FOCUS: bool;
}

/// None of them.
pub struct Plain;
/// All but focused light.
pub struct Rich;
/// All.
pub struct Focused;

impl Form for Plain {
    const EXTRAS: bool = false;
    const FOCUS: bool = false;
}
impl Form for Rich {
    const EXTRAS: bool = true;
    const FOCUS: bool = false;
}
impl Form for Focused {
    const EXTRAS: bool = true;
    const FOCUS: bool = true;
}

impl Plan {
    /// Whether shading for plain scenes is enough.
    pub fn is_plain(&self, world: &World) -> bool {
        !(world.normals.is_some() || self.transmit || world.lights.depend_on_receiver() || self.caustics())
    }
}
