//! Where focused light arrives, seen by some light paths before the render.

use super::camera::SplatQueue;
use super::scatter::Scatter;
use super::start::Start;
use crate::accel::Tiles;
use crate::columns::Rows;
use crate::lanes::dispatch;
use crate::light::Arrival;
use crate::material::for_kind;
use crate::probe::{Probe, Stage};
use crate::sampling::Sampler;
use crate::wave::compact::Compact;
use crate::wave::intersect::Intersect;
use crate::wave::queues::{Path, Queues};
use crate::wave::route::Route;
use crate::wave::{Context, Counts};
use crate::world::World;
use std::marker::PhantomData;

/// Bounces after which a path shows nothing any more: between lossless mirrors it would go on to the limit of all paths, and
/// what so few of them find is found without knowing where to look.
const MOST_BOUNCES: u32 = 256;

/// Follows the light paths from number `first` on, `count` of them, over mirrors and glass to the first other surface.
/// Where they arrive, in their order.
pub fn survey<S: Sampler>(
    cx: &Context<'_>,
    first: u64,
    count: usize,
    probe: &mut impl Probe,
    counts: &mut Counts,
) -> Vec<Arrival> {
    let Context { world, bvh, seed, .. } = *cx;
    let mut plan = cx.plan.of_light_paths();
    plan.max_depth = plan.max_depth.min(MOST_BOUNCES);
    let plan = &plan;
    let q = &mut Queues::new(plan);
    // Nothing is connected to the camera.
    let to_camera = &mut SplatQueue::with_capacity(0);
    let tracer = &mut Tiles::new();
    tracer.restart();
    let mut cut = Counts::default();
    let (mut next, mut arrivals) = (0, Vec::new());
    loop {
        let fresh = (plan.wave_size - q.paths.len()).min(count - next);
        probe.stage(Stage::Start, fresh, || {
            dispatch(Start { q, world, sampler: PhantomData::<S>, seed, first, next, count: fresh });
        });
        next += fresh;
        let n = q.paths.len();
        if n == 0 {
            arrivals.sort_unstable_by_key(|(slot, _)| *slot);
            return arrivals.into_iter().map(|(_, arrival)| arrival).collect();
        }
        counts.light += n as u64;
        probe.stage(Stage::Intersect, n, || dispatch(Intersect { q, bvh, tracer, fresh: n }));
        probe.stage(Stage::Route, n, || dispatch(Route { q, world, plan, counts: &mut cut }));
        for &kind in &plan.kinds {
            if !kind.is_delta() {
                arrive(q, world, kind as usize, &mut arrivals);
                q.end_all(kind);
                continue;
            }
            let hits = q.by_kind[kind as usize].len();
            for_kind!(kind, M => {
                let of = PhantomData::<(M, S)>;
                probe.stage(Stage::Scatter, hits, || dispatch(Scatter { q, to_camera, of, kind, world, plan: cx.plan }))
            });
        }
        probe.stage(Stage::Compact, n, || dispatch(Compact { q, shaded: true }));
    }
}

/// Notes the light paths that hit surfaces of a kind, but for those that come from the lamp. Each arrives once at most.
fn arrive(q: &Queues, world: &World, kind: usize, arrivals: &mut Vec<(u32, Arrival)>) {
    for &row in q.by_kind[kind].rows() {
        let row = Rows::range(row as usize, 1);
        let Path { depth, origin, throughput, slot, .. } = q.paths.gather::<f32>(&row);
        let energy = throughput.max_component();
        if depth > 0 && energy > 0.0 {
            let hit = q.hits.gather::<f32>(&row);
            let [a, b, c] = world.corners[hit.triangle as usize];
            let w = 1.0 - hit.u - hit.v;
            let at = std::array::from_fn(|k| w * a[k] + hit.u * b[k] + hit.v * c[k]);
            arrivals.push((slot, Arrival { at, from: origin.lane(0), energy }));
        }
    }
}
