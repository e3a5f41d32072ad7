//! Radiance of lights that were hit.

use super::Samples;
use super::plan::Plan;
use super::queues::{First, HitRow, Path, Queues};
use crate::columns::Rows;
use crate::lanes::{Kernel, Lanes, LanesU32, MAX_LANES, Vec3, Wide};
use crate::light::Receiver;
use crate::material::Kind;
use crate::sampling::power_heuristic;
use crate::world::World;

/// What a path that hit a light adds to its sample: weighted against the density with which light sampling would have
/// chosen the point, seen from the path's last vertex, whose normal is `normal`; after a delta lobe against that of light
/// paths, where they could be the reverse of this one, whose first bounce is `first`, and against that of aimed paths.
#[inline(always)]
pub fn emitted_radiance<L: Lanes>(
    world: &World,
    plan: &Plan,
    path: &Path<L>,
    normal: Vec3<L>,
    first: &First<L>,
    hit: &HitRow<L>,
) -> Vec3<L> {
    let ids = hit.triangle.array();
    let id = |i: usize| ids.as_ref()[i] as usize;
    let row = |i: usize| world.lobes[id(i)].row();
    let [a, b, c] = Vec3::triple(|i| &world.corners[id(i)]);
    let (e1, e2) = (b - a, c - a);
    let to_point = (a - path.origin) + e1 * hit.u + e2 * hit.v;
    let cos = e1.cross(e2).normalize().dot(path.direction).abs();
    let (radiance, light_pdf) = world.lights.seen(row, &Receiver { point: path.origin, normal }, to_point, cos);
    let mut weight = power_heuristic(path.prev_pdf, light_pdf);
    if plan.caustics() {
        let density = world.lights.emission_density(&world.targets, row, path.origin + to_point, -path.direction, cos);
        let reverse = power_heuristic(first.density, density * L::splat(plan.light_paths));
        let focused = reverse * power_heuristic(L::splat(1.0), first.aimed);
        weight = weight * L::select(path.prev_pdf.lt(L::splat(f32::INFINITY)), L::splat(1.0), focused);
    }
    path.throughput.scale(radiance) * weight
}

/// Adds the emitted radiance to the samples of all paths that hit a light.
pub struct Emit<'a> {
    pub q: &'a Queues,
    pub world: &'a World,
    pub plan: &'a Plan,
    pub samples: &'a mut Samples,
}

impl Kernel for Emit<'_> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, world, plan, samples } = self;
        for chunk in q.by_kind[Kind::Luminous as usize].rows().chunks(MAX_LANES) {
            let rows = Rows::listed(chunk);
            let path = q.paths.gather::<W>(&rows);
            let normal = q.normals.as_ref().map_or(Vec3::splat([0.0; 3]), |normals| normals.normal(&rows));
            let first = q.firsts.as_ref().map_or(First::none(), |firsts| firsts.gather(&rows));
            let radiance = emitted_radiance(world, plan, &path, normal, &first, &q.hits.gather(&rows));
            samples.add(rows.live(), path.slot, radiance);
        }
    }
}
