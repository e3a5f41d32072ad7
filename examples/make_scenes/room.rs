//! The closed room of the demos, with the camera inside it: x in [-2, 2], y in [-5, 2], z in [0, 3].

use crate::{
    flat,
    mesh::Mesh,
    scene::{Color, Kind, Scene, Size},
};
use glam::{DVec3, dvec3};

/// Where the lights are: each fills a hole in the ceiling exactly, so that none of its light is lost above.
#[derive(Clone, Copy)]
pub enum Lights {
    /// One in the middle.
    One,
    /// One left and one right.
    Two,
}

impl Lights {
    fn side(self) -> f64 {
        match self {
            Self::One => 1.5,
            Self::Two => 1.0,
        }
    }

    /// Middle of each light, seen from above.
    fn middles(self) -> &'static [[f64; 2]] {
        match self {
            Self::One => &[[0.0, -0.75]],
            Self::Two => &[[-1.1, -0.75], [1.1, -0.75]],
        }
    }

    fn mesh(self) -> &'static str {
        match self {
            Self::One => "ceiling_one_light",
            Self::Two => "ceiling_two_lights",
        }
    }

    /// The ceiling, facing +z (to be turned over), centred on the room.
    pub fn ceiling(self) -> Mesh {
        let half = 0.5 * self.side();
        let holes: Vec<[f64; 4]> = self
            .middles()
            .iter()
            // Turned over about the x axis, the ceiling has its y reversed.
            .map(|[x, y]| [x - half, x + half, MIDDLE.y - y - half, MIDDLE.y - y + half])
            .collect();
        flat::rectangle_with_holes(4.0, 7.0, &holes)
    }
}

/// Middle of the floor.
const MIDDLE: DVec3 = dvec3(0.0, -1.5, 0.0);

/// What the room is made of.
pub struct Room {
    /// Floor, ceiling and the wall behind the camera.
    pub plain: Color,
    /// The wall at the left.
    pub left: Color,
    /// The wall at the right.
    pub right: Color,
    /// The wall at the back; none leaves it out.
    pub back: Option<Color>,
    /// Where the lights are.
    pub lights: Lights,
    /// Their colour and radiance.
    pub light: (Color, f64),
}

impl Room {
    /// Adds the room to `scene`.
    pub fn build(&self, scene: &mut Scene) {
        let matt = || Kind::Diffuse(1.0);
        let plain = scene.material("floor and ceiling", matt(), self.plain);
        let left = scene.material("left wall", matt(), self.left);
        let right = scene.material("right wall", matt(), self.right);
        let light = scene.material("lamp", Kind::Luminous(self.light.1), self.light.0);
        let (as_is, up) = (|| Size::Scale(1.0), DVec3::Z);
        scene.object("floor", "rect_4x7", plain, MIDDLE, as_is(), [0.0; 3]);
        scene.object("ceiling", self.lights.mesh(), plain, MIDDLE + up * 3.0, as_is(), [180.0, 0.0, 0.0]);
        scene.object("left wall", "rect_3x7", left, dvec3(-2.0, MIDDLE.y, 1.5), as_is(), [0.0, 90.0, 0.0]);
        scene.object("right wall", "rect_3x7", right, dvec3(2.0, MIDDLE.y, 1.5), as_is(), [0.0, -90.0, 0.0]);
        if let Some(color) = self.back {
            let back = scene.material("back wall", matt(), color);
            scene.object("back wall", "rect_4x3", back, dvec3(0.0, 2.0, 1.5), as_is(), [90.0, 0.0, 0.0]);
        }
        scene.object("front wall", "rect_4x3", plain, dvec3(0.0, -5.0, 1.5), as_is(), [-90.0, 0.0, 0.0]);
        for &[x, y] in self.lights.middles() {
            let size = Size::Scale(self.lights.side());
            scene.object("lamp", "quad", light, dvec3(x, y, 3.0), size, [180.0, 0.0, 0.0]);
        }
    }
}
