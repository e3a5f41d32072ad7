//! The world: what a scene holds, frozen into columns.

mod input;
pub use input::{MaterialInput, Mesh, Object, Size};

use crate::camera::Camera;
use crate::error::{Error, Result};

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
    /// Checks everything and freezes it.
    pub fn build(self) -> Result<World> {
        let _ = Error::Scene(Vec::new());
        todo!()
    }
}

/// The frozen scene.
#[derive(Debug)]
pub struct World {}
