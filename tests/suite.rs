//! `wavetrace bench` and the instruments of a render, as a user has them: is everything measured that is said to be, is it
//! kept and compared, and does the command say what is wrong? Nothing here depends on how long anything takes.

mod common;

use common::meshes::repository;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// A scene with a lamp, a mirror and a matt floor, as small as can be.
const SCENE: &str = r#"{
  "camera": {"focalPoint": {"x": 0, "y": -4, "z": 1}, "direction": {"x": 0, "y": 4, "z": -0.5},
             "xReso": 16, "yReso": 16, "xAngle": 40, "yAngle": 40},
  "materials": [{"type": "diffuse", "color": {"r": 0.8, "g": 0.8, "b": 0.8}, "isLuminous": false},
                {"type": "specular", "color": {"r": 0.9, "g": 0.9, "b": 0.9}, "isLuminous": false},
                {"type": "diffuse", "color": {"r": 1, "g": 1, "b": 1}, "isLuminous": true, "radiance": 5}],
  "objects": [{"type": "mesh", "path": "quad.obj", "materialIndex": 0, "midPoint": {"x": 0, "y": 0, "z": 0}, "scale": 4},
              {"type": "mesh", "path": "quad.obj", "materialIndex": 1, "midPoint": {"x": 0, "y": 1.5, "z": 1},
               "scale": 1, "xrot": 60},
              {"type": "mesh", "path": "quad.obj", "materialIndex": 2, "midPoint": {"x": 0, "y": 0, "z": 2.5}, "scale": 1}]
}"#;

/// A folder with a folder of scenes; commands run in it.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(TempDir::new().unwrap());
        fs::create_dir(place.path("scenes")).unwrap();
        fs::write(place.path("scenes/small.json"), SCENE).unwrap();
        fs::copy(repository("meshes/quad.obj"), place.path("scenes/quad.obj")).unwrap();
        place
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    /// (exit code, standard output, standard error).
    fn run(&self, args: &str) -> (Option<i32>, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_wavetrace"));
        let ran = command.current_dir(self.0.path()).args(args.split_whitespace()).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (ran.status.code(), text(ran.stdout), text(ran.stderr))
    }
    fn expect(&self, code: i32, args: &str) -> (String, String) {
        let (found, out, err) = self.run(args);
        assert_eq!(found, Some(code), "{args}: {out}{err}");
        (out, err)
    }
    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }
    /// Writes a document of figures, all repeats times `factor` where more is better, and over it where less is.
    fn scaled(&self, name: &str, document: &Value, factor: f64) {
        let mut document = document.clone();
        for figure in document["figures"].as_array_mut().unwrap() {
            let rate = figure["unit"].as_str().unwrap().ends_with("/s");
            for value in figure["repeats"].as_array_mut().unwrap() {
                let x = value.as_f64().unwrap();
                *value = json!(if rate { x * factor } else { x / factor });
            }
        }
        fs::write(self.path(name), document.to_string()).unwrap();
    }
}

#[test]
fn the_suite_measures_all_of_it() {
    let place = Place::new();
    let (out, err) = place.expect(0, "bench --up-to 1000 --repeats 2 --threads 2 --save all");
    assert!(err.contains("wrote all.json"), "{err}");
    let document = place.json("all.json");
    let figures: BTreeMap<&str, &Value> =
        document["figures"].as_array().unwrap().iter().map(|f| (f["name"].as_str().unwrap(), f)).collect();
    let mut expected: BTreeSet<String> =
        ["machine/arithmetic", "machine/memory", "build/1k", "load/1k", "start/process"].map(str::to_owned).into();
    for kind in ["primary", "bounce", "shadow"] {
        expected.extend(["auto", "single", "many", "stream", "tile"].map(|kernel| format!("rays/1k/{kind}/{kernel}")));
    }
    // A mirror and a matt floor: light paths, too; nothing is sorted by one kind alone.
    let stages = "rays samples generate intersect route emit shade connect compact accumulate start scatter";
    expected.extend(stages.split(' ').chain(["instrumentation"]).map(|what| format!("scene/small/{what}")));
    // What a scene that small may or may not need.
    let rare = ["scene/small/aim", "scene/small/expose"];
    let names: BTreeSet<String> =
        figures.keys().filter(|name| !rare.contains(name)).map(|&name| name.to_owned()).collect();
    assert_eq!(names, expected);
    for (name, figure) in &figures {
        let repeats: Vec<f64> = figure["repeats"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        assert_eq!(repeats.len(), 2, "{name}");
        let whole = *name == "scene/small/instrumentation" || repeats.iter().all(|&x| x > 0.0);
        assert!(whole && figure["median"].is_number() && figure["spread"].is_number(), "{name}: {figure}");
    }
    for part in ["machine/memory", "1k primary", "small", "intersect", "start/process", "a clock in each stage adds"] {
        assert!(out.contains(part), "{part} in {out}");
    }
    assert_eq!(document["settings"]["threads"], 2);
    for place in ["/build/version", "/build/compiler", "/build/simd", "/machine/cpu", "/machine/cores"] {
        assert!(!document.pointer(place).unwrap().is_null(), "{place}");
    }
}

#[test]
fn slower_is_told_by_the_exit_code() {
    let place = Place::new();
    let bench = "bench --only start,load --up-to 1000 --repeats 2";
    let (out, _) = place.expect(0, &format!("{bench} --json --save now -q"));
    let now: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(now, place.json("now.json"));
    // Far more than any noise.
    place.scaled("fast.json", &now, 1000.0);
    place.scaled("slow.json", &now, 1e-3);
    let (out, _) = place.expect(3, &format!("{bench} --against fast"));
    assert!(out.contains("against fast.json") && out.contains("2 figures: 2 slower, 0 faster"), "{out}");
    let (out, _) = place.expect(0, &format!("{bench} --against slow.json --json"));
    let compared: Value = serde_json::from_str(&out).unwrap();
    for figure in compared["compared"]["figures"].as_array().unwrap() {
        assert_eq!(figure["verdict"], "faster", "{figure}");
        assert!(figure["speed"].as_f64().unwrap() > 1.0);
    }
    // Nothing is slower by more than this.
    place.expect(0, &format!("{bench} --against fast --tolerance 99.99"));
}

#[test]
fn figures_of_another_machine_or_build_are_refused() {
    let place = Place::new();
    let bench = "bench --only load --up-to 1000 --repeats 1";
    place.expect(0, &format!("{bench} --save now"));
    let mut other = place.json("now.json");
    other["machine"]["cpu"] = json!("another");
    other["build"]["compiler"] = json!("rustc 1.0.0");
    other["build"]["target"] = json!("a machine of next year");
    other["build"]["commit"] = json!("0123456789ab");
    fs::write(place.path("other.json"), other.to_string()).unwrap();
    let (out, err) = place.expect(1, &format!("{bench} --against other"));
    assert_eq!(out, "");
    for part in [
        "error: other.json: machine.cpu: found \"another\"",
        "build.compiler: found \"rustc 1.0.0\"",
        "build.target: found \"a machine",
        "--force",
    ] {
        assert!(err.contains(part), "{part} in {err}");
    }
    // What is compared is allowed to differ.
    assert!(!err.contains("commit"), "{err}");
    let (out, err) = place.expect(0, &format!("{bench} --against other --force --tolerance 99"));
    assert!(out.contains("1 figure:") && err.contains("warning: other.json: machine.cpu"), "{out}{err}");
}

/// What cannot be compared is told: nothing in common, figures without a counterpart, runs that failed, an unknown machine.
#[test]
fn what_is_not_compared_is_told() {
    let place = Place::new();
    place.expect(0, "bench --only load,start --up-to 1000 --repeats 1 --save now");
    let (_, err) = place.expect(1, "bench --only build --up-to 1000 --repeats 1 --against now");
    assert!(err.contains("now.json: found no figure of this run"), "{err}");
    let mut failed = place.json("now.json");
    for figure in failed["figures"].as_array_mut().unwrap() {
        figure["repeats"] = json!([null]);
    }
    fs::write(place.path("failed.json"), failed.to_string()).unwrap();
    let (out, _) = place.expect(0, "bench --only start --up-to 1000 --repeats 1 --against failed --json");
    let document: Value = serde_json::from_str(&out).unwrap();
    let compared = &document["compared"];
    assert_eq!((&compared["figures"][0]["verdict"], &compared["machine_speed"]), (&json!("unclear"), &Value::Null));
    let find = |name: &str| document["figures"].as_array().unwrap().iter().find(|f| f["name"] == name).unwrap();
    // Measured though it was not asked for; other processes are started, which keep this one's CPUs idle.
    assert!(find("machine/memory")["median"].as_f64().unwrap() > 0.0);
    assert!(find("start/process")["busy_cpus"].is_null());
    let (out, _) = place.expect(0, "bench --only start --up-to 1000 --repeats 1 --against failed");
    for part in ["1 figure: 0 slower", "0 of this run, 1 of those before", "has changed is not known"] {
        assert!(out.contains(part), "{part} in {out}");
    }
}

#[test]
fn mistakes_are_named() {
    let place = Place::new();
    fs::write(place.path("text.json"), "{").unwrap();
    fs::write(place.path("else.json"), "{\"program\": \"another\"}").unwrap();
    fs::write(place.path("bad.json"), "{\"program\": \"wavetrace\", \"format\": 1, \"figures\": [{\"name\": 3}]}")
        .unwrap();
    fs::create_dir(place.path("empty")).unwrap();
    for (code, args, part) in [
        (1, "bench --against none", "none.json: cannot read"),
        (1, "bench --against text", "text.json: found no JSON"),
        (1, "bench --against else", "else.json: found another document"),
        (1, "bench --against bad", "bad.json: found figures[0]"),
        (1, "bench --against empty --scenes none", "empty.json: cannot read"),
        (1, "bench --only scene --scenes none", "none: cannot look for scenes in"),
        (1, "bench --only scene --scenes empty", "empty: found no scene"),
        (1, "bench --only load --save none/a", "none"),
        (2, "bench --only rain", "rain"),
        (2, "bench --up-to 999", "999"),
        (2, "bench --repeats 0", "0"),
        (2, "bench --tolerance 5", "--against"),
        (2, "bench --against a --tolerance 0", "above 0 and below 100"),
        (2, "bench rays --only load", "--only"),
    ] {
        let (out, err) = place.expect(code, args);
        assert!(out.is_empty() && err.contains(part), "{args}: {part} in {err}");
    }
    fs::write(place.path("scenes/bad.json"), "{").unwrap();
    let (_, err) = place.expect(1, "bench --only scene");
    assert!(err.contains("bad.json:1:1"), "{err}");
}

/// A timeline has all workers and phases, in their order, stages within their spans of work.
#[test]
fn a_timeline_is_whole() {
    let place = Place::new();
    place.expect(0, "scenes/small.json 40 --size 64x64 --threads 2 -o a.png --trace t.json --stats s.json");
    let document = place.json("t.json");
    let events = document["traceEvents"].as_array().unwrap();
    let spans: Vec<(&str, u64, f64, f64)> = events
        .iter()
        .filter(|e| e["ph"] == "X")
        .map(|e| {
            let number = |key: &str| e[key].as_f64().unwrap();
            (e["name"].as_str().unwrap(), e["tid"].as_u64().unwrap(), number("ts"), number("ts") + number("dur"))
        })
        .collect();
    let phases: Vec<_> = spans.iter().filter(|s| s.1 == 0).collect();
    assert_eq!(phases.iter().map(|s| s.0).collect::<Vec<_>>(), ["load", "build", "render", "write"]);
    // Nanoseconds are told.
    let slack = 0.002;
    assert!(phases.windows(2).all(|pair| pair[0].3 <= pair[1].2 + slack), "{phases:?}");
    let render = phases[2];
    let names: BTreeSet<&str> = spans.iter().map(|s| s.0).collect();
    for name in ["generate", "shade", "connect", "scatter", "visit", "light paths", "survey", "merge"] {
        assert!(names.contains(name), "{name} in {names:?}");
    }
    // As viewers see it, to the last bit: what begins within another ends within it.
    for tid in 0..3 {
        let mut own: Vec<_> = spans.iter().filter(|s| s.1 == tid).collect();
        own.sort_by(|a, b| a.2.total_cmp(&b.2).then(b.3.total_cmp(&a.3)));
        let mut open: Vec<&&(&str, u64, f64, f64)> = Vec::new();
        for span in &own {
            while open.last().is_some_and(|outer| outer.3 <= span.2) {
                open.pop();
            }
            assert!(open.last().is_none_or(|outer| span.3 <= outer.3), "{span:?} in {open:?}");
            open.push(span);
        }
        assert!(own.len() > 3);
    }
    let stats = place.json("s.json");
    for tid in [1, 2] {
        let own: Vec<_> = spans.iter().filter(|s| s.1 == tid).collect();
        assert!(own.iter().all(|s| s.2 >= render.2 - slack && s.3 <= render.3 + slack));
        let outer = |s: &&&(&str, u64, f64, f64)| ["visit", "light paths", "survey", "merge"].contains(&s.0);
        for inner in own.iter().filter(|s| !outer(s)) {
            let within = own.iter().filter(outer).any(|o| o.2 <= inner.2 + slack && inner.3 <= o.3 + slack);
            assert!(within, "{inner:?}");
        }
    }
    // All that ran is there: so short a render is not thinned.
    let calls = |name: &str| {
        let stages = stats["stages"].as_array().unwrap();
        stages.iter().find(|s| s["name"] == name).unwrap()["calls"].as_u64().unwrap()
    };
    let items = |name: &str| -> u64 {
        let of = events.iter().filter(|e| e["name"] == name);
        of.map(|e| e["args"]["items"].as_u64().unwrap()).sum()
    };
    let stage = |name: &str| stats["stages"].as_array().unwrap().iter().find(|s| s["name"] == name).unwrap().clone();
    for name in ["generate", "intersect", "shade", "connect"] {
        assert_eq!(items(name), stage(name)["items"].as_u64().unwrap(), "{name}");
        assert!(calls(name) > 0);
    }
}

/// By the number of bounces: of waves that are not refilled exactly the rays that are counted.
#[test]
fn stages_are_told_by_bounces() {
    let place = Place::new();
    let render = "scenes/small.json 16 --light-paths 0 --threads 1 -o a.png --stats s.json";
    for refill in ["on", "off"] {
        place.expect(0, &format!("{render} --refill {refill}"));
        let stats = place.json("s.json");
        assert_eq!(stats["tuning"]["refill"], refill);
        let stages = stats["stages"].as_array().unwrap();
        let intersect = stages.iter().find(|s| s["name"] == "intersect").unwrap();
        let items: Vec<f64> =
            intersect["depths"].as_array().unwrap().iter().map(|d| d["items"].as_f64().unwrap()).collect();
        let (camera, bounce) = (stats["rays"]["camera"].as_f64().unwrap(), stats["rays"]["bounce"].as_f64().unwrap());
        assert!((items[0] - camera).abs() < 1e-6 * camera, "{refill}: {items:?}, {camera}");
        assert!((items.iter().skip(1).sum::<f64>() - bounce).abs() < 1e-6 * bounce, "{refill}: {items:?}, {bounce}");
        for stage in stages.iter().filter(|s| s["name"] != "accumulate") {
            let depths = stage["depths"].as_array().unwrap();
            let seconds: f64 = depths.iter().map(|d| d["seconds"].as_f64().unwrap()).sum();
            let all = stage["seconds"].as_f64().unwrap();
            assert!((seconds - all).abs() <= 1e-6 * all, "{refill}: {stage}");
        }
        assert!(intersect["bytes_per_item"] == 36 && intersect["gb_per_s"].as_f64().unwrap() > 0.0);
    }
}

/// Where the machine has counters, each stage that ran took cycles and instructions; else it is said why there are none.
#[test]
fn counters_are_read_or_it_is_said_why_not() {
    let place = Place::new();
    let stats = |more: &str| {
        place.expect(0, &format!("scenes/small.json 4 --threads 2 -o a.png --stats s.json {more}"));
        place.json("s.json")
    };
    let asked = stats("--counters");
    let said = asked["counters"].as_str().unwrap();
    for stage in asked["stages"].as_array().unwrap() {
        let counted = &stage["counters"];
        if said != "read" || stage["calls"] == 0 {
            assert!(counted.is_null(), "{said}: {stage}");
        } else if stage["items"].as_u64().unwrap() > 100 {
            assert!(["cycles", "instructions"].iter().all(|name| counted[name].as_u64().unwrap() > 0), "{stage}");
        }
    }
    assert!(said == "read" || said.starts_with("this system gives none: "), "{said}");
    let plain = stats("");
    assert!(plain["counters"].is_null() && plain["stages"][0]["counters"].is_null());
    let (_, err) = place.expect(2, "scenes/small.json -o a.png --counters");
    assert!(err.contains("--stats"), "{err}");
}

/// A sweep has a row for each scene, value and repeat, and draws each.
#[test]
fn a_sweep_has_all_values() {
    let place = Place::new();
    let sweep = "bench sweep --scene scenes/small.json --repeats 2 --size 16x16 --spp 1";
    let (out, err) = place.expect(0, &format!("{sweep} --vary wave=64..256 --set refill=off -o one"));
    assert!(out.contains("wave=256") && err.contains("wrote one/index.html"), "{out}{err}");
    let csv = fs::read_to_string(place.path("one/sweep.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0], ["scene", "wave", "repeat", "seconds", "mrays_per_s", "msamples_per_s"]);
    let keys: Vec<_> = rows[1..].iter().map(|row| (row[1], row[2])).collect();
    assert_eq!(keys, [("64", "1"), ("64", "2"), ("128", "1"), ("128", "2"), ("256", "1"), ("256", "2")]);
    assert!(rows[1..].iter().all(|row| row[3..].iter().all(|x| x.parse::<f64>().unwrap() > 0.0)));
    for (file, points) in [("one/index.html", 3), ("one/sweep.svg", 3)] {
        let text = fs::read_to_string(place.path(file)).unwrap();
        assert_eq!(text.matches("class=\"point\"").count(), points, "{file}");
    }
    assert!(fs::read(place.path("one/sweep.png")).unwrap().starts_with(b"\x89PNG"));

    place.expect(0, &format!("{sweep} --vary bvh=fast,best --vary leaf=2,4,8 -q -o two"));
    let page = fs::read_to_string(place.path("two/index.html")).unwrap();
    assert_eq!(page.matches("class=\"point\"").count(), 6);

    for (args, part) in [
        ("--vary colour=1 -o no", "one of the knobs"),
        ("--vary wave=0 -o no", "wave"),
        ("--vary wave=64 --vary leaf=1 --vary job=1 -o no", "one knob or two"),
        ("--vary wave=64 --set leaf=1,2 -o no", "one value"),
        ("--vary wave=64 --vary wave=128 -o no", "wave"),
        ("--vary wave=64", "--output"),
        ("--vary wave=64 --scene scenes/small.json -o no", "each scene once"),
        ("--vary wave=64 --scene other/small.json -o no", "file name of its own"),
        ("--vary wave=64,128 --set wave=256 -o no", "each knob once"),
    ] {
        let (_, err) = place.expect(2, &format!("{sweep} {args}"));
        assert!(err.contains(part) && !place.path("no").exists(), "{args}: {err}");
    }
}

/// Ctrl-C ends the suite soon, keeps nothing, and takes its temporary files with it.
#[test]
#[cfg(unix)]
fn an_interrupted_suite_leaves_nothing() {
    let place = Place::new();
    fs::create_dir(place.path("tmp")).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_wavetrace"))
        .args("bench --only load,start --up-to 1000 --repeats 1000 --save kept".split(' '))
        .current_dir(place.0.path())
        .env("TMPDIR", place.path("tmp"))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let files = || fs::read_dir(place.path("tmp")).unwrap().count();
    // The mesh and the scene are there once it measures.
    while files() < 2 {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let code = child.wait().unwrap().code();
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!((code, files(), place.path("kept.json").exists()), (Some(130), 0, false), "{said}");
    assert!(said.contains("nothing is kept"), "{said}");
}

/// Builds to compare with are programs that say how fast they were: one that is far faster shows a tax, one that is far
/// slower none, and a scene that has what a build lacks is not compared.
#[cfg(unix)]
#[test]
fn a_tax_is_what_this_program_takes_more_than_a_build_without() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    let program = |name: &str, samples_per_s: &str| {
        let this = env!("CARGO_BIN_EXE_wavetrace");
        let text = format!(
            "#!/bin/sh\n{this} \"$@\"{}\necho '{{\"samples_per_s\": {samples_per_s}}}' > stats.json\n",
            if name == "other" { " --seed 7" } else { "" }
        );
        fs::write(place.path(name), text).unwrap();
        fs::set_permissions(place.path(name), fs::Permissions::from_mode(0o755)).unwrap();
    };
    program("fast", "1e15");
    program("slow", "1e-3");
    program("other", "1");

    let (out, err) = place.expect(0, "bench tax");
    assert!(out.contains("used, 44") && out.contains("--without FEATURES=PROGRAM"), "{out}");
    assert!(!err.contains("error"), "{err}");
    let args = "bench tax --by time --repeats 2 --spp 1 --size 16x16 --without specular=./fast -o tax.md";
    let tax = |without: &str| format!("{args} --without transparent={without} --without smooth+choice={without}");
    let (out, _) = place.expect(0, &tax("./slow"));
    assert_eq!(out.matches("-100.00 %").count(), 2, "{out}");
    let page = fs::read_to_string(place.path("tax.md")).unwrap();
    assert!(page.contains("| small | used | -100.00 % | -100.00 % |") && page.contains("Nothing takes more"), "{page}");
    let (_, err) = place.expect(3, &tax("./fast"));
    assert!(
        err.contains("small pays") && err.contains("for transparent") && err.contains("for smooth+choice"),
        "{err}"
    );

    for (args, part) in [
        ("bench tax --without glass=./fast", "\"glass\""),
        ("bench tax --without transparent", "FEATURE+FEATURE=PROGRAM"),
        ("bench tax --by time --without transparent=./nowhere", "nowhere"),
        ("bench tax --by time --size 16x16 --without transparent=./other", "other: renders"),
        ("bench tax --scenes .", "found no scene"),
        ("bench tax -o missing/tax.md", "missing/tax.md"),
    ] {
        let (code, out, err) = place.run(args);
        assert!(code != Some(0) && err.contains(part) && out.is_empty(), "{args}: {out}{err}");
    }
    let names: BTreeSet<_> = fs::read_dir(place.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names.len(), 5, "{names:?}");
}
