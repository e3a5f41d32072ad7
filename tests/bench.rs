//! The instrument: are the rays what they are said to be, do all kernels find the same, and does the command say what is
//! wrong?

mod common;

use common::meshes::{Soup, cuboid, inverted, join, patch, soup, sphere, v};
use common::stats::{ALPHA, sidak};
use glam::DVec3;
use serde_json::Value;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::collections::HashMap;
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use tempfile::TempDir;
use wavetrace::accel::{Bvh, Ray, brute_force};
use wavetrace::bench::kernel::Query;
use wavetrace::bench::{
    self, Bounds, HitRecord, Kernel, Options, RayRecord, RaySet, SetKind, Tracer, View, camera, files, mesh, room,
};

/// A room of two boxes, and boxes that go to its corners: closed, of 12 x 10 x 8.
fn closed() -> Soup {
    soup(&join(&[
        inverted(cuboid(v(-6.0, -5.0, -4.0), v(6.0, 5.0, 4.0))),
        cuboid(v(-2.0, -5.0, -1.0), v(0.0, -1.0, 1.0)),
        sphere(v(2.0, -2.0, 0.5), 1.5, 2, false),
    ]))
}

/// What is open to all sides.
fn open() -> Soup {
    soup(&join(&[patch(0.0, 0.0, 0.0, 4.0, 4.0), sphere(v(0.3, 0.1, 1.0), 0.8, 3, false)]))
}

fn point(p: [f32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

/// The sets of a mesh, by kind.
struct Sets {
    corners: Soup,
    sets: Vec<RaySet>,
    view: View,
}

impl Sets {
    fn new(corners: Soup, options: &Options) -> Self {
        let bvh = Bvh::build(&corners);
        let tracer = Tracer { bvh: &bvh, kernel: Kernel::Auto, threads: 1 };
        let (sets, view) = bench::make(&corners, &tracer, options, &SetKind::ALL).unwrap();
        assert_eq!(sets.iter().map(|set| set.kind).collect::<Vec<_>>(), SetKind::ALL);
        Self { corners, sets, view }
    }
    fn rays(&self, kind: SetKind) -> &[RayRecord] {
        &self.sets.iter().find(|set| set.kind == kind).unwrap().rays
    }
    /// The nearest hit, found without a tree.
    fn hit(&self, ray: &RayRecord) -> wavetrace::accel::Hit {
        let ray = Ray { origin: ray.origin, direction: ray.direction, t_max: ray.t_max };
        brute_force(&self.corners, &ray)
    }
    /// (point, unit normal on the side of the ray) of the primary rays that hit something.
    fn primary_hits(&self) -> Vec<(DVec3, DVec3)> {
        let hit = |ray: &RayRecord| {
            let hit = self.hit(ray);
            let [a, b, c] = self.corners.get(hit.triangle as usize)?.map(point);
            let n = (b - a).cross(c - a).normalize();
            let d = point(ray.direction);
            Some((point(ray.origin) + d * f64::from(hit.t), if n.dot(d) > 0.0 { -n } else { n }))
        };
        self.rays(SetKind::Primary).iter().filter_map(hit).collect()
    }
}

fn bits(ray: &RayRecord) -> [u32; 8] {
    bytemuck::cast::<_, [u32; 8]>(*ray)
}

#[test]
fn sets_have_the_documented_numbers_and_order() {
    let options = Options { res: 32, ..Options::default() };
    for (name, corners, closed) in [("closed", closed(), true), ("open", open(), false)] {
        let sets = Sets::new(corners, &options);
        let hits = sets.primary_hits();
        assert_eq!(sets.rays(SetKind::Primary), sets.view.rays(32, options.up), "{name}");
        assert_eq!(sets.rays(SetKind::Primary).len(), 32 * 32);
        assert_eq!(hits.len() == 32 * 32, closed, "{name}: {} hits", hits.len());
        for kind in [SetKind::Bounce, SetKind::Shuffled, SetKind::Shadow] {
            assert_eq!(sets.rays(kind).len(), hits.len(), "{name} {kind:?}");
        }
        let deep = sets.rays(SetKind::Deep).len();
        assert!(if closed { deep == 32 * 32 } else { deep < hits.len() / 2 }, "{name}: {deep} deep rays");
        // Spawned rays start above their own hit, in the order of the primary rays.
        let bounds = Bounds::of(&sets.corners);
        let offset = 1e-4 * bounds.extent().length() + 1e-6 * bounds.lo.abs().max(bounds.hi.abs()).max_element();
        for kind in [SetKind::Bounce, SetKind::Shadow] {
            for (ray, (p, n)) in sets.rays(kind).iter().zip(&hits) {
                assert!((point(ray.origin) - (*p + *n * offset)).length() < 1e-3 * offset + 1e-6, "{name} {kind:?}");
            }
        }
        for set in &sets.sets {
            let end = if set.kind == SetKind::Shadow { 0.999 } else { f32::INFINITY };
            assert!(set.rays.iter().all(|ray| ray.t_min == 0.0 && ray.t_max == end), "{name} {:?}", set.kind);
            if set.kind != SetKind::Shadow {
                assert!(set.rays.iter().all(|ray| (point(ray.direction).length() - 1.0).abs() < 1e-6), "{name}");
            }
        }
    }
}

/// In a closed room all rays that were spawned hit something: none starts outside.
#[test]
fn spawned_rays_stay_in_a_closed_room() {
    let corners = mesh::corners(&room::room(5000, 3));
    let bvh = Bvh::build(&corners);
    let tracer = Tracer { bvh: &bvh, kernel: Kernel::Auto, threads: 2 };
    let (sets, _) = bench::make(&corners, &tracer, &Options { res: 128, ..Options::default() }, &SetKind::ALL).unwrap();
    for set in sets.iter().filter(|set| set.kind != SetKind::Shadow) {
        let hits = tracer.hits(&set.rays, Query::Closest);
        assert_eq!(set.rays.len(), 128 * 128, "{:?}", set.kind);
        assert_eq!(hits.iter().filter(|hit| !hit.is_some()).count(), 0, "{:?}", set.kind);
    }
}

#[test]
fn shadow_rays_end_at_uniform_points_of_the_light() {
    for up in [bench::Axis::X, bench::Axis::Y, bench::Axis::Z] {
        let sets = Sets::new(closed(), &Options { res: 64, up, ..Options::default() });
        let extent = DVec3::new(12.0, 10.0, 8.0);
        let [u, a, b] = up.cycle();
        let side = 0.1 * extent[a].min(extent[b]);
        let mut cells = [0u32; 64];
        for ray in sets.rays(SetKind::Shadow) {
            let target = point(ray.origin) + point(ray.direction);
            assert!((target[u] - 0.4 * extent[u]).abs() < 1e-5, "{target}");
            let [s, t] = [a, b].map(|k| target[k] / side + 0.5);
            assert!((-1e-4..1.0001).contains(&s) && (-1e-4..1.0001).contains(&t), "{target}");
            cells[((s * 8.0) as usize).min(7) * 8 + ((t * 8.0) as usize).min(7)] += 1;
        }
        let p = p_uniform(&cells);
        assert!(p > sidak(ALPHA, 3), "{up:?}: p = {p:e}");
    }
}

/// p-value of counts being of equally likely cells.
fn p_uniform(cells: &[u32]) -> f64 {
    let expected = f64::from(cells.iter().sum::<u32>()) / cells.len() as f64;
    let chi2: f64 = cells.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
    1.0 - ChiSquared::new(cells.len() as f64 - 1.0).unwrap().cdf(chi2)
}

/// Cosine-weighted directions have a uniform squared sine, and a uniform angle about the normal; those of the next
/// bounces do not follow from the first ones'.
#[test]
fn bounces_are_cosine_weighted_about_the_normal() {
    let sets = Sets::new(closed(), &Options { res: 128, ..Options::default() });
    let hits = sets.primary_hits();
    let mut cells = [0u32; 100];
    for (ray, (_, n)) in sets.rays(SetKind::Bounce).iter().zip(&hits) {
        let d = point(ray.direction);
        assert!(d.dot(*n) > 0.0, "a bounce goes into its surface");
        let across = n.any_orthonormal_vector();
        let turn = d.dot(n.cross(across)).atan2(d.dot(across)) / std::f64::consts::TAU + 0.5;
        let sine2 = 1.0 - d.dot(*n).powi(2);
        cells[((sine2 * 10.0) as usize).min(9) * 10 + ((turn * 10.0) as usize).min(9)] += 1;
    }
    assert_eq!(cells.iter().sum::<u32>(), 128 * 128);
    let p = p_uniform(&cells);
    assert!(p > ALPHA, "p = {p:e}");
}

#[test]
fn shuffled_is_a_permutation_of_bounce() {
    let sets = Sets::new(closed(), &Options { res: 64, ..Options::default() });
    let (bounce, shuffled) = (sets.rays(SetKind::Bounce), sets.rays(SetKind::Shuffled));
    let places: HashMap<[u32; 8], usize> = bounce.iter().enumerate().map(|(i, ray)| (bits(ray), i)).collect();
    assert_eq!(places.len(), bounce.len(), "all rays differ");
    let order: Vec<usize> = shuffled.iter().map(|ray| places[&bits(ray)]).collect();
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert!(sorted.iter().copied().eq(0..bounce.len()));
    // Where a ray comes from tells nothing of where it goes to: 8 x 8 cells of old and new places. They are not quite
    // independent, each row and column having its exact share: 49 degrees of freedom.
    let n = order.len();
    let mut cells = [0.0; 64];
    order.iter().enumerate().for_each(|(to, &from)| cells[to * 8 / n * 8 + from * 8 / n] += 1.0);
    let expected = n as f64 / 64.0;
    let chi2: f64 = cells.iter().map(|c: &f64| (c - expected).powi(2) / expected).sum();
    let p = 1.0 - ChiSquared::new(49.0).unwrap().cdf(chi2);
    assert!(p > ALPHA, "p = {p:e}");
}

/// The deep rays start where four hits of brute force say: off a surface, at a normal's distance.
#[test]
fn deep_rays_leave_surfaces() {
    let sets = Sets::new(closed(), &Options { res: 16, ..Options::default() });
    let offset = Bounds::of(&sets.corners).offset();
    let deep = sets.rays(SetKind::Deep);
    assert_eq!(deep.len(), 256);
    let bounce = sets.rays(SetKind::Bounce);
    assert!(deep.iter().all(|ray| bounce.iter().all(|other| ray.origin != other.origin)), "deep is not bounce");
    for ray in deep {
        let p = point(ray.origin);
        let distance = |t: &[[f32; 3]; 3]| {
            let [a, b, c] = t.map(point);
            let n = (b - a).cross(c - a).normalize();
            ((p - a).dot(n), n.dot(point(ray.direction)))
        };
        let near = |t: &[[f32; 3]; 3]| {
            let (height, slope) = distance(t);
            (height.abs() - offset).abs() < 0.05 * offset && height * slope > 0.0
        };
        assert!(sets.corners.iter().any(near), "{ray:?} does not leave a surface");
    }
}

#[test]
fn the_same_options_give_the_same_bytes_on_any_kernel_and_threads() {
    let corners = open();
    let bvh = Bvh::build(&corners);
    let options = Options { res: 64, ..Options::default() };
    let make = |kernel, threads, options: &Options| {
        bench::make(&corners, &Tracer { bvh: &bvh, kernel, threads }, options, &SetKind::ALL).unwrap().0
    };
    let first = make(Kernel::Auto, 1, &options);
    for (kernel, threads) in [(Kernel::Auto, 1), (Kernel::Single, 1), (Kernel::Many, 3)] {
        assert_eq!(make(kernel, threads, &options), first);
    }
    let other = make(Kernel::Auto, 1, &Options { seed: 2, ..options });
    for (a, b) in first.iter().zip(&other) {
        assert_eq!(a.rays == b.rays, a.kind == SetKind::Primary, "{:?}", a.kind);
    }
    // A set does not depend on what else is made.
    for kind in SetKind::ALL {
        let tracer = Tracer { bvh: &bvh, kernel: Kernel::Auto, threads: 1 };
        let (alone, _) = bench::make(&corners, &tracer, &options, &[kind]).unwrap();
        assert_eq!(alone, first.iter().filter(|set| set.kind == kind).cloned().collect::<Vec<_>>());
    }
}

/// Every kernel, on any number of threads, finds what brute force finds, and says it as the files want it.
#[test]
fn kernels_agree_with_brute_force_and_keep_the_conventions() {
    let mut flat = open();
    // Triangles without area change nothing but the numbers of the others.
    flat.insert(0, [[0.1, 0.2, 0.3]; 3]);
    flat.insert(3, [[-1.0, 0.0, 0.5], [0.0, 0.0, 0.5], [1.0, 0.0, 0.5]]);
    for (name, corners) in [("open", open()), ("closed", closed()), ("flat", flat), ("nothing", Vec::new())] {
        let sets = Sets::new(corners, &Options { res: 40, ..Options::default() });
        let bvh = Bvh::build(&sets.corners);
        let mut all = sets.sets.clone();
        // Rays that end before what they would hit, and rays without a direction.
        let short = |ray: &RayRecord| RayRecord { t_max: 0.7, ..*ray };
        all.push(RaySet { kind: SetKind::Primary, rays: sets.rays(SetKind::Primary).iter().map(short).collect() });
        all.push(RaySet {
            kind: SetKind::Primary,
            rays: vec![RayRecord { t_max: f32::INFINITY, ..Default::default() }],
        });
        let mut found = 0;
        for set in &all {
            let expected: Vec<HitRecord> = set
                .rays
                .iter()
                .map(|ray| match (sets.hit(ray), set.kind) {
                    (hit, _) if !hit.is_some() => HitRecord { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: 0xffff_ffff },
                    (_, SetKind::Shadow) => HitRecord { t: 0.0, u: 0.0, v: 0.0, triangle: 0 },
                    (hit, _) => HitRecord { t: hit.t, u: hit.u, v: hit.v, triangle: hit.triangle },
                })
                .collect();
            found += expected.iter().filter(|hit| hit.is_some()).count();
            for &(kernel, kernel_name) in Kernel::ALL {
                for threads in [1, 2, 7] {
                    let hits = Tracer { bvh: &bvh, kernel, threads }.hits(&set.rays, set.kind.query());
                    assert!(hits == expected, "{name}: {:?}, {kernel_name}, {threads} threads", set.kind);
                }
            }
        }
        assert_eq!(found > 1000, name != "nothing", "{name}: {found} hits");
    }
}

#[test]
fn the_chosen_camera_sees_the_most_triangles() {
    let sets = Sets::new(open(), &Options { res: 8, up: bench::Axis::Z, ..Options::default() });
    let seen = |view: &View| {
        let rays = view.rays(64, bench::Axis::Z);
        let mut ids: Vec<u32> = rays.iter().map(|ray| sets.hit(ray).triangle).filter(|&id| id != u32::MAX).collect();
        ids.sort_unstable();
        ids.dedup();
        ids.len()
    };
    let counts = camera::candidates(&Bounds::of(&sets.corners), bench::Axis::Z).map(|view| (seen(&view), view));
    let most = counts.iter().map(|c| c.0).max().unwrap();
    assert_eq!(sets.view, counts.iter().find(|c| c.0 == most).unwrap().1);
    assert!(most > 100, "{most}");
    let given = View { eye: v(0.5, 0.25, 3.0), direction: v(0.0, 0.1, -1.0), fov: 40.0 };
    assert_eq!(Sets::new(open(), &Options { res: 8, view: Some(given), ..Options::default() }).view, given);
}

/// A folder in which the program runs.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        let mut text = Vec::new();
        mesh::write_obj(&room::room(500, 1), &mut text).unwrap();
        fs::write(folder.path("room.obj"), text).unwrap();
        folder
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    /// (exit code, standard output, standard error).
    fn run(&self, args: &[&str]) -> (Option<i32>, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_wavetrace"));
        let ran = command.current_dir(self.0.path()).args(["bench", "rays"]).args(args).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (ran.status.code(), text(ran.stdout), text(ran.stderr))
    }
    fn ok(&self, args: &[&str]) -> String {
        let (code, out, err) = self.run(args);
        assert_eq!(code, Some(0), "{args:?}: {err}");
        out
    }
    fn fails(&self, expected: i32, args: &[&str], parts: &[&str]) {
        let (code, out, err) = self.run(args);
        assert_eq!((code, out.as_str()), (Some(expected), ""), "{args:?}: {err}");
        assert!(err.starts_with("error: "), "{args:?}: {err}");
        for part in parts {
            assert!(err.contains(part), "{args:?}: expected {part:?} in: {err}");
        }
    }
}

/// Options with which a run is short.
const SHORT: [&str; 5] = ["room.obj", "--res", "16", "--repeats", "1"];

#[test]
fn the_table_and_the_json_have_all_sets() {
    let folder = Folder::new();
    let table = folder.ok(&SHORT);
    let rows: Vec<&str> = table.lines().rev().take(5).map(|l| l.split_whitespace().next().unwrap()).collect();
    assert_eq!(rows, ["deep", "shadow", "shuffled", "bounce", "primary"], "{table}");

    let out = folder.ok(&[&SHORT[..], &["--json", "--rays", "deep,primary", "--threads", "2"]].concat());
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&json["threads"], &json["repeats"], &json["kernel"]), (&2.into(), &1.into(), &"auto".into()));
    assert!(json["build_s"].as_f64().unwrap() > 0.0);
    assert!((450..=550).contains(&json["triangles"].as_u64().unwrap()));
    let sets = json["sets"].as_object().unwrap();
    assert_eq!(sets.keys().collect::<Vec<_>>(), ["primary", "deep"]);
    for set in sets.values() {
        assert_eq!((&set["rays"], &set["hits"]), (&256.into(), &256.into()));
        let [median, best] = ["mrays_per_s", "best"].map(|key| set[key].as_f64().unwrap());
        assert!(median > 0.0 && best >= median, "{set}");
    }
}

#[test]
fn dumped_files_are_those_of_the_library_and_load_again() {
    let folder = Folder::new();
    folder.ok(&[&SHORT[..], &["--dump", "a/b"]].concat());
    folder.ok(&[&SHORT[..], &["--dump", "again", "--threads", "2", "--kernel", "single"]].concat());
    folder.ok(&["room.obj", "--load", "a/b", "--dump", "loaded", "--repeats", "1"]);
    let corners = mesh::load(&folder.path("room.obj")).unwrap();
    let sets = Sets::new(corners, &Options { res: 16, ..Options::default() });
    for set in &sets.sets {
        let file =
            |folder_name: &str, ending: &str| folder.path(folder_name).join(format!("{}.{ending}", set.kind.name()));
        assert_eq!(files::read_rays(&file("a/b", "rays")).unwrap(), set.rays);
        for ending in ["rays", "hits"] {
            let [first, again, loaded] = ["a/b", "again", "loaded"].map(|name| fs::read(file(name, ending)).unwrap());
            assert!(first == again && first == loaded, "{:?}.{ending}", set.kind);
        }
        assert_eq!(files::read_hits(&file("a/b", "hits")).unwrap().len(), set.rays.len());
    }
    // What was asked for must be there; else, what is there is taken.
    fs::remove_file(folder.path("a/b/bounce.rays")).unwrap();
    let load = ["room.obj", "--load", "a/b", "--repeats", "1"];
    assert!(!folder.ok(&load).contains("bounce"));
    folder.fails(1, &[&load[..], &["--rays", "bounce"]].concat(), &["bounce.rays: cannot read"]);
    let mut rays = files::read_rays(&folder.path("a/b/deep.rays")).unwrap();
    rays[3].t_min = 0.5;
    files::write_rays(&folder.path("a/b/deep.rays"), &rays).unwrap();
    folder.fails(1, &load, &["deep.rays: ray 3: found tmin 0.5, expected 0"]);
}

/// A set without rays gives files, and no figure.
#[test]
fn sets_without_rays_are_left_out_of_the_report() {
    let folder = Folder::new();
    fs::write(folder.path("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let args = ["one.obj", "--res", "8", "--repeats", "1", "--json", "--dump", "out"];
    let (code, out, err) = folder.run(&args);
    assert_eq!(code, Some(0), "{err}");
    assert!(err.contains("warning: deep: found no rays"), "{err}");
    let json: Value = serde_json::from_str(&out).unwrap();
    assert!(json["sets"]["primary"].is_object() && json["sets"]["deep"].is_null(), "{out}");
    for ending in ["rays", "hits"] {
        assert_eq!(fs::read(folder.path(&format!("out/deep.{ending}"))).unwrap(), b"");
    }
}

#[test]
fn mistakes_are_named() {
    let folder = Folder::new();
    let with = |args: &[&str], code, parts: &[&str]| folder.fails(code, &[&["room.obj"], args].concat(), parts);
    with(&["--rays", "primary,glossy"], 2, &["'glossy'", "primary, bounce, shuffled, shadow, deep"]);
    with(&["--kernel", "gpu"], 2, &["'gpu'", "auto, single, many, stream, tile"]);
    for res in ["0", "12", "16392"] {
        with(&["--res", res], 2, &["--res: found", res, "a multiple of 8 from 8 to 16384"]);
    }
    with(&["--camera", "1,2,3"], 2, &["ox,oy,oz,dx,dy,dz,fov"]);
    with(&["--camera", "1,2,3,0,0,x,50"], 2, &["ox,oy,oz,dx,dy,dz,fov"]);
    with(&["--camera", "1,2,3,0,0,0,50"], 2, &["--camera: found the direction"]);
    with(&["--camera", "1,2,3,0,0,-1,180"], 2, &["--camera: found an angle of 180 degrees"]);
    with(&["--up", "w"], 2, &["'w'", "x, y, z"]);
    with(&["--threads", "0"], 2, &["1..=1024"]);
    with(&["--repeats", "0"], 2, &["1..=1000"]);
    with(&["--load", ".", "--seed", "2"], 2, &["cannot be used with"]);
    with(&["--load", "."], 1, &["found no ray files"]);
    with(&["--dump", "room.obj"], 1, &["room.obj: cannot make"]);
    with(&["--dump", "room.obj/below"], 1, &["cannot make"]);
    fs::create_dir_all(folder.path("taken/shadow.hits")).unwrap();
    with(&["--dump", "taken"], 1, &["shadow.hits: found a folder, expected a file"]);
    folder.fails(1, &["nowhere.obj"], &["nowhere.obj: cannot read"]);
    fs::write(folder.path("empty.obj"), "").unwrap();
    folder.fails(1, &["empty.obj"], &["empty.obj: found an empty file, expected an OBJ file with at least one face"]);
    fs::write(folder.path("points.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
    folder.fails(1, &["points.obj"], &["points.obj: found no faces"]);
    fs::write(folder.path("wrong.obj"), "v 0 0 0\nf 1 2 3\n").unwrap();
    folder.fails(1, &["wrong.obj"], &["wrong.obj:2:", "vertex 2"]);
    folder.fails(2, &[], &["MESH.obj"]);
}
