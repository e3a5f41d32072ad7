//! Reads the `objects` of a scene and the meshes they name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::linear::DVec3;

use super::fields::{self, Fields, Range, fits_single};
use super::json::Node;
use super::obj::{self, Failure};
use super::problems::Problems;
use crate::error::Problem;
use crate::world::{Mesh, Object, Size};

const KEYS: &[&str] =
    &["type", "path", "materialIndex", "midPoint", "midpoint", "height", "scale", "xrot", "yrot", "zrot", "comment"];

/// A mesh is flat along z where its extent there is at most this share of its largest extent.
const FLAT: f64 = 1e-9;

/// The meshes that objects name, each read once.
pub(super) struct Meshes<'a> {
    folder: &'a Path,
    /// Index into `read`, or none of a file that is no mesh.
    by_path: HashMap<PathBuf, Option<usize>>,
    read: Vec<Mesh>,
}

impl<'a> Meshes<'a> {
    /// Paths are relative to `folder`.
    pub fn new(folder: &'a Path) -> Self {
        Self { folder, by_path: HashMap::new(), read: Vec::new() }
    }

    /// All meshes in the order of their indices.
    pub fn into_vec(self) -> Vec<Mesh> {
        self.read
    }

    /// The index of the mesh that `node` names. A file that several objects name has its mistakes told once.
    fn find(&mut self, node: &Node, path: &str, problems: &mut Problems) -> Option<usize> {
        let name = fields::text(node, path, "the path of an OBJ file", problems)?;
        if name.is_empty() {
            problems.error(node.at, path, node.describe(), "the path of an OBJ file");
            return None;
        }
        let file = self.folder.join(name);
        // Two spellings of one path lead to one mesh.
        let key = file.canonicalize().unwrap_or_else(|_| file.clone());
        if let Some(&known) = self.by_path.get(&key) {
            return known;
        }
        let mesh = match obj::load(&file) {
            Ok(mesh) => {
                self.read.push(mesh);
                Some(self.read.len() - 1)
            }
            Err(Failure::Unreadable(reason)) => {
                let found = format!("{}, which cannot be read: {reason}", node.describe());
                let backslash = name.contains('\\').then(|| "separate folders by `/`".to_owned());
                let expected = format!("an OBJ file at {}", file.display());
                problems.error_with_hint(node.at, path, found, expected, backslash);
                None
            }
            Err(Failure::Mistakes(mistakes)) => {
                let (line, column) = problems.place(node.at);
                let user = format!("used by {path} at {}:{line}:{column}", problems.file().display());
                for mistake in mistakes {
                    problems.error_elsewhere(Problem { hint: Some(user.clone()), ..mistake });
                }
                None
            }
        };
        self.by_path.insert(key, mesh);
        mesh
    }
}

/// Reads the object at `node` of a scene with `materials` materials, where their number is known.
pub(super) fn read(
    node: &Node,
    path: &str,
    materials: Option<usize>,
    meshes: &mut Meshes,
    problems: &mut Problems,
) -> Option<Object> {
    let fields = Fields::open(node, path, KEYS, problems)?;
    fields.comment(problems);
    if let Some(node) = fields.get("type") {
        fields::choice(node, &fields.path("type"), &["mesh"], problems);
    }
    let material = fields
        .require("materialIndex", "the index of a material, counted from 0", problems)
        .and_then(|node| material_index(node, &fields.path("materialIndex"), materials, problems));
    let mid_point = mid_point(&fields, problems);
    let size = size(&fields, problems);
    let [x, y, z] = ["xrot", "yrot", "zrot"].map(|key| fields.number(key, &Range::ANY, 0.0, problems));
    let path_node = fields.require("path", "the path of an OBJ file", problems);
    let mesh = path_node.and_then(|node| meshes.find(node, &fields.path("path"), problems));

    let object = Object {
        mesh: mesh?,
        material: material.unwrap_or(0),
        rotation: DVec3::new(x?, y?, z?),
        size: size?,
        mid_point: mid_point?,
    };
    check_placement(&object, meshes.read.get(object.mesh)?, &fields, problems)?;
    material.map(|_| object)
}

fn material_index(node: &Node, path: &str, materials: Option<usize>, problems: &mut Problems) -> Option<usize> {
    let expected = match materials {
        None => "an index counted from 0".to_owned(),
        Some(0) => "the index of a material, but the scene has none".to_owned(),
        Some(1) => "0, as the scene has 1 material".to_owned(),
        Some(count) => format!("an index from 0 to {}, as the scene has {count} materials", count - 1),
    };
    let index = usize::try_from(fields::whole(node, path, 0, &expected, problems)?).unwrap_or(usize::MAX);
    if materials.is_some_and(|count| index >= count) {
        problems.error(node.at, path, node.describe(), expected);
        return None;
    }
    Some(index)
}

fn mid_point(fields: &Fields, problems: &mut Problems) -> Option<DVec3> {
    if let (Some(one), Some(other)) = (fields.entry("midPoint"), fields.entry("midpoint")) {
        let later = if one.at > other.at { one } else { other };
        problems.error(later.at, fields.path(&later.key), "both `midPoint` and `midpoint`", "one of them");
        return None;
    }
    for key in ["midPoint", "midpoint"] {
        if let Some(node) = fields.get(key) {
            return fields::vector(node, &fields.path(key), problems);
        }
    }
    Some(DVec3::ZERO)
}

fn size(fields: &Fields, problems: &mut Problems) -> Option<Size> {
    match (fields.entry("height"), fields.entry("scale")) {
        (Some(height), Some(scale)) => {
            let later = if height.at > scale.at { height } else { scale };
            problems.error(later.at, fields.path(&later.key), "both `height` and `scale`", "one of them");
            None
        }
        (None, Some(_)) => fields.required_number("scale", &Range::POSITIVE, problems).map(Size::Scale),
        // Where there is neither, `height` is the one that is missed.
        (Some(_), None) => fields.required_number("height", &Range::POSITIVE, problems).map(Size::Height),
        (None, None) => {
            fields.require("height", "`height` or `scale`: a number > 0", problems);
            None
        }
    }
}

/// Checks that the mesh can be made as high as asked, and that it stays within single precision.
fn check_placement(object: &Object, mesh: &Mesh, fields: &Fields, problems: &mut Problems) -> Option<()> {
    let extent = rotated_extent(object, mesh);
    let (key, factor) = match object.size {
        Size::Scale(scale) => ("scale", scale),
        Size::Height(height) => {
            if extent.z <= FLAT * extent.max_element() {
                let at = fields.get("height")?.at;
                let found = "a mesh that is flat along z after its rotation, so that no height can be given to it";
                problems.error(at, fields.path("height"), found, "`scale` in place of `height`");
                return None;
            }
            ("height", height / extent.z)
        }
    };
    let corner = object.mid_point.abs() + extent * (factor / 2.0);
    if !fits_single(corner.max_element()) || corner.is_nan() {
        let at = fields.get(key)?.at;
        let found = format!("an object that reaches out to {:.1e}", corner.max_element());
        problems.error(at, fields.path(key), found, "coordinates between -3.4e38 and 3.4e38");
        return None;
    }
    Some(())
}

/// Extent of the rotated mesh's bounding box.
fn rotated_extent(object: &Object, mesh: &Mesh) -> DVec3 {
    let rotation = object.rotation_matrix();
    let mut points = mesh.positions.iter().map(|&point| rotation * point);
    let Some(first) = points.next() else { return DVec3::ZERO };
    let (low, high) = points.fold((first, first), |(low, high), point| (low.min(point), high.max(point)));
    high - low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(rotation: DVec3) -> Object {
        Object { mesh: 0, material: 0, rotation, size: Size::Scale(1.0), mid_point: DVec3::ZERO }
    }

    #[test]
    fn rotations_are_about_x_then_y_then_z() {
        // y goes to z about x, and on to x about y; in the other order y would stay until the turn to z.
        let turned = object(DVec3::new(90.0, 90.0, 0.0)).rotation_matrix() * DVec3::Y;
        assert!((turned - DVec3::X).length() < 1e-15, "{turned}");
        let turned = object(DVec3::new(0.0, 90.0, 90.0)).rotation_matrix() * DVec3::Z;
        assert!((turned - DVec3::Y).length() < 1e-15, "{turned}");
    }

    #[test]
    fn extent_is_that_of_the_rotated_mesh() {
        let mesh = Mesh { positions: vec![DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)], ..Mesh::default() };
        let extent = rotated_extent(&object(DVec3::new(90.0, 0.0, 0.0)), &mesh);
        assert!((extent - DVec3::new(1.0, 3.0, 2.0)).length() < 1e-15, "{extent}");
        assert_eq!(rotated_extent(&object(DVec3::ZERO), &Mesh::default()), DVec3::ZERO);
    }
}
