//! temporary
use wavetrace::{output, render::*, scene};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let t = std::time::Instant::now();
    let l = scene::load(a[1].as_ref()).unwrap_or_else(|e| {
        eprintln!("{e}");
        std::process::exit(1)
    });
    let w = l.builder.build().unwrap();
    let tl = t.elapsed();
    let r = Renderer::new(w);
    let tb = t.elapsed() - tl;
    let mut s = Settings { spp: a[2].parse().unwrap(), time_stages: false, ..Settings::default() };
    for x in &a[4..] {
        match x.as_str() {
            "ref" => s.integrator = Integrator::Reference,
            "stages" => s.time_stages = true,
            "path" => s.method = wavetrace::wave::Method::Path,
            "nee" => s.method = wavetrace::wave::Method::Nee,
            "sobol" => s.sampler = SamplerKind::Sobol,
            x if x.starts_with("t") => s.threads = x[1..].parse().unwrap(),
            x if x.starts_with("w") => s.wave_size = x[1..].parse().unwrap(),
            x if x.starts_with("seed") => s.seed = x[4..].parse().unwrap(),
            _ => panic!(),
        }
    }
    println!("{}", r.plan(&s).unwrap());
    let o = r.render(&s, &Control::default()).unwrap();
    println!(
        "load {tl:?} build {tb:?} render {:?} rays {} Mrays/s {:.2} Msamples/s {:.3} bad {} cut {} tris {} bvh {:?}",
        o.time,
        o.counts.rays(),
        o.counts.rays() as f64 / o.time.as_secs_f64() / 1e6,
        o.counts.camera as f64 / o.time.as_secs_f64() / 1e6,
        o.bad.len(),
        o.counts.cut,
        r.world().triangles(),
        r.bvh().counts()
    );
    let total: f64 = o.stages.iter().map(|s| s.time.as_secs_f64()).sum();
    for s in &o.stages {
        println!(
            "{:10} {:8} {:12} {:8.3}s {:5.1}% {:7.1} ns",
            s.stage.name(),
            s.calls,
            s.items,
            s.time.as_secs_f64(),
            s.time.as_secs_f64() / total * 100.0,
            s.time.as_secs_f64() * 1e9 / s.items as f64
        );
    }
    output::write(a[3].as_ref(), &o.film.image(), &Default::default(), &Default::default()).unwrap();
}
