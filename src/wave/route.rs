//! Sorts the rows of a wave by what they hit.

use super::Counts;
use super::plan::Plan;
use super::queues::Queues;
use crate::accel::Hit;
use crate::columns::Rows;
use crate::material::Kind;
use crate::world::World;

/// Fills the lists of rows. Paths that may bounce no more end here, and are counted.
pub fn route(q: &mut Queues, world: &World, plan: &Plan, counts: &mut Counts) {
    q.by_kind.iter_mut().for_each(Vec::clear);
    q.escaped.clear();
    for row in 0..q.paths.len() {
        let at = Rows::range(row, 1);
        let triangle = q.hits.triangle::<f32>(&at);
        let mut goes_on = false;
        if triangle == Hit::NONE {
            if plan.escape {
                q.escaped.push(row as u32);
            }
        } else {
            let kind = world.lobes[triangle as usize].kind();
            if kind == Kind::Luminous as usize {
                if plan.emit {
                    q.by_kind[kind].push(row as u32);
                }
            } else if q.paths.depth::<f32>(&at) < plan.max_depth {
                if !plan.sole_kind() {
                    q.by_kind[kind].push(row as u32);
                }
                goes_on = true;
            } else {
                counts.cut(q.paths.throughput::<f32>(&at));
            }
        }
        q.ended[row] = !goes_on;
    }
}
