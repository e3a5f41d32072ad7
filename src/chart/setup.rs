//! What rows must have in common to stand in one table, kept beside it as `chart.json`.

use super::machine::{Build, Machine};
use crate::error::{Error, Problem, Result};
use crate::film::Image;
use crate::input;
use crate::output;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Of what kind the document is; another layout would get another number.
const FORMAT: u64 = 1;

/// The circumstances of all rows.
#[derive(Clone, Debug)]
pub struct Setup {
    /// This build of the program.
    pub build: Build,
    /// This machine.
    pub machine: Machine,
    /// Threads of each render.
    pub threads: usize,
    /// Bounces at most.
    pub max_depth: Option<u32>,
    /// Seconds that the ladders of samples follow from, if they do.
    pub seconds: Option<f64>,
    /// The scenes.
    pub scenes: Vec<SceneSetup>,
}

/// The circumstances of a scene's rows.
#[derive(Clone, Debug)]
pub struct SceneSetup {
    /// Its name: that of the file without its ending.
    pub name: String,
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Fingerprint of a small render, by which any change of the scene shows.
    pub picture: String,
    /// What its images are held against.
    pub reference: ReferenceSetup,
    /// Numbers of samples by label, where they follow from a time.
    pub ladders: Vec<(String, Vec<u32>)>,
}

/// Where a reference comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReferenceSetup {
    /// Rendered, both halves together with so many samples per pixel.
    Rendered(u64),
    /// Files with this fingerprint.
    Files(String),
}

impl Setup {
    /// Whether rows made under `kept`, the document of [`read`], may stand beside those of this setup: scenes may be
    /// added, nothing else may differ. `path` is named in messages.
    ///
    /// # Errors
    /// [`Error::Scene`] with all that differs.
    pub fn check(&self, path: &Path, kept: &Value) -> Result<()> {
        let own = self.settings();
        let mut differences = Vec::new();
        compare("", &kept["settings"], &own, &mut differences);
        if kept["format"] != FORMAT {
            differences.insert(0, ("format".to_owned(), kept["format"].clone(), json!(FORMAT)));
        }
        if differences.is_empty() {
            return Ok(());
        }
        let hint = "rows of other settings are not mixed: choose another folder, or delete the files of this one";
        let problem = |(place, found, expected): (String, Value, Value)| Problem {
            file: path.to_owned(),
            place: None,
            path: place,
            found: plain(&found),
            expected: format!("{} as of this command", plain(&expected)),
            hint: Some(hint.to_owned()),
        };
        Err(Error::Scene(differences.into_iter().map(problem).collect()))
    }

    /// Writes the document, with `notes` that are for people alone.
    ///
    /// # Errors
    /// As [`output::write_text`].
    pub fn write(&self, path: &Path, notes: &Value) -> Result<()> {
        let ladders = |scene: &SceneSetup| {
            let by_label: Map<_, _> = scene.ladders.iter().map(|(label, spp)| (label.clone(), json!(spp))).collect();
            (scene.name.clone(), Value::Object(by_label))
        };
        let ladders: Map<_, _> = self.scenes.iter().map(ladders).collect();
        let ladders = json!({ "seconds": self.seconds, "scenes": ladders });
        let document = json!({ "format": FORMAT, "settings": self.settings(), "ladders": ladders, "notes": notes });
        output::write_text(path, &format!("{document:#}\n"))
    }

    fn settings(&self) -> Value {
        let scene = |scene: &SceneSetup| {
            let reference = match &scene.reference {
                ReferenceSetup::Rendered(spp) => json!({ "samples_per_pixel": spp }),
                ReferenceSetup::Files(picture) => json!({ "picture": picture }),
            };
            let (width, height) = scene.size;
            let settings =
                json!({ "size": format!("{width}x{height}"), "picture": scene.picture, "reference": reference });
            (scene.name.clone(), settings)
        };
        json!({
            "version": self.build.version,
            "commit": self.build.commit,
            "profile": self.build.profile,
            "compiler": self.build.compiler,
            "simd": self.build.simd,
            "cpu": self.machine.cpu,
            "threads": self.threads,
            "max_depth": self.max_depth,
            "scenes": self.scenes.iter().map(scene).collect::<Map<_, _>>(),
        })
    }
}

/// Reads the document; `None` where there is no such file.
///
/// # Errors
/// [`Error::Io`] where it cannot be read, [`Error::Scene`] where it is no JSON.
pub fn read(path: &Path) -> Result<Option<Value>> {
    let bytes = match input::regular(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(Error::Io { file: path.to_owned(), action: "read", source }),
    };
    serde_json::from_slice(&bytes).map(Some).map_err(|error| {
        Error::Scene(vec![Problem {
            file: path.to_owned(),
            place: Some((error.line(), error.column())),
            path: String::new(),
            found: "what is no JSON".to_owned(),
            expected: "the settings of a chart".to_owned(),
            hint: None,
        }])
    })
}

/// Samples per pixel of the reference that a document keeps for a scene.
pub fn kept_reference(kept: &Value, scene: &str) -> Option<u64> {
    kept["settings"]["scenes"].get(scene)?["reference"]["samples_per_pixel"].as_u64()
}

/// Numbers of samples that a document keeps for a label of a scene, where they follow from as many seconds.
pub fn kept_ladder(kept: &Value, seconds: f64, scene: &str, label: &str) -> Option<Vec<u32>> {
    let ladders = kept.get("ladders").filter(|ladders| ladders["seconds"].as_f64() == Some(seconds))?;
    let ladder = ladders.get("scenes")?.get(scene)?.get(label)?.as_array()?;
    let ladder: Option<Vec<u32>> = ladder.iter().map(|spp| spp.as_u64()?.try_into().ok()).collect();
    // A file that was edited must not lead to renders that make no sense.
    ladder.filter(|ladder| ladder.is_sorted() && ladder.first().is_some_and(|&spp| spp > 0))
}

/// A number that tells pictures apart, to the bit (FNV-1a of 64 bits, Fowler, Noll and Vo).
pub fn fingerprint<'a>(images: impl IntoIterator<Item = &'a Image>) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut eat = |byte: u8| hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    for image in images {
        [image.width, image.height].iter().flat_map(|n| n.to_le_bytes()).for_each(&mut eat);
        image.pixels.as_flattened().iter().flat_map(|c| c.to_bits().to_le_bytes()).for_each(&mut eat);
    }
    format!("{hash:016x}")
}

/// Finds values that differ; what `expected` has in its scenes beyond `found` is no difference.
fn compare(place: &str, found: &Value, expected: &Value, out: &mut Vec<(String, Value, Value)>) {
    let (Value::Object(a), Value::Object(b)) = (found, expected) else {
        if found != expected {
            out.push((place.to_owned(), found.clone(), expected.clone()));
        }
        return;
    };
    let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key) && place != "scenes"));
    for key in keys {
        let inner = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
        let value = |of: &Map<String, Value>| of.get(key).cloned().unwrap_or(Value::Null);
        compare(&inner, &value(a), &value(b), out);
    }
}

/// A value as messages show it.
fn plain(value: &Value) -> String {
    match value {
        Value::Null => "nothing".to_owned(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn setup() -> Setup {
        let scene = |name: &str| SceneSetup {
            name: name.to_owned(),
            size: (4, 3),
            picture: "00ff".to_owned(),
            reference: ReferenceSetup::Rendered(1024),
            ladders: vec![("mis xoshiro".to_owned(), vec![1, 2, 4])],
        };
        Setup {
            build: Build::this(),
            machine: Machine { cpu: "A CPU".to_owned(), cores: 2, system: "A system".to_owned() },
            threads: 2,
            max_depth: None,
            seconds: Some(0.5),
            scenes: vec![scene("a"), scene("b.c")],
        }
    }

    fn differs(change: impl Fn(&mut Setup), parts: &[&str]) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chart.json");
        setup().write(&path, &json!({ "command": "wavetrace" })).unwrap();
        let kept = read(&path).unwrap().unwrap();
        let mut other = setup();
        change(&mut other);
        match other.check(Path::new("chart.json"), &kept) {
            Ok(()) => assert!(parts.is_empty(), "expected {parts:?}"),
            Err(error) => {
                let lines: Vec<String> = error.to_string().lines().map(str::to_owned).collect();
                assert_eq!(lines.len(), parts.len(), "{lines:?}");
                for (line, part) in lines.iter().zip(parts) {
                    assert!(line.starts_with("chart.json: ") && line.contains(part), "{part} in {line}");
                }
            }
        }
    }

    #[test]
    fn whatever_changes_a_row_is_a_difference() {
        differs(|_| {}, &[]);
        differs(|s| s.threads = 1, &["threads: found 2, expected 1 as of this command"]);
        differs(|s| s.max_depth = Some(3), &["max_depth: found nothing, expected 3"]);
        differs(|s| s.machine.cpu = "B".to_owned(), &["cpu: found A CPU, expected B"]);
        differs(|s| s.build.simd = "none", &["simd: "]);
        differs(|s| s.scenes[0].size = (4, 4), &["scenes.a.size: found 4x3, expected 4x4"]);
        differs(|s| s.scenes[1].picture = "1".to_owned(), &["scenes.b.c.picture: found 00ff"]);
        differs(
            |s| {
                s.threads = 7;
                s.scenes[1].reference = ReferenceSetup::Rendered(2048);
            },
            &["threads: ", "scenes.b.c.reference.samples_per_pixel: found 1024, expected 2048"],
        );
        differs(
            |s| s.scenes[0].reference = ReferenceSetup::Files("0".to_owned()),
            &["samples_per_pixel: found 1024, expected nothing", "picture: found nothing, expected 0"],
        );
        differs(|s| drop(s.scenes.pop()), &["scenes.b.c"]);
        differs(|s| s.machine.cores = 64, &[]);
        differs(
            |s| {
                let mut more = s.scenes[0].clone();
                more.name = "d".to_owned();
                s.scenes.push(more);
            },
            &[],
        );
    }

    #[test]
    fn documents_at_fault_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chart.json");
        assert_eq!(read(&path).unwrap(), None);
        assert!(read(folder.path()).unwrap_err().to_string().contains("cannot read"));
        fs::write(&path, "{\"settings\": {\n").unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("chart.json:2:") && error.contains("expected the settings of a chart"), "{error}");
        for other in ["[]", "3", "{}", "{\"format\": 2, \"settings\": []}"] {
            fs::write(&path, other).unwrap();
            let kept = read(&path).unwrap().unwrap();
            assert!(setup().check(&path, &kept).is_err(), "{other}");
            assert_eq!(kept_ladder(&kept, 0.5, "a", "mis xoshiro"), None);
        }
    }

    #[test]
    fn references_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chart.json");
        let mut setup = setup();
        setup.scenes[0].reference = ReferenceSetup::Files("x".to_owned());
        setup.write(&path, &Value::Null).unwrap();
        let kept = read(&path).unwrap().unwrap();
        assert_eq!(kept_reference(&kept, "b.c"), Some(1024));
        assert_eq!((kept_reference(&kept, "a"), kept_reference(&kept, "none")), (None, None));
        assert_eq!(kept_reference(&json!([]), "a"), None);
    }

    #[test]
    fn ladders_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chart.json");
        setup().write(&path, &Value::Null).unwrap();
        let mut kept = read(&path).unwrap().unwrap();
        assert_eq!(kept_ladder(&kept, 0.5, "b.c", "mis xoshiro"), Some(vec![1, 2, 4]));
        assert_eq!(kept_ladder(&kept, 0.25, "b.c", "mis xoshiro"), None);
        assert_eq!(kept_ladder(&kept, 0.5, "b.c", "mis sobol"), None);
        for wrong in [json!([0, 1]), json!([4, 2]), json!([]), json!([1, -1]), json!([1e12]), json!("x")] {
            kept["ladders"]["scenes"]["a"]["mis xoshiro"] = wrong;
            assert_eq!(kept_ladder(&kept, 0.5, "a", "mis xoshiro"), None);
        }
    }

    #[test]
    fn fingerprints_see_every_bit() {
        let image = Image { width: 2, height: 1, pixels: vec![[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]] };
        let mut other = image.clone();
        other.pixels[1][2] = f32::from_bits(other.pixels[1][2].to_bits() + 1);
        let turned = Image { width: 1, height: 2, ..image.clone() };
        assert_ne!(fingerprint([&image]), fingerprint([&other]));
        assert_ne!(fingerprint([&image]), fingerprint([&turned]));
        assert_ne!(fingerprint([&image]), fingerprint([&image, &image]));
        // The published value of the empty text.
        assert_eq!(fingerprint([]), "cbf29ce484222325");
    }
}
