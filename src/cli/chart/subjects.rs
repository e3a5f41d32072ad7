//! The scenes of a sweep, with what their images are held against.

use super::args::ChartArgs;
use crate::cli::Exit;
use crate::cli::load::load as load_scene;
use crate::cli::messages::Console;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use wavetrace::accel::BuildOptions;
use wavetrace::chart::Reference;
use wavetrace::chart::setup::fingerprint;
use wavetrace::error::Result as LibraryResult;
use wavetrace::film::Image;
use wavetrace::output::{self, Format};
use wavetrace::render::Renderer;

/// A scene, ready to render.
pub struct Subject {
    /// The name of its file without ending.
    pub name: String,
    /// Its file.
    pub path: PathBuf,
    /// World and tree.
    pub renderer: Renderer,
    /// How long it took to read.
    pub load: Duration,
    /// How long its tree took.
    pub build: Duration,
    /// What the user holds its images against.
    pub given: Option<Given>,
}

/// A reference from files.
pub struct Given {
    /// The image.
    pub reference: Reference,
    /// What tells it from others.
    pub picture: String,
    /// Its files.
    pub paths: Vec<PathBuf>,
}

impl Subject {
    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        (self.renderer.world().width(), self.renderer.world().height())
    }
    /// Pixels in all.
    pub fn pixels(&self) -> u64 {
        let (width, height) = self.size();
        u64::from(width) * u64::from(height)
    }
}

/// Names of the scenes, all different; the number of references fits them.
pub fn names(args: &ChartArgs, console: &Console) -> Result<Vec<String>, Exit> {
    let name = |path: &Path| path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let names: Vec<String> = args.scenes.iter().map(|path| name(path)).collect();
    for (i, name) in names.iter().enumerate() {
        if names.iter().take(i).any(|other| other == name) {
            let path = args.scenes.get(i).map_or_else(String::new, |path| path.display().to_string());
            console.error(format_args!("{path}: found a second scene of the name {name}, expected names that differ"));
            return Err(Exit::Usage);
        }
    }
    let (scenes, files) = (names.len(), args.reference.len());
    if files != 0 && files != scenes && files != 2 * scenes {
        console.error(format_args!(
            "--reference: found {files} for {scenes} scenes, expected {scenes}, one for each, or {}, two halves for each",
            2 * scenes
        ));
        return Err(Exit::Usage);
    }
    Ok(names)
}

/// Reads scenes and references, and builds the trees.
pub fn load(args: &ChartArgs, names: &[String], console: &Console) -> Result<Vec<Subject>, Exit> {
    let per_scene = args.reference.len() / args.scenes.len().max(1);
    let mut subjects = Vec::new();
    for (i, (path, name)) in args.scenes.iter().zip(names).enumerate() {
        let files = args.reference.get(i * per_scene..(i + 1) * per_scene).unwrap_or_default();
        let images = files.iter().map(|path| reference(path, console)).collect::<Result<Vec<_>, Exit>>()?;
        let start = Instant::now();
        let scene = load_scene(path, args.size, console)?;
        let load = start.elapsed();
        let options = BuildOptions { threads: args.settings().threads, ..BuildOptions::default() };
        let start = Instant::now();
        let renderer = Renderer::with_options(scene.world, &options).map_err(|error| console.fail(&error))?;
        let (name, path, build) = (name.clone(), path.clone(), start.elapsed());
        let mut subject = Subject { name, path, renderer, load, build, given: None };
        subject.given = given(&subject, files, images, console)?;
        subjects.push(subject);
    }
    Ok(subjects)
}

/// The reference that one image, or two halves, make for a scene.
fn given(subject: &Subject, files: &[PathBuf], images: Vec<Image>, console: &Console) -> Result<Option<Given>, Exit> {
    let (width, height) = subject.size();
    for (image, path) in images.iter().zip(files) {
        if (image.width, image.height) != (width, height) {
            console.error(format_args!(
                "{}: found {}x{} pixels, expected {width}x{height} as {} has",
                path.display(),
                image.width,
                image.height,
                subject.path.display()
            ));
            return Err(Exit::Fault);
        }
    }
    let picture = fingerprint(&images);
    let mut images = images.into_iter();
    let reference = match (images.next(), images.next()) {
        (None, _) => return Ok(None),
        (Some(image), None) => Reference::whole(image),
        (Some(a), Some(b)) => Reference::halves([a, b]),
    };
    let reference = reference.map_err(|error| {
        let names: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
        console.error(format_args!("{}: {error}", names.join(", ")));
        Exit::Fault
    })?;
    Ok(Some(Given { reference, picture, paths: files.to_vec() }))
}

/// The pixels of a reference; what is odd about it is said.
fn reference(path: &Path, console: &Console) -> Result<Image, Exit> {
    let file = output::read(path).map_err(|error| console.fail(&error))?;
    let name = path.display();
    if matches!(file.format, Format::Png | Format::Ppm) {
        console.warn(format_args!(
            "{name}: values are limited to 1, expected .exr or .hdr: what is brighter counts as error"
        ));
    }
    for remark in &file.remarks {
        console.warn(format_args!("{name}: {remark}"));
    }
    Ok(file.image)
}

/// The pixels of an image file.
pub fn read(path: &Path) -> LibraryResult<Image> {
    output::read(path).map(|file| file.image)
}
