//! What a world built in code can break: ranges and indices.

use super::{MaterialInput, Mesh, Object, Size, WorldBuilder};
use crate::camera::Camera;
use crate::error::{Error, Result};

fn wrong<T>(place: impl Into<String>, found: impl ToString, expected: impl Into<String>) -> Result<T> {
    Err(Error::World { place: place.into(), found: found.to_string(), expected: expected.into() })
}

/// The first rule that is broken, if any.
pub(super) fn check(w: &WorldBuilder) -> Result<()> {
    camera(&w.camera)?;
    for (i, m) in w.materials.iter().enumerate() {
        material(&format!("materials[{i}]"), m)?;
    }
    for (i, m) in w.meshes.iter().enumerate() {
        mesh(&format!("meshes[{i}]"), m)?;
    }
    for (i, o) in w.objects.iter().enumerate() {
        object(&format!("objects[{i}]"), o, w)?;
    }
    radiance("background", w.background)
}

fn camera(c: &Camera) -> Result<()> {
    if !c.focal_point.is_finite() {
        return wrong("camera.focal_point", c.focal_point, "finite numbers");
    }
    if !c.direction.is_finite() || c.direction.length() < 1e-150 {
        return wrong("camera.direction", c.direction, "a vector that is not zero");
    }
    for (name, side) in [("camera.width", c.width), ("camera.height", c.height)] {
        if side == 0 || side > Camera::MAX_SIDE {
            return wrong(name, side, format!("1 to {} pixels", Camera::MAX_SIDE));
        }
    }
    if u64::from(c.width) * u64::from(c.height) > Camera::MAX_PIXELS {
        return wrong(
            "camera",
            format!("{} x {} pixels", c.width, c.height),
            format!("at most {} in all", Camera::MAX_PIXELS),
        );
    }
    for (name, angle) in [("camera.x_angle", c.x_angle), ("camera.y_angle", c.y_angle)] {
        if !(angle > 0.0 && angle < 180.0) {
            return wrong(name, angle, "degrees between 0 and 180, both excluded");
        }
    }
    Ok(())
}

fn color(place: &str, color: [f32; 3]) -> Result<()> {
    match color.iter().find(|c| !(0.0..=1.0).contains(*c)) {
        Some(c) => wrong(format!("{place}.color"), c, "a number in [0, 1]"),
        None => Ok(()),
    }
}

fn radiance(place: &str, radiance: [f32; 3]) -> Result<()> {
    match radiance.iter().find(|r| !(r.is_finite() && **r >= 0.0)) {
        Some(r) => wrong(place, r, "a finite number >= 0"),
        None => Ok(()),
    }
}

fn material(place: &str, m: &MaterialInput) -> Result<()> {
    match m {
        MaterialInput::Diffuse { color: c, mattness } => {
            if !(0.0..=1.0).contains(mattness) {
                return wrong(format!("{place}.mattness"), mattness, "a number in [0, 1]");
            }
            color(place, *c)
        }
        MaterialInput::Specular { color: c } => color(place, *c),
        MaterialInput::Transparent { color: c, ref_index } => {
            if !(ref_index.is_finite() && *ref_index > 0.0) {
                return wrong(format!("{place}.ref_index"), ref_index, "a finite number > 0");
            }
            color(place, *c)
        }
        MaterialInput::Luminous { radiance: r } => radiance(&format!("{place}.radiance"), *r),
    }
}

fn mesh(place: &str, m: &Mesh) -> Result<()> {
    if let Some(i) = m.positions.iter().position(|p| !p.is_finite()) {
        return wrong(format!("{place}.positions[{i}]"), m.positions[i], "finite numbers");
    }
    if let Some(i) = m.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= m.positions.len())) {
        return wrong(
            format!("{place}.triangles[{i}]"),
            format!("{:?}", m.triangles[i]),
            format!("indices below {}", m.positions.len()),
        );
    }
    if m.triangle_normals.is_empty() {
        return Ok(());
    }
    if m.triangle_normals.len() != m.triangles.len() {
        return wrong(
            format!("{place}.triangle_normals"),
            format!("{} entries", m.triangle_normals.len()),
            format!("one for each of {} triangles, or none", m.triangles.len()),
        );
    }
    let fits = |t: &[u32; 3]| t == &[Mesh::NO_NORMAL; 3] || t.iter().all(|&n| (n as usize) < m.normals.len());
    match m.triangle_normals.iter().position(|t| !fits(t)) {
        Some(i) => wrong(
            format!("{place}.triangle_normals[{i}]"),
            format!("{:?}", m.triangle_normals[i]),
            format!("indices below {}, or NO_NORMAL thrice", m.normals.len()),
        ),
        None => Ok(()),
    }
}

fn object(place: &str, o: &Object, w: &WorldBuilder) -> Result<()> {
    if o.mesh >= w.meshes.len() {
        return wrong(format!("{place}.mesh"), o.mesh, format!("an index below {}", w.meshes.len()));
    }
    if o.material >= w.materials.len() {
        return wrong(format!("{place}.material"), o.material, format!("an index below {}", w.materials.len()));
    }
    if !(o.rotation.is_finite() && o.mid_point.is_finite()) {
        return wrong(place, format!("rotation {}, mid_point {}", o.rotation, o.mid_point), "finite numbers");
    }
    let (Size::Height(size) | Size::Scale(size)) = o.size;
    if size.is_finite() && size > 0.0 {
        return Ok(());
    }
    wrong(format!("{place}.size"), size, "a finite number > 0")
}
