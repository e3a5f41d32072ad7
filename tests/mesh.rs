//! OBJ files in every form that is read, and the message of every mistake, through whole scenes.

use std::{fs, path::Path};

use glam::DVec3;
use wavetrace::error::Error;
use wavetrace::scene::{self, Loaded};
use wavetrace::world::Mesh;

const SCENE: &str = r#"{
  "camera": {"focalPoint": {"x": 0, "y": -3, "z": 1}, "direction": {"x": 0, "y": 1, "z": 0}},
  "materials": [{"type": "diffuse", "color": {"r": 1, "g": 1, "b": 1}}],
  "objects": [{"path": "mesh.obj", "materialIndex": 0, "scale": 1}]
}"#;

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\n";
const FLAT: [u32; 3] = [Mesh::NO_NORMAL; 3];

fn load_scene(scene: &str, files: &[(&str, &[u8])]) -> Result<Loaded, Vec<String>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, content) in files {
        fs::write(folder.path().join(name), content).expect("a file in it");
    }
    let path = folder.path().join("scene.json");
    fs::write(&path, scene).expect("a file in it");
    scene::load(&path).map_err(|error| messages(error, folder.path()))
}

/// The messages, with paths as seen from the scene's folder.
fn messages(error: Error, folder: &Path) -> Vec<String> {
    let Error::Scene(problems) = error else { panic!("{error}") };
    assert!(!problems.is_empty(), "an error says what is wrong");
    let folder = format!("{}/", folder.display());
    problems.iter().map(|problem| problem.to_string().replace(&folder, "")).collect()
}

fn load(obj: &[u8]) -> Result<Mesh, Vec<String>> {
    load_scene(SCENE, &[("mesh.obj", obj)]).map(|loaded| loaded.builder.meshes()[0].clone())
}

fn mesh(obj: &str) -> Mesh {
    load(obj.as_bytes()).unwrap_or_else(|messages| panic!("{obj}\n{messages:?}"))
}

/// The corners of each triangle, whatever the numbering of the vertices.
fn triangles(mesh: &Mesh) -> Vec<[(f64, f64, f64); 3]> {
    mesh.triangles.iter().map(|corners| corners.map(|i| mesh.positions[i as usize].into())).collect()
}

fn normals(mesh: &Mesh) -> Vec<Option<[(f64, f64, f64); 3]>> {
    assert_eq!(mesh.triangle_normals.len(), mesh.triangles.len());
    let lookup = |corners: [u32; 3]| corners.map(|i| mesh.normals[i as usize].into());
    mesh.triangle_normals.iter().map(|&corners| (corners != FLAT).then(|| lookup(corners))).collect()
}

const A: (f64, f64, f64) = (0.0, 0.0, 0.0);
const B: (f64, f64, f64) = (1.0, 0.0, 0.0);
const C: (f64, f64, f64) = (1.0, 1.0, 0.0);
const D: (f64, f64, f64) = (0.0, 1.0, 0.0);
const E: (f64, f64, f64) = (-1.0, 0.5, 0.0);

#[test]
fn a_triangle_is_read_exactly() {
    let mesh = mesh("v 0.1 -2.5e-3 1e3\nv 1. .5 +3\nv 123456789.123456789 0 -0\nf 1 2 3\n");
    assert_eq!(
        mesh.positions,
        [DVec3::new(0.1, -2.5e-3, 1e3), DVec3::new(1.0, 0.5, 3.0), DVec3::new(123_456_789.123_456_79, 0.0, 0.0)]
    );
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert!(mesh.normals.is_empty() && mesh.triangle_normals.is_empty());
}

#[test]
fn polygons_are_fans_about_their_first_corner_in_the_order_of_the_file() {
    let mesh = mesh(&format!("{CORNERS}f 1 2 3 4 5\nf 3 2 1\nf 4 3 2 1\n"));
    assert_eq!(triangles(&mesh), [[A, B, C], [A, C, D], [A, D, E], [C, B, A], [D, C, B], [D, B, A]]);
    assert_eq!(mesh.positions.len(), 5, "vertices are shared");
}

#[test]
fn a_concave_polygon_is_the_same_fan() {
    let mesh = mesh("v 0 0 0\nv 2 0 0\nv 0.1 0.1 0\nv 0 2 0\nf 2 3 4 1\n");
    assert_eq!(
        triangles(&mesh),
        [[(2.0, 0.0, 0.0), (0.1, 0.1, 0.0), (0.0, 2.0, 0.0)], [(2.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 0.0)]]
    );
}

#[test]
fn negative_indices_count_from_what_is_above() {
    let mesh = mesh("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -4 -2 -1\nf 1 -2 4\n");
    assert_eq!(triangles(&mesh), [[A, B, C], [A, C, D], [A, C, D]]);
}

#[test]
fn a_face_may_precede_its_vertices() {
    assert_eq!(triangles(&mesh(&format!("f 1 2 3\n{CORNERS}"))), [[A, B, C]]);
}

#[test]
fn vertices_that_no_face_uses_take_no_part() {
    let mesh = mesh("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 2 3 4\n");
    assert_eq!(mesh.positions.len(), 3);
    assert_eq!(triangles(&mesh), [[A, B, C]]);
}

#[test]
fn normals_and_texture_coordinates() {
    let head = format!("{CORNERS}vt 0 0\nvt 1 1\nvn 0 0 2\nvn 3 0 0.5\n");
    let (up, side) = ((0.0, 0.0, 2.0), (3.0, 0.0, 0.5));
    for face in ["f 1//1 2//2 3//1", "f 1/1/1 2/2/2 3/1/1", "f 1//-2 -4//-1 3//1", "f 1/7/1 2/0/2 3/-9/1"] {
        let mesh = mesh(&format!("{head}{face}\n"));
        assert_eq!(triangles(&mesh), [[A, B, C]], "{face}");
        assert_eq!(normals(&mesh), [Some([up, side, up])], "normals keep their length: {face}");
    }
    for face in ["f 1/1 2/2 3/1", "f 1 2 3", "f 1/ 2/ 3/", "f 1// 2// 3//"] {
        let mesh = mesh(&format!("{head}{face}\n"));
        assert_eq!(triangles(&mesh), [[A, B, C]], "{face}");
        assert!(mesh.normals.is_empty() && mesh.triangle_normals.is_empty(), "normals that no face uses: {face}");
    }
}

#[test]
fn faces_with_and_without_normals_mix() {
    let mesh = mesh(&format!(
        "{CORNERS}vn 0 0 1\nvn 0 1 0\nf 1 2 3\nf 1//2 3//1 4//2 5//1\nf 1 4 5\nf 3/1/2 2//2 1//1\nf 1/1 2/1 3/1\n"
    ));
    assert_eq!(triangles(&mesh), [[A, B, C], [A, C, D], [A, D, E], [A, D, E], [C, B, A], [A, B, C]]);
    let (z, y) = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0));
    assert_eq!(normals(&mesh), [None, Some([y, z, y]), Some([y, y, z]), None, Some([y, y, z]), None]);
}

#[test]
fn a_normal_of_no_length_leaves_its_faces_flat() {
    let mesh = mesh(&format!("{CORNERS}vn 0 0 0\nvn 0 0 1\nf 1//1 2//2 3//2\nf 1//2 3//2 4//2\n"));
    let z = (0.0, 0.0, 1.0);
    assert_eq!(normals(&mesh), [None, Some([z, z, z])]);
}

#[test]
fn groups_objects_and_materials_are_one_mesh() {
    let mesh = mesh(&format!(
        "mtllib missing.mtl\no first\n{CORNERS}vn 0 0 1\ng a b\nusemtl red\nf 1 2 3\ng\nusemtl blue\ns 1\n\
         f 1//1 3//1 4//1\no second\ns off\nf 1 4 5\nusemtl\nmtllib\n"
    ));
    assert_eq!(triangles(&mesh), [[A, B, C], [A, C, D], [A, D, E]]);
    assert_eq!(mesh.positions.len(), 5, "groups share vertices");
    let z = (0.0, 0.0, 1.0);
    assert_eq!(normals(&mesh), [None, Some([z, z, z]), None]);
}

#[test]
fn points_and_lines_are_left_out() {
    assert_eq!(triangles(&mesh(&format!("{CORNERS}p 1 2\nl 1 2 3\nl 1 2\nf 1 2 3\nl 3 4 5 1\n"))), [[A, B, C]]);
}

#[test]
fn vertex_colours_are_left_out_and_w_divides() {
    let mesh = mesh("v 0 0 0 1 0 0\nv 1 0 0\nv 2 2 0 2\nv 0 1 0 0.5 0.5 0.5 1\nf 1 2 3 4\n");
    assert_eq!(triangles(&mesh), [[A, B, C], [A, C, D]]);
}

#[test]
fn white_space_comments_and_continuations() {
    let text = "# C:\\models\\\r\n\r\n  v\t0 0   0\r\nv 1 0 0 # right\r\nv 1 \\\r\n 1 \\\r\n0\r\nv 0 1 0#no space\r\n\
                #f 1 2 4\r\nf\t1  2\t3  \r\nf 1 \\\n 3 \\\n 4 # last\\";
    assert_eq!(triangles(&mesh(text)), [[A, B, C], [A, C, D]]);
}

#[test]
fn comments_and_names_need_not_be_utf8() {
    let mut text = b"# caf\xE9\no caf\xE9\n".to_vec();
    text.extend_from_slice(format!("{CORNERS}f 1 2 3 # \\").as_bytes());
    text.extend_from_slice(b"\xE9\n");
    assert_eq!(triangles(&load(&text).unwrap()), [[A, B, C]]);
}

#[test]
fn a_byte_order_mark_hides_no_vertex() {
    assert_eq!(triangles(&mesh(&format!("\u{feff}{CORNERS}f 1 2 3\n"))), [[A, B, C]]);
}

/// Each mistake alone in a file behind five vertices (lines 1 to 5) and one normal (line 6).
#[test]
fn every_mistake_has_its_place() {
    let cases = [
        ("v 0 0 nan", "mesh.obj:7:7: found `nan`, expected a finite number"),
        ("v inf 0 0", "mesh.obj:7:3: found `inf`, expected a finite number"),
        ("v 0 1e999 0", "mesh.obj:7:5: found `1e999`, expected a finite number between -3.4e38 and 3.4e38"),
        ("v 0 1e39 0", "mesh.obj:7:5: found `1e39`, expected a finite number between -3.4e38 and 3.4e38"),
        ("v 0 zero 0", "mesh.obj:7:5: found `zero`, expected a number"),
        ("v 0 0", "mesh.obj:7:3: found 2 numbers, expected x, y and z"),
        ("v", "mesh.obj:7:2: found 0 numbers, expected x, y and z"),
        ("v 1 2 3 4 5", "mesh.obj:7:3: found 5 numbers, expected x, y and z"),
        ("v 1 2 3 0", "mesh.obj:7:9: found `0`, expected a w by which"),
        ("v 1 2 3 1e-300", "mesh.obj:7:9: found `1e-300`, expected a w by which"),
        ("vn 0 1", "mesh.obj:7:4: found 2 numbers, expected x, y and z of a normal"),
        ("vn 0 1 NaN", "mesh.obj:7:8: found `NaN`, expected a finite number"),
        ("vn 0 1 x", "mesh.obj:7:8: found `x`, expected a number"),
        ("f 1 2", "mesh.obj:7:3: found a face of 2 corners, expected at least 3 corners"),
        ("f 1", "mesh.obj:7:3: found a face of 1 corner, expected at least 3 corners"),
        ("f", "mesh.obj:7:2: found a face of 0 corners, expected at least 3 corners"),
        ("f 1 0 2", "mesh.obj:7:5: found vertex 0, expected indices counted from 1"),
        ("f 1 2 6", "mesh.obj:7:7: found vertex 6, expected 1 to 5, as many as the file has"),
        ("f 1 2 99999999999999999999", "mesh.obj:7:7: found vertex 92233720368547758, expected 1 to 5"),
        ("f 1 2 -6", "mesh.obj:7:7: found vertex -6, expected -1 back to -5, as 5 are given above"),
        ("f 1//1 2//1 3//2", "mesh.obj:7:13: found normal 2, expected 1 to 1"),
        ("f 1//1 2//1 3//-2", "mesh.obj:7:13: found normal -2, expected -1 back to -1"),
        ("f 1//0 2//0 3//0", "mesh.obj:7:3: found normal 0, expected indices counted from 1"),
        ("f 1//1 2//1 3", "mesh.obj:7:13: found a corner without a normal after one with, expected all corners"),
        ("f 1 2//1 3", "mesh.obj:7:5: found a corner with a normal after one without, expected all corners"),
        ("f 1 2 c", "mesh.obj:7:7: found `c`, expected a corner as v, v/vt, v//vn or v/vt/vn"),
        ("f 1.0 2 3", "mesh.obj:7:3: found `1.0`, expected a corner"),
        ("f 1/1/1/1 2 3", "mesh.obj:7:3: found `1/1/1/1`, expected a corner"),
        ("f //1 2 3", "mesh.obj:7:3: found `//1`, expected a corner that begins with the index of its vertex"),
        ("v 1 \\\n 2 \\\n x", "mesh.obj:9:2: found `x`, expected a number"),
    ];
    for (line, expected) in cases {
        let text = format!("{CORNERS}vn 0 0 1\n{line}\nf 1 2 3\n");
        let messages = load(text.as_bytes()).expect_err(line);
        assert_eq!(messages.len(), 1, "{line}: {messages:?}");
        assert!(messages[0].starts_with(expected), "{line}: {}", messages[0]);
        assert!(messages[0].ends_with("(used by objects[0].path at scene.json:4:24)"), "{line}: {}", messages[0]);
    }
}

#[test]
fn all_mistakes_of_a_mesh_are_named_up_to_twenty() {
    let messages = load(b"v 0 0 x\nv 1 0 0\nf 1 2\nf 1 2 3\n").unwrap_err();
    let places: Vec<_> = messages.iter().map(|message| message.split(": ").next().unwrap_or_default()).collect();
    assert_eq!(places, ["mesh.obj:1:7", "mesh.obj:3:3", "mesh.obj:4:7"]);

    let messages = load(format!("{CORNERS}{}", "f 1 2\n".repeat(1000)).as_bytes()).unwrap_err();
    assert_eq!(messages.len(), 21);
    assert!(messages[20].starts_with("mesh.obj: found 980 more mistakes"), "{}", messages[20]);
}

#[test]
fn a_file_without_faces_is_no_mesh() {
    for (text, found) in [
        ("", "mesh.obj: found an empty file, expected an OBJ file with at least one face"),
        (CORNERS, "mesh.obj: found no faces, expected an OBJ file with at least one face"),
        ("\u{89}PNG\r\n\u{1a}\n", "mesh.obj: found no faces"),
    ] {
        let messages = load(text.as_bytes()).unwrap_err();
        assert_eq!(messages.len(), 1);
        assert!(messages[0].starts_with(found), "{}", messages[0]);
    }
}

#[test]
fn a_missing_mesh_names_the_place_in_the_scene_and_the_file() {
    let messages = load_scene(SCENE, &[]).map(|_| ()).unwrap_err();
    assert_eq!(messages.len(), 1);
    assert!(
        messages[0].starts_with("scene.json:4:24: objects[0].path: found \"mesh.obj\", which cannot be read: "),
        "{}",
        messages[0]
    );
    assert!(messages[0].ends_with("expected an OBJ file at mesh.obj"), "{}", messages[0]);
}

#[test]
fn a_mesh_of_several_objects_is_read_once() {
    let scene = SCENE.replace(
        r#""objects": ["#,
        r#""objects": [{"path": "./mesh.obj", "materialIndex": 0, "scale": 2}, {"path": "b.obj", "materialIndex": 0, "scale": 1},"#,
    );
    let obj = format!("{CORNERS}f 1 2 3\n");
    let loaded = load_scene(&scene, &[("mesh.obj", obj.as_bytes()), ("b.obj", obj.as_bytes())]).unwrap();
    assert_eq!(loaded.builder.meshes().len(), 2);
    let used: Vec<_> = loaded.builder.objects().iter().map(|object| object.mesh).collect();
    assert_eq!(used, [0, 1, 0]);

    let messages = load_scene(&scene, &[("mesh.obj", b"f 1 2 3"), ("b.obj", obj.as_bytes())]).map(|_| ()).unwrap_err();
    assert_eq!(messages.len(), 1, "told once, not again for the second object: {messages:?}");
}

#[cfg(unix)]
#[test]
fn a_mesh_is_a_regular_file() {
    let load = |path: &str| load_scene(&SCENE.replace("mesh.obj", path), &[]);
    let refused = "which cannot be read: it is a device or a pipe, no regular file, expected an OBJ file at /dev/zero";
    assert_eq!(
        load("/dev/zero").unwrap_err(),
        [format!("scene.json:4:24: objects[0].path: found \"/dev/zero\", {refused}")]
    );
    assert!(matches!(scene::load_mesh(Path::new("/dev/zero")), Err(Error::Io { action: "read", .. })));
    let folder = load(".").unwrap_err();
    assert!(folder[0].contains("found \".\", which cannot be read: Is a directory"), "{folder:?}");
}
