//! The world: what a scene holds, frozen into columns. An entity is an id, a component a column.

mod check;
mod freeze;
mod input;
mod order;

pub use input::{MaterialInput, Mesh, Object, Size};

use crate::camera::{Camera, View};
use crate::error::Result;
use crate::ids::LobeId;
use crate::lanes::{LanesU32, prefetch_ends};
use crate::light::{Lights, Targets};
use crate::linear::DVec3;
use crate::material::{Kind, Materials};

/// Triangles whose corners and normals stay in the first cache, more or less.
const NEAR: usize = 512;

/// Collects the parts of a scene; [`WorldBuilder::build`] checks them and freezes them into a [`World`].
#[derive(Clone, Debug)]
pub struct WorldBuilder {
    camera: Camera,
    materials: Vec<MaterialInput>,
    meshes: Vec<Mesh>,
    objects: Vec<Object>,
    background: [f32; 3],
}

impl WorldBuilder {
    /// Starts a world that is seen through `camera`.
    pub fn new(camera: Camera) -> Self {
        Self { camera, materials: Vec::new(), meshes: Vec::new(), objects: Vec::new(), background: [0.0; 3] }
    }
    /// Adds a material and returns its index.
    pub fn material(&mut self, material: MaterialInput) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }
    /// Adds a mesh and returns its index.
    pub fn mesh(&mut self, mesh: Mesh) -> usize {
        self.meshes.push(mesh);
        self.meshes.len() - 1
    }
    /// Places a mesh in the world.
    pub fn object(&mut self, object: Object) {
        self.objects.push(object);
    }
    /// Constant radiance from outside everything; black unless set.
    pub fn background(&mut self, radiance: [f32; 3]) {
        self.background = radiance;
    }
    /// The camera, to override its pixels.
    pub fn camera_mut(&mut self) -> &mut Camera {
        &mut self.camera
    }
    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }
    /// The materials, in order of their indices.
    pub fn materials(&self) -> &[MaterialInput] {
        &self.materials
    }
    /// The meshes, in order of their indices.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }
    /// The objects, in the order in which they were placed.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }
    /// Checks everything and freezes it: places the objects in f64, moves the centre of the world to the origin, scales
    /// it by a power of two to about size 1, and only then rounds to f32. Degenerate triangles are dropped and counted.
    ///
    /// # Errors
    /// [`crate::error::Error::World`] names the first part that breaks a rule of the format.
    pub fn build(self) -> Result<World> {
        check::check(&self)?;
        freeze::freeze(self)
    }
}

/// The frozen scene. Columns of triangles are indexed by [`crate::ids::TriangleId`], in the order of objects and faces.
#[derive(Clone, Debug)]
pub struct World {
    pub(crate) view: View,
    /// Component of every triangle: its corners.
    pub(crate) corners: Vec<[[f32; 3]; 3]>,
    /// Component of every triangle: what its surface does. Luminous triangles have rows of their own, in their order.
    pub(crate) lobes: Vec<LobeId>,
    /// Unit normals at the corners; absent unless some mesh has vertex normals.
    pub(crate) normals: Option<Vec<[[f32; 3]; 3]>>,
    pub(crate) materials: Materials,
    pub(crate) lights: Lights,
    /// Balls about all objects that reflect or refract into single directions.
    pub(crate) targets: Targets,
    /// Radiance from outside everything; absent where it is black.
    pub(crate) background: Option<[f32; 3]>,
    pub(crate) dropped: usize,
    pub(crate) centre: DVec3,
    pub(crate) scale: f64,
}

impl World {
    /// Corners of every triangle, in world coordinates.
    pub fn corners(&self) -> &[[[f32; 3]; 3]] {
        &self.corners
    }
    /// Whether what shading reads of triangles is more than the nearest cache holds.
    pub(crate) fn is_far(&self) -> bool {
        self.corners.len() > NEAR
    }
    /// Asks for what shading reads of a group of triangles, without waiting.
    #[inline(always)]
    pub(crate) fn prefetch<U: LanesU32>(&self, triangles: U) {
        for &triangle in triangles.array().as_ref() {
            prefetch_ends(&self.corners, triangle as usize);
            if let Some(normals) = &self.normals {
                prefetch_ends(normals, triangle as usize);
            }
        }
    }
    /// The camera, in world coordinates.
    pub fn view(&self) -> &View {
        &self.view
    }
    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.corners.len()
    }
    /// Number of luminous triangles.
    pub fn lights(&self) -> usize {
        self.lights.triangles()
    }
    /// Number of degenerate triangles that were dropped.
    pub fn dropped(&self) -> usize {
        self.dropped
    }
    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.view.width()
    }
    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.view.height()
    }
    /// Whether nothing in the scene gives light, so that every image of it is black.
    pub fn is_dark(&self) -> bool {
        self.lights.is_empty() && self.background.is_none()
    }
    /// Whether radiance comes from outside everything.
    pub fn has_background(&self) -> bool {
        self.background.is_some()
    }
    /// Number of materials of a kind, used or not.
    pub fn materials_of(&self, kind: Kind) -> usize {
        self.materials.count(kind)
    }
    /// Smallest box that holds all triangles, in scene coordinates, as (min, max), to the rounding of f32.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let points = self.corners.iter().flatten().map(|p| DVec3::from(p.map(f64::from)));
        let (lo, hi) = points.map(|p| (p, p)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        Some((lo / self.scale + self.centre, hi / self.scale + self.centre))
    }
    /// World coordinates are (scene point - centre) * scale; the scale is a power of two.
    pub fn placement(&self) -> (DVec3, f64) {
        (self.centre, self.scale)
    }
    /// Names of the columns and the bytes that each holds; what the scene lacks holds none.
    pub fn columns(&self) -> [(&'static str, usize); 4] {
        [
            ("corners", self.corners.len() * 36),
            ("lobes", self.corners.len() * 4),
            ("normals", self.normals.as_ref().map_or(0, |n| n.len() * 36)),
            ("lights", self.lights.bytes()),
        ]
    }
    /// Bytes held by the columns.
    pub fn bytes(&self) -> usize {
        self.columns().iter().map(|(_, bytes)| bytes).sum()
    }
}
