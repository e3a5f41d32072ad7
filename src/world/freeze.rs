//! From the user's parts to columns: placement in f64, re-centring, rounding to f32.

use super::order::order;
use super::{MaterialInput, Mesh, Object, Size, World, WorldBuilder};
use crate::camera::View;
use crate::error::{Error, Result};
use crate::ids::LobeId;
use crate::light::{LightTriangle, Lights, TARGETS, Targets, cover};
use crate::linear::{DMat3, DVec3, Vec3};
use crate::material::{Diffuse, Kind, Luminous, Materials, Matt, Specular, Table, Transparent};
use crate::material::{DiffuseRow, MattRow, SpecularRow, TransparentRow};

/// Triangles at most: ids leave room for marks.
const MAX_TRIANGLES: usize = 1 << 30;
/// Squared length of the cross product of two edges below which a triangle of the unit-sized world counts as
/// degenerate: past it, f32 cannot tell its normal.
const MIN_CROSS2: f32 = 1e-36;

/// Rotation, scale and translation of an object in scene coordinates.
struct Placement {
    linear: DMat3,
    rotation: DMat3,
    offset: DVec3,
}

impl Placement {
    fn new(index: usize, o: &Object, mesh: &Mesh) -> Result<Self> {
        let rotation = o.rotation_matrix();
        let rotated = Mesh { positions: mesh.positions.iter().map(|&p| rotation * p).collect(), ..Mesh::default() };
        let (lo, hi) = rotated.bounds();
        let extent = hi - lo;
        let scale = match o.size {
            Size::Scale(s) => s,
            Size::Height(_) if mesh.positions.is_empty() => 1.0,
            Size::Height(h) if extent.z > Mesh::FLAT * extent.max_element() => h / extent.z,
            Size::Height(_) => {
                return Err(Error::World {
                    place: format!("objects[{index}].size"),
                    found: "a height for a mesh that is flat along z".into(),
                    expected: "a scale".into(),
                });
            }
        };
        Ok(Self { linear: rotation * scale, rotation, offset: o.mid_point - (lo + hi) * 0.5 * scale })
    }
    fn point(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.offset
    }
}

/// Centre of all placed points, and the power of two that brings their extent to about 1.
fn normalisation(b: &WorldBuilder, places: &[Placement]) -> (DVec3, f64) {
    let mut bounds: Option<(DVec3, DVec3)> = None;
    for (o, place) in b.objects.iter().zip(places) {
        for &p in &b.meshes[o.mesh].positions {
            let p = place.point(p);
            bounds = Some(bounds.map_or((p, p), |(lo, hi)| (lo.min(p), hi.max(p))));
        }
    }
    let Some((lo, hi)) = bounds else { return (DVec3::ZERO, 1.0) };
    let centre = lo * 0.5 + hi * 0.5;
    let half = (hi * 0.5 - lo * 0.5).max_element();
    // Beyond this range the power of two itself would overflow.
    let usable = half.is_finite() && (1e-250..1e250).contains(&half);
    (centre, if usable { (-half.log2().ceil()).exp2() } else { 1.0 })
}

fn add_material(materials: &mut Materials, m: &MaterialInput) -> Option<LobeId> {
    match *m {
        MaterialInput::Diffuse { color, mattness } if mattness < Matt::NARROWEST => {
            Table::<Specular>::add(materials, SpecularRow { color })
        }
        MaterialInput::Specular { color } => Table::<Specular>::add(materials, SpecularRow { color }),
        MaterialInput::Diffuse { color, mattness: 1.0 } => Table::<Diffuse>::add(materials, DiffuseRow { color }),
        MaterialInput::Diffuse { color, mattness } => Table::<Matt>::add(materials, MattRow::new(color, mattness)),
        MaterialInput::Transparent { color, ref_index } => {
            Table::<Transparent>::add(materials, TransparentRow { color, ref_index })
        }
        MaterialInput::Luminous { radiance } => materials.add_luminous(Luminous { radiance }),
    }
}

/// Unit normals at the corners of face `k`; `flat` thrice where the mesh has none that can be used.
fn corner_normals(mesh: &Mesh, k: usize, rotation: DMat3, flat: Vec3) -> [[f32; 3]; 3] {
    let Some(indices) = mesh.triangle_normals.get(k).filter(|t| t[0] != Mesh::NO_NORMAL) else {
        return [flat.to_array(); 3];
    };
    indices.map(|n| {
        let normal = (rotation * mesh.normals[n as usize]).normalize_or_zero().as_vec3();
        if normal == Vec3::ZERO { flat.to_array() } else { normal.to_array() }
    })
}

/// Freezes checked parts.
pub(super) fn freeze(b: WorldBuilder) -> Result<World> {
    let too_many = |what: &str, limit: usize| Error::World {
        place: "objects".into(),
        found: format!("more than {limit} {what}"),
        expected: format!("at most {limit}"),
    };
    let faces = b.objects.iter().map(|o| b.meshes[o.mesh].triangles.len()).sum::<usize>();
    if faces > MAX_TRIANGLES {
        return Err(too_many("triangles", MAX_TRIANGLES));
    }
    let mut materials = Materials::default();
    let mut lobes_of = Vec::new();
    for m in &b.materials {
        lobes_of.push(add_material(&mut materials, m).ok_or_else(|| too_many("materials", 1 << 28))?);
    }
    let places = b
        .objects
        .iter()
        .enumerate()
        .map(|(i, o)| Placement::new(i, o, &b.meshes[o.mesh]))
        .collect::<Result<Vec<_>>>()?;
    let (centre, scale) = normalisation(&b, &places);

    let smooth = b.objects.iter().any(|o| !b.meshes[o.mesh].triangle_normals.is_empty());
    let (mut corners, mut lobes) = (Vec::with_capacity(faces), Vec::with_capacity(faces));
    let mut normals = smooth.then(|| Vec::with_capacity(faces));
    let is_delta = |o: &Object| Kind::SCATTERING.get(lobes_of[o.material].kind()).is_some_and(|kind| kind.is_delta());
    let balls_each = TARGETS / b.objects.iter().filter(|o| is_delta(o)).count().max(1);
    let (mut light_triangles, mut balls, mut dropped) = (Vec::new(), Vec::new(), 0);
    for (o, place) in b.objects.iter().zip(&places) {
        let (mesh, lobe) = (&b.meshes[o.mesh], lobes_of[o.material]);
        let first = corners.len();
        let points: Vec<Vec3> = mesh.positions.iter().map(|&p| ((place.point(p) - centre) * scale).as_vec3()).collect();
        for k in order(mesh, &points) {
            let k = k as usize;
            let p = mesh.triangles[k].map(|v| points[v as usize]);
            let cross = (p[1] - p[0]).cross(p[2] - p[0]);
            let length2 = cross.length_squared();
            if !(length2 >= MIN_CROSS2 && length2.is_finite()) {
                dropped += 1;
                continue;
            }
            let flat = cross / length2.sqrt();
            if let Some(normals) = &mut normals {
                normals.push(corner_normals(mesh, k, place.rotation, flat));
            }
            let mut lobe = lobe;
            if lobe.kind() == Kind::Luminous as usize {
                let radiance = materials.luminous()[lobe.row()].radiance;
                let row = LobeId::new(Kind::Luminous as usize, light_triangles.len());
                lobe = row.ok_or_else(|| too_many("luminous triangles", 1 << 28))?;
                light_triangles.push(LightTriangle {
                    corners: p.map(|p| p.to_array()),
                    normal: flat.to_array(),
                    radiance,
                });
            }
            corners.push(p.map(|p| p.to_array()));
            lobes.push(lobe);
        }
        if is_delta(o) {
            balls.extend(cover(&corners[first..], balls_each.max(1)));
        }
    }
    Ok(World {
        view: View::new(&b.camera, centre, scale),
        corners,
        lobes,
        normals,
        materials,
        lights: Lights::new(&light_triangles),
        targets: Targets::new(balls),
        background: b.background.iter().any(|&c| c > 0.0).then_some(b.background),
        dropped,
        centre,
        scale,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    fn camera() -> Camera {
        Camera { focal_point: DVec3::ZERO, direction: DVec3::Y, width: 4, height: 4, x_angle: 45.0, y_angle: 45.0 }
    }

    fn slab() -> Mesh {
        let positions = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]].map(DVec3::from).to_vec();
        Mesh { positions, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 0, 1]], ..Mesh::default() }
    }

    fn place(size: Size, mid_point: DVec3, rotation: DVec3) -> Result<World> {
        let mut b = WorldBuilder::new(camera());
        let material = b.material(MaterialInput::Luminous { radiance: [2.0; 3] });
        let mesh = b.mesh(slab());
        b.object(Object { mesh, material, rotation, size, mid_point });
        b.build()
    }

    fn scene_point(w: &World, t: usize, c: usize) -> DVec3 {
        DVec3::from(w.corners[t][c].map(f64::from)) / w.scale + w.centre
    }

    #[test]
    fn rotates_then_centres_then_scales_then_moves() {
        // Turned by 90 degrees about x, the slab is 2 tall along z.
        let w = place(Size::Height(4.0), DVec3::new(10.0, 20.0, 30.0), DVec3::new(90.0, 0.0, 0.0)).unwrap();
        assert_eq!((w.triangles(), w.dropped(), w.lights()), (2, 1, 2));
        let is_at = |t: usize, c: usize, p: DVec3| scene_point(&w, t, c).distance(p) < 1e-5;
        let is_first =
            |t: &usize| is_at(*t, 0, DVec3::new(6.0, 21.0, 28.0)) && is_at(*t, 1, DVec3::new(6.0, 21.0, 32.0));
        assert_eq!((0..2).filter(is_first).count(), 1, "{:?}", w.corners);
    }

    #[test]
    fn far_and_tiny_objects_keep_their_shape() {
        let near = place(Size::Scale(1.0), DVec3::ZERO, DVec3::ZERO).unwrap();
        let far = place(Size::Scale(1e-6), DVec3::splat(1.0), DVec3::ZERO).unwrap();
        for t in 0..2 {
            for c in 0..3 {
                // The tiny one's own numbers, divided by two powers of two, match to the rounding of f64.
                let ratio = 1e6 * near.scale / far.scale;
                for k in 0..3 {
                    let (a, b) = (f64::from(near.corners[t][c][k]), f64::from(far.corners[t][c][k]) * ratio);
                    assert!((a - b).abs() < 1e-7, "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn wrong_parts_are_named() {
        let error = place(Size::Scale(-1.0), DVec3::ZERO, DVec3::ZERO).unwrap_err().to_string();
        assert_eq!(error, "objects[0].size: found -1, expected a finite number > 0");
        let mut b = WorldBuilder::new(camera());
        b.object(Object {
            mesh: 2,
            material: 0,
            rotation: DVec3::ZERO,
            size: Size::Scale(1.0),
            mid_point: DVec3::ZERO,
        });
        assert!(b.build().unwrap_err().to_string().contains("objects[0].mesh: found 2, expected an index below 0"));
    }
}
