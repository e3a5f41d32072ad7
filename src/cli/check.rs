//! `wavetrace check`: is a scene right, and what is in it?

use super::Exit;
use super::args::CheckArgs;
use super::load::{Scene, load};
use super::messages::Console;
use super::units::{count, counted, short};
use wavetrace::material::Kind;
use wavetrace::render::Settings;
use wavetrace::wave::Plan;
use wavetrace::world::World;

/// Checks a scene.
pub fn run(args: &CheckArgs) -> Result<Exit, Exit> {
    let console = Console::new(false, args.strict);
    let Scene { camera, world } = load(&args.scene, None, &console)?;
    let rows = [
        ("camera", format!("at {}, towards {}", point(camera.focal_point), point(camera.direction))),
        (
            "pixels",
            format!(
                "{} x {}, {} x {} degrees",
                camera.width,
                camera.height,
                short(camera.x_angle),
                short(camera.y_angle)
            ),
        ),
        ("triangles", triangles(&world)),
        ("lights", lights(&world)),
        ("materials", materials(&world)),
        ("bounds", bounds(&world)),
        ("by chance", by_chance(&world)),
    ];
    let rows: Vec<String> = rows.iter().map(|(name, text)| format!("  {name:<10} {text}")).collect();
    console.answer(format_args!("{}: no mistakes\n{}", args.scene.display(), rows.join("\n")))?;
    Ok(Exit::Done)
}

/// Light that a render by default finds only where a path happens to hit a lamp.
fn by_chance(world: &World) -> String {
    let Settings { method, max_depth, wave_size, light_paths, .. } = Settings::default();
    let plan = Plan::new(world, method, max_depth, wave_size, light_paths);
    let focused =
        "no light; what mirrors and glass focus is found by light paths, and by paths aimed at where it comes from";
    plan.left_to_chance().unwrap_or(if plan.caustics() { focused } else { "no light" }).to_owned()
}

fn point(p: impl Into<[f64; 3]>) -> String {
    format!("({})", p.into().map(short).join(", "))
}

fn bounds(world: &World) -> String {
    let Some((lo, hi)) = world.bounds() else { return "none".to_owned() };
    // What rounding has left of a zero is no news.
    let least = 1e-6 * (hi - lo).max_element();
    let [lo, hi] = [lo, hi].map(|corner| corner.to_array().map(|c| if c.abs() < least { 0.0 } else { c }));
    format!("{} to {}", point(lo), point(hi))
}

/// Number of triangles, those that were dropped included.
pub fn triangles(world: &World) -> String {
    let kept = count(world.triangles() as u64);
    match world.dropped() as u64 {
        0 => kept,
        dropped => format!("{kept}; {} dropped", counted(dropped, "degenerate one")),
    }
}

/// What gives light.
pub fn lights(world: &World) -> String {
    let triangles = match world.lights() as u64 {
        0 => "no luminous triangle".to_owned(),
        n => counted(n, "luminous triangle"),
    };
    format!("{triangles}, {} background", if world.has_background() { "luminous" } else { "black" })
}

fn materials(world: &World) -> String {
    let kinds = Kind::SCATTERING.iter().copied().chain([Kind::Luminous]);
    let some: Vec<String> = kinds
        .map(|kind| (world.materials_of(kind), kind))
        .filter(|&(n, _)| n > 0)
        .map(|(n, kind)| format!("{n} {}", kind.name()))
        .collect();
    if some.is_empty() { "none".to_owned() } else { some.join(", ") }
}
