//! Light paths at surfaces of one kind: connects to the camera, chooses the next ray, plays roulette.

use super::camera::{Connection, SplatQueue, connection};
use crate::columns::Rows;
use crate::lanes::{Frame, Kernel, Lanes, MAX_LANES, Mask, Wide};
use crate::material::{Kind, Lobe, Materials, Table};
use crate::sampling::Sampler;
use crate::wave::caustic::first::reversible;
use crate::wave::plan::Plan;
use crate::wave::queues::{HitRow, Path, Queues};
use crate::wave::roulette::alive;
use crate::wave::shade::{draw, params};
use crate::wave::surface::Surface;
use crate::world::World;
use std::marker::PhantomData;

/// What became of a group of light paths.
#[derive(Clone, Copy, Debug)]
pub struct Reversed<L: Lanes> {
    /// The paths, one bounce on.
    pub path: Path<L>,
    /// Which go on.
    pub alive: L::Mask,
    /// Connections to the camera.
    pub connection: Connection<L>,
    /// Which of them are worth a ray.
    pub connected: L::Mask,
}

/// One bounce of a group of light paths at surfaces of kind `M`. The surface is seen from `wi`, where the light comes from;
/// `wo` is where it goes. Sampled from there, a reciprocal lobe gives what it would from the other side, but for the cosines:
/// the factor is |ns . wi| |ng . wo| / (|ns . wo| |ng . wi|), 1 where normals are not interpolated (Veach 1997, section
/// 5.3.2). Light does not go on where the lobe would not be the same from the other side.
#[inline(always)]
pub fn scatter_rows<M: Lobe, S: Sampler, L: Lanes>(
    world: &World,
    plan: &Plan,
    mut path: Path<L>,
    scale: L,
    hit: &HitRow<L>,
) -> Reversed<L>
where
    Materials: Table<M>,
{
    let p = params::<M, L>(world, hit);
    let wi = -path.direction;
    let surface = Surface::new(world, hit, wi);
    let frame = Frame::about(surface.ns);
    let local = frame.to_local(wi);

    let (connection, connected) = if M::DELTA {
        (Connection::none(&path), L::Mask::splat(false))
    } else {
        connection::<M, L>(world, plan, &p, &path, &surface, hit)
    };

    let scattered = M::sample(&p, local, surface.outside, draw::<M, S, L>(&mut path));
    let wo = frame.to_world(scattered.wi).renormalize();
    let cosines = (surface.ns.dot(wi) * surface.ng.dot(wo)).abs();
    let others = (surface.ns.dot(wo) * surface.ng.dot(wi)).abs();
    path.throughput = path.throughput.scale(scattered.weight) * (cosines / (others * scattered.radiance_scale));
    // The first surface has to be one that light cannot be connected to.
    let of_use = if M::DELTA { L::Mask::splat(true) } else { L::from_u24(path.depth).gt(L::splat(0.0)) };
    let of_use = of_use & reversible(&surface, wi, wo, scattered.transmitted);
    let alive = alive::<S, L>(&mut path, scale) & of_use;
    path.origin =
        if M::TRANSMITS { surface.spawn(scattered.transmitted) } else { surface.spawn(L::Mask::splat(false)) };
    path.direction = wo;
    Reversed { path, alive, connection, connected }
}

/// One bounce of all light paths that hit a surface of kind `M`.
pub struct Scatter<'a, M, S> {
    pub q: &'a mut Queues,
    pub to_camera: &'a mut SplatQueue,
    pub of: PhantomData<(M, S)>,
    /// The number of `M`.
    pub kind: Kind,
    pub world: &'a World,
    /// The plan of camera paths.
    pub plan: &'a Plan,
}

impl<M: Lobe, S: Sampler> Kernel for Scatter<'_, M, S>
where
    Materials: Table<M>,
{
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, to_camera, kind, world, plan, .. } = self;
        let list = std::mem::take(&mut q.by_kind[kind as usize]);
        for chunk in list.rows().chunks(MAX_LANES) {
            let rows = Rows::listed(chunk);
            let scale = q.scales.as_ref().map_or(W::splat(1.0), |scales| scales.scale(&rows));
            let out = scatter_rows::<M, S, W>(world, plan, q.paths.gather(&rows), scale, &q.hits.gather(&rows));
            q.paths.scatter(&rows, out.path);
            if !M::DELTA {
                to_camera.append(out.connected.bits() & rows.live(), out.connection);
            }
            q.end(&rows, !out.alive.bits());
        }
        q.by_kind[kind as usize] = list;
    }
}
