//! Stages that compute in lanes have their lanes full. Nothing here is statistical: occupancy follows from the lengths of
//! queues, and these from the seed. Light paths are left out: this small image has too few of them to fill a wave.

mod common;

use common::worlds::rooms;
use common::{SAMPLERS, settings};
use wavetrace::probe::Stage;
use wavetrace::render::{Control, Settings};
use wavetrace::wave::Method;

#[test]
fn lanes_are_full_where_there_are_paths_enough() {
    for (name, renderer) in rooms([48, 48]) {
        // Light that is trapped in the coarse glass ball keeps a few paths of each job alive for hundreds of bounces.
        let least = if name == "delta" { 0.9 } else { 0.95 };
        for sampler in SAMPLERS {
            let timed =
                Settings { time_stages: true, threads: 1, light_paths: 0.0, ..settings(Method::Mis, sampler, 64, 2) };
            let rendered = renderer.render(&timed, &Control::default()).unwrap();
            for row in &rendered.stages {
                let occupancy = row.occupancy();
                assert!((0.0..=1.0).contains(&occupancy) && row.lanes >= row.items, "{name}: {row:?}");
                if matches!(row.stage, Stage::Generate | Stage::Intersect | Stage::Shade) {
                    assert!(row.items > 0 && occupancy >= least, "{name}, {sampler:?}: {occupancy} in {row:?}");
                }
            }
        }
    }
}
