//! The renders: references first, then one task after the other, until all are there or the user has enough.

use super::plan::Plan;
use super::progress::{Meter, during};
use super::subjects::read;
use super::sweep::{SHOWN_SEED, Stop, Sweep};
use crate::cli::Exit;
use crate::cli::units::{count, counted, per_pixel, time};
use std::collections::{HashMap, HashSet};
use std::time::{Duration, Instant};
use wavetrace::chart::sweep::{Ladder, REFERENCE_SEEDS, common, row as measured_row, tasks};
use wavetrace::chart::{Reference, ReferenceSetup, Row, SceneSetup, Setup, Task, row};
use wavetrace::film::Image;
use wavetrace::render::{SamplerKind, Settings};

/// Rows are written to their file this often at most.
const SAVE_TIME: Duration = Duration::from_secs(1);

/// What has come of a sweep.
pub struct Outcome {
    /// All rows.
    pub rows: Vec<Row>,
    /// References by scene; fewer where it was interrupted.
    pub references: Vec<Reference>,
    /// Images to show, by scene and series.
    pub pictures: HashMap<(usize, usize), Image>,
    /// Renders that are missing.
    pub missing: usize,
}

impl Sweep<'_> {
    /// Renders what is missing. Interrupted, it comes back with what there is by then.
    pub fn run(&self, plan: Plan) -> Result<Outcome, Exit> {
        let key = |row: &Row| (row.scene.clone(), row.label.clone(), row.spp, row.seed);
        let done: HashSet<_> = plan.rows.iter().map(key).collect();
        let mut todo = tasks(&plan.ladders, self.args.seeds);
        let all = todo.len();
        todo.retain(|task| {
            let [scene, label] = self.names(task).map(str::to_owned);
            !done.contains(&(scene, label, u64::from(task.spp), Some(task.seed)))
        });
        self.announce(all, todo.len());
        let meter = self.meter(&plan, &todo);
        let mut outcome =
            Outcome { rows: plan.rows, references: Vec::new(), pictures: HashMap::new(), missing: todo.len() };
        let state = State { setup: &plan.setup, ladders: &plan.ladders, reuse: plan.reuse, meter: &meter };
        let done = during(&meter, self.control, self.console, || {
            let measured =
                self.references(&state, &mut outcome).and_then(|()| self.measure(&state, &todo, &mut outcome));
            // Whatever ended it, what was measured is kept.
            row::write(&self.folder.rows(), &outcome.rows).map_err(|error| self.console.fail(&error))?;
            measured.and_then(|()| self.pictures(&state, &mut outcome))
        });
        match done {
            Ok(()) => Ok(outcome),
            Err(Stop::Fault(exit)) => Err(exit),
            Err(Stop::Interrupted) => {
                // Those of an earlier run alone: nothing is rendered any more.
                let _ = self.pictures(&state, &mut outcome);
                Ok(outcome)
            }
        }
    }

    fn announce(&self, all: usize, todo: usize) {
        for subject in self.subjects {
            let (width, height) = subject.size();
            self.console.line(format_args!(
                "{}: {width}x{height} pixels, {}; load {}, build {}",
                subject.name,
                counted(subject.renderer.world().triangles() as u64, "triangle"),
                time(subject.load),
                time(subject.build)
            ));
        }
        let there =
            if todo < all { format!(", {} of them there already", count((all - todo) as u64)) } else { String::new() };
        let (series, seeds) = (self.series.len(), counted(u64::from(self.args.seeds), "seed"));
        let renders = counted(all as u64, "render");
        self.console.line(format_args!("{series} series, {seeds}: {renders}{there}"));
    }

    /// All that is to come, for the time that is left.
    fn meter(&self, plan: &Plan, todo: &[Task]) -> Meter {
        let meter = Meter::default();
        for (scene, (subject, (samples, time))) in self.subjects.iter().zip(&plan.trials).enumerate() {
            for series in 0..=self.series.len() {
                meter.timed(self.kind(scene, series), *samples, *time);
            }
            if subject.given.is_none() {
                let samples = plan.setup.scenes.get(scene).map_or(0, half) * subject.pixels();
                (0..2).for_each(|_| meter.plan(self.kind(scene, self.series.len()), samples));
            }
        }
        for task in todo {
            meter.plan(self.kind(task.scene, task.series), self.samples(task));
        }
        meter
    }

    /// References of all scenes: as given, of an earlier run, or rendered.
    fn references(&self, state: &State<'_>, outcome: &mut Outcome) -> Result<(), Stop> {
        for (scene, (subject, setup)) in self.subjects.iter().zip(&state.setup.scenes).enumerate() {
            if let Some(given) = &subject.given {
                outcome.references.push(given.reference.clone());
                continue;
            }
            let samples = half(setup);
            let mut halves = Vec::new();
            for (i, seed) in REFERENCE_SEEDS.into_iter().enumerate() {
                let path = self.folder.reference(&subject.name, i);
                let doing = format!("reference of {}, half {}", subject.name, i + 1);
                state.meter.begin(doing, self.kind(scene, self.series.len()), samples * subject.pixels(), self.control);
                let kept = state.reuse.then(|| read(&path).ok()).flatten();
                let image = match kept.filter(|image| (image.width, image.height) == subject.size()) {
                    Some(image) => image,
                    None => {
                        // The default method with Sobol points: the least noise for the time.
                        let settings = Settings { sampler: SamplerKind::Sobol, ..self.args.settings() };
                        let spp = u32::try_from(samples).unwrap_or(u32::MAX);
                        let image = self.render(subject, &settings, spp, seed)?.0;
                        self.write(&path, &image, &[("spp", spp.to_string()), ("seed", seed.to_string())])?;
                        image
                    }
                };
                state.meter.end();
                halves.push(image);
            }
            let Ok(halves) = <[Image; 2]>::try_from(halves) else { continue };
            outcome.references.push(Reference::halves(halves).map_err(|error| self.console.fail(&error))?);
        }
        Ok(())
    }

    /// Renders and measures one task after the other.
    fn measure(&self, state: &State<'_>, todo: &[Task], outcome: &mut Outcome) -> Result<(), Stop> {
        let mut saved = Instant::now();
        for task in todo {
            let (Some(subject), Some(series), Some(reference)) =
                (self.subjects.get(task.scene), self.series.get(task.series), outcome.references.get(task.scene))
            else {
                continue;
            };
            let doing = format!(
                "{} {}, {}, seed {} of {}",
                subject.name,
                series.label,
                per_pixel(task.spp),
                task.seed,
                self.args.seeds
            );
            state.meter.begin(doing, self.kind(task.scene, task.series), self.samples(task), self.control);
            let (image, time) = self.render(subject, &series.settings, task.spp, task.seed)?;
            let row = measured_row(&subject.name, &series.label, task, time, &image, reference);
            outcome.rows.push(row.map_err(|error| self.console.fail(&error))?);
            outcome.missing -= 1;
            if task.seed == SHOWN_SEED && state.shown(task.scene) == Some(task.spp) {
                self.show(task.scene, task.series, task.spp, image, outcome)?;
            }
            state.meter.end();
            if saved.elapsed() >= SAVE_TIME {
                row::write(&self.folder.rows(), &outcome.rows).map_err(|error| self.console.fail(&error))?;
                saved = Instant::now();
            }
        }
        Ok(())
    }

    fn show(&self, scene: usize, series: usize, spp: u32, image: Image, outcome: &mut Outcome) -> Result<(), Stop> {
        let [name, label] = self.names(&Task { scene, series, spp, seed: SHOWN_SEED });
        let path = self.folder.picture(name, label, spp);
        let entries = [("spp", spp.to_string()), ("seed", SHOWN_SEED.to_string()), ("series", label.to_owned())];
        self.write(&path, &image, &entries)?;
        outcome.pictures.insert((scene, series), image);
        Ok(())
    }

    /// Images to show that an earlier run has made, from their files, or rendered again where these are gone.
    fn pictures(&self, state: &State<'_>, outcome: &mut Outcome) -> Result<(), Stop> {
        for (scene, subject) in self.subjects.iter().enumerate() {
            let Some(spp) = state.shown(scene) else { continue };
            for (i, series) in self.series.iter().enumerate() {
                if outcome.pictures.contains_key(&(scene, i)) {
                    continue;
                }
                let kept = state.reuse.then(|| read(&self.folder.picture(&subject.name, &series.label, spp)).ok());
                match kept.flatten().filter(|image| (image.width, image.height) == subject.size()) {
                    Some(image) => drop(outcome.pictures.insert((scene, i), image)),
                    None if self.control.is_stopped() => {}
                    None => {
                        let image = self.render(subject, &series.settings, spp, SHOWN_SEED)?.0;
                        self.show(scene, i, spp, image, outcome)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// What the steps of a run share.
struct State<'a> {
    setup: &'a Setup,
    ladders: &'a [Vec<Ladder>],
    reuse: bool,
    meter: &'a Meter,
}

impl State<'_> {
    /// The budget at which a scene's images are shown.
    fn shown(&self, scene: usize) -> Option<u32> {
        common(self.ladders.get(scene)?)
    }
}

/// Samples per pixel of half a reference.
fn half(scene: &SceneSetup) -> u64 {
    match scene.reference {
        ReferenceSetup::Rendered(samples) => samples / 2,
        ReferenceSetup::Files(_) => 0,
    }
}
