//! From a scene file to a world, with its warnings shown.

use super::Exit;
use super::messages::Console;
use std::path::Path;
use wavetrace::camera::Camera;
use wavetrace::scene;
use wavetrace::world::World;

/// A scene that was read and found right.
pub struct Scene {
    /// The camera as stated, its size overridden.
    pub camera: Camera,
    /// The frozen scene.
    pub world: World,
}

/// Reads the scene at `path`, with `size` pixels in place of its own. Mistakes and warnings are shown, all of them.
pub fn load(path: &Path, size: Option<(u32, u32)>, console: &Console) -> Result<Scene, Exit> {
    let mut loaded = scene::load(path).map_err(|error| console.fail(&error))?;
    for warning in &loaded.warnings {
        console.warn(warning);
    }
    if let Some((width, height)) = size {
        loaded.resize(width, height).map_err(|error| console.fail(&error))?;
    }
    let camera = loaded.builder.camera().clone();
    let world = loaded.builder.build().map_err(|error| console.fail(&error))?;
    if world.is_dark() {
        let path = path.display();
        console.warn(format_args!(
            "{path}: found no light, expected a luminous material that some object has, or a background: \
             the image is black"
        ));
    }
    console.settle()?;
    Ok(Scene { camera, world })
}
