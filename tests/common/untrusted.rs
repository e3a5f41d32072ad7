//! Bytes of unknown origin on the way of a user's files through the library: what the fuzzers in `fuzz/` and the test of
//! their corpus share. Nothing here may panic, whatever the bytes.
#![allow(dead_code)] // Every fuzzer is a crate of its own and uses its share of this.

use std::{fs, path::Path, path::PathBuf, time::Duration};

use tempfile::TempDir;
use wavetrace::accel::{BuildOptions, Quality};
use wavetrace::error::{Error, Result};
use wavetrace::output;
use wavetrace::render::{Control, Renderer, Settings};
use wavetrace::report::errors::rel_mse_less_variance;
use wavetrace::report::{Measured, Viewing, errors, flip, welch};
use wavetrace::scene;

/// What the library says of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    Accepted,
    Refused,
}

/// Pixels of the renders.
const SIZE: (u32, u32) = (4, 3);
/// Triangles at most of a world that is rendered, and pixels of images that are compared: time goes into many inputs.
const SMALL: usize = 4096;

/// Meshes that a scene may name: closed, open and flat, smooth, without area.
const MESHES: [(&str, &str); 4] = [
    ("box.obj", include_str!("../../meshes/box.obj")),
    ("quad.obj", include_str!("../../meshes/quad.obj")),
    ("n.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 1 1 0\nf 1//1 2//2 3//1\nf 1//1 2//2 4//1\nf 2 4 3\n"),
    ("dot.obj", "v 1 2 3\nf 1 1 1\n"),
];
/// Where the mesh that is tried stands matt, as glass and as a lamp.
const OF_ONE_MESH: &str = r#"{
  "camera": {"focalPoint": {"x": 0, "y": -5, "z": 0.5}, "direction": {"x": 0, "y": 1, "z": 0}},
  "materials": [
    {"type": "diffuse", "mattness": 0.5, "color": {"r": 0.8, "g": 0.8, "b": 0.8}},
    {"type": "transparent", "refIndex": 1.5, "color": {"r": 1, "g": 1, "b": 1}},
    {"type": "diffuse", "color": {"r": 1, "g": 1, "b": 1}, "isLuminous": true}
  ],
  "objects": [
    {"type": "mesh", "path": "any.obj", "materialIndex": 0, "scale": 1, "xrot": 30},
    {"type": "mesh", "path": "any.obj", "materialIndex": 1, "scale": 2, "midPoint": {"x": 1, "y": 1, "z": 0}},
    {"type": "mesh", "path": "any.obj", "materialIndex": 2, "scale": 0.5, "midPoint": {"x": 0, "y": 0, "z": 3}}
  ],
  "background": {"r": 0.1, "g": 0.1, "b": 0.1}
}"#;

/// Where inputs become files: the library reads files only. In memory, where the system has such a place.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        let memory = Path::new("/dev/shm");
        let folder = if memory.is_dir() { TempDir::new_in(memory) } else { TempDir::new() };
        let folder = Self(folder.expect("a temporary folder"));
        for (name, text) in MESHES {
            folder.file(name, text.as_bytes());
        }
        folder
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, bytes).expect("a file in the temporary folder");
        path
    }

    /// As a scene: read, built, rendered.
    pub fn scene(&self, bytes: &[u8]) -> Verdict {
        verdict(render(&self.file("any.json", bytes)))
    }

    /// As the mesh of a scene.
    pub fn obj(&self, bytes: &[u8]) -> Verdict {
        self.file("any.obj", bytes);
        verdict(render(&self.file("of_one_mesh.json", OF_ONE_MESH.as_bytes())))
    }

    /// As an image: read, and compared with itself.
    pub fn image(&self, bytes: &[u8]) -> Verdict {
        verdict(compare(&self.file("any image", bytes)))
    }
}

/// A message must come out, too.
fn verdict(result: Result<()>) -> Verdict {
    match result {
        Ok(()) => Verdict::Accepted,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            Verdict::Refused
        }
    }
}

fn render(path: &Path) -> Result<()> {
    let mut loaded = scene::load(path)?;
    loaded.warnings.iter().for_each(|warning| assert!(!warning.to_string().is_empty()));
    // An angle that does not fit the new shape is none of the scene's mistakes.
    let resized = loaded.resize(SIZE.0, SIZE.1);
    assert!(matches!(resized, Ok(()) | Err(Error::Setting { .. })));
    let world = loaded.builder.build()?;
    if resized.is_err() || world.triangles() > SMALL {
        return Ok(());
    }
    let renderer = Renderer::with_options(
        world,
        &BuildOptions { quality: Quality::default(), threads: 1, ..BuildOptions::default() },
    )?;
    let settings = Settings { threads: 1, wave_size: 64, time: Duration::MAX, ..Settings::default() };
    renderer.render(&settings, &Control::default()).map(drop)
}

fn compare(path: &Path) -> Result<()> {
    let file = output::read(path)?;
    let pixels = &file.image.pixels;
    if pixels.len() > SMALL {
        return Ok(());
    }
    let (width, variance) = (file.image.width as usize, file.variance.as_deref());
    let side = Measured { pixels, variance, samples: file.metadata.get("spp").and_then(|spp| spp.parse().ok()) };
    // Where a figure cannot be had, an error says so; the image was read.
    let _ = errors(pixels, pixels);
    let _ = flip(pixels, pixels, width, &Viewing::default());
    let _ = welch(side, side, width, 1);
    let _ = variance.map(|variance| rel_mse_less_variance(pixels, pixels, variance));
    Ok(())
}
