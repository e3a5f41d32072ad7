//! Figures against those that were kept: what is slower, faster or unclear.

use super::saved::Saved;
use super::table::Table;
use crate::cli::units::{counted, short};
use serde_json::{Value, json};
use std::fmt::Write;
use wavetrace::bench::measure::median;
use wavetrace::bench::suite::YARDSTICKS;
use wavetrace::bench::verdict::{self, Compared, Verdict};
use wavetrace::bench::{Figure, Unit};

/// What came of a comparison.
pub struct Against {
    /// Each figure that both have, but for those of the machine itself.
    pub all: Vec<Compared>,
    /// How many figures of this run, and of those before, have no counterpart.
    alone: [usize; 2],
    /// The least and the largest speed of the machine itself over that before, and 1; where nothing before tells, none.
    drift: Option<(f64, f64)>,
}

/// What is compared: speeds of the program.
fn is_compared(figure: &Figure) -> bool {
    figure.unit != Unit::Percent && !is_yardstick(figure)
}

fn is_yardstick(figure: &Figure) -> bool {
    YARDSTICKS.contains(&figure.name.as_str())
}

fn is_same(a: &Figure, b: &Figure) -> bool {
    a.name == b.name && a.unit == b.unit
}

impl Against {
    /// Compares; `tolerance` is a share.
    pub fn new(before: &Saved, figures: &[Figure], tolerance: f64) -> Self {
        let known = before.figures.iter().any(is_yardstick) && figures.iter().any(is_yardstick);
        let drift = known.then(|| verdict::drift(&before.figures, figures));
        let compare = |after: &Figure| {
            let before = before.figures.iter().find(|before| is_same(before, after))?;
            Some(verdict::compare(before, after, drift.unwrap_or((1.0, 1.0)), tolerance))
        };
        let all: Vec<_> = figures.iter().filter(|f| is_compared(f)).filter_map(compare).collect();
        let alone = |of: &[Figure]| of.iter().filter(|f| is_compared(f)).count().saturating_sub(all.len());
        Self { alone: [figures, &before.figures].map(alone), all, drift }
    }

    fn count(&self, verdict: Verdict) -> usize {
        self.all.iter().filter(|c| c.verdict == verdict).count()
    }

    /// Whether something is slower.
    pub fn is_slower(&self) -> bool {
        self.count(Verdict::Slower) > 0
    }

    /// For people; `tolerance` in per cent.
    pub fn text(&self, tolerance: f64) -> String {
        let mut table = Table::new(["what", "speed", "at least", "at most", "verdict"]);
        for c in self.all.iter().filter(|c| c.verdict != Verdict::Same) {
            let cells = [c.ratio, c.interval.0, c.interval.1].map(|x| format!("{x:.3}"));
            table.0.push([c.name.clone()].into_iter().chain(cells).chain([c.verdict.name().to_owned()]).collect());
        }
        let mut text = if table.0.len() > 1 { table.text() } else { String::new() };
        let ratios: Vec<f64> = self.all.iter().map(|c| c.ratio).collect();
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{}: {} slower, {} faster, {} the same within {} %, {} unclear; median speed {:.3} of that before",
            counted(self.all.len() as u64, "figure"),
            self.count(Verdict::Slower),
            self.count(Verdict::Faster),
            self.count(Verdict::Same),
            short(tolerance),
            self.count(Verdict::Unclear),
            median(&ratios)
        );
        if self.alone != [0, 0] {
            let [here, there] = self.alone;
            let _ = write!(text, "\nwithout a counterpart: {here} of this run, {there} of those before");
        }
        let _ = match self.drift {
            Some((1.0, 1.0)) => Ok(()),
            Some((least, most)) => write!(
                text,
                "\nthe machine itself has {least:.3} to {most:.3} of the speed that it had: what this may explain is unclear"
            ),
            None => write!(text, "\nwhether the machine itself has changed is not known: no figures of it were kept"),
        };
        text
    }

    /// For programs.
    pub fn json(&self) -> Value {
        let one = |c: &Compared| {
            json!({
                "name": c.name,
                "speed": c.ratio,
                "interval": [c.interval.0, c.interval.1],
                "verdict": c.verdict.name(),
            })
        };
        let drift = self.drift.map(|(least, most)| [least, most]);
        json!({"machine_speed": drift, "figures": self.all.iter().map(one).collect::<Vec<_>>()})
    }
}
