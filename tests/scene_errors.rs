//! Every mistake of a scene file has its message, all of them are told, and no input makes the reader panic.

use std::{fs, path::Path, process::Command};

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use tempfile::TempDir;
use wavetrace::error::{Error, Problem};
use wavetrace::scene::{self, Loaded};
use wavetrace::world::{MaterialInput, Size};

/// A valid scene; the cases below change one piece of it.
const BASE: &str = r#"{
  "camera": {
    "focalPoint": {"x": 0, "y": -3.2, "z": 1},
    "direction": {"x": 0, "y": 1, "z": 0},
    "xReso": 640, "yReso": 480,
    "xAngle": 45, "yAngle": 34.5
  },
  "materials": [
    {"type": "diffuse", "mattness": 0.5, "color": {"r": 0.8, "g": 0.7, "b": 0.6}, "isLuminous": false},
    {"type": "transparent", "refIndex": 1.5, "color": {"r": 1, "g": 1, "b": 1}},
    {"type": "diffuse", "color": {"r": 1, "g": 0.5, "b": 1}, "isLuminous": true, "radiance": 12}
  ],
  "objects": [
    {"type": "mesh", "path": "ball.obj", "materialIndex": 1,
     "midPoint": {"x": 0.4, "y": 0.2, "z": 0.4}, "height": 0.8, "xrot": 0, "yrot": 0, "zrot": 30},
    {"type": "mesh", "path": "flat.obj", "materialIndex": 2, "scale": 2}
  ],
  "background": {"r": 0.1, "g": 0, "b": 2}
}
"#;

const BALL: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1 3 2\nf 1//1 2//1 4//1\nf 2/1 3/1 4/1\nf -4 -1 -2\n";
const FLAT: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("ball.obj"), BALL).expect("a mesh in it");
    fs::write(folder.path().join("flat.obj"), FLAT).expect("a mesh in it");
    folder
}

fn load_bytes(folder: &Path, scene: &[u8]) -> Result<Loaded, Error> {
    let path = folder.join("scene.json");
    fs::write(&path, scene).expect("a scene in the folder");
    scene::load(&path)
}

/// Messages with paths as seen from the scene's folder.
fn texts(problems: &[Problem], folder: &Path) -> Vec<String> {
    let folder = format!("{}/", folder.display());
    problems.iter().map(|problem| problem.to_string().replace(&folder, "")).collect()
}

fn errors(scene: impl AsRef<[u8]>) -> Vec<String> {
    let folder = folder();
    match load_bytes(folder.path(), scene.as_ref()) {
        Err(Error::Scene(problems)) => texts(&problems, folder.path()),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("no mistake found in\n{}", String::from_utf8_lossy(scene.as_ref())),
    }
}

fn patched(from: &str, to: &str) -> String {
    assert_eq!(BASE.matches(from).count(), 1, "the patch is unambiguous: {from}");
    BASE.replace(from, to)
}

#[test]
fn the_base_scene_is_read() {
    let folder = folder();
    let loaded = load_bytes(folder.path(), BASE.as_bytes()).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let builder = &loaded.builder;
    let camera = builder.camera();
    assert_eq!((camera.width, camera.height, camera.x_angle, camera.y_angle), (640, 480, 45.0, 34.5));
    assert_eq!(
        builder.materials(),
        [
            MaterialInput::Diffuse { color: [0.8, 0.7, 0.6], mattness: 0.5 },
            MaterialInput::Transparent { color: [1.0; 3], ref_index: 1.5 },
            MaterialInput::Luminous { radiance: [12.0, 6.0, 12.0] },
        ]
    );
    let [ball, flat] = builder.objects() else { panic!("two objects") };
    assert_eq!((ball.mesh, ball.material, ball.size), (0, 1, Size::Height(0.8)));
    assert_eq!((ball.mid_point.to_array(), ball.rotation.to_array()), ([0.4, 0.2, 0.4], [0.0, 0.0, 30.0]));
    assert_eq!((flat.mesh, flat.material, flat.size), (1, 2, Size::Scale(2.0)));
    assert_eq!(flat.mid_point.to_array(), [0.0; 3], "the origin where the file is silent");
    assert_eq!(builder.meshes().iter().map(|mesh| mesh.triangles.len()).collect::<Vec<_>>(), [4, 2]);
}

#[test]
fn the_example_of_the_documentation_is_read() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/scene-format.md")).unwrap();
    let example = text.split("```json\n").nth(1).unwrap().split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    for name in ["scenes", "meshes"] {
        fs::create_dir(folder.path().join(name)).unwrap();
    }
    fs::write(folder.path().join("meshes/ball.obj"), BALL).unwrap();
    fs::write(folder.path().join("meshes/square.obj"), FLAT).unwrap();
    let loaded = load_bytes(&folder.path().join("scenes"), example.as_bytes()).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert_eq!(loaded.builder.objects().len(), 2);
}

#[test]
fn an_empty_scene_is_a_scene() {
    let scene = r#"{"camera": {"focalPoint": {"x": 0, "y": 0, "z": 0}, "direction": {"x": 0, "y": 1, "z": 0}},
        "materials": [], "objects": [], "$schema": "s", "comment": "nothing"}"#;
    let loaded = load_bytes(folder().path(), scene.as_bytes()).unwrap();
    assert!(loaded.warnings.is_empty() && loaded.builder.objects().is_empty());
}

/// One mistake each: what of the base scene is replaced, by what, and how its only message begins.
const MISTAKES: &[(&str, &str, &str)] = &[
    // The document
    (
        "\"camera\": {",
        "\"kamera\": {",
        "scene.json:1:1: camera: found no such key, expected an object (did you mean it by `kamera` at line 2, column 3?)",
    ),
    ("\"materials\": [", "\"stuff\": [", "scene.json:1:1: materials: found no such key, expected a list"),
    ("\"objects\": [", "\"meshes\": [", "scene.json:1:1: objects: found no such key, expected a list"),
    (
        "\"xReso\": 640, \"yReso\"",
        "\"xReso\": 640, \"xReso\"",
        "scene.json:5:19: camera.xReso: found the key a second time, after line 5, column 5, expected each key once",
    ),
    (
        "\"background\": {\"r\": 0.1",
        "\"background\": {\"r\": -0.1",
        "scene.json:18:23: background.r: found -0.1, expected a number >= 0",
    ),
    (
        "{\"r\": 0.1, \"g\": 0, \"b\": 2}",
        "0.5",
        "scene.json:18:17: background: found 0.5, expected an object with r, g and b",
    ),
    ("\"xReso\": 640,", "\"xReso\": 640;", "scene.json:5:17: found `;`, expected valid JSON (expected `,` or `}`)"),
    (
        "\"scale\": 2}\n",
        "\"scale\": 2},\n",
        "scene.json:17:3: found `]`, expected valid JSON (the comma before it is one too many)",
    ),
    ("\"b\": 2}\n}\n", "\"b\": 2}\n} 1\n", "scene.json:19:3: found trailing characters, expected valid JSON"),
    // The camera
    (
        "\"focalPoint\": {\"x\": 0, \"y\": -3.2, \"z\": 1},",
        "",
        "scene.json:2:13: camera.focalPoint: found no such key, expected the origin of the rays",
    ),
    (
        "\"direction\": {\"x\": 0, \"y\": 1, \"z\": 0},",
        "",
        "scene.json:2:13: camera.direction: found no such key, expected the direction of view",
    ),
    (
        "{\"x\": 0, \"y\": 1, \"z\": 0}",
        "{\"x\": 0, \"y\": 0.0, \"z\": -0}",
        "scene.json:4:18: camera.direction: found a vector of length 0, expected a direction",
    ),
    (
        "{\"x\": 0, \"y\": 1, \"z\": 0}",
        "[0, 1, 0]",
        "scene.json:4:18: camera.direction: found a list, expected an object with x, y and z",
    ),
    ("\"y\": -3.2, ", "", "scene.json:3:19: camera.focalPoint.y: found no such key, expected a number"),
    (
        "\"y\": -3.2",
        "\"y\": 1e999",
        "scene.json:3:33: camera.focalPoint.y: found 1e999, expected a number between -3.4e38 and 3.4e38",
    ),
    ("\"y\": -3.2", "\"y\": null", "scene.json:3:33: camera.focalPoint.y: found null, expected a number"),
    (
        "\"xReso\": 640",
        "\"xReso\": 0",
        "scene.json:5:14: camera.xReso: found 0, expected a whole number of pixels from 1 to 65536",
    ),
    (
        "\"xReso\": 640",
        "\"xReso\": -640",
        "scene.json:5:14: camera.xReso: found -640, expected a whole number of pixels from 1 to 65536",
    ),
    (
        "\"xReso\": 640",
        "\"xReso\": 640.5",
        "scene.json:5:14: camera.xReso: found 640.5, expected a whole number of pixels",
    ),
    (
        "\"xReso\": 640",
        "\"xReso\": \"640\"",
        "scene.json:5:14: camera.xReso: found \"640\", expected a whole number of pixels",
    ),
    (
        "\"yReso\": 480",
        "\"yReso\": 65537",
        "scene.json:5:28: camera.yReso: found 65537, expected a whole number of pixels from 1 to 65536",
    ),
    (
        "\"yReso\": 480",
        "\"yReso\": 1e300",
        "scene.json:5:28: camera.yReso: found 1e300, expected a whole number of pixels from 1 to 65536",
    ),
    (
        "640, \"yReso\": 480",
        "65536, \"yReso\": 65536",
        "scene.json:2:13: camera: found 65536 x 65536 pixels, expected at most 268435456 pixels (2^28) in all",
    ),
    (
        "\"xAngle\": 45",
        "\"xAngle\": 0",
        "scene.json:6:15: camera.xAngle: found 0, expected an angle in degrees above 0 and below 180",
    ),
    (
        "\"yAngle\": 34.5",
        "\"yAngle\": 180",
        "scene.json:6:29: camera.yAngle: found 180, expected an angle in degrees above 0 and below 180",
    ),
    (
        "\"xAngle\": 45",
        "\"xAngle\": \"45\"",
        "scene.json:6:15: camera.xAngle: found \"45\", expected an angle in degrees above 0 and below 180 (write it without quotes)",
    ),
    // Materials
    (
        "{\"type\": \"diffuse\", \"mattness\": 0.5",
        "{\"mattness\": 0.5",
        "scene.json:9:5: materials[0].type: found no such key, expected \"diffuse\", \"specular\" or \"transparent\"",
    ),
    (
        "\"type\": \"transparent\"",
        "\"type\": \"transparant\"",
        "scene.json:10:14: materials[1].type: found \"transparant\", expected \"diffuse\", \"specular\" or \"transparent\" (did you mean \"transparent\"?)",
    ),
    (
        "\"type\": \"transparent\"",
        "\"type\": \"wood\"",
        "scene.json:10:14: materials[1].type: found \"wood\", expected \"diffuse\", \"specular\" or \"transparent\"",
    ),
    ("\"type\": \"transparent\"", "\"type\": 3", "scene.json:10:14: materials[1].type: found 3, expected \"diffuse\""),
    (
        "\"mattness\": 0.5",
        "\"mattness\": 1.5",
        "scene.json:9:37: materials[0].mattness: found 1.5, expected a number in [0, 1]",
    ),
    (
        "\"mattness\": 0.5",
        "\"mattness\": true",
        "scene.json:9:37: materials[0].mattness: found true, expected a number in [0, 1]",
    ),
    ("\"refIndex\": 1.5", "\"refIndex\": 0", "scene.json:10:41: materials[1].refIndex: found 0, expected a number > 0"),
    ("\"refIndex\": 1.5, ", "", "scene.json:10:5: materials[1].refIndex: found no such key, expected a number > 0"),
    (
        "\"refIndex\": 1.5",
        "\"refIndex\": 1e-60",
        "scene.json:10:41: materials[1].refIndex: found 1e-60, expected a number > 0 (at least 1.2e-38)",
    ),
    ("\"r\": 0.8", "\"r\": 1.01", "scene.json:9:57: materials[0].color.r: found 1.01, expected a number in [0, 1]"),
    (
        "\"r\": 0.8, \"g\": 0.7, \"b\": 0.6",
        "\"r\": 0.8, \"g\": 0.7",
        "scene.json:9:51: materials[0].color.b: found no such key, expected a number in [0, 1]",
    ),
    (
        ", \"color\": {\"r\": 0.8, \"g\": 0.7, \"b\": 0.6}",
        "",
        "scene.json:9:5: materials[0].color: found no such key, expected a colour",
    ),
    (
        "\"isLuminous\": false",
        "\"isLuminous\": 0",
        "scene.json:9:97: materials[0].isLuminous: found 0, expected true or false",
    ),
    (
        "\"isLuminous\": false",
        "\"isLuminous\": \"no\"",
        "scene.json:9:97: materials[0].isLuminous: found \"no\", expected true or false",
    ),
    (
        "\"radiance\": 12",
        "\"radiance\": -12",
        "scene.json:11:94: materials[2].radiance: found -12, expected a number >= 0",
    ),
    (
        "\"radiance\": 12",
        "\"radiance\": 1e39",
        "scene.json:11:94: materials[2].radiance: found 1e39, expected a number between -3.4e38 and 3.4e38",
    ),
    (
        "{\"type\": \"transparent\", \"refIndex\": 1.5, \"color\": {\"r\": 1, \"g\": 1, \"b\": 1}}",
        "7",
        "scene.json:10:5: materials[1]: found 7, expected an object with type, color,",
    ),
    ("\"mattness\": 0.5", "\"comment\": []", "scene.json:9:36: materials[0].comment: found a list, expected a string"),
    // Objects
    (
        "\"type\": \"mesh\", \"path\": \"ball.obj\"",
        "\"type\": \"sphere\", \"path\": \"ball.obj\"",
        "scene.json:14:14: objects[0].type: found \"sphere\", expected \"mesh\"",
    ),
    (
        "\"path\": \"ball.obj\", ",
        "",
        "scene.json:14:5: objects[0].path: found no such key, expected the path of an OBJ file",
    ),
    (
        "\"path\": \"ball.obj\"",
        "\"path\": \"\"",
        "scene.json:14:30: objects[0].path: found \"\", expected the path of an OBJ file",
    ),
    (
        "\"path\": \"ball.obj\"",
        "\"path\": 1",
        "scene.json:14:30: objects[0].path: found 1, expected the path of an OBJ file",
    ),
    (
        "\"path\": \"ball.obj\"",
        "\"path\": \"no.obj\"",
        "scene.json:14:30: objects[0].path: found \"no.obj\", which cannot be read: ",
    ),
    (
        "\"path\": \"ball.obj\"",
        "\"path\": \".\"",
        "scene.json:14:30: objects[0].path: found \".\", which cannot be read: ",
    ),
    (
        "\"path\": \"ball.obj\"",
        "\"path\": \"a\\u0000b\"",
        "scene.json:14:30: objects[0].path: found \"a\\0b\", which cannot be read: ",
    ),
    (
        " \"materialIndex\": 1,",
        "",
        "scene.json:14:5: objects[0].materialIndex: found no such key, expected the index of a material",
    ),
    (
        "\"materialIndex\": 1",
        "\"materialIndex\": 3",
        "scene.json:14:59: objects[0].materialIndex: found 3, expected an index from 0 to 2, as the scene has 3 materials",
    ),
    (
        "\"materialIndex\": 1",
        "\"materialIndex\": -1",
        "scene.json:14:59: objects[0].materialIndex: found -1, expected an index from 0 to 2",
    ),
    (
        "\"materialIndex\": 1",
        "\"materialIndex\": 0.5",
        "scene.json:14:59: objects[0].materialIndex: found 0.5, expected an index from 0 to 2",
    ),
    (
        "\"materialIndex\": 1",
        "\"materialIndex\": 1e300",
        "scene.json:14:59: objects[0].materialIndex: found 1e300, expected an index from 0 to 2",
    ),
    ("\"height\": 0.8", "\"height\": 0", "scene.json:15:60: objects[0].height: found 0, expected a number > 0"),
    (
        "\"height\": 0.8",
        "\"height\": 0.8, \"scale\": 1",
        "scene.json:15:65: objects[0].scale: found both `height` and `scale`, expected one of them",
    ),
    (
        "\"height\": 0.8, ",
        "",
        "scene.json:14:5: objects[0].height: found no such key, expected `height` or `scale`: a number > 0",
    ),
    ("\"scale\": 2", "\"scale\": -2", "scene.json:16:71: objects[1].scale: found -2, expected a number > 0"),
    (
        "\"scale\": 2",
        "\"height\": 2",
        "scene.json:16:72: objects[1].height: found a mesh that is flat along z after its rotation, so that no height can be given to it, expected `scale` in place of `height`",
    ),
    (
        "\"scale\": 2",
        "\"scale\": 3.4e38, \"midPoint\": {\"x\": 1e38, \"y\": 0, \"z\": 0}",
        "scene.json:16:71: objects[1].scale: found an object that reaches out to 4.4e38, expected coordinates between",
    ),
    (
        "\"height\": 0.8",
        "\"midpoint\": {\"x\": 0, \"y\": 0, \"z\": 0}, \"height\": 0.8",
        "scene.json:15:50: objects[0].midpoint: found both `midPoint` and `midpoint`, expected one of them",
    ),
    (
        "\"zrot\": 30",
        "\"zrot\": \"30\"",
        "scene.json:15:95: objects[0].zrot: found \"30\", expected a number (write it without quotes)",
    ),
    (
        "\"zrot\": 30",
        "\"zrot\": 1e400",
        "scene.json:15:95: objects[0].zrot: found 1e400, expected a number between -3.4e38 and 3.4e38",
    ),
];

#[test]
fn every_mistake_has_its_message() {
    let mut wrong = Vec::new();
    for (from, to, expected) in MISTAKES {
        let messages = errors(patched(from, to));
        if messages.len() != 1 || !messages[0].starts_with(expected) {
            wrong.push(format!("{to}\n  messages {messages:#?}\n  expected {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The same mistakes through the program: message on standard error, exit code 1, no image.
#[test]
fn every_mistake_ends_the_program_with_code_1() {
    let mut wrong = Vec::new();
    for (from, to, expected) in MISTAKES {
        let folder = folder();
        fs::write(folder.path().join("scene.json"), patched(from, to)).expect("a scene in the folder");
        let out = Command::new(env!("CARGO_BIN_EXE_wavetrace"))
            .args(["scene.json", "-o", "image.png"])
            .current_dir(folder.path())
            .output()
            .expect("the program starts");
        let message = String::from_utf8_lossy(&out.stderr).replace(&format!("{}/", folder.path().display()), "");
        let told = message.lines().any(|line| line.starts_with(&format!("error: {expected}")));
        if out.status.code() != Some(1) || !told || folder.path().join("image.png").exists() {
            wrong.push(format!("{to}\n  {} {message}\n  expected {expected}", out.status));
        }
    }
    assert!(MISTAKES.len() >= 25 && wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_flat_mesh_that_is_turned_upright_has_a_height() {
    let scene = patched("\"scale\": 2", "\"height\": 2, \"xrot\": 90");
    assert!(load_bytes(folder().path(), scene.as_bytes()).is_ok());
    let scene = patched("\"scale\": 2", "\"height\": 2, \"xrot\": 180");
    assert!(errors(scene)[0].contains("flat along z"), "rounding of the turn gives no height");
}

#[test]
fn documents_that_are_no_scene() {
    let cases: [(&[u8], &str); 9] = [
        (b"", "scene.json:1:1: found an empty file, expected a scene as JSON in UTF-8"),
        (b" \n\t", "scene.json:1:1: found an empty file"),
        (
            b"\xEF\xBB\xBF{}",
            "scene.json:1:1: found a byte order mark, expected a scene as JSON in UTF-8 (save it as UTF-8",
        ),
        (b"\xFF\xFE{\0}\0", "scene.json:1:1: found UTF-16, expected a scene as JSON in UTF-8 (save it as UTF-8"),
        (b"{\n \"\xC3\xA4 caf\xE9\": 1}", "scene.json:2:8: found the byte 0xE9, which is not UTF-8, expected"),
        (b"[]", "scene.json:1:1: found a list, expected an object with camera, materials, objects"),
        (b"null", "scene.json:1:1: found null, expected an object with camera"),
        (b"{\"camera\": {\n", "scene.json:2:1: found EOF while parsing an object, expected a complete JSON document"),
        (b"v 1 2 3\n", "scene.json:1:1: found `v`, expected valid JSON (expected value)"),
    ];
    for (bytes, expected) in cases {
        let messages = errors(bytes);
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert!(messages[0].starts_with(expected), "  message  {}\n  expected {expected}", messages[0]);
    }
}

#[test]
fn a_scene_that_cannot_be_read_is_named() {
    let folder = folder();
    for name in ["no.json", "."] {
        let path = folder.path().join(name);
        let error = scene::load(&path).map(|_| ()).unwrap_err();
        assert!(matches!(error, Error::Io { .. }), "{error}");
        assert!(error.to_string().starts_with(&format!("{}: cannot read: ", path.display())), "{error}");
    }
}

#[test]
fn all_mistakes_are_told_at_once_in_the_order_of_the_file() {
    let scene = BASE
        .replace("\"xReso\": 640", "\"xReso\": 0")
        .replace("\"xAngle\": 45", "\"xAngle\": 200")
        .replace("\"r\": 0.8, \"g\": 0.7", "\"r\": 8, \"g\": -7")
        .replace("\"refIndex\": 1.5", "\"refIndex\": {}")
        .replace("\"materialIndex\": 1", "\"materialIndex\": 9")
        .replace("ball.obj", "bad.obj")
        .replace("\"zrot\": 30", "\"zrot\": []")
        .replace("flat.obj", "no.obj");
    let folder = folder();
    fs::write(folder.path().join("bad.obj"), "v 0 0 0\nf 1 2\nf 1 2 3\n").unwrap();
    let Err(Error::Scene(problems)) = load_bytes(folder.path(), scene.as_bytes()) else { panic!("mistakes") };
    let text = Error::Scene(problems.clone()).to_string();
    assert_eq!(text.lines().count(), problems.len(), "one line each");
    let places: Vec<_> = problems
        .iter()
        .map(|problem| {
            let name = problem.file.file_name().unwrap().to_str().unwrap();
            format!("{name}:{} {}", problem.place.unwrap().0, problem.path)
        })
        .collect();
    assert_eq!(
        places,
        [
            "scene.json:5 camera.xReso",
            "scene.json:6 camera.xAngle",
            "scene.json:9 materials[0].color.r",
            "scene.json:9 materials[0].color.g",
            "scene.json:10 materials[1].refIndex",
            "scene.json:14 objects[0].materialIndex",
            "scene.json:15 objects[0].zrot",
            "scene.json:16 objects[1].path",
            "bad.obj:2 ",
            "bad.obj:3 ",
        ]
    );
}

#[test]
fn unknown_keys_are_warnings_with_the_nearest_known_key() {
    let scene = BASE
        .replace("\"xReso\": 640", "\"xreso\": 640")
        .replace("\"mattness\": 0.5", "\"matness\": 0.5, \"glossy\": 1")
        .replace("\"zrot\": 30", "\"z_rot\": 30");
    let folder = folder();
    let loaded = load_bytes(folder.path(), scene.as_bytes()).unwrap();
    assert_eq!(loaded.builder.camera().width, 1000, "an unknown key has no effect");
    let camera = "found an unknown key, expected one of focalPoint, direction, xReso, yReso, xAngle, yAngle or comment";
    let warnings = texts(&loaded.warnings, folder.path());
    assert_eq!(warnings.len(), 4, "{warnings:#?}");
    assert_eq!(warnings[0], format!("scene.json:5:5: camera.xreso: {camera} (did you mean `xReso`?)"));
    assert!(warnings[1].starts_with("scene.json:9:25: materials[0].matness: "), "{}", warnings[1]);
    assert!(warnings[1].ends_with("(did you mean `mattness`?)"), "{}", warnings[1]);
    assert!(warnings[2].starts_with("scene.json:9:41: materials[0].glossy: found an unknown key"), "{}", warnings[2]);
    assert!(warnings[2].ends_with("comment"), "nothing is near: {}", warnings[2]);
    assert!(warnings[3].starts_with("scene.json:15:87: objects[0].z_rot: "), "{}", warnings[3]);
    assert!(warnings[3].ends_with("(did you mean `zrot`?)"), "{}", warnings[3]);
}

#[test]
fn another_size_keeps_pixels_square_unless_both_angles_are_given() {
    let folder = folder();
    let mut both = load_bytes(folder.path(), BASE.as_bytes()).unwrap();
    both.resize(100, 100).unwrap();
    let camera = both.builder.camera();
    assert_eq!((camera.width, camera.height, camera.x_angle, camera.y_angle), (100, 100, 45.0, 34.5));

    let mut one = load_bytes(folder.path(), patched(", \"yAngle\": 34.5", "").as_bytes()).unwrap();
    one.resize(100, 100).unwrap();
    assert!((one.builder.camera().y_angle - 45.0).abs() < 1e-12);
    for (width, height) in [(0, 1), (1, 0), (65_537, 1), (65_536, 65_536)] {
        let error = one.resize(width, height).unwrap_err().to_string();
        assert!(error.starts_with(&format!("--size: found {width}x{height}, expected ")), "{error}");
    }
}

#[test]
fn the_first_hundred_mistakes_are_told_and_the_number_of_the_others() {
    let list = |piece: &str, count: usize| vec![piece; count].join(", ");
    let scene = |materials: &str, objects: &str| {
        format!(
            r#"{{"camera": {{"focalPoint": {{"x": 0, "y": 0, "z": 0}}, "direction": {{"x": 0, "y": 1, "z": 0}}}},
"materials": [{materials}], "objects": [{objects}]}}"#
        )
    };
    assert_eq!(errors(scene(&list("7", 100), "")).len(), 100);
    let messages = errors(scene(&list("7", 90), &list("8", 30)));
    assert_eq!(messages.len(), 101);
    assert!(messages[99].contains(" objects[9]: found 8, expected an object"), "{}", messages[99]);
    assert_eq!(messages[100], "scene.json: found 20 more mistakes, expected none");
    let folder = folder();
    let odd = list(r#"{"type": "specular", "color": {"r": 1, "g": 1, "b": 1}, "?": 0}"#, 102);
    let loaded = load_bytes(folder.path(), scene(&odd, "").as_bytes()).unwrap();
    assert_eq!((loaded.warnings.len(), loaded.builder.materials().len()), (101, 102));
    assert_eq!(texts(&loaded.warnings, folder.path())[100], "scene.json: found 2 more warnings, expected none");
}

#[test]
fn every_prefix_of_a_scene_is_a_mistake() {
    let folder = folder();
    for end in 0..BASE.trim_end().len() {
        let result = load_bytes(folder.path(), &BASE.as_bytes()[..end]);
        assert!(matches!(result, Err(Error::Scene(problems)) if !problems.is_empty()), "{end} bytes");
    }
}

/// Changes one to four bytes: replaced, removed, doubled, or a span of them cut out.
fn mutate(bytes: &[u8], rng: &mut Xoshiro256PlusPlus) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let below = |rng: &mut Xoshiro256PlusPlus, end: usize| (rng.next_u64() % end as u64) as usize;
    let telling = b"-0123456789.eE/\\\"{}[],:# \n\rvnfx\0\xFF";
    for _ in 0..1 + below(rng, 4) {
        let at = below(rng, bytes.len());
        match below(rng, 5) {
            0 => bytes[at] = rng.next_u64() as u8,
            1 => bytes[at] = telling[below(rng, telling.len())],
            2 => drop(bytes.remove(at)),
            3 => bytes.insert(at, bytes[at]),
            _ => drop(bytes.drain(at..bytes.len().min(at + 1 + below(rng, 12)))),
        }
        if bytes.is_empty() {
            return bytes;
        }
    }
    bytes
}

#[test]
fn mutated_scenes_and_meshes_never_panic() {
    let folder = folder();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
    let mut outcomes = [0; 2];
    let mut count = |result: Result<Loaded, Error>| match result {
        Ok(_) => outcomes[0] += 1,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            outcomes[1] += 1;
        }
    };
    for _ in 0..3000 {
        count(load_bytes(folder.path(), &mutate(BASE.as_bytes(), &mut rng)));
    }
    for _ in 0..3000 {
        fs::write(folder.path().join("ball.obj"), mutate(BALL.as_bytes(), &mut rng)).expect("a mesh in the folder");
        count(load_bytes(folder.path(), BASE.as_bytes()));
    }
    assert!(outcomes.iter().all(|&count| count > 100), "both outcomes are exercised: {outcomes:?}");
}
