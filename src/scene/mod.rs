//! Scene files and meshes in: `scene.json` with the OBJ files it names becomes a [`WorldBuilder`].
//!
//! All mistakes of a scene are gathered, those in its meshes included, each with its place. The format is described in
//! `docs/scene-format.md`.

mod camera;
mod fields;
mod json;
mod material;
mod obj;
mod obj_check;
mod obj_lines;
mod object;
mod problems;

use std::path::Path;

pub use camera::{GivenAngles, MAX_PIXELS, MAX_SIDE};

use crate::error::{Error, Problem, Result};
use crate::input;
use crate::world::{MaterialInput, Mesh, WorldBuilder};
use fields::{Fields, Range};
use object::Meshes;
use problems::Problems;

const KEYS: &[&str] = &["camera", "materials", "objects", "background", "comment", "$schema"];

/// A scene that was read.
#[derive(Debug)]
pub struct Loaded {
    /// Camera, materials, meshes and objects of the scene.
    pub builder: WorldBuilder,
    /// What is odd but no obstacle, such as a key that nobody knows: the first 100, and the number of the others.
    pub warnings: Vec<Problem>,
    /// Which fields of view the scene states.
    pub given_angles: GivenAngles,
}

impl Loaded {
    /// Overrides the camera's pixels. A field of view that the scene does not state is derived anew, so that pixels
    /// stay square.
    ///
    /// # Errors
    /// [`Error::Setting`] of `--size` where the image would be empty or larger than [`MAX_SIDE`] and [`MAX_PIXELS`],
    /// or where the angle that follows rounds to 0 or 180 degrees.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<()> {
        let fault =
            |expected: String| Error::Setting { setting: "--size", found: format!("{width}x{height}"), expected };
        if width == 0 || height == 0 || !camera::pixels_fit(width, height) {
            return Err(fault(format!("1 to {MAX_SIDE} pixels each way and at most {MAX_PIXELS} in all")));
        }
        let mut resized = self.builder.camera().clone();
        (resized.width, resized.height) = (width, height);
        if !self.given_angles.complete(&mut resized) {
            return Err(fault("a shape from which square pixels give angles above 0 and below 180".to_owned()));
        }
        *self.builder.camera_mut() = resized;
        Ok(())
    }
}

/// Reads the scene at `path` and the meshes it names. The scene may come through a pipe, up to 256 MiB of it; meshes are
/// regular files.
///
/// # Errors
/// [`Error::Io`] where the scene file cannot be read, [`Error::Scene`] with the mistakes of the scene and its meshes: the first
/// 100 that were found, and the number of the others.
pub fn load(path: &Path) -> Result<Loaded> {
    let bytes = input::bounded(path).map_err(|source| Error::Io { file: path.to_owned(), action: "read", source })?;
    let text = decode(path, &bytes)?;
    let mut problems = Problems::new(path, text);
    let scene = read(text, path.parent().unwrap_or(Path::new("")), &mut problems);
    let (errors, warnings) = problems.into_parts();
    match scene {
        Some((builder, given_angles)) if errors.is_empty() => Ok(Loaded { builder, warnings, given_angles }),
        _ => Err(Error::Scene(errors)),
    }
}

/// Reads the OBJ file at `path` as one mesh: the faces of all its groups in their order, polygons as fans about their
/// first corner. Triangles without area are among them.
///
/// # Errors
/// [`Error::Io`] where the file cannot be read or is no regular file, [`Error::Scene`] with its mistakes, of which having no face is one.
pub fn load_mesh(path: &Path) -> Result<Mesh> {
    obj::load(path).map_err(|failure| match failure {
        obj::Failure::Unreadable(source) => Error::Io { file: path.to_owned(), action: "read", source },
        obj::Failure::Mistakes(problems) => Error::Scene(problems),
    })
}

/// The text of a scene file, which is UTF-8 without a byte order mark.
fn decode<'b>(path: &Path, bytes: &'b [u8]) -> Result<&'b str> {
    let fault = |place, found: String, hint: Option<&str>| {
        let (file, path, expected) = (path.to_owned(), String::new(), "a scene as JSON in UTF-8".to_owned());
        Error::Scene(vec![Problem { file, place: Some(place), path, found, expected, hint: hint.map(str::to_owned) }])
    };
    let resave = Some("save it as UTF-8 without a byte order mark");
    if bytes.starts_with(b"\xEF\xBB\xBF") {
        return Err(fault((1, 1), "a byte order mark".to_owned(), resave));
    }
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        return Err(fault((1, 1), "UTF-16".to_owned(), resave));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let (valid, rest) = bytes.split_at(error.valid_up_to());
        let valid = std::str::from_utf8(valid).unwrap_or_default();
        let byte = rest.first().copied().unwrap_or_default();
        let place = Problems::new(path, valid).place(valid.len());
        fault(place, format!("the byte 0x{byte:02X}, which is not UTF-8"), None)
    })?;
    match text.trim().is_empty() {
        true => Err(fault((1, 1), "an empty file".to_owned(), None)),
        false => Ok(text),
    }
}

fn read(text: &str, folder: &Path, problems: &mut Problems) -> Option<(WorldBuilder, GivenAngles)> {
    let root = json::parse(text, problems)?;
    let fields = Fields::open(&root, "", KEYS, problems)?;
    fields.comment(problems);
    let camera = fields.require("camera", "an object", problems).and_then(|node| camera::read(node, problems));
    let background = match fields.get("background") {
        Some(node) => fields::color(node, "background", &Range::NOT_NEGATIVE, problems),
        None => Some([0.0; 3]),
    };
    let materials =
        fields.require("materials", "a list", problems).and_then(|node| fields::items(node, "materials", problems));
    let inputs: Vec<Option<MaterialInput>> = materials
        .unwrap_or_default()
        .iter()
        .enumerate()
        .map(|(i, node)| material::read(node, &format!("materials[{i}]"), problems))
        .collect();
    let objects =
        fields.require("objects", "a list", problems).and_then(|node| fields::items(node, "objects", problems));
    let mut meshes = Meshes::new(folder);
    let mut placed = Vec::new();
    for (i, node) in objects.unwrap_or_default().iter().enumerate() {
        let count = materials.map(<[_]>::len);
        placed.push(object::read(node, &format!("objects[{i}]"), count, &mut meshes, problems));
    }

    let (camera, given_angles) = camera?;
    let mut builder = WorldBuilder::new(camera);
    builder.background(background?.map(|channel| channel as f32));
    for material in inputs {
        builder.material(material?);
    }
    for mesh in meshes.into_vec() {
        builder.mesh(mesh);
    }
    for object in placed {
        builder.object(object?);
    }
    Some((builder, given_angles))
}
