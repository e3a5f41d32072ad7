//! The meshes and scenes of this repository are what they are said to be: closed, the right way round, all there.

use glam::DVec3;
use serde_json::Value;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Coordinates are written with five decimals, each at most half of the last one off.
const WRITTEN: f64 = 0.5e-5;

/// Meshes that enclose a volume.
const CLOSED: [&str; 9] =
    ["box", "block_tall", "pane", "sphere_320", "sphere_1280", "sphere_5120", "sphere_20480", "pawn", "rabbit"];

/// An OBJ file of triangles.
struct Obj {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
    triangle_normals: Vec<[usize; 3]>,
}

impl Obj {
    fn read(name: &str) -> Self {
        let text = fs::read_to_string(folder("meshes").join(name).with_extension("obj")).unwrap();
        let mut obj =
            Self { positions: Vec::new(), normals: Vec::new(), triangles: Vec::new(), triangle_normals: Vec::new() };
        for line in text.lines() {
            let mut words = line.split(' ');
            let head = words.next().unwrap();
            let words: Vec<&str> = words.collect();
            match head {
                "#" => {}
                "v" => obj.positions.push(vector(&words)),
                "vn" => obj.normals.push(vector(&words)),
                "f" => {
                    let corners: Vec<Vec<usize>> = words.iter().map(|word| indices(word)).collect();
                    let column = |k: usize| [corners[0][k], corners[1][k], corners[2][k]];
                    assert_eq!(corners.len(), 3, "{name}: {line}");
                    obj.triangles.push(column(0));
                    if corners[0].len() == 2 {
                        obj.triangle_normals.push(column(1));
                    }
                }
                _ => panic!("{name}: {line}"),
            }
        }
        assert!(obj.triangles.iter().flatten().all(|&i| i < obj.positions.len()), "{name}");
        assert!(obj.triangle_normals.iter().flatten().all(|&i| i < obj.normals.len()), "{name}");
        assert!(obj.triangle_normals.is_empty() || obj.triangle_normals.len() == obj.triangles.len(), "{name}");
        obj
    }

    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i])
    }

    /// Twice the area, along the front face's normal.
    fn face(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Positive where a closed mesh faces outwards.
    fn volume(&self) -> f64 {
        let tetrahedron = |t| {
            let [a, b, c] = self.corners(t);
            a.dot(b.cross(c)) / 6.0
        };
        (0..self.triangles.len()).map(tetrahedron).sum()
    }
}

fn vector(words: &[&str]) -> DVec3 {
    let values: Vec<f64> = words.iter().map(|word| word.parse().unwrap()).collect();
    DVec3::from_array(values.try_into().unwrap())
}

/// `7//8` as 0-based [6, 7], `7` as [6].
fn indices(word: &str) -> Vec<usize> {
    word.split("//").map(|index| index.parse::<usize>().unwrap().checked_sub(1).unwrap()).collect()
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Names of the files in a folder of the repository, without their ending.
fn names(of: &str) -> BTreeSet<String> {
    let stem = |path: PathBuf| path.file_stem().unwrap().to_str().unwrap().to_owned();
    fs::read_dir(folder(of)).unwrap().map(|entry| stem(entry.unwrap().path())).collect()
}

#[test]
fn closed_meshes_are_watertight_and_face_outwards() {
    for name in CLOSED {
        let obj = Obj::read(name);
        let mut edges = BTreeMap::new();
        for &[a, b, c] in &obj.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        for (&(a, b), &count) in &edges {
            assert_eq!((count, edges.get(&(b, a))), (1, Some(&1)), "{name}: edge {a} {b}");
        }
        assert!(obj.volume() > 0.0, "{name}");
    }
}

#[test]
fn closed_meshes_are_in_one_piece() {
    for name in CLOSED {
        let obj = Obj::read(name);
        let mut edges: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for &[a, b, c] in &obj.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                edges.entry(from).or_default().push(to);
            }
        }
        let (mut reached, mut open) = (BTreeSet::from([0]), vec![0]);
        while let Some(vertex) = open.pop() {
            open.extend(edges[&vertex].iter().filter(|&&next| reached.insert(next)));
        }
        assert_eq!(reached.len(), obj.positions.len(), "{name}");
    }
}

#[test]
fn volumes_are_those_of_the_shapes() {
    let volume = |name| Obj::read(name).volume();
    assert!((volume("box") - 1.0).abs() < 1e-9);
    assert!((volume("block_tall") - 2.0).abs() < 1e-9);
    assert!((volume("pane") - 0.045).abs() < 1e-9);
    // Inscribed in the unit sphere: smaller than it, by an error that falls with the number of triangles.
    let ball = 4.0 / 3.0 * std::f64::consts::PI;
    let missing = ["sphere_320", "sphere_1280", "sphere_5120", "sphere_20480"].map(|name| 1.0 - volume(name) / ball);
    assert!(missing[0] > 0.0 && missing[0] < 0.05, "{missing:?}");
    for pair in missing.windows(2) {
        assert!((3.8..4.2).contains(&(pair[0] / pair[1])), "{missing:?}");
    }
}

#[test]
fn no_triangle_is_degenerate() {
    for name in names("meshes") {
        let obj = Obj::read(&name);
        for t in 0..obj.triangles.len() {
            let [a, b, c] = obj.corners(t);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            assert!(obj.face(t).length() > 0.02 * longest * longest, "{name}: triangle {t} {a} {b} {c}");
        }
    }
}

#[test]
fn normals_are_unit_and_on_the_front_side() {
    let mut with_normals = BTreeSet::new();
    for name in names("meshes") {
        let obj = Obj::read(&name);
        for (i, n) in obj.normals.iter().enumerate() {
            assert!((n.length() - 1.0).abs() < WRITTEN * 3.0_f64.sqrt(), "{name}: normal {i}");
        }
        for (t, normals) in obj.triangle_normals.iter().enumerate() {
            for &n in normals {
                let cos = obj.normals[n].dot(obj.face(t).normalize());
                assert!(cos > 0.0, "{name}: triangle {t}, normal {n}: cosine {cos}");
            }
            with_normals.insert(name.clone());
        }
    }
    let round = ["bent_wall", "pawn", "rabbit", "sphere_1280", "sphere_20480", "sphere_320", "sphere_5120"];
    assert!(with_normals.iter().eq(round), "{with_normals:?}");
}

#[test]
fn normals_of_a_sphere_are_its_positions() {
    for name in ["sphere_320", "sphere_1280", "sphere_5120", "sphere_20480"] {
        let obj = Obj::read(name);
        assert_eq!(obj.positions, obj.normals, "{name}");
        assert_eq!(obj.triangles, obj.triangle_normals, "{name}");
    }
}

#[test]
fn triangle_counts() {
    for name in ["sphere_320", "sphere_1280", "sphere_5120", "sphere_20480"] {
        assert_eq!(name, format!("sphere_{}", Obj::read(name).triangles.len()));
    }
    assert!((5_000..=12_000).contains(&Obj::read("rabbit").triangles.len()));
    assert!((3_000..=8_000).contains(&Obj::read("pawn").triangles.len()));
}

#[test]
fn the_fan_has_ten_triangles_from_0_to_90_degrees() {
    let (fan, flipped) = (Obj::read("fan"), Obj::read("fan_flipped"));
    assert_eq!((fan.triangles.len(), flipped.triangles.len()), (10, 10));
    for k in 0..10 {
        let (sin, cos) = (10.0 * k as f64).to_radians().sin_cos();
        let normal = DVec3::new(cos, -sin, 0.0);
        // The base is 0.9 long: written digits turn it by about 1e-5.
        assert!((fan.face(k).normalize() - normal).length() < 1e-4, "triangle {k}");
        assert!((flipped.face(k).normalize() + normal).length() < 1e-4, "triangle {k}");
    }
}

#[test]
fn flat_meshes_face_up_and_the_bent_wall_its_front() {
    for name in ["quad", "rect_4x7", "rect_4x3", "rect_3x7", "ruling"] {
        let obj = Obj::read(name);
        assert!((0..obj.triangles.len()).all(|t| obj.face(t).normalize().distance(DVec3::Z) < 1e-9), "{name}");
    }
    let area = |name: &str| {
        let obj = Obj::read(name);
        (0..obj.triangles.len()).map(|t| 0.5 * obj.face(t).z).sum::<f64>()
    };
    for (name, expected) in [
        ("quad", 1.0),
        ("ruling", 6.0),
        ("ceiling_one_light", 28.0 - 1.5 * 1.5),
        ("ceiling_two_lights", 28.0 - 2.0),
        ("ceiling_cornell", 4.0 - 0.36),
        ("ceiling_small_lamp", 4.0 - 0.0632 * 0.0632),
        ("ceiling_100_lamps", 4.0 - 100.0 * 0.0009),
        ("wall_50_lamps", 4.0 - 50.0 * 0.0009),
        ("lamps_100", 100.0 * 0.0009),
        ("lamps_50", 50.0 * 0.0009),
    ] {
        assert!((area(name) - expected).abs() < 1e-9, "{name}: {}", area(name));
    }
    let bent = Obj::read("bent_wall");
    assert!((0..bent.triangles.len()).all(|t| bent.face(t).y < 0.0));
    // Convex towards the front: the middle lies before the edges.
    let front = bent.positions.iter().min_by(|p, q| p.y.total_cmp(&q.y)).unwrap();
    assert!(front.x.abs() < 1e-9, "{front}");
}

#[test]
fn every_scene_names_meshes_and_materials_that_exist() {
    let mut used = BTreeSet::new();
    for name in names("scenes") {
        let path = folder("scenes").join(&name).with_extension("json");
        let scene: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        let (materials, objects) = (scene["materials"].as_array().unwrap(), scene["objects"].as_array().unwrap());
        assert!(scene["camera"]["focalPoint"].is_object(), "{name}");
        let mut wanted = BTreeSet::new();
        for object in objects {
            let mesh = path.with_file_name(object["path"].as_str().unwrap());
            assert!(mesh.is_file(), "{name}: {}", mesh.display());
            used.insert(mesh.file_stem().unwrap().to_str().unwrap().to_owned());
            assert_ne!(object["height"].is_number(), object["scale"].is_number(), "{name}: {object}");
            wanted.insert(usize::try_from(object["materialIndex"].as_u64().unwrap()).unwrap());
        }
        assert!(wanted.into_iter().eq(0..materials.len()), "{name}: a material is missing or idle");
        for material in materials {
            let lit = material["isLuminous"].as_bool().unwrap();
            assert_eq!(lit, material["radiance"].is_number(), "{name}: {material}");
        }
        assert!(materials.iter().any(|material| material["isLuminous"] == true), "{name}: no light");
    }
    let idle: Vec<String> = names("meshes").difference(&used).cloned().collect();
    assert_eq!(idle, ["sphere_1280", "sphere_320"], "meshes that no scene shows");
}

#[test]
fn the_gallery_shows_every_scene() {
    let page = fs::read_to_string(folder("docs").join("gallery.md")).unwrap();
    let mut expected: BTreeSet<String> = (1..=15).map(|k| format!("test{k:02}")).collect();
    expected.extend((1..=6).map(|k| format!("demo{k}")));
    expected.extend(["cornell", "cornell-balls", "lamps-200", "small-lamp"].map(str::to_owned));
    assert_eq!(names("scenes"), expected);
    for name in expected {
        assert!(page.contains(&format!("(images/{name}.png)")), "{name}");
        assert!(page.contains(&format!("(../scenes/{name}.json)")), "{name}");
    }
}

#[test]
fn all_of_it_is_small() {
    let size = |path: PathBuf| fs::metadata(path).unwrap().len();
    let all = ["meshes", "scenes"].map(|of| fs::read_dir(folder(of)).unwrap().map(|e| size(e.unwrap().path())).sum());
    assert!(all.iter().sum::<u64>() < 4_000_000, "{all:?}");
}
