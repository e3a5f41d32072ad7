//! Worlds built in code.

use super::meshes::{cuboid, inverted, patch, quad, sphere, turned, v};
use glam::DVec3;
use wavetrace::camera::Camera;
use wavetrace::render::Renderer;
use wavetrace::world::{MaterialInput, Mesh, Object, Size, WorldBuilder};

/// A camera at `eye` that looks along `direction` with square pixels.
pub fn camera(eye: DVec3, direction: DVec3, [width, height]: [u32; 2], x_angle: f64) -> Camera {
    let half = (x_angle.to_radians() / 2.0).tan() * f64::from(height) / f64::from(width);
    Camera { focal_point: eye, direction, width, height, x_angle, y_angle: 2.0 * half.atan().to_degrees() }
}

pub fn diffuse(albedo: f32) -> MaterialInput {
    matt(albedo, 1.0)
}

pub fn matt(albedo: f32, mattness: f32) -> MaterialInput {
    MaterialInput::Diffuse { color: [albedo; 3], mattness }
}

pub fn colored(color: [f32; 3], mattness: f32) -> MaterialInput {
    MaterialInput::Diffuse { color, mattness }
}

pub fn mirror(albedo: f32) -> MaterialInput {
    MaterialInput::Specular { color: [albedo; 3] }
}

pub fn glass(color: f32, ref_index: f32) -> MaterialInput {
    MaterialInput::Transparent { color: [color; 3], ref_index }
}

pub fn lamp(radiance: f32) -> MaterialInput {
    MaterialInput::Luminous { radiance: [radiance; 3] }
}

/// A world in the making; meshes stay where their coordinates put them.
pub struct Scene(pub WorldBuilder);

impl Scene {
    pub fn new(camera: Camera) -> Self {
        Self(WorldBuilder::new(camera))
    }
    pub fn background(mut self, radiance: f32) -> Self {
        self.0.background([radiance; 3]);
        self
    }
    pub fn with(mut self, mesh: Mesh, material: MaterialInput) -> Self {
        let (lo, hi) = mesh.bounds();
        let (mesh, material) = (self.0.mesh(mesh), self.0.material(material));
        let mid_point = (lo + hi) * 0.5;
        self.0.object(Object { mesh, material, rotation: DVec3::ZERO, size: Size::Scale(1.0), mid_point });
        self
    }
    /// Small triangles about the room that give light.
    pub fn with_lamps(mut self, count: u32) -> Self {
        let mut random = super::random::Random(7);
        for i in 0..count {
            let mut number = || f64::from(random.unit());
            let corner = v(1.8 * number() - 0.9, 1.8 * number() - 0.9, 0.1 + 1.7 * number());
            let mut edge = || 0.15 * v(number() - 0.5, number() - 0.5, number() - 0.5);
            let positions = vec![corner, corner + edge(), corner + edge()];
            let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
            let colour = [1.0, 0.7 + 0.3 * (i % 2) as f32, 1.0 - 0.1 * (i % 5) as f32];
            self = self.with(mesh, MaterialInput::Luminous { radiance: colour.map(|c| c * (1 + i % 7) as f32 * 3.0) });
        }
        self
    }
    pub fn renderer(self) -> Renderer {
        Renderer::new(self.0.build().unwrap())
    }
}

/// A closed room of two units each way with a wide lamp below its ceiling, seen from within; `size` in pixels.
pub fn room(size: [u32; 2]) -> Scene {
    let eye = v(0.0, -0.95, 1.0);
    Scene::new(camera(eye, DVec3::Y, size, 80.0))
        .with(patch(0.0, 0.0, 0.0, 2.0, 2.0), colored([0.7, 0.65, 0.6], 1.0))
        .with(patch(0.0, 0.0, 2.0, 2.0, 2.0), diffuse(0.7))
        .with(quad(v(-1.0, -1.0, 0.0), v(0.0, 2.0, 0.0), v(0.0, 0.0, 2.0)), colored([0.6, 0.1, 0.05], 1.0))
        .with(quad(v(1.0, -1.0, 0.0), v(0.0, 2.0, 0.0), v(0.0, 0.0, 2.0)), colored([0.1, 0.5, 0.1], 1.0))
        .with(quad(v(-1.0, 1.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 0.0, 2.0)), diffuse(0.7))
        .with(quad(v(-1.0, -1.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 0.0, 2.0)), diffuse(0.5))
        .with(patch(0.1, 0.1, 1.9, 1.2, 1.2), MaterialInput::Luminous { radiance: [3.0, 2.5, 2.0] })
}

/// A block in the room, turned, so that no edge is parallel to a wall.
pub fn block(x: f64, y: f64, side: f64, tall: f64, degrees: f64) -> Mesh {
    let mut mesh = turned(cuboid(v(-side / 2.0, -side / 2.0, 0.0), v(side / 2.0, side / 2.0, tall)), degrees);
    mesh.positions.iter_mut().for_each(|p| *p += v(x, y, 0.01));
    mesh
}

/// Rooms that between them have every material, flat and smooth, two lamps of different colours, and a background.
pub fn rooms(size: [u32; 2]) -> Vec<(&'static str, Renderer)> {
    let ball = |x: f64, y: f64, z: f64, smooth| sphere(v(x, y, z), 0.38, if smooth { 2 } else { 1 }, smooth);
    vec![
        (
            "diffuse",
            room(size)
                .with(block(-0.4, 0.4, 0.5, 1.1, 20.0), diffuse(0.8))
                .with(block(0.4, 0.1, 0.5, 0.5, -15.0), colored([0.2, 0.4, 0.9], 1.0))
                .renderer(),
        ),
        (
            "matt",
            room(size)
                .with(block(-0.45, 0.4, 0.5, 1.1, 20.0), matt(0.9, 0.3))
                .with(ball(0.4, 0.2, 0.5, true), colored([0.9, 0.6, 0.3], 0.6))
                .with(patch(0.0, -0.3, 0.02, 0.8, 0.5), matt(0.8, 0.1))
                .renderer(),
        ),
        (
            "delta",
            room(size)
                .with(block(-0.45, 0.4, 0.5, 1.1, 20.0), mirror(0.9))
                .with(ball(0.4, 0.2, 0.5, true), glass(0.95, 1.5))
                .with(patch(0.9, 0.0, 0.9, 0.1, 0.1), MaterialInput::Luminous { radiance: [0.0, 6.0, 20.0] })
                .renderer(),
        ),
        (
            "open",
            Scene::new(camera(v(0.0, -3.0, 1.2), v(0.0, 3.0, -0.7), size, 45.0))
                .background(0.4)
                .with(patch(0.0, 0.0, 0.0, 4.0, 4.0), diffuse(0.6))
                .with(ball(-0.5, 0.0, 0.4, true), matt(0.7, 0.8))
                .with(inverted(inverted(ball(0.5, 0.0, 0.4, false))), colored([0.9, 0.4, 0.2], 0.4))
                .with(
                    quad(v(-1.0, 1.0, 0.2), v(2.0, 0.0, 0.0), v(0.0, 0.3, 1.2)),
                    MaterialInput::Luminous { radiance: [2.0, 1.5, 1.0] },
                )
                .renderer(),
        ),
        (
            // Lamps of all sizes, colours and directions, some of them hidden from most of the room.
            "many lamps",
            room(size)
                .with(block(-0.45, 0.4, 0.5, 1.1, 20.0), matt(0.9, 0.3))
                .with(ball(0.4, 0.2, 0.5, true), diffuse(0.7))
                .with_lamps(40)
                .renderer(),
        ),
    ]
}
