//! Paths aimed at mirrors and glass: focused light on surfaces that light paths cannot show.
//!
//! A light path cannot be connected to the camera from a surface that is seen in a mirror or through glass. Where focused
//! light is known to arrive there, a second path is sent to where it comes from, with a density that is known; it goes on
//! while it meets delta lobes alone, and brings what the lamp that it ends on radiates. The path that scatters as usual finds
//! the same light by chance. Both choose the first direction, with densities p and q, and share all that follows, so that
//! the power heuristic of p and q weighs them (Veach 1997, equation 9.13). Only some paths look, the others count for none:
//! p is the density of aiming times the chance to do so, which depends on what came before alone.

use crate::accel::Tiles;
use crate::columns::Rows;
use crate::lanes::{Frame, Kernel, Lanes, LanesU32, MAX_LANES, Mask, Vec3, Wide, dispatch};
use crate::light::Spots;
use crate::material::{Kind, Lobe, Materials, Table, for_kind};
use crate::probe::{Probe, Stage};
use crate::sampling::{Decision, Sampler, State, power_heuristic_over_pdf};
use crate::wave::compact::Compact;
use crate::wave::emit::Emit;
use crate::wave::intersect::Intersect;
use crate::wave::queues::{HitRow, Path, Queues, Scale};
use crate::wave::route::Route;
use crate::wave::shade::{Shade, eval, params};
use crate::wave::surface::Surface;
use crate::wave::{Context, Counts, Plan, Samples};
use crate::world::World;
use std::marker::PhantomData;

/// Which paths look for focused light from the surface that they hit.
#[derive(Clone, Copy, Debug)]
pub struct Aims<L: Lanes> {
    /// How likely each was to look: 0 where light paths find that light, or none arrives.
    pub chance: L,
    /// Which do.
    pub chosen: L::Mask,
    /// State of the random numbers of the second path.
    pub rng: State<L>,
}

impl<L: Lanes> Aims<L> {
    /// None of a group of paths.
    #[inline(always)]
    pub fn none(path: &Path<L>) -> Self {
        Self { chance: L::splat(0.0), chosen: L::Mask::splat(false), rng: path.rng }
    }
}

/// The chance to look, from `origin`, where rays leave the surface. Light paths show all that a camera ray hits, and what
/// lies beyond where `first`, the density of the path's first bounce before this one, is finite.
#[inline(always)]
fn chance<L: Lanes>(spots: &Spots, path: &Path<L>, scale: L, first: L, origin: Vec3<L>) -> L {
    let unseen = L::from_u24(path.depth).gt(L::splat(0.0)) & L::splat(f32::INFINITY).le(first);
    if !unseen.any() {
        return L::splat(0.0);
    }
    L::select(unseen, spots.chance(origin, path.throughput.max_component() / scale), L::splat(0.0))
}

/// Decides which of a group of paths look: `path` as it hit the surface.
#[inline(always)]
pub fn aims<S: Sampler, L: Lanes>(spots: &Spots, path: &Path<L>, scale: L, first: L, origin: Vec3<L>) -> Aims<L> {
    let chance = chance(spots, path, scale, first, origin);
    let possible = chance.gt(L::splat(0.0));
    if !possible.any() {
        return Aims { chance, chosen: possible, rng: path.rng };
    }
    let mut rng = S::fork::<L>(&path.rng);
    let [coin] = S::draw::<L, 1>(&mut rng, Decision::Roulette, path.depth);
    Aims { chance, chosen: coin.lt(chance), rng }
}

/// For a path that hit a delta lobe, [`First::aimed`](crate::wave::queues::First) after it: the density of aiming into the direction in which it left
/// the last finite surface, over that of scattering. `aimed` is what it was before: the chance, where the path comes from
/// that surface.
#[inline(always)]
pub fn ratio<L: Lanes>(spots: &Spots, path: &Path<L>, aimed: L) -> L {
    let zero = L::splat(0.0);
    let fresh = path.prev_pdf.lt(L::splat(f32::INFINITY)) & aimed.gt(zero);
    if !fresh.any() {
        return aimed;
    }
    let density = spots.pdf(path.origin, path.direction) / path.prev_pdf.max(L::splat(f32::MIN_POSITIVE));
    L::select(fresh, aimed * density, aimed)
}

/// A group of paths that look, on their way.
#[derive(Clone, Copy, Debug)]
pub struct Aimed<L: Lanes> {
    /// The paths, with the weight of what they may find.
    pub path: Path<L>,
    /// Their throughput over the share of energy that is left of them.
    pub scale: L,
    /// Which are worth a ray.
    pub worth: L::Mask,
}

/// Sends paths from surfaces of kind `M`: `path` as it hit them, with the numbers that [`aims`] gave it.
#[inline(always)]
pub fn aim_rows<M: Lobe, S: Sampler, L: Lanes>(
    world: &World,
    spots: &Spots,
    mut path: Path<L>,
    scale: L,
    hit: &HitRow<L>,
) -> Aimed<L>
where
    Materials: Table<M>,
{
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let p = params::<M, L>(world, hit);
    let wo = -path.direction;
    let surface = Surface::new(world, hit, wo);
    let frame = Frame::about(surface.ns);
    let origin = surface.spawn(L::Mask::splat(false));
    // That the path looks says that light paths do not show this.
    let chance = chance(spots, &path, scale, L::splat(f32::INFINITY), origin);
    let [u, v, pick] = S::draw::<L, 3>(&mut path.rng, Decision::Scatter, path.depth);
    let wi = spots.sample(origin, pick, [u, v]);
    let density = chance * spots.pdf(origin, wi);
    let lobe = eval::<M, L>(world.normals.is_some(), &p, &surface, &frame, frame.to_local(wo), wi);
    let energy = path.throughput.max_component() / scale;
    let throughput = path.throughput.scale(lobe.f_cos) * power_heuristic_over_pdf(one / density, lobe.pdf);
    let strength = throughput.max_component();
    let worth = wi.dot(surface.ng).gt(zero) & density.gt(zero) & strength.gt(zero);
    let depth = path.depth.add(L::Uint::splat(1));
    let path = Path { origin, direction: wi, throughput, prev_pdf: zero, depth, ..path };
    Aimed { path, scale: strength / energy, worth }
}

/// Sends all paths that look from surfaces of kind `M`.
struct Aim<'a, M, S> {
    q: &'a mut Queues,
    of: PhantomData<(M, S)>,
    kind: Kind,
    world: &'a World,
    spots: &'a Spots,
}

impl<M: Lobe, S: Sampler> Kernel for Aim<'_, M, S>
where
    Materials: Table<M>,
{
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, kind, world, spots, .. } = self;
        let list = std::mem::take(&mut q.by_kind[kind as usize]);
        for chunk in list.rows().chunks(MAX_LANES) {
            let rows = Rows::listed(chunk);
            let scale = q.scales.as_ref().map_or(W::splat(1.0), |scales| scales.scale(&rows));
            let out = aim_rows::<M, S, W>(world, spots, q.paths.gather(&rows), scale, &q.hits.gather(&rows));
            q.paths.scatter(&rows, out.path);
            if let Some(scales) = &mut q.scales {
                scales.scatter(&rows, Scale { scale: out.scale });
            }
            q.end(&rows, !out.worth.bits());
        }
        q.by_kind[kind as usize] = list;
    }
}

/// Sends the paths in `q`, which look from the surfaces that they hit, and follows them to their ends.
pub(in crate::wave) fn follow<S: Sampler>(
    cx: &Context<'_>,
    plan: &Plan,
    q: &mut Queues,
    tracer: &mut Tiles,
    samples: &mut Samples,
    probe: &mut impl Probe,
    counts: &mut Counts,
) {
    let Context { world, bvh, spots, .. } = *cx;
    let mut cut = Counts::default();
    let n = q.paths.len();
    probe.stage(Stage::Route, n, || dispatch(Route { q, world, plan, counts: &mut cut }));
    for &kind in plan.kinds.iter().filter(|kind| !kind.is_delta()) {
        let hits = q.by_kind[kind as usize].len();
        for_kind!(kind, M => {
            let of = PhantomData::<(M, S)>;
            probe.stage(Stage::Aim, hits, || dispatch(Aim { q, of, kind, world, spots }))
        });
    }
    probe.stage(Stage::Compact, n, || dispatch(Compact { q, shaded: true }));
    let mut bounced = false;
    while !q.paths.is_empty() {
        let n = q.paths.len();
        counts.bounce += n as u64;
        probe.stage(Stage::Intersect, n, || dispatch(Intersect { q, bvh, tracer, fresh: n }));
        probe.stage(Stage::Route, n, || dispatch(Route { q, world, plan, counts: &mut cut }));
        if bounced {
            // A lamp in plain sight is a matter of connections.
            let hits = q.by_kind[Kind::Luminous as usize].len();
            probe.stage(Stage::Emit, hits, || dispatch(Emit { q, world, plan, samples }));
        }
        bounced = true;
        for &kind in &plan.kinds {
            if !kind.is_delta() {
                q.end_all(kind);
                continue;
            }
            let hits = q.by_kind[kind as usize].len();
            for_kind!(kind, M => {
                let of = PhantomData::<(M, S)>;
                probe.stage(Stage::Shade, hits, || dispatch(Shade { q, of, kind, world, plan, spots }))
            });
        }
        probe.stage(Stage::Compact, n, || dispatch(Compact { q, shaded: true }));
    }
}
