//! What a user states of a scene, before it is frozen into columns: materials, meshes, objects.

use crate::linear::{DMat3, DVec3};

/// A material, as the user states it. Colours are linear RGB in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialInput {
    /// The mattness lobe: 0 is a mirror, 1 is Lambertian.
    Diffuse {
        /// Share of light reflected, per channel.
        color: [f32; 3],
        /// Width of the lobe, in [0, 1].
        mattness: f32,
    },
    /// A mirror.
    Specular {
        /// Share of light reflected, per channel.
        color: [f32; 3],
    },
    /// A smooth dielectric.
    Transparent {
        /// Share of light let through per crossing, per channel.
        color: [f32; 3],
        /// Index of refraction inside against 1 outside, > 0.
        ref_index: f32,
    },
    /// A two-sided light that reflects nothing.
    Luminous {
        /// Emitted radiance per channel (W sr^-1 m^-2 up to scale), >= 0.
        radiance: [f32; 3],
    },
}

/// Triangles with optional vertex normals, in the mesh's own coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions; all finite.
    pub positions: Vec<DVec3>,
    /// Three indices into `positions` per triangle; counter-clockwise seen from the front. Their order has no meaning.
    pub triangles: Vec<[u32; 3]>,
    /// Vertex normals, any length; empty where the mesh has none.
    pub normals: Vec<DVec3>,
    /// Three indices into `normals` per triangle, [`Mesh::NO_NORMAL`] thrice for a flat one. Empty where the mesh
    /// has no normals, else as long as `triangles`.
    pub triangle_normals: Vec<[u32; 3]>,
}

impl Mesh {
    /// Stands in `triangle_normals` for a triangle that is flat.
    pub const NO_NORMAL: u32 = u32::MAX;
    /// Extent along z below this share of the largest extent is flat: no height can be given to it.
    pub const FLAT: f64 = 1e-9;

    /// Smallest box that holds all positions, as (min, max); (0, 0) of an empty mesh.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let Some(&first) = self.positions.first() else {
            return (DVec3::ZERO, DVec3::ZERO);
        };
        self.positions.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)))
    }
}

/// How large an object is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Extent of the rotated bounding box along z, > 0.
    Height(f64),
    /// Factor on the mesh's own size, > 0.
    Scale(f64),
}

/// A mesh placed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Which mesh, an index in order of [`super::WorldBuilder::mesh`] calls.
    pub mesh: usize,
    /// Which material, an index in order of [`super::WorldBuilder::material`] calls.
    pub material: usize,
    /// Rotations about x, then y, then z, in degrees, right-handed.
    pub rotation: DVec3,
    /// Size after the rotation.
    pub size: Size,
    /// Where the centre of the rotated bounding box goes.
    pub mid_point: DVec3,
}

impl Object {
    /// The rotation as a matrix: x first, then y, then z.
    pub fn rotation_matrix(&self) -> DMat3 {
        let r = self.rotation * (std::f64::consts::PI / 180.0);
        DMat3::from_rotation_z(r.z) * DMat3::from_rotation_y(r.y) * DMat3::from_rotation_x(r.x)
    }
}
