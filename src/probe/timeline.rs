//! The clock in the stages: what they took, and for timelines what a worker did when.

use super::counters::since;
use super::{Asked, Counted, Counters, Probe, Seen, Stage, StageTimes};
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
    /// In which of the worker's spans of work it lies.
    span: u32,
}

/// Events of a worker that are kept at most; beyond, stages are kept in every second span only, then in every fourth.
const MOST: usize = 1 << 17;

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
    /// Number of the span of work, and how many go on.
    span: u32,
    inside: u32,
    /// Stages are kept where the number is a multiple of 2 to this power.
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
        if self.timeline && self.span.trailing_zeros() >= self.sparse {
            self.push(Event { what: What::Stage(stage), start, length, items: items as u32, span: self.span });
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
    !matches!(event.what, What::Stage(_) | What::Merge) || event.span.trailing_zeros() >= sparse
}

/// Leaves out stages of more and more spans of work, and then of those spans, until there are `most` events at most.
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
        events.retain(|event| event.span.trailing_zeros() >= sparse);
    }
}

impl Probe for Clock {
    fn new(asked: Asked) -> Self {
        let counters = if asked.counters { Counters::open().ok() } else { None };
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
        self.inside += 1;
        let result = work(self);
        self.inside -= 1;
        self.last = None;
        let event = Event { what, start, length: start.elapsed(), items: 0, span: self.span };
        if is_kept(&event, self.sparse) {
            self.push(event);
        }
        if self.inside == 0 {
            self.span += 1;
        }
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
        let names: Vec<_> = seen.events.iter().map(|e| (e.what.name(), e.items, e.span)).collect();
        let expected = [("shade", 3, 0), ("merge", 0, 0), ("visit", 0, 0), ("scatter", 5, 1), ("light paths", 0, 1)];
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
    fn long_renders_keep_all_spans_and_stages_of_some() {
        let mut probe = Clock::new(Asked { timeline: true, counters: false });
        let spans = 20_000;
        for _ in 0..spans {
            probe.span(What::Visit, |probe| (0..10).for_each(|_| probe.stage(Stage::Shade, 1, || ())));
        }
        let Seen { stages: counted, events } = probe.seen();
        assert!(events.len() <= MOST, "{}", events.len());
        let visits = events.iter().filter(|e| e.what == What::Visit).count();
        assert_eq!(visits, spans);
        let stages: Vec<_> = events.iter().filter(|e| e.what != What::Visit).collect();
        assert!(stages.len() >= 10 * spans / 4 && stages.iter().all(|e| e.span % 2 == 0), "{}", stages.len());
        // What is counted is all of it.
        assert_eq!(counted.iter().map(|row| row.items).sum::<u64>(), 10 * spans as u64);

        let mut fewer = events.clone();
        thin(&mut fewer, 30_000);
        assert!(fewer.len() <= 30_000 && fewer.iter().filter(|e| e.what == What::Visit).count() == spans);
        thin(&mut fewer, 1_000);
        assert!((500..=1_000).contains(&fewer.len()), "{}", fewer.len());
    }
}
