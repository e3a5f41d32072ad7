//! The clock: figures of cases that take turns, so that a slow moment of the machine touches one repeat of each.

use super::cpu;
use std::time::{Duration, Instant};

/// Shortest time that is measured: short work is done several times in it.
const SHORTEST: Duration = Duration::from_millis(100);
/// Passes that are not timed, at most: a pass that takes long enough to be timed alone is the only one.
const WARM_UPS: usize = 3;

/// What a figure counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// 10^6 rays per second.
    Mrays,
    /// 10^6 samples of pixels per second.
    Msamples,
    /// 10^6 triangles per second.
    Mtriangles,
    /// 10^6 bytes per second.
    Megabytes,
    /// 10^9 floating-point operations per second.
    Gflops,
    /// Nanoseconds for one item.
    Nanoseconds,
    /// Milliseconds.
    Milliseconds,
    /// Per cent of a time.
    Percent,
}

impl Unit {
    /// All units and their names.
    const ALL: [(Self, &'static str); 8] = [
        (Self::Mrays, "Mrays/s"),
        (Self::Msamples, "Msamples/s"),
        (Self::Mtriangles, "Mtriangles/s"),
        (Self::Megabytes, "MB/s"),
        (Self::Gflops, "Gflop/s"),
        (Self::Nanoseconds, "ns"),
        (Self::Milliseconds, "ms"),
        (Self::Percent, "%"),
    ];
    /// As it is written.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|unit| unit.0 == self).map_or("", |unit| unit.1)
    }
    /// The unit that is written so.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|unit| unit.1 == name).map(|unit| unit.0)
    }
    /// Whether more of it is better: rates, not times.
    pub fn is_rate(self) -> bool {
        !matches!(self, Self::Nanoseconds | Self::Milliseconds | Self::Percent)
    }
}

/// Something that is measured: each run gives a value for each of its figures.
pub struct Case<'a> {
    /// Names of the figures, unique in a suite, and their units.
    pub figures: Vec<(String, Unit)>,
    /// Does the work and returns the values.
    pub run: Box<dyn FnMut() -> Vec<f64> + 'a>,
    /// Whether other processes do the work, so that this one does not know how busy CPUs are with it.
    pub elsewhere: bool,
}

impl<'a> Case<'a> {
    /// Work of this process.
    pub fn new(figures: Vec<(String, Unit)>, run: impl FnMut() -> Vec<f64> + 'a) -> Self {
        Self { figures, run: Box::new(run), elsewhere: false }
    }
    /// Work of other processes.
    pub fn elsewhere(self) -> Self {
        Self { elsewhere: true, ..self }
    }
}

/// What was measured, repeat by repeat.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it is of.
    pub name: String,
    /// What it counts.
    pub unit: Unit,
    /// The value of each repeat.
    pub values: Vec<f64>,
    /// CPUs that were busy with this program in the mean, where the system tells: less than the threads where other
    /// programs took their share.
    pub busy: Option<f64>,
}

impl Figure {
    /// The median of the repeats, 0 without any.
    pub fn median(&self) -> f64 {
        median(&self.values)
    }
    /// The best repeat: the largest rate or the shortest time; 0 without any.
    pub fn best(&self) -> f64 {
        let (least, most) = self.range();
        match self.values.is_empty() {
            true => 0.0,
            false if self.unit.is_rate() => most,
            false => least,
        }
    }
    /// From the least repeat to the largest, over the median.
    pub fn spread(&self) -> f64 {
        let ((least, most), median) = (self.range(), self.median());
        if median > 0.0 { (most - least) / median } else { 0.0 }
    }
    fn range(&self) -> (f64, f64) {
        self.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)))
    }
}

/// The median of some values, 0 of none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |i: usize| sorted.get(i).copied().unwrap_or(0.0);
    match sorted.len() {
        0 => 0.0,
        n => (at(n / 2) + at((n - 1) / 2)) / 2.0,
    }
}

/// What the runs of a case gave.
#[derive(Default)]
struct Log {
    runs: Vec<Vec<f64>>,
    wall: Duration,
    /// CPU time, where the system tells.
    worked: Option<Duration>,
}

impl Log {
    fn add(&mut self, run: Vec<f64>, wall: Duration, worked: Option<Duration>) {
        let before = if self.runs.is_empty() { Some(Duration::ZERO) } else { self.worked };
        self.worked = before.zip(worked).map(|(sum, worked)| sum + worked);
        self.wall += wall;
        self.runs.push(run);
    }
    /// The values of a figure, one by one.
    fn column(&self, k: usize) -> Vec<f64> {
        self.runs.iter().filter_map(|run| run.get(k).copied()).collect()
    }
    fn busy(&self) -> Option<f64> {
        let worked = self.worked.filter(|_| !self.wall.is_zero())?;
        Some(worked.as_secs_f64() / self.wall.as_secs_f64())
    }
}

/// Runs all cases in turn, `repeats` times after a run that does not count, and returns their figures. `seen` is told the
/// share of the runs that is done; where it returns false, the repeats that are whole are all there are.
pub fn measure(mut cases: Vec<Case<'_>>, repeats: usize, mut seen: impl FnMut(f64) -> bool) -> Vec<Figure> {
    let all = cases.len() * (repeats + 1);
    let mut done = 0;
    let mut logs: Vec<Log> = cases.iter().map(|_| Log::default()).collect();
    'repeats: for repeat in 0..=repeats {
        let mut round = Vec::with_capacity(cases.len());
        for case in &mut cases {
            let (cpu, start) = (cpu::time(), Instant::now());
            let run = (case.run)();
            let wall = start.elapsed();
            let worked = cpu::time().zip(cpu).map(|(after, before)| after.saturating_sub(before));
            round.push((run, wall, worked));
            done += 1;
            if !seen(done as f64 / all as f64) {
                break 'repeats;
            }
        }
        if repeat > 0 {
            logs.iter_mut().zip(round).for_each(|(log, (run, wall, worked))| log.add(run, wall, worked));
        }
    }
    let of = |(case, log): (Case<'_>, Log)| {
        let names = case.figures.into_iter().enumerate();
        let busy = log.busy().filter(|_| !case.elsewhere);
        names.map(move |(k, (name, unit))| Figure { name, unit, values: log.column(k), busy })
    };
    cases.into_iter().zip(logs).flat_map(of).collect()
}

/// Times short work: as many passes at once as take long enough.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    passes: Option<usize>,
}

impl Pace {
    /// Seconds of one pass of `work`, which does as many as it is told.
    pub fn seconds(&mut self, mut work: impl FnMut(usize)) -> f64 {
        let mut time = |passes: usize| {
            let start = Instant::now();
            work(passes);
            start.elapsed().as_secs_f64().max(1e-9)
        };
        let passes = *self.passes.get_or_insert_with(|| {
            // A slow moment in a short pass would tell too little of the next ones: the best of some.
            let mut seconds = f64::INFINITY;
            for _ in 0..WARM_UPS {
                seconds = seconds.min(time(1));
                if seconds >= SHORTEST.as_secs_f64() {
                    break;
                }
            }
            (SHORTEST.as_secs_f64() / seconds).ceil().max(1.0) as usize
        });
        time(passes) / passes as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(unit: Unit, values: &[f64]) -> Figure {
        Figure { name: String::new(), unit, values: values.to_vec(), busy: None }
    }

    #[test]
    fn median_best_and_spread() {
        let odd = figure(Unit::Mrays, &[4.0, 1.0, 2.0]);
        assert_eq!((odd.median(), odd.best(), odd.spread()), (2.0, 4.0, 1.5));
        assert_eq!(figure(Unit::Nanoseconds, &[4.0, 1.0, 2.0]).best(), 1.0);
        assert_eq!(figure(Unit::Mrays, &[4.0, 1.0, 2.0, 3.0]).median(), 2.5);
        let none = figure(Unit::Mrays, &[]);
        assert_eq!((none.median(), none.best(), none.spread()), (0.0, 0.0, 0.0));
    }

    #[test]
    fn units_have_names_of_their_own() {
        for (unit, name) in Unit::ALL {
            assert_eq!((Unit::from_name(name), unit.name()), (Some(unit), name));
        }
    }

    #[test]
    fn cases_take_turns_and_the_first_run_does_not_count() {
        let order = std::cell::RefCell::new(Vec::new());
        let case = |id: f64| {
            let (order, mut runs) = (&order, 0.0);
            let run = move || {
                order.borrow_mut().push(id);
                runs += 1.0;
                vec![id, runs]
            };
            Case::new(vec![(format!("{id}"), Unit::Mrays), (format!("{id} runs"), Unit::Mrays)], run)
        };
        let figures = measure(vec![case(1.0), case(2.0)], 2, |_| true);
        assert_eq!(*order.borrow(), [1.0, 2.0, 1.0, 2.0, 1.0, 2.0]);
        let values: Vec<_> = figures.iter().map(|f| f.values.clone()).collect();
        assert_eq!(values, [[1.0, 1.0], [2.0, 3.0], [2.0, 2.0], [2.0, 3.0]]);

        // Stopped in the midst of the second repeat: one is whole.
        let mut left = 5;
        let cut = measure(vec![case(1.0), case(2.0)], 2, |_| {
            left -= 1;
            left > 0
        });
        assert_eq!(cut.iter().map(|f| f.values.len()).collect::<Vec<_>>(), [1; 4]);
    }

    #[test]
    fn work_of_other_processes_keeps_no_cpu_of_this_one_busy() {
        let case = || Case::new(vec![(String::new(), Unit::Mrays)], || vec![1.0]);
        let figures = measure(vec![case(), case().elsewhere()], 1, |_| true);
        let [own, other] = figures.as_slice() else { panic!("two figures") };
        assert_eq!((own.busy.is_some(), other.busy), (cfg!(target_os = "linux"), None));
    }

    #[test]
    fn short_work_is_done_several_times() {
        let (mut pace, mut passes) = (Pace::default(), Vec::new());
        pace.seconds(|n| {
            passes.push(n);
            std::thread::sleep(Duration::from_millis(20) * n as u32);
        });
        assert_eq!(passes[..3], [1, 1, 1]);
        assert!((2..=5).contains(&passes[3]) && passes.len() == 4, "{passes:?}");
        pace.seconds(|n| passes.push(n));
        assert_eq!(passes[4], passes[3], "later runs do as many");
    }
}
