//! `--trace`: a timeline in the Trace Event Format, which Perfetto and chrome://tracing open.

use std::fmt::Write;
use std::time::{Duration, Instant};
use wavetrace::probe::{Event, What, thin};

/// Events of all workers at most: some 40 MB.
const MOST: usize = 400_000;
/// Number of the thread that reads, builds and writes.
const MAIN: usize = 0;

/// A part of the whole run.
#[derive(Clone, Copy, Debug)]
pub struct Phase {
    /// Its name.
    pub name: &'static str,
    /// When it began.
    pub start: Instant,
    /// How long it took.
    pub length: Duration,
}

/// The document: phases on a thread of their own, below them the workers. Times are in microseconds from the first phase on. Each event
/// ends a nanosecond early: viewers add start and length in floating point, and take what overlaps by a rounding error for neither within
/// nor beside the other.
pub fn text(workers: &[Vec<Event>], phases: &[Phase]) -> String {
    let Some(zero) = phases.iter().map(|phase| phase.start).min() else { return "{\"traceEvents\":[]}\n".to_owned() };
    let micros = |time: Duration| time.as_nanos() as f64 / 1e3;
    let length_of = |time: Duration| micros(time.saturating_sub(Duration::from_nanos(1)));
    let since = |start: Instant| micros(start.saturating_duration_since(zero));
    let mut out = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n".to_owned();
    // Writing to a string cannot fail.
    let mut name = |thread: usize, name: &str| {
        let _ =
            writeln!(out, r#"{{"ph":"M","pid":1,"tid":{thread},"name":"thread_name","args":{{"name":"{name}"}}}},"#);
    };
    name(MAIN, "program");
    (0..workers.len()).for_each(|k| name(k + 1, &format!("worker {}", k + 1)));
    for (thread, events) in workers.iter().enumerate() {
        let mut events = events.clone();
        thin(&mut events, MOST / workers.len());
        for event in events {
            let (start, length) = (since(event.start), length_of(event.length));
            let _ = write!(
                out,
                r#"{{"ph":"X","pid":1,"tid":{},"name":"{}","ts":{start:.3},"dur":{length:.3}"#,
                thread + 1,
                event.what.name()
            );
            if matches!(event.what, What::Stage(_)) {
                let _ = write!(out, r#","args":{{"items":{}}}"#, event.items);
            }
            out.push_str("},\n");
        }
    }
    for (k, phase) in phases.iter().enumerate() {
        let (start, length) = (since(phase.start), length_of(phase.length));
        let comma = if k + 1 < phases.len() { "," } else { "" };
        let _ = writeln!(
            out,
            r#"{{"ph":"X","pid":1,"tid":{MAIN},"name":"{}","ts":{start:.3},"dur":{length:.3}}}{comma}"#,
            phase.name
        );
    }
    out + "]}\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;
    use wavetrace::probe::{Asked, Clock, Probe, Stage};

    #[test]
    fn events_are_those_of_workers_and_phases() {
        let start = Instant::now();
        let mut probe = Clock::new(Asked { timeline: true, counters: false });
        probe.span(What::Visit, |probe| probe.stage(Stage::Shade, 7, || ()));
        let phases = [
            Phase { name: "load", start, length: Duration::from_millis(2) },
            Phase { name: "render", start: start + Duration::from_millis(2), length: Duration::from_millis(3) },
        ];
        let document: Value = serde_json::from_str(&text(&[probe.seen().events, Vec::new()], &phases)).unwrap();
        let events = document["traceEvents"].as_array().unwrap();
        let named = |name: &str| events.iter().find(|e| e["name"] == name && e["ph"] == "X").unwrap();
        assert_eq!(events.iter().filter(|e| e["ph"] == "M").count(), 3);
        assert_eq!((&named("shade")["tid"], &named("shade")["args"]["items"]), (&1.into(), &7.into()));
        assert_eq!((&named("render")["ts"], &named("render")["dur"]), (&2000.0.into(), &2999.999.into()));
        assert!(named("visit")["dur"].as_f64().unwrap() >= named("shade")["dur"].as_f64().unwrap());
    }
}
