//! Starting the program: the time of a whole process that renders next to nothing.

use crate::bench::measure::{Case, Pace, Unit};
use crate::error::{Error, Result};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
const SCENE: &str = r#"{
  "camera": {"focalPoint": {"x": 0.3, "y": -3, "z": 0.3}, "direction": {"x": 0, "y": 1, "z": 0},
             "xReso": 8, "yReso": 8, "xAngle": 30, "yAngle": 30},
  "materials": [{"type": "diffuse", "color": {"r": 1, "g": 1, "b": 1}, "isLuminous": true, "radiance": 1}],
  "objects": [{"type": "mesh", "path": "start.obj", "materialIndex": 0,
               "midPoint": {"x": 0.5, "y": 0, "z": 0.5}, "scale": 1}]
}
"#;

/// A folder with the scene of one triangle, seen in 8 x 8 pixels.
pub(super) fn folder() -> Result<TempDir> {
    let fault = |source| Error::Io { file: std::env::temp_dir(), action: "write a scene into", source };
    let folder = tempfile::tempdir().map_err(fault)?;
    fs::write(folder.path().join("start.obj"), MESH).map_err(fault)?;
    fs::write(folder.path().join("start.json"), SCENE).map_err(fault)?;
    Ok(folder)
}

/// `program` renders it to a file: from its start to its end.
pub(super) fn case<'a>(folder: &'a TempDir, program: &'a Path) -> Case<'a> {
    let mut pace = Pace::default();
    let render = move || {
        let mut command = Command::new(program);
        command.args(["-q", "start.json", "-o", "start.png"]).current_dir(folder.path());
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    let run = move || {
        let mut good = true;
        let seconds = pace.seconds(|passes| good &= (0..passes).all(|_| render()));
        vec![if good { seconds * 1e3 } else { f64::NAN }]
    };
    Case::new(vec![("start/process".to_owned(), Unit::Milliseconds)], run).elsewhere()
}
