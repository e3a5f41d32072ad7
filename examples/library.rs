//! wavetrace as a library: `cargo run --release --example library [IMAGE]`.
//!
//! Builds a world in code, renders it, reads the film as linear RGB and writes an image (`library.png` unless named).

use std::{env, error::Error, path::PathBuf};
use wavetrace::output::{self, Metadata, Tone};
use wavetrace::{Camera, Control, DVec3, MaterialInput, Mesh, Object, Renderer, Settings, Size, WorldBuilder};

/// A unit square in the plane z = 0, facing +z.
fn square() -> Mesh {
    let corner = |x, y| DVec3::new(x, y, 0.0);
    Mesh {
        positions: vec![corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A regular octahedron, corners at distance 1 from its centre, front faces outwards.
fn octahedron() -> Mesh {
    let [x, y, z] = DVec3::AXES;
    Mesh {
        positions: vec![x, -x, y, -y, z, -z],
        triangles: vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
        ..Mesh::default()
    }
}

/// Three stones on a floor under a lamp and a dim sky.
fn world() -> WorldBuilder {
    let mut world = WorldBuilder::new(Camera {
        focal_point: DVec3::new(0.0, -5.0, 1.8),
        direction: DVec3::new(0.0, 5.0, -1.2),
        width: 320,
        height: 200,
        x_angle: 40.0,
        y_angle: 25.64,
    });
    let (square, stone) = (world.mesh(square()), world.mesh(octahedron()));
    let mut place = |mesh, material, size, rotation, mid_point| {
        let material = world.material(material);
        world.object(Object { mesh, material, rotation, size, mid_point });
    };
    let gray = MaterialInput::Diffuse { color: [0.7; 3], mattness: 1.0 };
    let satin = MaterialInput::Diffuse { color: [0.8, 0.25, 0.1], mattness: 0.3 };
    let gold = MaterialInput::Specular { color: [0.95, 0.75, 0.35] };
    let glass = MaterialInput::Transparent { color: [0.9, 1.0, 0.95], ref_index: 1.5 };
    let lamp = MaterialInput::Luminous { radiance: [4.5, 4.0, 3.0] };
    let turned = |degrees| DVec3::new(0.0, 0.0, degrees);
    place(square, gray, Size::Scale(20.0), DVec3::ZERO, DVec3::ZERO);
    place(square, lamp, Size::Scale(2.5), DVec3::new(180.0, 0.0, 0.0), DVec3::new(-1.0, -0.5, 3.0));
    place(stone, satin, Size::Height(1.0), turned(20.0), DVec3::new(-1.2, 0.0, 0.5));
    place(stone, gold, Size::Height(1.2), turned(50.0), DVec3::new(0.0, 0.6, 0.6));
    place(stone, glass, Size::Height(1.0), turned(75.0), DVec3::new(1.2, 0.0, 0.5));
    world.background([0.10, 0.12, 0.16]);
    world
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::args_os().nth(1).map_or_else(|| PathBuf::from("library.png"), PathBuf::from);
    let renderer = Renderer::new(world().build()?);
    let settings = Settings { spp: 64, ..Settings::default() };
    println!("stages of this scene:\n{}", renderer.plan(&settings)?);

    let rendered = renderer.render(&settings, &Control::default())?;
    let image = rendered.film.image();
    let pixels: &[[f32; 3]] = &image.pixels;
    let (samples, rays) = (rendered.counts.camera, rendered.counts.rays());
    println!("{samples} samples, {rays} rays in {:.2?} on {} threads", rendered.time, rendered.threads);
    let mean = |channel: usize| pixels.iter().map(|p| f64::from(p[channel])).sum::<f64>() / pixels.len() as f64;
    println!("mean radiance, linear RGB: {:.4} {:.4} {:.4}", mean(0), mean(1), mean(2));

    output::write(&path, &image, &Metadata::default(), &Tone::default())?;
    println!("wrote {}", path.display());
    Ok(())
}
