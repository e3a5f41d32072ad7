//! The standard suite: what is measured when nothing is named. One file for each part.

mod build;
mod load;
mod machine;
pub mod rays;
mod scenes;
mod start;

use super::measure::{Case, Figure, measure};
use super::{Corners, mesh, room};
use crate::accel::{BuildOptions, Bvh};
use crate::error::Result;
use crate::world::Mesh;
use std::path::PathBuf;

pub use machine::{Limits, YARDSTICKS, limits};
pub use scenes::INSTRUMENTATION;

/// Triangles of the generated meshes, about.
pub const SIZES: [usize; 4] = [1_000, 30_000, 1_000_000, 10_000_000];
/// The mesh of a size is the same in every run.
const SEED: u64 = 1;

/// A part of the suite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// What the machine itself can do: by it, a slower machine is told from a slower program.
    Machine,
    /// Rays per second in generated meshes, by each kernel.
    Rays,
    /// Whole renders of scenes, and their stages.
    Scenes,
    /// Building the tree over generated meshes.
    Build,
    /// Reading a mesh.
    Load,
    /// Starting the program.
    Start,
}

impl Part {
    /// All parts, in the order of reports.
    pub const ALL: [Self; 6] = [Self::Machine, Self::Rays, Self::Scenes, Self::Build, Self::Load, Self::Start];

    /// Its name, with which the names of its figures begin.
    pub fn name(self) -> &'static str {
        match self {
            Self::Machine => "machine",
            Self::Rays => "rays",
            Self::Scenes => "scene",
            Self::Build => "build",
            Self::Load => "load",
            Self::Start => "start",
        }
    }
    /// The part of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|part| part.name() == name)
    }
}

/// What is measured, and how.
#[derive(Clone, Debug)]
pub struct Suite {
    /// Parts to measure.
    pub parts: Vec<Part>,
    /// Scene files to render.
    pub scenes: Vec<PathBuf>,
    /// The program that is started.
    pub program: PathBuf,
    /// Most triangles of a generated mesh.
    pub up_to: usize,
    /// Threads of all that can use several.
    pub threads: usize,
    /// Repeats that count.
    pub repeats: usize,
}

/// A generated mesh and its tree.
struct Room {
    /// About how many triangles were asked for, as names have it.
    size: usize,
    mesh: Mesh,
    corners: Corners,
    bvh: Bvh,
}

impl Suite {
    /// Whether a part is asked for.
    fn has(&self, part: Part) -> bool {
        self.parts.contains(&part)
    }
    fn build_options(&self) -> BuildOptions {
        BuildOptions { threads: self.threads, ..BuildOptions::default() }
    }

    /// Measures; `seen` is told the share that is done, and ends it where it returns false.
    ///
    /// # Errors
    /// What reading a scene says, or writing temporary files; too many threads.
    pub fn run(&self, mut seen: impl FnMut(f64) -> bool) -> Result<Vec<Figure>> {
        // What goes before takes a while, too.
        let mut goes_on = || seen(0.0);
        let rooms = self.rooms(&mut goes_on)?;
        let sets = if self.has(Part::Rays) { rays::sets(&rooms, self.threads, &mut goes_on)? } else { Vec::new() };
        let rendered =
            if self.has(Part::Scenes) { scenes::load(&self.scenes, self, &mut goes_on)? } else { Vec::new() };
        if !goes_on() {
            return Ok(Vec::new());
        }
        let file = if self.has(Part::Load) { load::file(&rooms)? } else { None };
        let folder = if self.has(Part::Start) { Some(start::folder()?) } else { None };
        let mut cases: Vec<Case<'_>> = Vec::new();
        if self.has(Part::Machine) {
            cases.extend(machine::cases());
        }
        cases.extend(rays::cases(&sets, self.threads));
        cases.extend(scenes::cases(&rendered, self.threads));
        if self.has(Part::Build) {
            cases.extend(rooms.iter().map(|room| build::case(room, self.build_options())));
        }
        cases.extend(file.iter().map(load::case));
        cases.extend(folder.iter().map(|folder| start::case(folder, &self.program)));
        Ok(measure(cases, self.repeats, seen))
    }

    /// The rooms, as long as it goes on.
    fn rooms(&self, goes_on: &mut impl FnMut() -> bool) -> Result<Vec<Room>> {
        if ![Part::Rays, Part::Build, Part::Load].into_iter().any(|part| self.has(part)) {
            return Ok(Vec::new());
        }
        let make = |size: usize| {
            let mesh = room(size, SEED);
            let corners = mesh::corners(&mesh);
            Ok(Room { size, bvh: Bvh::build_with(&corners, &self.build_options())?, mesh, corners })
        };
        SIZES.into_iter().filter(|&size| size <= self.up_to).take_while(|_| goes_on()).map(make).collect()
    }
}

/// A number of triangles as names have it: 1k, 30k, 1M.
fn short(size: usize) -> String {
    if size >= 1_000_000 { format!("{}M", size / 1_000_000) } else { format!("{}k", size / 1_000) }
}
