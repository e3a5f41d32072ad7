//! The clock in the stages: what they took, and for timelines what a worker did when.

use super::counters::since;
use super::{Asked, Counted, Counters, Probe, Seen, Stage, StageTimes};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// What takes time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// A stage of a wave.
    Stage(Stage),
    /// A worker's visit of a tile: samples of its pixels.
    Visit,
    /// Light paths.
    Light,
    /// Light paths before the render, which show where focused light arrives.
    Survey,
    /// Waiting for others to add to the film, and adding to it.
    Merge,
}

impl What {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stage(stage) => stage.name(),
            Self::Visit => "visit",
            Self::Light => "light paths",
            Self::Survey => "survey",
            Self::Merge => "merge",
        }
    }
}

/// Something that took time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// What it was.
    pub what: What,
    /// When it began: a stage, at the end of the one before it.
    pub start: Instant,
    /// How long it took.
    pub length: Duration,
    /// Rows that a stage ran on.
    pub items: u32,
    /// Number of the period in which it began.
    pub period: u32,
}

/// Microseconds of a period, as a power of 2: stages of a period are kept or left out together, by all workers.
const PERIOD: u32 = 13;
/// Events of a worker that are kept at most; beyond, stages are kept in every second period only, then in every fourth.
const MOST: usize = 1 << 17;

/// When the first period of this process began.
fn origin() -> Instant {
    static ORIGIN: OnceLock<Instant> = OnceLock::new();
    *ORIGIN.get_or_init(Instant::now)
}

fn period_of(start: Instant) -> u32 {
    (start.saturating_duration_since(origin()).as_micros() >> PERIOD) as u32
}

/// When a period begins and ends.
pub fn period(number: u32) -> [Instant; 2] {
    [0, 1].map(|next| origin() + Duration::from_micros((u64::from(number) + next) << PERIOD))
}

/// Sums up the time of each stage that has rows; where a timeline is asked for, notes when everything began and how long it took, too.
/// A stage begins where the one before ended: what little goes on between, stages without rows too, is the later one's.
#[derive(Debug, Default)]
pub struct Clock {
    times: StageTimes,
    counters: Option<Counters>,
    timeline: bool,
    /// When the stage before ended; none where a span of work begins or ends, where the wave was looked at, and where counters are
    /// read between.
    last: Option<Instant>,
    events: Vec<Event>,
    /// Stages are kept in periods whose number is a multiple of 2 to this power.
    sparse: u32,
}

impl Clock {
    /// Notes that a stage ran, which began at `start`. Out of line: there are many calls, each once in a batch.
    #[inline(never)]
    fn note(&mut self, stage: Stage, items: usize, start: Instant, before: Option<Counted>) {
        let end = Instant::now();
        let length = end.saturating_duration_since(start);
        self.last = self.counters.is_none().then_some(end);
        let counted = self.counters.as_mut().zip(before).map(|(counters, before)| since(&before, &counters.read()));
        self.times.note(stage, items, length, counted);
        if self.timeline {
            self.keep(What::Stage(stage), start, length, items);
        }
    }
    /// Notes an event, if those of its kind and period are kept.
    fn keep(&mut self, what: What, start: Instant, length: Duration, items: usize) {
        let event = Event { what, start, length, items: items as u32, period: period_of(start) };
        if is_kept(&event, self.sparse) {
            self.push(event);
        }
    }
    fn push(&mut self, event: Event) {
        self.events.push(event);
        while self.events.len() > MOST && self.sparse < 31 {
            self.sparse += 1;
            let sparse = self.sparse;
            self.events.retain(|event| is_kept(event, sparse));
        }
    }
}

fn is_kept(event: &Event, sparse: u32) -> bool {
    !matches!(event.what, What::Stage(_) | What::Merge) || event.period.trailing_zeros() >= sparse
}

/// Leaves out stages of more and more periods, and then all else in them, until there are `most` events at most.
pub fn thin(events: &mut Vec<Event>, most: usize) {
    for sparse in 1..32 {
        if events.len() <= most {
            return;
        }
        events.retain(|event| is_kept(event, sparse));
    }
    for sparse in 1..32 {
        if events.len() <= most {
            return;
        }
        events.retain(|event| event.period.trailing_zeros() >= sparse);
    }
}

impl Probe for Clock {
    fn new(asked: Asked) -> Self {
        let counters = if asked.counters { Counters::open().ok() } else { None };
        origin();
        Self { counters, timeline: asked.timeline, ..Self::default() }
    }
    #[inline(always)]
    fn stage<T>(&mut self, stage: Stage, items: usize, work: impl FnOnce() -> T) -> T {
        if items == 0 {
            return work();
        }
        let before = self.counters.as_mut().map(Counters::read);
        let start = self.last.unwrap_or_else(Instant::now);
        let result = work();
        self.note(stage, items, start, before);
        result
    }
    fn span<T>(&mut self, what: What, work: impl FnOnce(&mut Self) -> T) -> T {
        self.last = None;
        if !self.timeline {
            let result = work(self);
            self.last = None;
            return result;
        }
        let start = Instant::now();
        let result = work(self);
        self.last = None;
        self.keep(what, start, start.elapsed(), 0);
        result
    }
    #[inline(always)]
    fn wave(&mut self, depths: &[u32], fresh: usize) {
        self.times.wave(depths, fresh);
        self.last = None;
    }
    fn seen(self) -> Seen {
        Seen { stages: self.times.rows().to_vec(), events: self.events }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_lie_in_their_spans() {
        let mut probe = Clock::new(Asked { timeline: true, counters: false });
        probe.span(What::Visit, |probe| {
            probe.stage(Stage::Shade, 3, || ());
            probe.stage(Stage::Emit, 0, || ());
            probe.span(What::Merge, |_| ());
        });
        probe.span(What::Light, |probe| probe.stage(Stage::Scatter, 5, || ()));
        let seen = probe.seen();
        let names: Vec<_> = seen.events.iter().map(|e| (e.what.name(), e.items)).collect();
        let expected = [("shade", 3), ("merge", 0), ("visit", 0), ("scatter", 5), ("light paths", 0)];
        assert_eq!(names, expected);
        let [shade, _, visit, scatter, light] = seen.events[..] else { panic!("five events") };
        assert!(light.start <= scatter.start && scatter.start + scatter.length <= light.start + light.length);
        // On no rows nothing ran.
        assert_eq!(seen.stages.iter().map(|row| row.calls).sum::<u64>(), 2);
        assert!(visit.start <= shade.start && shade.start + shade.length <= visit.start + visit.length);
        assert_eq!(seen.stages.iter().map(|row| row.items).sum::<u64>(), 8);
    }

    /// Stages touch, but for where something else goes on between.
    #[test]
    fn a_stage_begins_where_the_one_before_ended() {
        let mut probe = Clock::new(Asked { timeline: true, counters: false });
        let pause = || std::thread::sleep(Duration::from_millis(2));
        probe.span(What::Visit, |probe| {
            probe.stage(Stage::Generate, 3, pause);
            probe.wave(&[0, 0, 0], 3);
            pause();
            probe.stage(Stage::Intersect, 3, pause);
            probe.stage(Stage::Route, 0, pause);
            probe.stage(Stage::Shade, 3, pause);
            pause();
        });
        pause();
        probe.span(What::Visit, |probe| probe.stage(Stage::Accumulate, 3, pause));
        let events = probe.seen().events;
        let [generate, intersect, shade, visit, accumulate, last] = events[..] else { panic!("{events:?}") };
        assert!(
            generate.start + generate.length < intersect.start && intersect.start + intersect.length == shade.start
        );
        assert!(
            shade.length >= 2 * Duration::from_millis(2) && shade.start + shade.length < visit.start + visit.length
        );
        assert!(visit.start + visit.length < last.start && last.start <= accumulate.start);
    }

    #[test]
    fn periods_follow_each_other() {
        let [start, end] = period(7);
        assert_eq!([start, end - Duration::from_nanos(1), end].map(period_of), [7, 7, 8]);
    }

    #[test]
    fn long_renders_keep_all_spans_and_stages_of_some_periods() {
        let mut probe = Clock::new(Asked { timeline: true, counters: false });
        let (periods, visits, stages) = (1_000, 20, 10);
        for number in 0..periods {
            let [start, _] = period(number);
            for _ in 0..visits {
                (0..stages).for_each(|_| probe.keep(What::Stage(Stage::Shade), start, Duration::ZERO, 1));
                probe.keep(What::Visit, start, Duration::ZERO, 0);
            }
        }
        let events = probe.seen().events;
        let number = |events: &[Event], what: What| events.iter().filter(|e| e.what == what).count();
        let of_stages = |period: u32| events.iter().filter(|e| e.period == period && e.items > 0).count();
        assert!(events.len() <= MOST, "{}", events.len());
        assert_eq!(number(&events, What::Visit), periods as usize * visits);
        // Every second one is whole.
        let kept: Vec<usize> = (0..periods).map(of_stages).collect();
        assert!(kept.chunks(2).all(|pair| pair == [visits * stages, 0]), "{kept:?}");

        let mut fewer = events.clone();
        thin(&mut fewer, 30_000);
        assert!(fewer.len() <= 30_000 && number(&fewer, What::Visit) == periods as usize * visits);
        thin(&mut fewer, 1_000);
        assert!((500..=1_000).contains(&fewer.len()), "{}", fewer.len());
    }
}
