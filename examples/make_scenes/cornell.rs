//! The box that every renderer is compared in: white, with a red wall at the left and a green one at the right, open
//! towards the camera. Its inside is x in [-1, 1], y in [-1, 1], z in [0, 2].

use crate::{
    flat,
    mesh::Mesh,
    scene::{Kind, Scene, Size},
};
use glam::{DVec3, dvec3};

/// Side of the lamp, which fills a hole in the ceiling.
const LAMP: f64 = 0.6;
/// Side of the small one: a thousandth of the ceiling.
const SMALL_LAMP: f64 = 0.0632;
/// Many lamps: how many of them one way and the other in the ceiling; a wall has half of them. Side of each.
const MANY: [u32; 2] = [10, 10];
const MANY_ON_A_WALL: [u32; 2] = [5, 10];
const MANY_LAMP: f64 = 0.03;

/// All scenes, by name.
pub fn scenes() -> Vec<(String, Scene)> {
    vec![
        ("cornell".to_owned(), blocks()),
        ("cornell-balls".to_owned(), balls()),
        ("small-lamp".to_owned(), small_lamp()),
        ("lamps-200".to_owned(), many_lamps()),
    ]
}

/// Meshes that only these scenes use.
pub fn meshes() -> Vec<(&'static str, &'static str, Mesh)> {
    let ceiling =
        |lamp: f64| flat::rectangle_with_holes(2.0, 2.0, &[[-0.5 * lamp, 0.5 * lamp, -0.5 * lamp, 0.5 * lamp]]);
    let [many, wall] = [MANY, MANY_ON_A_WALL].map(lamps);
    vec![
        ("ceiling_cornell", "2 by 2 with a hole for the lamp, facing +z", ceiling(LAMP)),
        ("ceiling_small_lamp", "2 by 2 with a hole for the lamp, facing +z", ceiling(SMALL_LAMP)),
        (
            "ceiling_100_lamps",
            "2 by 2 with holes for 10 by 10 lamps, facing +z",
            flat::rectangle_with_holes(2.0, 2.0, &many),
        ),
        (
            "wall_50_lamps",
            "2 by 2 with holes for 5 by 10 lamps, facing +z",
            flat::rectangle_with_holes(2.0, 2.0, &wall),
        ),
        ("lamps_100", "10 by 10 squares, facing +z", flat::rectangles(&many)),
        ("lamps_50", "5 by 10 squares, facing +z", flat::rectangles(&wall)),
    ]
}

/// Lamps evenly over 2 by 2, as (x from, x to, y from, y to).
fn lamps([across, along]: [u32; 2]) -> Vec<[f64; 4]> {
    let at = |k: u32, of: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(of) - 1.0;
    let half = 0.5 * MANY_LAMP;
    let middles = (0..along).flat_map(|j| (0..across).map(move |i| (at(i, across), at(j, along))));
    middles.map(|(x, y)| [x - half, x + half, y - half, y + half]).collect()
}

/// The empty box with its lamp, and its white.
fn empty() -> (Scene, usize) {
    let (mut scene, colours) = shell(true);
    let lamp = scene.material("lamp", Kind::Luminous(14.0), [1.0, 0.84, 0.6]);
    scene.object("ceiling", "ceiling_cornell", colours[0], TOP, Size::Scale(1.0), OVER);
    scene.object("lamp", "quad", lamp, TOP, Size::Scale(LAMP), OVER);
    (scene, colours[0])
}

/// Middle of the ceiling, and the rotation of what faces downwards there.
const TOP: DVec3 = dvec3(0.0, 0.0, 2.0);
const OVER: [f64; 3] = [180.0, 0.0, 0.0];

/// Floor, back wall and, if they are plain, side walls; white, red and green.
fn shell(sides: bool) -> (Scene, [usize; 3]) {
    // The opening is 2 wide at a distance of 2.9 and fills the picture: 2 atan(1 / 2.9) is 38.05 degrees.
    let mut scene = Scene::new(dvec3(0.0, -3.9, 1.0), dvec3(0.0, 0.0, 1.0), [512, 512], 38.0);
    let white = scene.material("white", Kind::Diffuse(1.0), [0.74, 0.74, 0.74]);
    let red = scene.material("red", Kind::Diffuse(1.0), [0.62, 0.06, 0.05]);
    let green = scene.material("green", Kind::Diffuse(1.0), [0.13, 0.46, 0.1]);
    let walls = [
        ("floor", white, dvec3(0.0, 0.0, 0.0), [0.0, 0.0, 0.0]),
        ("back wall", white, dvec3(0.0, 1.0, 1.0), [90.0, 0.0, 0.0]),
        ("left wall", red, LEFT.0, LEFT.1),
        ("right wall", green, RIGHT.0, RIGHT.1),
    ];
    for (comment, material, middle, rotation) in walls.into_iter().take(if sides { 4 } else { 2 }) {
        scene.object(comment, "quad", material, middle, Size::Scale(2.0), rotation);
    }
    (scene, [white, red, green])
}

/// Middles and rotations of the side walls.
const LEFT: (DVec3, [f64; 3]) = (dvec3(-1.0, 0.0, 1.0), [0.0, 90.0, 0.0]);
const RIGHT: (DVec3, [f64; 3]) = (dvec3(1.0, 0.0, 1.0), [0.0, -90.0, 0.0]);

fn stand_blocks(scene: &mut Scene, white: usize) {
    scene.standing("tall block", "block_tall", white, [-0.34, 0.3], 1.2, 18.0);
    scene.standing("short block", "box", white, [0.36, -0.36], 0.6, -17.0);
}

fn blocks() -> Scene {
    let (mut scene, white) = empty();
    stand_blocks(&mut scene, white);
    scene
}

/// The same light from a small lamp: hard shadows, and next to nothing that finds it by chance.
fn small_lamp() -> Scene {
    let (mut scene, [white, ..]) = shell(true);
    let lamp = scene.material("lamp", Kind::Luminous(1260.0), [1.0, 0.84, 0.6]);
    scene.object("ceiling", "ceiling_small_lamp", white, TOP, Size::Scale(1.0), OVER);
    scene.object("lamp", "quad", lamp, TOP, Size::Scale(SMALL_LAMP), OVER);
    stand_blocks(&mut scene, white);
    scene
}

/// Two hundred lamps of three colours, in the ceiling and in both side walls.
fn many_lamps() -> Scene {
    let (mut scene, [white, red, green]) = shell(false);
    let warm = scene.material("warm lamps", Kind::Luminous(45.0), [1.0, 0.84, 0.6]);
    let blue = scene.material("blue lamps", Kind::Luminous(30.0), [0.3, 0.5, 1.0]);
    let pink = scene.material("pink lamps", Kind::Luminous(30.0), [1.0, 0.4, 0.5]);
    scene.object("ceiling", "ceiling_100_lamps", white, TOP, Size::Scale(1.0), OVER);
    scene.object("lamps in the ceiling", "lamps_100", warm, TOP, Size::Scale(1.0), OVER);
    for (side, (middle, rotation), wall, lamps) in [("left", LEFT, red, blue), ("right", RIGHT, green, pink)] {
        scene.object(&format!("{side} wall"), "wall_50_lamps", wall, middle, Size::Scale(1.0), rotation);
        scene.object(&format!("lamps in the {side} wall"), "lamps_50", lamps, middle, Size::Scale(1.0), rotation);
    }
    stand_blocks(&mut scene, white);
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
