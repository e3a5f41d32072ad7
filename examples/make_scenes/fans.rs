//! The scenes `test01` to `test14`: the fan of ten triangles and one wall of light.

use crate::scene::{Color, Kind, Scene, Size};
use glam::{DVec3, dvec3};

/// Where the wall of light is, as the camera sees it.
#[derive(Clone, Copy)]
enum Wall {
    Right,
    BehindCamera,
    BehindFan,
}

impl Wall {
    /// Mesh, middle and scale of the wall, and the rotation that turns its front to the fan.
    fn place(self) -> (&'static str, DVec3, f64, [f64; 3]) {
        match self {
            Self::Right => ("quad", dvec3(9.0, 0.0, 1.5), 14.0, [0.0, -90.0, 0.0]),
            Self::BehindCamera => ("quad", dvec3(0.0, -25.0, 1.5), 60.0, [-90.0, 0.0, 0.0]),
            // Near, so that refraction at grazing angles still ends on it; leaves black above and below.
            Self::BehindFan => ("rect_3x7", dvec3(0.0, 1.5, 1.5), 1.45, [90.0, 90.0, 0.0]),
        }
    }
}

/// All of them, by name.
pub fn scenes() -> Vec<(String, Scene)> {
    let mut scenes = Vec::new();
    let mut add = |scene| scenes.push((format!("test{:02}", scenes.len() + 1), scene));
    let silver = [0.9, 0.9, 0.9];
    add(fan("fan", "mirror", Kind::Specular, silver, Wall::Right, 1.0));
    add(fan("fan", "mirror", Kind::Specular, silver, Wall::BehindCamera, 1.0));
    for mattness in [1.0, 0.8, 0.6, 0.4, 0.2, 0.0] {
        add(fan("fan", "matt", Kind::Diffuse(mattness), silver, Wall::Right, 1.0));
    }
    for mesh in ["fan", "fan_flipped"] {
        // The wall behind the fan is in the picture, and light that leaves the glass grows by the square of 1.5.
        for (wall, radiance) in [(Wall::BehindCamera, 6.0), (Wall::BehindFan, 0.4), (Wall::Right, 1.5)] {
            add(fan(mesh, "glass", Kind::Transparent(1.5), [1.0; 3], wall, radiance));
        }
    }
    scenes
}

fn fan(mesh: &str, comment: &str, kind: Kind, color: Color, wall: Wall, radiance: f64) -> Scene {
    let middle = dvec3(0.0, 0.0, 1.5);
    let mut scene = Scene::new(dvec3(0.0, -24.0, 1.5), middle, [640, 320], 24.0);
    let surface = scene.material(comment, kind, color);
    let light = scene.material("wall of light", Kind::Luminous(radiance), [1.0; 3]);
    scene.object("ten triangles", mesh, surface, middle, Size::Scale(1.0), [0.0; 3]);
    let (wall_mesh, place, scale, rotation) = wall.place();
    scene.object("wall of light", wall_mesh, light, place, Size::Scale(scale), rotation);
    scene
}
