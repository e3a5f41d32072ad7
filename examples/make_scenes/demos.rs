//! The scenes `demo1` to `demo6`, and `test15`, which looks through the pane of `demo6`.

use crate::{
    room::{Lights, Room},
    scene::{Color, Kind, Scene, Size},
};
use glam::dvec3;

const WHITE: Color = [0.75, 0.75, 0.75];
const WARM: Color = [1.0, 0.93, 0.82];

/// All of them, by name.
pub fn scenes() -> Vec<(String, Scene)> {
    let named = [
        ("demo1", demo1()),
        ("demo2", demo2()),
        ("demo3", demo3()),
        ("demo4", demo4()),
        ("demo5", demo5()),
        ("demo6", demo6()),
        ("test15", test15()),
    ];
    named.map(|(name, scene)| (name.to_owned(), scene)).into()
}

/// From the front end of the room to `height` above the middle of its back half.
fn view(height: f64) -> Scene {
    Scene::new(dvec3(0.0, -4.8, 1.45), dvec3(0.0, 0.0, height), [640, 480], 45.0)
}

fn demo1() -> Scene {
    let mut scene = view(0.9);
    let room = Room {
        plain: WHITE,
        left: [0.7, 0.3, 0.18],
        right: [0.2, 0.42, 0.7],
        back: Some(WHITE),
        lights: Lights::One,
        light: (WARM, 6.0),
    };
    room.build(&mut scene);
    let silver = scene.material("silver", Kind::Specular, [0.92, 0.92, 0.92]);
    let gold = scene.material("gold", Kind::Specular, [0.95, 0.72, 0.32]);
    scene.standing("silver ball", "sphere_20480", silver, [-0.72, 0.35], 1.4, 0.0);
    scene.standing("gold ball", "sphere_20480", gold, [0.75, -0.75], 1.1, 0.0);
    scene
}

/// Three green balls of different mattness in a diffuse box.
fn three_balls(scene: &mut Scene) {
    let room = Room {
        plain: WHITE,
        left: [0.75, 0.6, 0.4],
        right: [0.75, 0.6, 0.4],
        back: Some(WHITE),
        lights: Lights::One,
        light: (WARM, 6.0),
    };
    room.build(scene);
    for (x, y, mattness) in [(-1.26, -0.1, 1.0), (0.0, 0.3, 0.4), (1.26, -0.1, 0.1)] {
        let green = scene.material("green", Kind::Diffuse(mattness), [0.2, 0.68, 0.22]);
        scene.standing("ball", "sphere_5120", green, [x, y], 1.25, 0.0);
    }
}

fn demo2() -> Scene {
    let mut scene = view(0.85);
    three_balls(&mut scene);
    scene
}

fn demo3() -> Scene {
    let mut scene = view(1.05);
    let room = Room {
        plain: WHITE,
        left: [0.75, 0.45, 0.3],
        right: [0.75, 0.68, 0.45],
        back: Some(WHITE),
        lights: Lights::Two,
        light: (WARM, 6.0),
    };
    room.build(&mut scene);
    let green = scene.material("green", Kind::Diffuse(1.0), [0.2, 0.62, 0.18]);
    scene.standing("rabbit", "rabbit", green, [0.0, -0.5], 1.9, -55.0);
    scene
}

fn demo4() -> Scene {
    let mut scene = view(0.95);
    let room = Room {
        plain: [0.62, 0.68, 0.78],
        left: [0.3, 0.45, 0.75],
        right: [0.35, 0.6, 0.75],
        back: Some([0.5, 0.6, 0.78]),
        lights: Lights::Two,
        light: (WARM, 9.0),
    };
    room.build(&mut scene);
    let silver = scene.material("silver", Kind::Specular, [0.92, 0.92, 0.92]);
    let copper = scene.material("copper", Kind::Specular, [0.93, 0.58, 0.42]);
    let fur = scene.material("rabbit", Kind::Diffuse(1.0), [0.78, 0.58, 0.38]);
    scene.standing("silver ball", "sphere_20480", silver, [-1.15, 0.6], 1.3, 0.0);
    scene.standing("copper ball", "sphere_20480", copper, [1.15, 0.0], 1.0, 0.0);
    scene.standing("rabbit", "rabbit", fur, [-0.05, -0.75], 1.5, -115.0);
    scene
}

fn demo5() -> Scene {
    let mut scene = view(1.0);
    let room = Room {
        plain: WHITE,
        left: WHITE,
        right: WHITE,
        back: None,
        lights: Lights::Two,
        light: ([1.0, 1.0, 1.0], 8.0),
    };
    room.build(&mut scene);
    let blue = scene.material("blue mirror", Kind::Specular, [0.4, 0.56, 0.92]);
    // The bent wall is 0.5 deep: its sides meet the side walls at the very back of the room.
    let size = Size::Scale(1.0);
    scene.object("convex back wall", "bent_wall", blue, dvec3(0.0, 1.75, 1.5), size, [0.0; 3]);
    for (comment, x, y, mattness, color) in [
        ("ivory", -1.1, 0.1, 1.0, [0.78, 0.68, 0.5]),
        ("red", 0.0, -0.55, 0.4, [0.7, 0.12, 0.08]),
        ("black", 1.1, 0.1, 0.15, [0.12, 0.1, 0.1]),
    ] {
        let lacquer = scene.material(comment, Kind::Diffuse(mattness), color);
        scene.standing("pawn", "pawn", lacquer, [x, y], 1.5, 0.0);
    }
    scene
}

fn demo6() -> Scene {
    let mut scene = view(0.85);
    three_balls(&mut scene);
    let glass = scene.material("glass", Kind::Transparent(1.5), [0.9, 0.97, 0.93]);
    // Its edges cut the ball in the middle and the right one, so that the shift shows.
    let size = Size::Scale(1.5);
    scene.object("pane", "pane", glass, dvec3(0.6, -1.9, 1.02), size, [0.0, 0.0, 40.0]);
    scene
}

/// The pane straight in front of a ruled wall: it shifts every line by nothing, and magnifies none.
fn test15() -> Scene {
    let mut scene = Scene::new(dvec3(0.0, -4.8, 1.5), dvec3(0.0, 0.0, 1.5), [640, 480], 32.0);
    let room = Room {
        plain: WHITE,
        left: WHITE,
        right: WHITE,
        back: None,
        lights: Lights::One,
        light: ([1.0, 1.0, 1.0], 9.0),
    };
    room.build(&mut scene);
    let dark = scene.material("dark stripes", Kind::Diffuse(1.0), [0.05, 0.05, 0.05]);
    let light = scene.material("light stripes", Kind::Diffuse(1.0), [0.8, 0.8, 0.8]);
    // Each set of stripes lacks the last one at its far end, which moves its centre by half a stripe.
    let size = || Size::Scale(1.0);
    scene.object("stripes", "ruling", dark, dvec3(-0.05, 2.0, 1.5), size(), [90.0, 0.0, 0.0]);
    scene.object("stripes", "ruling", light, dvec3(0.05, 2.0, 1.5), size(), [90.0, 0.0, 0.0]);
    let glass = scene.material("glass", Kind::Transparent(1.5), [0.9, 0.97, 0.93]);
    scene.object("pane", "pane", glass, dvec3(0.0, -1.5, 1.5), Size::Scale(1.5), [0.0; 3]);
    scene
}
