//! The render: load, build, trace, write, and the figures of it all.

use super::Exit;
use super::args::RenderArgs;
use super::choices::word;
use super::closing;
use super::interrupt::Interrupt;
use super::load::load;
use super::messages::Console;
use super::outputs::{self, Written};
use super::progress::{self, Goal};
use super::stats::{self, Run};
use super::trace::{self, Phase};
use super::units::{counted, per_pixel};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};
use wavetrace::output::{self, Layers, Metadata};
use wavetrace::render::{Control, Rendered, Renderer, Settings};
use wavetrace::wave::Plan;

/// Seconds that each part of a run took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Times {
    /// Reading the scene and its meshes, and freezing the world.
    pub load: Duration,
    /// Building the tree.
    pub build: Duration,
    /// Tracing.
    pub render: Duration,
    /// Encoding and writing the images.
    pub write: Duration,
    /// All of it.
    pub total: Duration,
}

/// Renders a scene to image files.
pub fn run(args: &RenderArgs) -> Result<Exit, Exit> {
    let start = Instant::now();
    let console = Console::new(args.quiet, args.strict);
    let interrupt = Interrupt::listen();
    outputs::check(args, &console)?;
    outputs::warn(args, &console);

    let scene = load(&args.scene, args.size, &console)?;
    let mut times = Times { load: start.elapsed(), ..Times::default() };
    let renderer = Renderer::with_options(scene.world, &args.build_options()).map_err(|error| console.fail(&error))?;
    times.build = start.elapsed() - times.load;

    let settings = args.settings();
    // From the announcement on, whoever interrupts gets an image.
    let control = interrupt.start_render();
    let plan = renderer.plan(&settings).map_err(|error| console.fail(&error))?;
    announce(args, &renderer, &settings, &plan, &console);
    let render_start = Instant::now();
    let rendered = watch(&renderer, &settings, control, &console)?;
    times.render = rendered.time;

    let write_start = Instant::now();
    let metadata = metadata(args, &settings, &rendered);
    let (image, variance) = (rendered.film.image(), args.variance.then(|| rendered.film.variances()));
    let layers = Layers { image: &image, variance: variance.as_deref() };
    let Written { files, complete } = outputs::write(args, layers, &metadata, &console);
    times.write = write_start.elapsed();
    times.total = start.elapsed();

    let run = Run { args, settings: &settings, renderer: &renderer, plan: &plan, rendered: &rendered, times: &times };
    let figured = args.stats.as_ref().map_or(Ok(()), |path| output::write_text(path, &stats::text(&run)));
    let traced = args.trace.as_ref().map_or(Ok(()), |path| {
        let phases = [
            Phase { name: "load", start, length: times.load },
            Phase { name: "build", start: start + times.load, length: times.build },
            Phase { name: "render", start: render_start, length: times.render },
            Phase { name: "write", start: write_start, length: times.write },
        ];
        output::write_text(path, &trace::text(&rendered.timeline, &phases))
    });
    closing::show(&run, &files, &console);
    let figured = figured.map_err(|error| console.fail(&error));
    let traced = traced.map_err(|error| console.fail(&error));
    if interrupt.happened() {
        return Ok(Exit::Interrupted);
    }
    figured?;
    traced?;
    console.settle()?;
    Ok(if complete { Exit::Done } else { Exit::Fault })
}

fn announce(args: &RenderArgs, renderer: &Renderer, settings: &Settings, plan: &Plan, console: &Console) {
    let world = renderer.world();
    console.line(format_args!(
        "rendering {}: {}x{} pixels, {}, {}",
        args.scene.display(),
        world.width(),
        world.height(),
        effort(args, settings),
        counted(world.triangles() as u64, "triangle"),
    ));
    if let Some(light) = plan.left_to_chance() {
        console.note(format_args!("found by chance alone: {light}; expect bright dots"));
    }
}

/// How many samples, or what decides it.
fn effort(args: &RenderArgs, settings: &Settings) -> String {
    let goals = [
        args.target_error.map(|error| format!("down to a relMSE of {error}")),
        args.time.map(|seconds| format!("for {seconds} s")),
        args.given_spp().filter(|_| args.is_open()).map(|spp| format!("at most {}", per_pixel(spp))),
    ];
    let goals: Vec<String> = goals.into_iter().flatten().collect();
    if goals.is_empty() { per_pixel(settings.spp) } else { goals.join(", ") }
}

/// Renders while another thread shows how far it is.
fn watch(renderer: &Renderer, settings: &Settings, control: &Control, console: &Console) -> Result<Rendered, Exit> {
    let world = renderer.world();
    let samples = u64::from(world.width()) * u64::from(world.height()) * u64::from(settings.spp);
    let goal = Goal { samples, time: settings.time, error: settings.target_error };
    thread::scope(|scope| {
        // Dropped at the end of this block, which is what the other thread waits for.
        let (_rendering, done) = mpsc::channel();
        if !console.is_quiet() {
            scope.spawn(move || progress::watch(control, goal, &done));
        }
        renderer.render(settings, control).map_err(|error| console.fail(&error))
    })
}

fn metadata(args: &RenderArgs, settings: &Settings, rendered: &Rendered) -> Metadata {
    let entries = [
        ("Software", format!("wavetrace {}", env!("CARGO_PKG_VERSION"))),
        ("scene", args.scene.display().to_string()),
        ("spp", stats::spp(args, settings, rendered).to_string()),
        ("seed", settings.seed.to_string()),
        ("method", word(args.method)),
        ("sampler", word(args.sampler)),
        ("effort", word(args.effort)),
        ("max_depth", settings.max_depth.map_or_else(|| "none".to_owned(), |depth| depth.to_string())),
        ("light_paths", settings.light_paths.to_string()),
        ("seconds_render", format!("{:.3}", rendered.time.as_secs_f64())),
    ];
    Metadata { entries: entries.map(|(key, value)| (key.to_owned(), value)).to_vec(), partial: rendered.partial }
}
