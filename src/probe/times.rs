//! Calls, rows and time of each stage, in all and by the number of bounces.

use super::{Counted, Stage};
use crate::lanes::MAX_LANES;
use std::time::Duration;

/// Numbers of bounces that are told apart: the last stands for itself and all above.
pub const DEPTHS: usize = 16;

/// Of rows that have bounced, one in so many tells how often rows have.
const EVERY: usize = 16;

/// What a stage did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageRow {
    /// Which stage.
    pub stage: Stage,
    /// How often it ran, on any rows.
    pub calls: u64,
    /// Rows that it ran on, in all.
    pub items: u64,
    /// Lanes that were spent on them: each run takes its rows eight at a time.
    pub lanes: u64,
    /// Time spent in it and since the stage before it, summed over threads.
    pub time: Duration,
    /// What hardware counters counted in it, summed over threads; `None` where none was read.
    pub counted: Option<Counted>,
    /// The same by the number of bounces of the paths; all 0 for stages whose rows have none.
    pub depths: [DepthRow; DEPTHS],
}

/// What a stage did for paths with the same number of bounces. A wave holds several, and each run of a stage is shared out
/// as the rows of its wave are, of which one in 16 is looked at: exact where waves are not [refilled](crate::wave::Tuning::refill), else an estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthRow {
    /// Rows.
    pub items: f64,
    /// Seconds, summed over threads.
    pub seconds: f64,
}

impl StageRow {
    fn new(stage: Stage) -> Self {
        let depths = [DepthRow::default(); DEPTHS];
        Self { stage, calls: 0, items: 0, lanes: 0, time: Duration::ZERO, counted: None, depths }
    }
    /// Share of the lanes that held a row; 1 where none were spent.
    pub fn occupancy(&self) -> f64 {
        if self.lanes == 0 { 1.0 } else { self.items as f64 / self.lanes as f64 }
    }
    /// Nanoseconds for each row; 0 without any.
    pub fn ns_per_item(&self) -> f64 {
        if self.items == 0 { 0.0 } else { self.time.as_secs_f64() * 1e9 / self.items as f64 }
    }
    fn count(&mut self, counted: Option<Counted>) {
        if let Some(counted) = counted {
            let sum = self.counted.get_or_insert_default();
            sum.iter_mut().zip(counted).for_each(|(sum, count)| *sum += count);
        }
    }
    /// Adds what the same stage did elsewhere.
    pub fn add(&mut self, other: &Self) {
        self.calls += other.calls;
        self.items += other.items;
        self.lanes += other.lanes;
        self.time += other.time;
        self.count(other.counted);
        for (sum, row) in self.depths.iter_mut().zip(&other.depths) {
            sum.items += row.items;
            sum.seconds += row.seconds;
        }
    }
}

/// Sums of calls, rows and time of each stage.
#[derive(Clone, Debug)]
pub struct StageTimes {
    rows: [StageRow; Stage::ALL.len()],
    /// Share of each number of bounces in the wave.
    shares: [f64; DEPTHS],
}

impl Default for StageTimes {
    fn default() -> Self {
        Self { rows: Stage::ALL.map(StageRow::new), shares: [0.0; DEPTHS] }
    }
}

impl StageTimes {
    /// Notes that a stage ran.
    pub(super) fn note(&mut self, stage: Stage, items: usize, time: Duration, counted: Option<Counted>) {
        let row = &mut self.rows[stage as usize];
        row.time += time;
        row.calls += 1;
        row.count(counted);
        row.items += items as u64;
        row.lanes += items.next_multiple_of(MAX_LANES) as u64;
        let (items, seconds) = (items as f64, time.as_secs_f64());
        match stage {
            // Paths begin there, before the wave is looked at.
            Stage::Generate | Stage::Start => {
                row.depths[0].items += items;
                row.depths[0].seconds += seconds;
            }
            // Samples are whole paths.
            Stage::Accumulate => {}
            _ => {
                for (sum, share) in row.depths.iter_mut().zip(&self.shares) {
                    sum.items += share * items;
                    sum.seconds += share * seconds;
                }
            }
        }
    }
}

impl StageTimes {
    /// Notes how many bounces the rows of the wave have whose stages follow; the last `fresh` ones have none. Of the others one in
    /// [`EVERY`] is looked at: all of them take 2 % of the time of a render with short paths.
    #[inline(never)]
    pub(super) fn wave(&mut self, depths: &[u32], fresh: usize) {
        let old = &depths[..depths.len() - fresh.min(depths.len())];
        // Several counts, because neighbours mostly have the same, and an addition has to wait for the one before.
        let mut counts = [[0u32; DEPTHS]; 4];
        for four in old.chunks(4 * EVERY) {
            for (count, &depth) in counts.iter_mut().zip(four.iter().step_by(EVERY)) {
                count[(depth as usize).min(DEPTHS - 1)] += 1;
            }
        }
        let seen = old.len().div_ceil(EVERY).max(1) as f64;
        let rows = depths.len().max(1) as f64;
        let count = |depth: usize| counts.iter().map(|count| count[depth]).sum::<u32>();
        self.shares = std::array::from_fn(|depth| f64::from(count(depth)) / seen * old.len() as f64 / rows);
        self.shares[0] += fresh as f64 / rows;
    }
    /// One row per stage.
    pub(super) fn rows(&self) -> &[StageRow] {
        &self.rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(times: &StageTimes, stage: Stage) -> StageRow {
        *times.rows().iter().find(|row| row.stage == stage).unwrap()
    }

    #[test]
    fn rows_fill_lanes_eight_at_a_time() {
        let mut probe = StageTimes::default();
        for items in [16, 9, 1] {
            probe.note(Stage::Shade, items, Duration::ZERO, Some([2, 3, 5, 7]));
        }
        let (none, row) = (row(&probe, Stage::Generate), row(&probe, Stage::Shade));
        assert_eq!((row.calls, row.items, row.lanes), (3, 26, 40));
        assert_eq!((row.counted, none.counted), (Some([6, 9, 15, 21]), None));
        let mut both = row;
        both.add(&none);
        both.add(&row);
        assert_eq!((both.items, both.counted), (52, Some([12, 18, 30, 42])));
        assert_eq!((row.occupancy(), none.occupancy(), none.ns_per_item()), (0.65, 1.0, 0.0));
    }

    #[test]
    fn rows_and_time_are_shared_out_by_bounces() {
        let mut probe = StageTimes::default();
        probe.note(Stage::Generate, 30, Duration::ZERO, None);
        // One path in four has bounced; of these one in 16 tells: once, or as often as is told apart or more.
        let [one, many] = [1, 99].map(|depth| [vec![depth], vec![7; EVERY - 1]].concat());
        let old = [one, many].concat().repeat(10);
        let fresh = 3 * old.len();
        probe.wave(&[old, vec![0; fresh]].concat(), fresh);
        probe.note(Stage::Shade, 16, Duration::from_secs(8), None);
        probe.note(Stage::Accumulate, 16, Duration::from_secs(8), None);
        let shade = row(&probe, Stage::Shade);
        let by = |depth: usize| (shade.depths[depth].items, shade.depths[depth].seconds);
        assert_eq!([0, 1, 2, DEPTHS - 1].map(by), [(12.0, 6.0), (2.0, 1.0), (0.0, 0.0), (2.0, 1.0)]);
        assert_eq!(row(&probe, Stage::Generate).depths[0].items, 30.0);
        assert!(row(&probe, Stage::Accumulate).depths.iter().all(|d| d.items == 0.0));
    }
}
