//! `wavetrace profile`: where the time and the memory of a render go, on one page.

mod args;
mod drawings;
mod page;

pub use args::ProfileArgs;

use super::Exit;
use super::args::RenderArgs;
use super::load::load;
use super::messages::Console;
use std::fs;
use std::time::{Duration, Instant};
use wavetrace::bench::suite::{Limits, limits};
use wavetrace::error::Error;
use wavetrace::output;
use wavetrace::probe::Counters;
use wavetrace::render::{Arithmetic, Control, Rendered, Renderer, Settings};
use wavetrace::wave::{Plan, Tuning};

/// All that the page shows.
pub struct Profile<'a> {
    /// What was asked for.
    pub args: &'a ProfileArgs,
    /// The scene.
    pub renderer: &'a Renderer,
    /// Which stages run.
    pub plan: &'a Plan,
    /// What it was rendered with.
    pub settings: &'a Settings,
    /// The render as users have it, with a timeline.
    pub usual: &'a Rendered,
    /// When it began.
    pub start: Instant,
    /// The same without refilled waves: all paths of a wave have the same number of bounces.
    pub by_depth: &'a Rendered,
    /// The same with the machine's counters read in each stage; or why there are none.
    pub counted: Result<Rendered, String>,
    /// What the stages compute for a row.
    pub arithmetic: Arithmetic,
    /// What the machine can do.
    pub limits: Limits,
    /// Reading the scene, building the tree.
    pub before: [Duration; 2],
}

/// Renders with clocks, and where there are counters with those, and writes the page.
pub fn run(args: &ProfileArgs) -> Result<Exit, Exit> {
    let console = Console::new(args.quiet, false);
    let fail = |error: Error| console.fail(&error);
    // Mistakes in it are told before anything is made.
    let render: RenderArgs =
        args.render().map_err(|(found, expected)| fail(Error::Setting { setting: "--set", found, expected }))?;
    let path = args.output.join("index.html");
    fs::create_dir_all(&args.output)
        .map_err(|source| fail(Error::Io { file: args.output.clone(), action: "make", source }))?;
    output::check_writable_text(&path).map_err(fail)?;

    let start = Instant::now();
    let scene = load(&args.scene, args.size, &console)?;
    let loaded = start.elapsed();
    let renderer = Renderer::with_options(scene.world, &render.build_options()).map_err(fail)?;
    let before = [loaded, start.elapsed() - loaded];

    let missing = Counters::missing();
    let times = if missing.is_some() { "twice" } else { "three times" };
    console.line(format_args!("measuring what the machine can do, then rendering {times}"));
    let limits = limits();
    let settings = Settings { timeline: true, time_stages: true, ..render.settings() };
    let plan = renderer.plan(&settings).map_err(fail)?;
    let start = Instant::now();
    let usual = renderer.render(&settings, &Control::default()).map_err(fail)?;
    let unfilled =
        Settings { tuning: Tuning { refill: false, ..settings.tuning }, timeline: false, ..settings.clone() };
    let counted = match missing {
        Some(reason) => Err(reason),
        None => Ok(renderer
            .render(&Settings { timeline: false, counters: true, ..settings.clone() }, &Control::default())
            .map_err(fail)?),
    };
    let by_depth = renderer.render(&unfilled, &Control::default()).map_err(fail)?;

    let arithmetic = renderer.arithmetic(&settings).map_err(fail)?;
    let profile = Profile {
        args,
        renderer: &renderer,
        plan: &plan,
        settings: &settings,
        usual: &usual,
        start,
        by_depth: &by_depth,
        counted,
        arithmetic,
        limits,
        before,
    };
    output::write_text(&path, &profile.page()).map_err(fail)?;
    console.line(format_args!("wrote {}", path.display()));
    Ok(Exit::Done)
}
