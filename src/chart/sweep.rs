//! What is rendered, in which order, and what is measured of a render.

use super::Row;
use super::reference::Reference;
use crate::error::Result;
use crate::film::Image;
use crate::render::{Control, Rendered, Renderer, Settings};
use std::time::Duration;

/// Most samples per pixel of a sweep: its reference takes sixteen times as many.
pub const MAX_SPP: u32 = u32::MAX / REFERENCE_FACTOR;
/// How many times the samples of the largest budget a reference takes.
pub const REFERENCE_FACTOR: u32 = 16;
/// Most seeds: they are 1, 2, ..., and those of references come after them.
pub const MAX_SEEDS: u32 = 1000;
/// Seeds of the two halves of a reference.
pub const REFERENCE_SEEDS: [u64; 2] = [MAX_SEEDS as u64 + 1, MAX_SEEDS as u64 + 2];
/// Seed of renders that are not measured.
pub const TRIAL_SEED: u64 = 0;
/// Samples per pixel unless set.
pub const DEFAULT_SPP: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];
/// A trial of this share of the time tells well enough how long the whole takes.
const TRIAL_SHARE: f64 = 0.1;

/// Numbers of samples per pixel in rising order.
pub type Ladder = Vec<u32>;
/// Ladders by scene and series.
pub type Ladders = Vec<Vec<Ladder>>;

/// A line of the chart: a way to render.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What it is called.
    pub label: String,
    /// All settings but samples and seed.
    pub settings: Settings,
}

/// One render of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// Index of the scene.
    pub scene: usize,
    /// Index of the series.
    pub series: usize,
    /// Samples per pixel.
    pub spp: u32,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// All renders of a sweep in their order: for each seed, for each step of the ladders, for each scene, each series. What
/// belongs together is spread over the whole time, so that a slow hour of the machine meets all alike.
///
/// Seeds are 1 to `seeds`.
pub fn tasks(ladders: &[Vec<Ladder>], seeds: u32) -> Vec<Task> {
    let steps = ladders.iter().flatten().map(Vec::len).max().unwrap_or(0);
    let mut tasks = Vec::new();
    for seed in 1..=u64::from(seeds) {
        for step in 0..steps {
            for (scene, ladders) in ladders.iter().enumerate() {
                let with_step =
                    ladders.iter().enumerate().filter_map(|(series, ladder)| Some((series, ladder.get(step)?)));
                tasks.extend(with_step.map(|(series, &spp)| Task { scene, series, spp, seed }));
            }
        }
    }
    tasks
}

/// The largest number of samples that all ladders have in common, if there is one.
pub fn common(ladders: &[Ladder]) -> Option<u32> {
    let (first, others) = ladders.split_first()?;
    first.iter().copied().filter(|spp| others.iter().all(|ladder| ladder.contains(spp))).max()
}

/// Renders with settings but for samples and seed; `None` where it was stopped.
///
/// # Errors
/// As [`Renderer::render`].
pub fn render(
    renderer: &Renderer,
    settings: &Settings,
    spp: u32,
    seed: u64,
    control: &Control,
) -> Result<Option<Rendered>> {
    let rendered = renderer.render(&Settings { spp, seed, ..settings.clone() }, control)?;
    Ok((!rendered.partial).then_some(rendered))
}

/// 1, 2, 4, ... samples per pixel, up to the first that takes `seconds` or more, at most [`MAX_SPP`]. Found out by
/// renders of up to about a tenth of that time; `None` where they were stopped.
///
/// # Errors
/// As [`Renderer::render`].
pub fn ladder(renderer: &Renderer, settings: &Settings, seconds: f64, control: &Control) -> Result<Option<Ladder>> {
    let mut spp = 1;
    loop {
        let Some(rendered) = render(renderer, settings, spp, TRIAL_SEED, control)? else { return Ok(None) };
        let time = rendered.time.as_secs_f64();
        if time >= TRIAL_SHARE * seconds || spp > MAX_SPP / 2 {
            return Ok(Some(doubling(spp, time, seconds)));
        }
        spp *= 2;
    }
}

/// 1, 2, 4, ... up to the first that takes `seconds`, where `spp` samples take `time`.
fn doubling(spp: u32, time: f64, seconds: f64) -> Ladder {
    let takes = |n: u32| f64::from(n) / f64::from(spp) * time;
    let mut ladder = vec![1];
    let mut last = 1;
    while takes(last) < seconds && last <= MAX_SPP / 2 {
        last *= 2;
        ladder.push(last);
    }
    ladder
}

/// The row of a render.
///
/// # Errors
/// [`Error::Images`](crate::Error::Images) where the reference is of another size.
pub fn row(scene: &str, label: &str, task: &Task, time: Duration, image: &Image, reference: &Reference) -> Result<Row> {
    let found = reference.measure(image)?;
    Ok(Row {
        scene: scene.to_owned(),
        label: label.to_owned(),
        spp: u64::from(task.spp),
        seed: Some(task.seed),
        seconds: time.as_secs_f64(),
        relmse: found.rel_mse.raw,
        relmse_trimmed: Some(found.rel_mse.trimmed),
        mse: Some(found.mse),
        flip: Some(found.flip),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_belongs_together_is_spread() {
        let ladders = [vec![vec![1, 4], vec![2]], vec![vec![1], vec![1, 2]]];
        let found: Vec<_> = tasks(&ladders, 2).iter().map(|t| (t.seed, t.spp, t.scene, t.series)).collect();
        let once = [(1, 0, 0), (2, 0, 1), (1, 1, 0), (1, 1, 1), (4, 0, 0), (2, 1, 1)];
        let expected: Vec<_> =
            [1, 2].iter().flat_map(|&s| once.map(|(spp, scene, series)| (s, spp, scene, series))).collect();
        assert_eq!(found, expected);
        assert_eq!(tasks(&[], 3), []);
    }

    #[test]
    fn the_common_budget() {
        assert_eq!(common(&[vec![1, 2, 4], vec![1, 2]]), Some(2));
        assert_eq!(common(&[vec![1], vec![2]]), None);
        assert_eq!(common(&[vec![1, 8]]), Some(8));
        assert_eq!(common(&[]), None);
    }

    #[test]
    fn ladders_end_where_the_time_is_spent() {
        assert_eq!(doubling(1, 0.5, 2.0), [1, 2, 4]);
        assert_eq!(doubling(4, 1.0, 2.1), [1, 2, 4, 8, 16]);
        assert_eq!(doubling(1, 3.0, 2.0), [1]);
        let endless = doubling(1, 0.0, 1.0);
        assert_eq!(endless.last(), Some(&(1 << 27)));
        assert!(endless.iter().all(|&spp| spp <= MAX_SPP));
    }
}
