//! Light paths at surfaces of one kind: connects to the camera, chooses the next ray, plays roulette.

use super::camera::{Connection, SplatQueue, connection};
use crate::columns::Rows;
use crate::lanes::{Frame, Kernel, Lanes, MAX_LANES, Mask, Wide};
use crate::material::{Kind, Lobe, Materials, Table};
use crate::sampling::Sampler;
use crate::wave::plan::Plan;
use crate::wave::queues::{HitRow, Path, Queues};
use crate::wave::shade::{alive, draw, eval, params};
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
/// `wo` is where it goes. Radiance and what light paths carry are reversed by the factor |ng . wo| / |ng . wi| (Veach 1997,
/// equation 5.20), which differs from that of the lobe where normals are interpolated.
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
    let cos_wi = surface.ng.dot(wi).abs();

    let (connection, connected) = if M::DELTA {
        (Connection::none(&path), L::Mask::splat(false))
    } else {
        connection::<M, L>(world, plan, &p, &path, &surface, hit)
    };

    let scattered = M::sample(&p, local, surface.outside, draw::<M, S, L>(&mut path));
    let unfolded = frame.to_world(scattered.wi).normalize();
    let regular = surface.regular(unfolded, scattered.transmitted);
    let (wo, weight) = if M::DELTA {
        let cosines = (surface.ns.dot(wi) * surface.ng.dot(unfolded)).abs();
        let others = (surface.ns.dot(unfolded) * surface.ng.dot(wi)).abs();
        (unfolded, scattered.weight * (cosines / (others * scattered.radiance_scale)))
    } else {
        let wo = surface.fold(unfolded, scattered.transmitted);
        let weight = match &world.normals {
            // The lobe is reciprocal, and its samples weigh the same from both sides.
            None => scattered.weight,
            Some(_) => {
                let pdf = eval::<M, L>(world, &p, &surface, &frame, wi, wo).pdf;
                let seen = Surface::new(world, hit, wo);
                let value = eval::<M, L>(world, &p, &seen, &Frame::about(seen.ns), wo, wi).f_cos;
                value * (surface.ng.dot(wo).abs() / (cos_wi * pdf))
            }
        };
        (wo, weight)
    };
    path.throughput = path.throughput.scale(weight);
    // The first surface has to be one that light cannot be connected to, and light has to be able to go the other way.
    let of_use = if M::DELTA { regular } else { L::from_u24(path.depth).gt(L::splat(0.0)) };
    let lives = alive::<S, L>(&mut path, scale) & of_use & path.throughput.max_component().gt(L::splat(0.0));
    path.origin =
        if M::TRANSMITS { surface.spawn(scattered.transmitted) } else { surface.spawn(L::Mask::splat(false)) };
    path.direction = wo;
    Reversed { path, alive: lives, connection, connected }
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
