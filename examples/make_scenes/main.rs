//! Writes the meshes and scenes that this repository holds: `cargo run --release --example make_scenes [FOLDER]`.
//!
//! Everything is computed from the numbers in these files, and comes out the same every time.

mod cornell;
mod demos;
mod fan;
mod fans;
mod flat;
mod mesh;
mod pawn;
mod rabbit;
mod room;
mod round;
mod scene;
mod surface_nets;
mod text;

use glam::{DVec3, dvec3};
use mesh::Mesh;
use room::Lights;
use std::{env, fs, io, path::PathBuf};

/// Name, comment and shape of every mesh.
fn meshes() -> Vec<(&'static str, &'static str, Mesh)> {
    vec![
        ("quad", "unit square in the plane z = 0, facing +z", flat::rectangle(1.0, 1.0)),
        ("rect_4x7", "rectangle, 4 along x and 7 along y, facing +z", flat::rectangle(4.0, 7.0)),
        ("rect_4x3", "rectangle, 4 along x and 3 along y, facing +z", flat::rectangle(4.0, 3.0)),
        ("rect_3x7", "rectangle, 3 along x and 7 along y, facing +z", flat::rectangle(3.0, 7.0)),
        ("ceiling_one_light", "4 by 7 with a hole for one lamp, facing +z", Lights::One.ceiling()),
        ("ceiling_two_lights", "4 by 7 with holes for two lamps, facing +z", Lights::Two.ceiling()),
        ("ruling", "every second of 40 stripes along y that rule 4 by 3, facing +z", flat::ruling(4.0, 3.0, 40)),
        ("box", "unit cube", flat::block(DVec3::ONE)),
        ("block_tall", "block twice as tall as wide", flat::block(dvec3(1.0, 1.0, 2.0))),
        ("pane", "flat pane across y", flat::block(dvec3(1.0, 0.06, 0.75))),
        ("bent_wall", "part of a cylinder, 4 wide, 3 tall, bulging by 0.5 to -y", round::bent_wall(4.0, 0.5, 3.0, 64)),
        ("sphere_320", "unit sphere", round::sphere(2)),
        ("sphere_1280", "unit sphere", round::sphere(3)),
        ("sphere_5120", "unit sphere", round::sphere(4)),
        ("sphere_20480", "unit sphere", round::sphere(5)),
        ("pawn", "chess pawn", pawn::pawn()),
        ("rabbit", "sitting rabbit, its nose to +x", rabbit::rabbit()),
        ("fan", "ten triangles turned by 0, 10, ... 90 degrees, fronts to -y", fan::fan()),
        ("fan_flipped", "the fan with its backs to -y", fan::fan().flipped()),
    ]
}

fn main() -> io::Result<()> {
    let root = env::args_os().nth(1).map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    let (mesh_folder, scene_folder) = (root.join("meshes"), root.join("scenes"));
    fs::create_dir_all(&mesh_folder)?;
    fs::create_dir_all(&scene_folder)?;
    for (name, comment, mesh) in meshes().into_iter().chain(cornell::meshes()) {
        fs::write(mesh_folder.join(name).with_extension("obj"), mesh.to_obj(comment))?;
    }
    let scenes = [demos::scenes(), fans::scenes(), cornell::scenes()];
    for (name, scene) in scenes.into_iter().flatten() {
        fs::write(scene_folder.join(name).with_extension("json"), scene.to_json())?;
    }
    Ok(())
}
