//! `wavetrace chart` as a user meets it: a small sweep, gone on with, cut short, refused; other programs' figures.

mod common;

use common::meshes::repository;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use wavetrace::chart::{Row, row};

/// A folder in which charts are made.
struct Place(TempDir);

struct Ran {
    code: Option<i32>,
    err: String,
}

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn put(&self, name: &str, text: &str) -> String {
        fs::write(self.path(name), text).unwrap();
        name.to_owned()
    }
    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_wavetrace"));
        command.current_dir(self.0.path()).arg("chart").args(args);
        command
    }
    fn run(&self, args: &[&str]) -> Ran {
        let output = self.command(args).output().unwrap();
        assert!(output.stdout.is_empty());
        Ran { code: output.status.code(), err: String::from_utf8(output.stderr).unwrap() }
    }
    fn ok(&self, args: &[&str]) -> String {
        let ran = self.run(args);
        assert_eq!(ran.code, Some(0), "{args:?}: {}", ran.err);
        ran.err
    }
    fn fails(&self, code: i32, args: &[&str], parts: &[&str]) {
        let ran = self.run(args);
        assert_eq!(ran.code, Some(code), "{args:?}: {}", ran.err);
        for part in parts {
            assert!(ran.err.contains(part), "{args:?}: expected {part:?} in: {}", ran.err);
        }
    }
    fn rows(&self, folder: &str) -> Vec<Row> {
        row::read(&self.path(folder).join("chart.csv")).unwrap()
    }
    fn page(&self, folder: &str) -> String {
        fs::read_to_string(self.path(folder).join("index.html")).unwrap()
    }
}

fn cornell() -> String {
    repository("scenes/cornell.json").to_str().unwrap().to_owned()
}

/// A sweep of twelve renders.
fn small<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec![scene, "--size", "32x32", "--spp", "1,2,4", "--seeds", "2", "--samplers", "xoshiro"];
    args.extend(["--methods", "nee,mis", "--threads", "2", "-o", "out"]);
    args.extend(more);
    args
}

/// What a row is of, without what differs from run to run.
fn what(row: &Row) -> (String, u64, u64) {
    (row.label.clone(), row.spp, row.seed.unwrap())
}

#[test]
fn a_sweep_gives_rows_in_their_order_and_all_files() {
    let (place, scene) = (Place::new(), cornell());
    let err = place.ok(&small(&scene, &[]));
    assert!(err.contains("12 renders") && err.contains("wrote out"), "{err}");
    let rows = place.rows("out");
    let order: Vec<_> = rows.iter().map(what).collect();
    let mut expected = Vec::new();
    for seed in 1..=2 {
        for spp in [1, 2, 4] {
            for label in ["nee xoshiro", "mis xoshiro"] {
                expected.push((label.to_owned(), spp, seed));
            }
        }
    }
    assert_eq!(order, expected);
    for row in &rows {
        let (trimmed, mse, flip) = (row.relmse_trimmed.unwrap(), row.mse.unwrap(), row.flip.unwrap());
        assert!(row.scene == "cornell" && row.seconds > 0.0 && row.relmse > 0.0 && mse > 0.0, "{row:?}");
        assert!(trimmed > 0.0 && trimmed <= row.relmse && (0.0..=1.0).contains(&flip), "{row:?}");
    }
    // The error falls about as one over the number of samples: within a factor of two of four times.
    let mean = |spp| rows.iter().filter(|row| row.spp == spp).map(|row| row.relmse_trimmed.unwrap()).sum::<f64>();
    let ratio = mean(1) / mean(4);
    assert!((2.0..8.0).contains(&ratio), "{ratio}");

    let svg = fs::read_to_string(place.path("out/chart.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.matches("class=\"point\"").count() == 12, "{svg}");
    assert!(fs::read(place.path("out/chart.png")).unwrap().starts_with(b"\x89PNG"));
    let page = place.page("out");
    for part in [
        "nee xoshiro",
        "mis xoshiro",
        "--seeds 2",
        "rustc",
        "32x32",
        "data:image/png;base64,",
        "two halves of 32 samples",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("Not complete"));
    let mut images: Vec<_> = fs::read_dir(place.path("out/images"))
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    images.sort();
    let expected = ["mis-xoshiro-4", "nee-xoshiro-4", "reference-a", "reference-b"];
    assert_eq!(images, expected.map(|name| format!("cornell.{name}.exr")));
}

#[test]
fn the_same_command_goes_on_where_it_was_cut_off() {
    let (place, scene) = (Place::new(), cornell());
    let args = small(&scene, &[]);
    place.ok(&args);
    let whole = place.rows("out");
    let text = fs::read_to_string(place.path("out/chart.csv")).unwrap();
    let kept: Vec<&str> = text.lines().take(1 + 7).collect();
    fs::write(place.path("out/chart.csv"), kept.join("\n") + "\n").unwrap();
    let reference = fs::metadata(place.path("out/images/cornell.reference-a.exr")).unwrap().modified().unwrap();
    let err = place.ok(&args);
    assert!(err.contains("7 of them there already"), "{err}");
    let again = place.rows("out");
    assert_eq!(again[..7], whole[..7], "what was measured stays");
    for (again, whole) in again.iter().zip(&whole) {
        assert_eq!(what(again), what(whole));
        // The images are the same to the bit, and so is what they are held against.
        assert_eq!((again.relmse, again.mse, again.flip), (whole.relmse, whole.mse, whole.flip));
    }
    let after = fs::metadata(place.path("out/images/cornell.reference-a.exr")).unwrap().modified().unwrap();
    assert_eq!(reference, after, "the reference is not rendered again");
    // All done: nothing is measured, the files are made again.
    fs::remove_file(place.path("out/index.html")).unwrap();
    fs::remove_file(place.path("out/images/cornell.nee-xoshiro-4.exr")).unwrap();
    assert!(place.ok(&args).contains("12 of them there already"));
    assert_eq!(place.rows("out"), again);
    assert!(place.page("out").contains("nee xoshiro") && place.path("out/images/cornell.nee-xoshiro-4.exr").exists());
    // More seeds and series of the same settings join them.
    let mut more = args.clone();
    more[6] = "3";
    more[8] = "xoshiro,sobol";
    place.ok(&more);
    assert_eq!(place.rows("out").len(), 36);
    assert_eq!(place.rows("out")[..12], again);
    place.ok(&args);
    assert_eq!(place.rows("out").len(), 36);
    assert!(place.page("out").contains("mis sobol"), "rows of series that this command lacks are drawn");
}

#[test]
fn rows_of_other_settings_are_refused() {
    let (place, scene) = (Place::new(), cornell());
    place.ok(&small(&scene, &[]));
    let before = fs::read(place.path("out/chart.csv")).unwrap();
    let change = |from: &str, to: &str| -> Vec<String> {
        small(&scene, &[]).iter().map(|word| if *word == from { to.to_owned() } else { (*word).to_owned() }).collect()
    };
    for (args, parts) in [
        (change("32x32", "16x32"), vec!["chart.json: scenes.cornell.size: found 32x32, expected 16x32", "not mixed"]),
        (change("1,2,4", "1,2,8"), vec!["reference.samples_per_pixel: found 64, expected 128"]),
        ([change("", ""), vec!["--max-depth".to_owned(), "2".to_owned()]].concat(), vec!["max_depth: found nothing"]),
        (
            [change("", ""), vec!["--reference".to_owned(), "out/images/cornell.reference-a.exr".to_owned()]].concat(),
            vec!["reference.picture: found nothing"],
        ),
    ] {
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        place.fails(1, &args, &parts);
    }
    let args = change("2", "1");
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    place.fails(1, &args, &["threads: found 2, expected 1"]);
    assert_eq!(fs::read(place.path("out/chart.csv")).unwrap(), before);
    // A scene of the same name with other content.
    let text = fs::read_to_string(&scene).unwrap().replace("../meshes", repository("meshes").to_str().unwrap());
    let other = place.put("cornell.json", &text.replace("\"radiance\": ", "\"radiance\": 1"));
    place.fails(1, &small(&other, &[]), &["scenes.cornell.picture: found"]);
    // Files that are damaged.
    let settings = fs::read_to_string(place.path("out/chart.json")).unwrap();
    fs::write(place.path("out/chart.json"), &settings[..settings.len() / 2]).unwrap();
    place.fails(1, &small(&scene, &[]), &["chart.json:", "found what is no JSON"]);
    fs::remove_file(place.path("out/chart.json")).unwrap();
    place.fails(1, &small(&scene, &[]), &["chart.csv:1:1: found rows without chart.json"]);
    fs::write(place.path("out/chart.json"), settings).unwrap();
    fs::write(place.path("out/chart.csv"), "scene,label,spp,seed,seconds,relmse\ncornell,mis xoshiro,1,1,0.1,x\n")
        .unwrap();
    place.fails(1, &small(&scene, &[]), &["chart.csv:2:29: relmse: found \"x\", expected a finite number"]);
}

#[test]
fn other_programs_are_drawn_on_the_same_axes() {
    let (place, scene) = (Place::new(), cornell());
    let header = "scene,label,spp,seconds,relmse\n";
    place.put("peer.csv", &format!("{header}cornell,other,4,0.01,0.5\ncornell,other,16,0.04,0.1\nroom,other,4,1,1\n"));
    let err = place.ok(&small(&scene, &["--import", "peer.csv"]));
    assert!(err.contains("warning: 1 imported row of the scene room"), "{err}");
    assert_eq!(place.rows("out").len(), 12, "imported rows stay in their own file");
    let svg = fs::read_to_string(place.path("out/chart.svg")).unwrap();
    assert!(svg.contains("other\n16 samples per pixel, 1 render\n0.0400 s\nrelMSE 0.100"), "{svg}");
    assert!(place.page("out").contains("<td>other</td>"));
    // A label of ours from elsewhere is told apart.
    fs::copy(place.path("out/chart.csv"), place.path("older.csv")).unwrap();
    place.ok(&small(&scene, &["--import", "older.csv"]));
    assert!(place.page("out").contains("mis xoshiro (older)"));
}

#[test]
fn broken_imports_are_named_before_anything_is_measured() {
    let (place, scene) = (Place::new(), cornell());
    let fails = |text: &str, part: &str| {
        place.put("peer.csv", text);
        place.fails(1, &small(&scene, &["--import", "peer.csv"]), &["error: peer.csv:", part]);
        assert!(!place.path("out").exists());
    };
    fails("", ":1:1: found an empty file");
    fails("scene,label,spp,seconds\n", ":1:1: found no column relmse");
    fails("scene,label,spp,seconds,relmse\ncornell,x,4,1,0.5\ncornell,x,4,0.", ":3:1: found 4 fields, expected 5");
    fails("scene,label,spp,seconds,relmse\ncornell,x,4,1,nan\n", ":2:15: relmse: found \"nan\"");
    fails("scene,label,spp,seconds,relmse\ncornell,x,-4,1,1\n", ":2:11: spp: found \"-4\"");
    place.fails(1, &small(&scene, &["--import", "none.csv"]), &["none.csv: cannot read"]);
    place.fails(1, &small(&scene, &["--import", "."]), &["cannot read"]);
}

#[test]
fn mistakes_of_the_command_line_exit_with_2() {
    let (place, scene) = (Place::new(), cornell());
    let copy = place.put("cornell.json", "{}");
    for (args, part) in [
        (vec![scene.as_str()], "--output"),
        (vec!["-o", "out"], "SCENE.json"),
        (vec![&scene, &copy, "-o", "out"], "second scene of the name cornell"),
        (
            vec![&scene, "-o", "out", "--reference", "a.exr", "--reference", "b.exr", "--reference", "c.exr"],
            "found 3 for",
        ),
        (vec![&scene, "-o", "out", "--spp", "4", "--seconds", "1"], "cannot be used with"),
        (vec![&scene, "-o", "out", "--spp", "268435456"], "268435456 is not in"),
        (vec![&scene, "-o", "out", "--methods", "bdpt"], "path, nee, mis"),
    ] {
        place.fails(2, &args, &[part]);
    }
    assert!(!place.path("out").exists());
}

#[test]
fn scenes_references_and_folders_at_fault_exit_with_1() {
    let (place, scene) = (Place::new(), cornell());
    place.fails(1, &["none.json", "-o", "out"], &["none.json: cannot read"]);
    place.fails(1, &small(&scene, &["--reference", "none.exr"]), &["none.exr: cannot read"]);
    place.put("empty.exr", "");
    place.fails(1, &small(&scene, &["--reference", "empty.exr"]), &["empty.exr: found an empty file"]);
    let wavetrace = |args: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_wavetrace")).current_dir(place.0.path()).args(args).output();
        assert!(output.unwrap().status.success());
    };
    wavetrace(&[&scene, "--size", "16x32", "-o", "small.exr"]);
    place.fails(1, &small(&scene, &["--reference", "small.exr"]), &["small.exr: found 16x32 pixels, expected 32x32"]);
    assert!(!place.path("out").exists(), "nothing is made before all input is read");
    wavetrace(&[&scene, "--size", "32x32", "-o", "limited.png"]);
    let err = place.ok(&small(&scene, &["--reference", "limited.png"]));
    assert!(err.contains("warning: limited.png: values are limited to 1"), "{err}");
    place.put("file", "");
    let mut args = small(&scene, &[]);
    let last = args.len() - 1;
    args[last] = "file";
    place.fails(1, &args, &["file: found a file, expected a folder"]);
    args[last] = "/proc/none";
    place.fails(1, &args, &["cannot make"]);
    fs::create_dir_all(place.path("taken/index.html")).unwrap();
    args[last] = "taken";
    place.fails(1, &args, &["taken/index.html: found a folder, expected a file"]);
}

#[test]
fn references_from_files_are_used_as_they_are() {
    let (place, scene) = (Place::new(), cornell());
    place.ok(&small(&scene, &[]));
    let own = place.rows("out");
    let halves =
        ["--reference", "out/images/cornell.reference-a.exr", "--reference", "out/images/cornell.reference-b.exr"];
    let mut args = small(&scene, &halves);
    let at = args.iter().position(|&word| word == "out").unwrap();
    args[at] = "two";
    place.ok(&args);
    // Both halves from files are the same as the folder's own; the images are the same to the bit.
    for (a, b) in own.iter().zip(&place.rows("two")) {
        assert_eq!((a.relmse, a.relmse_trimmed, a.mse, a.flip), (b.relmse, b.relmse_trimmed, b.mse, b.flip));
    }
    args.truncate(args.len() - 2);
    args[at] = "one";
    place.ok(&args);
    let one = place.rows("one");
    assert!(own.iter().zip(&one).all(|(a, b)| a.relmse != b.relmse));
    assert!(place.page("one").contains("out/images/cornell.reference-a.exr"));
    assert!(place.page("two").contains("is taken off") && !place.page("one").contains("is taken off"));
}

#[test]
fn seconds_make_a_ladder_of_their_own() {
    let (place, scene) = (Place::new(), cornell());
    let args =
        [scene.as_str(), "--size", "32x32", "--seconds", "0.02", "--seeds", "1", "--methods", "mis", "-o", "out"];
    place.ok(&args);
    let rows = place.rows("out");
    for label in ["mis xoshiro", "mis sobol"] {
        let budgets: Vec<u64> = rows.iter().filter(|row| row.label == label).map(|row| row.spp).collect();
        assert!(!budgets.is_empty() && budgets.iter().enumerate().all(|(i, &spp)| spp == 1 << i), "{budgets:?}");
    }
    // The ladders are kept: going on finds nothing to do.
    assert!(place.ok(&args).contains(&format!("{} of them there already", rows.len())));
    assert_eq!(place.rows("out"), rows);
}

#[test]
fn quiet_says_nothing() {
    let (place, scene) = (Place::new(), cornell());
    assert_eq!(place.ok(&small(&scene, &["--quiet"])), "");
}

#[test]
fn a_black_scene_has_no_error_and_no_chart_but_a_page() {
    let place = Place::new();
    let camera = r#"{"focalPoint": {"x": 0, "y": 0, "z": 0}, "direction": {"x": 0, "y": 1, "z": 0}}"#;
    let scene = place.put("dark.json", &format!(r#"{{"camera": {camera}, "materials": [], "objects": []}}"#));
    let err = place.ok(&small(&scene, &[]));
    assert!(err.contains("the image is black"), "{err}");
    assert!(place.rows("out").iter().all(|row| row.relmse == 0.0));
    assert!(place.page("out").contains("nothing to draw"));
}

/// Waits until `found` says yes, which takes seconds at most.
fn wait(found: impl Fn() -> bool) {
    let start = Instant::now();
    while !found() {
        assert!(start.elapsed() < Duration::from_secs(120), "waited in vain");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_sweep_keeps_what_it_has_and_goes_on() {
    let (place, scene) = (Place::new(), cornell());
    // The first budgets take no time, the last one would take hours: the reference is given.
    let wavetrace = Command::new(env!("CARGO_BIN_EXE_wavetrace"))
        .current_dir(place.0.path())
        .args([&scene, "64", "--size", "32x32", "-o", "reference.exr"])
        .status();
    assert!(wavetrace.unwrap().success());
    let args = [
        scene.as_str(),
        "--size",
        "32x32",
        "--spp",
        "1,2,200000000",
        "--seeds",
        "1",
        "--methods",
        "mis",
        "--samplers",
        "xoshiro",
        "--reference",
        "reference.exr",
        "-o",
        "out",
    ];
    let child = place.command(&args).stderr(Stdio::piped()).spawn().unwrap();
    // A plain line of progress tells that the long render runs; by then the rows before it are in memory.
    wait(|| place.path("out/chart.json").exists());
    std::thread::sleep(Duration::from_millis(1500));
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{err}");
    assert!(err.contains("interrupted") && err.contains("wrote out"), "{err}");
    assert_eq!(
        place.rows("out").iter().map(what).collect::<Vec<_>>(),
        [("mis xoshiro".to_owned(), 1, 1), ("mis xoshiro".to_owned(), 2, 1)]
    );
    assert!(place.page("out").contains("Not complete: 1 render"));
    let mut shorter = args;
    shorter[4] = "1,2,4";
    let err = place.ok(&shorter);
    assert!(err.contains("2 of them there already"), "{err}");
    assert_eq!(place.rows("out").len(), 3);
    assert!(!place.page("out").contains("Not complete"));
}

#[cfg(unix)]
#[test]
fn an_interruption_before_the_first_row_leaves_no_chart() {
    let (place, scene) = (Place::new(), cornell());
    let args = [scene.as_str(), "--size", "32x32", "--spp", "200000000", "--methods", "mis", "-o", "out"];
    let child = place.command(&args).stderr(Stdio::piped()).spawn().unwrap();
    wait(|| place.path("out/chart.json").exists());
    std::thread::sleep(Duration::from_millis(300));
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{err}");
    assert!(err.contains("interrupted before anything was measured"), "{err}");
    assert!(!place.path("out/index.html").exists());
    // With other settings it starts afresh: there is nothing to mix.
    place.ok(&[scene.as_str(), "--size", "16x16", "--spp", "1,2", "--seeds", "1", "--methods", "mis", "-o", "out"]);
}

#[test]
fn no_temporary_file_is_left() {
    let (place, scene) = (Place::new(), cornell());
    place.ok(&small(&scene, &["--quiet"]));
    let names = |path: &Path| -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(path).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(
        names(&place.path("out")),
        ["chart.csv", "chart.json", "chart.png", "chart.svg", "images", "index.html"]
    );
    assert_eq!(names(place.0.path()), ["out"]);
}
