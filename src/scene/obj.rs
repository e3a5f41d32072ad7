//! Reads the triangles of an OBJ file. The only file that names `tobj`.
//!
//! `tobj` splits a file at each group and material, gives a corner without a normal the normal of the corner before,
//! and stops at the first mistake without its line. Hence it is fed by [`Lines`], which lets the surface through and
//! remembers which triangles have normals.

use std::io;
use std::path::Path;

use crate::linear::DVec3;

use super::fields::fits_single;
use super::obj_check::Flaw;
use super::obj_lines::{Lines, diagnose};
use crate::error::Problem;
use crate::input;
use crate::world::Mesh;

/// Why there is no mesh.
#[derive(Debug)]
pub(super) enum Failure {
    /// The file cannot be read.
    Unreadable(io::Error),
    /// Its content is at fault.
    Mistakes(Vec<Problem>),
}

/// Reads the mesh at `path`: the faces of all its groups in their order, polygons as fans about their first corner.
pub(super) fn load(path: &Path) -> Result<Mesh, Failure> {
    let bytes = input::regular(path).map_err(Failure::Unreadable)?;
    // Behind a byte order mark the first statement would not be recognised.
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
    parse(text).map_err(|flaws| {
        let problem = |flaw: Flaw| Problem {
            file: path.to_owned(),
            place: flaw.at.map(|at| place(text, at)),
            path: String::new(),
            found: flaw.found,
            expected: flaw.expected,
            hint: None,
        };
        Failure::Mistakes(flaws.into_iter().map(problem).collect())
    })
}

fn parse(text: &[u8]) -> Result<Mesh, Vec<Flaw>> {
    let mut lines = Lines::new(text);
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let parsed = match tobj::load_obj_buf(&mut lines, &options, no_materials) {
        Ok((models, _)) => models.into_iter().next().map(|model| model.mesh).unwrap_or_default(),
        Err(error) => return Err(explain(text, &error.to_string())),
    };
    if !parsed.positions.iter().chain(&parsed.normals).all(|&value| fits_single(value)) {
        return Err(explain(text, "a number out of range"));
    }
    let mut mesh = Mesh {
        positions: vectors(&parsed.positions),
        triangles: parsed.indices.as_chunks().0.to_vec(),
        ..Mesh::default()
    };
    if mesh.triangles.is_empty() {
        return Err(explain(text, "no faces"));
    }
    let smooth = lines.into_smooth();
    if smooth.contains(&true) {
        mesh.normals = vectors(&parsed.normals);
        let corners = parsed.normal_indices.as_chunks().0;
        let triangle = |(&corners, smooth): (&[u32; 3], bool)| match smooth && corners.iter().all(|&i| usable(&mesh, i))
        {
            true => corners,
            false => [Mesh::NO_NORMAL; 3],
        };
        mesh.triangle_normals = corners.iter().zip(smooth).map(triangle).collect();
    }
    Ok(mesh)
}

/// Whether a normal has a direction: files hold zero vectors where a face had no area.
fn usable(mesh: &Mesh, normal: u32) -> bool {
    mesh.normals.get(normal as usize).is_some_and(|normal| normal.length_squared() >= f64::MIN_POSITIVE)
}

fn vectors(numbers: &[f64]) -> Vec<DVec3> {
    numbers.as_chunks().0.iter().map(|&xyz| DVec3::from_array(xyz)).collect()
}

/// The mistakes of a file that did not make a mesh, for `reason` if nothing better is found.
fn explain(text: &[u8], reason: &str) -> Vec<Flaw> {
    let mut flaws = diagnose(text);
    if flaws.is_empty() {
        let found = if text.is_empty() { "an empty file" } else { reason };
        flaws.push(Flaw {
            at: None,
            found: found.to_owned(),
            expected: "an OBJ file with at least one face".to_owned(),
        });
    }
    flaws
}

/// 1-based line and column (in characters) of a byte offset.
fn place(text: &[u8], at: usize) -> (usize, usize) {
    let before = text.get(..at).unwrap_or(text);
    let line_start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
    let line = before.iter().filter(|&&byte| byte == b'\n').count();
    // Bytes 10xxxxxx go on with a character of UTF-8.
    let column = before.iter().skip(line_start).filter(|&&byte| byte & 0xC0 != 0x80).count();
    (line + 1, column + 1)
}
