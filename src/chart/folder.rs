//! The folder that a sweep writes to, and finds its earlier rows in.

use super::row::{self, Row};
use super::setup;
use crate::error::{Error, Problem, Result};
use crate::output;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Where everything of a chart lies.
#[derive(Clone, Debug)]
pub struct Folder {
    root: PathBuf,
}

/// What an earlier run has left.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    /// The document of its settings.
    pub settings: Option<Value>,
    /// Its rows; none without settings.
    pub rows: Vec<Row>,
}

impl Folder {
    /// Makes the folder where there is none, and finds out whether its files can be written.
    ///
    /// # Errors
    /// [`Error::Io`] or [`Error::Output`] where they cannot.
    pub fn open(root: &Path) -> Result<Self> {
        if root.exists() && !root.is_dir() {
            let reason = "found a file, expected a folder".to_owned();
            return Err(Error::Output { file: root.to_owned(), reason });
        }
        let folder = Self { root: root.to_owned() };
        let images = folder.root.join("images");
        fs::create_dir_all(&images).map_err(|source| Error::Io { file: images.clone(), action: "make", source })?;
        for path in [folder.rows(), folder.settings(), folder.svg(), folder.png(), folder.page()] {
            output::check_writable_text(&path)?;
        }
        output::check_writable_text(&images.join("writable.exr"))?;
        Ok(folder)
    }
    /// Measurements.
    pub fn rows(&self) -> PathBuf {
        self.root.join("chart.csv")
    }
    /// Their settings.
    pub fn settings(&self) -> PathBuf {
        self.root.join("chart.json")
    }
    /// The chart as a drawing.
    pub fn svg(&self) -> PathBuf {
        self.root.join("chart.svg")
    }
    /// The chart as a picture.
    pub fn png(&self) -> PathBuf {
        self.root.join("chart.png")
    }
    /// The page.
    pub fn page(&self) -> PathBuf {
        self.root.join("index.html")
    }
    /// A half of the reference of a scene: 0 or 1.
    pub fn reference(&self, scene: &str, half: usize) -> PathBuf {
        self.image(scene, if half == 0 { "reference-a" } else { "reference-b" })
    }
    /// The image that the page shows of a series.
    pub fn picture(&self, scene: &str, label: &str, spp: u32) -> PathBuf {
        self.image(scene, &format!("{}-{spp}", label.replace(' ', "-")))
    }
    fn image(&self, scene: &str, name: &str) -> PathBuf {
        self.root.join("images").join(format!("{scene}.{name}.exr"))
    }

    /// What an earlier run has left here.
    ///
    /// # Errors
    /// [`Error::Io`] where a file cannot be read; [`Error::Scene`] where one is at fault, where there are rows without
    /// settings, and where a row has no seed.
    pub fn kept(&self) -> Result<Kept> {
        let settings = setup::read(&self.settings())?;
        let path = self.rows();
        let rows = if path.exists() { row::read(&path)? } else { Vec::new() };
        let wrong = |line, found: String, expected: &str| {
            let (place, path_in_file, expected) = (Some((line, 1)), String::new(), expected.to_owned());
            Err(Error::Scene(vec![Problem {
                file: path.clone(),
                place,
                path: path_in_file,
                found,
                expected,
                hint: None,
            }]))
        };
        if settings.is_none() && !rows.is_empty() {
            return wrong(1, "rows without chart.json beside them".to_owned(), "the rows of an earlier run, or none");
        }
        if let Some(i) = rows.iter().position(|row| row.seed.is_none()) {
            return wrong(i + 2, "a row without a seed".to_owned(), "rows of this command, not of another program");
        }
        Ok(Kept { settings, rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn earlier_rows_come_with_their_settings() {
        let outer = tempfile::tempdir().unwrap();
        let folder = Folder::open(&outer.path().join("a/b")).unwrap();
        let kept = folder.kept().unwrap();
        assert!(kept.settings.is_none() && kept.rows.is_empty());
        let header = "scene,label,spp,seed,seconds,relmse\n";
        fs::write(folder.rows(), format!("{header}a,mis,1,1,1,1\n")).unwrap();
        let error = folder.kept().unwrap_err().to_string();
        assert!(error.contains("chart.csv:1:1: found rows without chart.json"), "{error}");
        fs::write(folder.settings(), "{}").unwrap();
        assert_eq!(folder.kept().unwrap().rows.len(), 1);
        fs::write(folder.rows(), format!("{header}a,mis,1,1,1,1\na,mis,1,,1,1\n")).unwrap();
        let error = folder.kept().unwrap_err().to_string();
        assert!(error.contains("chart.csv:3:1: found a row without a seed"), "{error}");
        // A table without rows is none.
        fs::write(folder.rows(), header).unwrap();
        fs::remove_file(folder.settings()).unwrap();
        assert!(folder.kept().is_ok());
    }

    #[test]
    fn what_cannot_be_written_is_said_before_there_is_work_to_lose() {
        let outer = tempfile::tempdir().unwrap();
        fs::write(outer.path().join("file"), "").unwrap();
        let error = Folder::open(&outer.path().join("file")).unwrap_err().to_string();
        assert!(error.contains("file: found a file, expected a folder"), "{error}");
        let error = Folder::open(&outer.path().join("file/below")).unwrap_err().to_string();
        assert!(error.contains("cannot make"), "{error}");
        fs::create_dir_all(outer.path().join("a/chart.csv")).unwrap();
        let error = Folder::open(&outer.path().join("a")).unwrap_err().to_string();
        assert!(error.contains("chart.csv: found a folder, expected a file"), "{error}");
    }

    #[test]
    fn images_have_names_of_their_own() {
        let outer = tempfile::tempdir().unwrap();
        let folder = Folder::open(outer.path()).unwrap();
        let name = |path: PathBuf| path.strip_prefix(outer.path()).unwrap().to_string_lossy().replace('\\', "/");
        assert_eq!(name(folder.picture("room", "mis xoshiro", 64)), "images/room.mis-xoshiro-64.exr");
        assert_eq!(name(folder.reference("room", 1)), "images/room.reference-b.exr");
    }
}
