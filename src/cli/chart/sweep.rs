//! What a sweep is made of, and what its steps share: names, renders, image files.

use super::args::ChartArgs;
use super::subjects::Subject;
use crate::cli::Exit;
use crate::cli::messages::Console;
use std::path::Path;
use std::time::Duration;
use wavetrace::chart::{Folder, Series, Task, sweep};
use wavetrace::film::Image;
use wavetrace::output::{self, Metadata, Tone};
use wavetrace::render::{Control, Settings};

/// The seed whose image the page shows.
pub const SHOWN_SEED: u64 = 1;

/// Why a step did not come to its end.
pub enum Stop {
    /// Something is at fault.
    Fault(Exit),
    /// The user has enough.
    Interrupted,
}

impl From<Exit> for Stop {
    fn from(exit: Exit) -> Self {
        Self::Fault(exit)
    }
}

/// What the user asked for, and what it is done with.
pub struct Sweep<'a> {
    /// Options.
    pub args: &'a ChartArgs,
    /// Messages go here.
    pub console: &'a Console,
    /// How renders are stopped.
    pub control: &'a Control,
    /// Where everything goes.
    pub folder: &'a Folder,
    /// The scenes.
    pub subjects: &'a [Subject],
    /// The ways to render.
    pub series: &'a [Series],
}

impl Sweep<'_> {
    /// The image of a render, and how long it took.
    pub fn render(
        &self,
        subject: &Subject,
        settings: &Settings,
        spp: u32,
        seed: u64,
    ) -> Result<(Image, Duration), Stop> {
        let rendered = sweep::render(&subject.renderer, settings, spp, seed, self.control);
        let rendered = rendered.map_err(|error| self.console.fail(&error))?.ok_or(Stop::Interrupted)?;
        Ok((rendered.film.image(), rendered.time))
    }

    /// Scene and label of a task.
    pub fn names(&self, task: &Task) -> [&str; 2] {
        let scene = self.subjects.get(task.scene).map_or("", |subject| &subject.name);
        [scene, self.series.get(task.series).map_or("", |series| &series.label)]
    }

    /// Kinds of work: each series on each scene, and each scene's reference.
    pub fn kind(&self, scene: usize, series: usize) -> usize {
        scene * (self.series.len() + 1) + series
    }

    /// Samples of a task, all pixels together.
    pub fn samples(&self, task: &Task) -> u64 {
        u64::from(task.spp) * self.subjects.get(task.scene).map_or(0, Subject::pixels)
    }
    /// Writes an image with what there is to say of it.
    pub fn write(&self, path: &Path, image: &Image, entries: &[(&str, String)]) -> Result<(), Exit> {
        let software = ("Software", format!("wavetrace {}", env!("CARGO_PKG_VERSION")));
        let entries = [software].into_iter().chain(entries.iter().cloned());
        let entries = entries.map(|(key, value)| (key.to_owned(), value)).collect();
        let metadata = Metadata { entries, ..Metadata::default() };
        output::write(path, image, &metadata, &Tone::default()).map_err(|error| self.console.fail(&error))
    }
}
