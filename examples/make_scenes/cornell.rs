//! The box that every renderer is compared in: white, with a red wall at the left and a green one at the right, open
//! towards the camera. Its inside is x in [-1, 1], y in [-1, 1], z in [0, 2].

use crate::{
    flat,
    mesh::Mesh,
    scene::{Kind, Scene, Size},
};
use glam::dvec3;

/// Side of the lamp, which fills a hole in the ceiling.
const LAMP: f64 = 0.6;

/// All scenes, by name.
pub fn scenes() -> Vec<(String, Scene)> {
    vec![("cornell".to_owned(), blocks()), ("cornell-balls".to_owned(), balls())]
}

/// The ceiling: the lamp's hole is in its middle.
pub fn ceiling() -> Mesh {
    let half = 0.5 * LAMP;
    flat::rectangle_with_holes(2.0, 2.0, &[[-half, half, -half, half]])
}

/// The empty box, and its white.
fn empty() -> (Scene, usize) {
    // The opening is 2 wide at a distance of 2.9 and fills the picture: 2 atan(1 / 2.9) is 38.05 degrees.
    let mut scene = Scene::new(dvec3(0.0, -3.9, 1.0), dvec3(0.0, 0.0, 1.0), [512, 512], 38.0);
    let white = scene.material("white", Kind::Diffuse(1.0), [0.74, 0.74, 0.74]);
    let red = scene.material("red", Kind::Diffuse(1.0), [0.62, 0.06, 0.05]);
    let green = scene.material("green", Kind::Diffuse(1.0), [0.13, 0.46, 0.1]);
    let lamp = scene.material("lamp", Kind::Luminous(14.0), [1.0, 0.84, 0.6]);
    for (comment, material, middle, rotation) in [
        ("floor", white, dvec3(0.0, 0.0, 0.0), [0.0, 0.0, 0.0]),
        ("back wall", white, dvec3(0.0, 1.0, 1.0), [90.0, 0.0, 0.0]),
        ("left wall", red, dvec3(-1.0, 0.0, 1.0), [0.0, 90.0, 0.0]),
        ("right wall", green, dvec3(1.0, 0.0, 1.0), [0.0, -90.0, 0.0]),
    ] {
        scene.object(comment, "quad", material, middle, Size::Scale(2.0), rotation);
    }
    let (over, top) = ([180.0, 0.0, 0.0], dvec3(0.0, 0.0, 2.0));
    scene.object("ceiling", "ceiling_cornell", white, top, Size::Scale(1.0), over);
    scene.object("lamp", "quad", lamp, top, Size::Scale(LAMP), over);
    (scene, white)
}

fn blocks() -> Scene {
    let (mut scene, white) = empty();
    scene.standing("tall block", "block_tall", white, [-0.34, 0.3], 1.2, 18.0);
    scene.standing("short block", "box", white, [0.36, -0.36], 0.6, -17.0);
    scene
}

fn balls() -> Scene {
    let (mut scene, _) = empty();
    let silver = scene.material("mirror", Kind::Specular, [0.95, 0.95, 0.95]);
    let glass = scene.material("glass", Kind::Transparent(1.5), [1.0, 1.0, 1.0]);
    scene.standing("mirror ball", "sphere_20480", silver, [-0.42, 0.32], 0.8, 0.0);
    scene.standing("glass ball", "sphere_20480", glass, [0.42, -0.3], 0.8, 0.0);
    scene
}
