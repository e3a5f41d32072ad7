//! Sorts the rows of a wave by what they hit.

use super::Counts;
use super::plan::Plan;
use super::queues::{Queues, RowList};
use crate::columns::Rows;
use crate::lanes::{Kernel, LanesU32, MAX_LANES, Mask, Wide};
use crate::material::Kind;
use crate::world::World;

/// Fills the lists of rows. Paths that may bounce no more end here, and are counted.
pub struct Route<'a> {
    pub q: &'a mut Queues,
    pub world: &'a World,
    pub plan: &'a Plan,
    pub counts: &'a mut Counts,
}

impl Kernel for Route<'_> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        // A wave of one kind lists none, and does not ask for each register.
        if self.plan.sole_kind() { self.route::<W, false>() } else { self.route::<W, true>() }
    }
}

impl Route<'_> {
    #[inline(always)]
    fn route<W: Wide, const LISTED: bool>(self) {
        let Self { q, world, plan, counts } = self;
        q.by_kind.iter_mut().for_each(RowList::clear);
        q.escaped.clear();
        q.alive.clear();
        let deepest = W::splat(plan.max_depth as f32);
        let Plan { escape, emit, .. } = *plan;
        for first in (0..q.paths.len()).step_by(MAX_LANES) {
            let rows = Rows::range(first, MAX_LANES.min(q.paths.len() - first));
            let triangles = q.hits.triangle::<W>(&rows).array();
            // What hit nothing has a number that no triangle has.
            let mut kinds = [0; MAX_LANES];
            for (kind, &triangle) in kinds.iter_mut().zip(&triangles) {
                *kind = world.lobes.get(triangle as usize).map_or(Kind::COUNT, |lobe| lobe.kind()) as u32;
            }
            let kinds = W::from_u24(W::Uint::load(&kinds));
            let set = |kind: usize| kinds.eq(W::splat(kind as f32)).bits() & rows.live();
            let (escaped, luminous) = (set(Kind::COUNT), set(Kind::Luminous as usize));
            if escape {
                q.escaped.append::<W>(first, escaped);
            }
            if emit {
                q.by_kind[Kind::Luminous as usize].append::<W>(first, luminous);
            }
            let hit = rows.live() & !(escaped | luminous);
            let alive = hit & W::from_u24(q.paths.depth::<W>(&rows)).lt(deepest).bits();
            let mut cut = hit & !alive;
            while cut != 0 {
                let row = Rows::range(first + cut.trailing_zeros() as usize, 1);
                let scale = q.scales.as_ref().map_or(1.0, |scales| scales.scale(&row));
                counts.cut(q.paths.throughput::<f32>(&row) * (1.0 / scale));
                cut &= cut - 1;
            }
            if LISTED {
                for &kind in &plan.kinds {
                    q.by_kind[kind as usize].append::<W>(first, set(kind as usize) & alive);
                }
            }
            q.alive.push(alive as u8);
        }
    }
}
