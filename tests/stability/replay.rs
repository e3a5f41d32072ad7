//! One sample of a pixel, traced again by itself.

use wavetrace::light::Spots;
use wavetrace::probe::NoProbe;
use wavetrace::render::{Renderer, SamplerKind, Settings};
use wavetrace::sampling::{Sampler, Screen, Sobol, Xoshiro};
use wavetrace::wave::{Context, Counts, Job, Wave};

/// Radiance of sample number `sample` of `pixel` in the render of these settings, where no light paths are traced.
pub fn replay(renderer: &Renderer, settings: &Settings, pixel: [u32; 2], sample: u32) -> [f32; 3] {
    let plan = renderer.plan(settings).unwrap();
    assert!(!plan.caustics(), "what light paths bring is no part of a sample");
    let cx = Context {
        world: renderer.world(),
        bvh: renderer.bvh(),
        plan: &plan,
        spots: &Spots::default(),
        seed: settings.seed,
        screen: Screen::new(renderer.world().width(), settings.spp),
    };
    let job = Job { pixels: vec![pixel], first_sample: sample, samples: 1, ..Job::default() };
    match settings.sampler {
        SamplerKind::Xoshiro => trace::<Xoshiro>(&cx, &job),
        SamplerKind::Sobol => trace::<Sobol>(&cx, &job),
    }
}

fn trace<S: Sampler>(cx: &Context<'_>, job: &Job) -> [f32; 3] {
    Wave::<S>::new(cx).run(cx, job, &mut NoProbe, &mut Counts::default())[0]
}
