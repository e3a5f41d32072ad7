//! Before the first render that counts: settings, ladders of samples, and whether earlier rows belong to them.

use super::subjects::Subject;
use super::sweep::{Stop, Sweep};
use serde_json::{Value, json};
use std::time::Duration;
use wavetrace::chart::setup::{fingerprint, kept_ladder, kept_reference};
use wavetrace::chart::sweep::{Ladder, Ladders, REFERENCE_FACTOR, TRIAL_SEED, ladder};
use wavetrace::chart::{Build, Kept, Machine, ReferenceSetup, Row, SceneSetup, Series, Setup};

/// What is known before the first render that counts.
pub struct Plan {
    /// Settings of all rows.
    pub setup: Setup,
    /// Samples by scene and series.
    pub ladders: Ladders,
    /// What there is already.
    pub rows: Vec<Row>,
    /// Whether images of an earlier run belong to the same settings.
    pub reuse: bool,
    /// Samples and time of a small render of each scene.
    pub trials: Vec<(u64, Duration)>,
}

impl Sweep<'_> {
    /// Finds out what is to be done, and whether what is there already belongs to it.
    pub fn plan(&self, kept: Kept) -> Result<Plan, Stop> {
        let mut trials = Vec::new();
        let mut pictures = Vec::new();
        for subject in self.subjects {
            let rendered = self.render(subject, &self.args.settings(), 1, TRIAL_SEED)?;
            trials.push((subject.pixels(), rendered.1));
            pictures.push(fingerprint([&rendered.0]));
        }
        let path = self.folder.settings();
        let (mut setup, mut ladders) = self.setup(&pictures, kept.settings.as_ref())?;
        let mut reuse = kept.settings.is_some();
        if let Some(settings) = &kept.settings
            && let Err(error) = setup.check(&path, settings)
        {
            if !kept.rows.is_empty() {
                return Err(self.console.fail(&error).into());
            }
            // Nothing was measured yet: there is nothing to mix.
            (setup, ladders) = self.setup(&pictures, None)?;
            reuse = false;
        }
        setup.write(&path, &self.notes()).map_err(|error| self.console.fail(&error))?;
        Ok(Plan { setup, ladders, rows: kept.rows, reuse, trials })
    }

    /// Settings and ladders; those that follow from a time are found out unless they are kept.
    fn setup(&self, pictures: &[String], kept: Option<&Value>) -> Result<(Setup, Ladders), Stop> {
        let mut ladders = Vec::new();
        let mut scenes = Vec::new();
        for (subject, picture) in self.subjects.iter().zip(pictures) {
            let mut of_scene = Vec::new();
            for series in self.series {
                of_scene.push(self.ladder(subject, series, kept)?);
            }
            let largest = of_scene.iter().flatten().copied().max().unwrap_or(1);
            let needed = u64::from(largest) * u64::from(REFERENCE_FACTOR);
            // One that is better than needed serves as well.
            let there = kept.and_then(|kept| kept_reference(kept, &subject.name)).unwrap_or(0);
            let reference = match &subject.given {
                Some(given) => ReferenceSetup::Files(given.picture.clone()),
                None => ReferenceSetup::Rendered(needed.max(there)),
            };
            let by_label = self.series.iter().map(|series| series.label.clone()).zip(of_scene.clone());
            scenes.push(SceneSetup {
                name: subject.name.clone(),
                size: subject.size(),
                picture: picture.clone(),
                reference,
                ladders: if self.args.seconds.is_some() { by_label.collect() } else { Vec::new() },
            });
            ladders.push(of_scene);
        }
        let machine = Machine::here();
        let setup = Setup {
            build: Build::this(),
            threads: self.args.threads.map_or(machine.cores, |threads| threads as usize),
            machine,
            max_depth: self.args.max_depth,
            seconds: self.args.seconds,
            scenes,
        };
        Ok((setup, ladders))
    }

    fn ladder(&self, subject: &Subject, series: &Series, kept: Option<&Value>) -> Result<Ladder, Stop> {
        let Some(seconds) = self.args.seconds else { return Ok(self.args.budgets()) };
        if let Some(ladder) = kept.and_then(|kept| kept_ladder(kept, seconds, &subject.name, &series.label)) {
            return Ok(ladder);
        }
        let found = ladder(&subject.renderer, &series.settings, seconds, self.control);
        found.map_err(|error| self.console.fail(&error))?.ok_or(Stop::Interrupted)
    }

    /// What people want to know of the run that made the settings.
    fn notes(&self) -> Value {
        let scene = |subject: &Subject| {
            json!({
                "name": subject.name,
                "file": subject.path.display().to_string(),
                "triangles": subject.renderer.world().triangles(),
                "seconds_load": subject.load.as_secs_f64(),
                "seconds_build": subject.build.as_secs_f64(),
            })
        };
        json!({ "command": crate::cli::facts::command(), "scenes": self.subjects.iter().map(scene).collect::<Vec<_>>() })
    }
}
