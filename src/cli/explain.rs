//! `--explain`: what a scene makes the program build, and what it leaves out.

use super::Exit;
use super::args::RenderArgs;
use super::check::{lights, triangles};
use super::choices::{Integrator, word};
use super::load::load;
use super::messages::Console;
use super::units::{bytes, count};
use wavetrace::lanes;
use wavetrace::render::Renderer;

/// Shows the plan of a render; renders nothing.
pub fn run(args: &RenderArgs) -> Result<Exit, Exit> {
    let console = Console::new(args.quiet, args.strict);
    let scene = load(&args.scene, args.size, &console)?;
    let renderer = Renderer::with_options(scene.world, &args.build_options()).map_err(|error| console.fail(&error))?;
    let plan = renderer.plan(&args.settings()).map_err(|error| console.fail(&error))?;
    let (world, (nodes, leaves)) = (renderer.world(), renderer.bvh().counts());
    let integrator = match args.integrator {
        Integrator::Wavefront => format!("wavefront, SIMD: {}", lanes::simd()),
        Integrator::Reference => "reference: one path at a time takes the decisions below".to_owned(),
        Integrator::Scalar => "scalar: one path, box and triangle at a time takes the decisions below".to_owned(),
    };
    let rows = [
        ("scene", args.scene.display().to_string()),
        ("pixels", format!("{} x {}", world.width(), world.height())),
        ("triangles", format!("{}; {}", triangles(world), bytes(world.bytes() as u64))),
        ("lights", lights(world)),
        (
            "bvh",
            format!(
                "{} inner nodes, {} leaves; {}",
                count(nodes as u64),
                count(leaves as u64),
                bytes(renderer.bvh().bytes() as u64)
            ),
        ),
        ("method", format!("{}, sampler {}", word(args.method), word(args.sampler))),
        ("integrator", integrator),
    ];
    let rows: Vec<String> = rows.iter().map(|(name, text)| format!("{name:<12}{text}")).collect();
    console.answer(format_args!("{}\nstages       + runs, - is left out\n{plan}", rows.join("\n")))?;
    Ok(Exit::Done)
}
