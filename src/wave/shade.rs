//! Scattering at surfaces of one kind: connects to a light, chooses the next ray, plays roulette.

use super::caustic::aim::{Aims, aims, ratio};
use super::caustic::first::{first_density, reversible};
use super::form::{Focused, Form, Plain, Rich};
use super::plan::{Plan, PrevPdf};
use super::queues::{First, HitRow, Normal, Path, Queues, Scale, Shadow};
use super::roulette::alive;
use super::surface::{Surface, off_surface};
use crate::columns::Rows;
use crate::lanes::{Frame, Kernel, Lanes, LanesU32, MAX_LANES, Mask, Vec3, Wide, select3};
use crate::light::{Receiver, Spots};
use crate::material::{Evaluated, Kind, Lobe, Materials, Table};
use crate::sampling::{Decision, Sampler, power_heuristic_over_pdf};
use crate::world::World;
use std::marker::PhantomData;

/// What became of a group of paths.
#[derive(Clone, Copy, Debug)]
pub struct Shaded<L: Lanes> {
    /// The paths, one bounce on.
    pub path: Path<L>,
    /// Scale of their radiance.
    pub scale: L,
    /// Which go on.
    pub alive: L::Mask,
    /// Connections to lights.
    pub shadow: Shadow<L>,
    /// Which of them are worth a ray.
    pub connected: L::Mask,
    /// Unit geometric normal where the paths go on, on the side of `wo`.
    pub normal: Vec3<L>,
    /// What the weights of focused light need to know.
    pub first: First<L>,
    /// Which paths look for such light from here; none at delta lobes.
    pub aims: Aims<L>,
}

/// Density and value of the lobe in world direction `wi`, on the path's side of the surface. Where the scene is `smooth`, directions
/// that an interpolated normal would send into the surface are folded out of it: what is folded onto `wi` adds to it.
#[inline(always)]
pub(super) fn eval<M: Lobe, L: Lanes>(
    smooth: bool,
    p: &M::Params<L>,
    surface: &Surface<L>,
    frame: &Frame<L>,
    wo: Vec3<L>,
    wi: Vec3<L>,
) -> Evaluated<L> {
    let direct = M::eval(p, wo, frame.to_local(wi));
    if !smooth {
        return direct;
    }
    let folded = M::eval(p, wo, frame.to_local(surface.mirror(wi)));
    Evaluated { f_cos: direct.f_cos + folded.f_cos, pdf: direct.pdf + folded.pdf }
}

/// The materials of a group of hits on surfaces of kind `M`.
#[inline(always)]
pub(super) fn params<M: Lobe, L: Lanes>(world: &World, hit: &HitRow<L>) -> M::Params<L>
where
    Materials: Table<M>,
{
    let ids = hit.triangle.array();
    let rows = Table::<M>::rows(&world.materials);
    M::params(L::columns4(|i| &rows[world.lobes[ids.as_ref()[i] as usize].row()]))
}

/// The numbers that a direction of scattering takes.
#[inline(always)]
pub(super) fn draw<M: Lobe, S: Sampler, L: Lanes>(path: &mut Path<L>) -> [L; 3] {
    let zero = L::splat(0.0);
    match M::NUMBERS {
        0 => [zero; 3],
        1 => {
            let [a] = S::draw::<L, 1>(&mut path.rng, Decision::Scatter, path.depth);
            [a, zero, zero]
        }
        2 => {
            let [a, b] = S::draw::<L, 2>(&mut path.rng, Decision::Scatter, path.depth);
            [a, b, zero]
        }
        _ => S::draw::<L, 3>(&mut path.rng, Decision::Scatter, path.depth),
    }
}

/// One bounce of a group of paths at surfaces of kind `M`. Form `F` must have all that the plan needs.
#[inline(always)]
pub fn shade_rows<M: Lobe, S: Sampler, L: Lanes, F: Form>(
    world: &World,
    plan: &Plan,
    spots: &Spots,
    mut path: Path<L>,
    scale: L,
    mut first: First<L>,
    hit: &HitRow<L>,
) -> Shaded<L>
where
    Materials: Table<M>,
{
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let came = path;
    let p = params::<M, L>(world, hit);
    let wo_world = -path.direction;
    let normals = world.normals.as_deref().filter(|_| F::EXTRAS);
    let smooth = normals.is_some();
    let surface = Surface::with(world, normals, hit, wo_world);
    let frame = Frame::about(surface.ns);
    let wo = frame.to_local(wo_world);

    let mut shadow =
        Shadow { origin: path.origin, direction: path.direction, radiance: path.throughput, slot: path.slot };
    let mut connected = L::Mask::splat(false);
    if plan.connect && !M::DELTA {
        let origin = surface.spawn(L::Mask::splat(false));
        let u = S::draw::<L, 2>(&mut path.rng, Decision::Light, path.depth);
        let pick = if F::EXTRAS && world.lights.depend_on_receiver() {
            S::draw::<L, 1>(&mut path.rng, Decision::Pick, path.depth)[0]
        } else {
            zero
        };
        let light = world.lights.sample(&Receiver { point: origin, normal: surface.ng }, pick, u);
        // From where the light was sampled, as what a path meets by chance is weighted.
        let way = light.point - origin;
        let distance2 = way.length2();
        let wi = way * (one / distance2.sqrt());
        let cos_light = light.normal.dot(wi);
        let lobe = eval::<M, L>(smooth, &p, &surface, &frame, wo, wi);
        // One over the density per solid angle.
        let inverse = cos_light.abs() / (light.pdf_area * distance2);
        let weight = match plan.prev_pdf {
            PrevPdf::Density => power_heuristic_over_pdf(inverse, lobe.pdf),
            PrevPdf::Never | PrevPdf::Always => inverse,
        };
        let radiance = path.throughput.scale(lobe.f_cos).scale(light.radiance) * weight;
        let found = lobe.pdf.gt(zero) & light.pdf_area.gt(zero);
        connected = wi.dot(surface.ng).gt(zero) & found & radiance.max_component().gt(zero);
        let toward = select3(cos_light.gt(zero), -light.normal, light.normal);
        // The way itself is rounded too, by its own length.
        let end = off_surface(light.point, light.reach + distance2.sqrt(), toward);
        shadow = Shadow { origin, direction: end - origin, radiance, slot: path.slot };
    }

    let scattered = M::sample(&p, wo, surface.outside, draw::<M, S, L>(&mut path));
    let unfolded = frame.to_world(scattered.wi).renormalize();
    let wi = surface.fold(unfolded, scattered.transmitted);
    path.prev_pdf = match plan.prev_pdf {
        _ if M::DELTA => L::splat(f32::INFINITY),
        PrevPdf::Always => L::splat(f32::INFINITY),
        PrevPdf::Never => zero,
        PrevPdf::Density => eval::<M, L>(smooth, &p, &surface, &frame, wo, wi).pdf,
    };
    let mut look = Aims::none(&came);
    if F::FOCUS && plan.caustics() {
        if M::DELTA {
            first.aimed = ratio(spots, &came, first.aimed);
        } else {
            look = aims::<S, L>(spots, &came, scale, first.density, surface.spawn(L::Mask::splat(false)));
            first.aimed = look.chance;
            let density = first_density(&world.view, &surface, surface.point - path.origin, wi, path.prev_pdf);
            first.density = L::select(L::from_u24(path.depth).eq(zero), density, first.density);
        }
        let reversible = reversible(&surface, wo_world, unfolded, scattered.transmitted);
        first.density = L::select(reversible, first.density, L::splat(f32::INFINITY));
    }
    path.throughput = path.throughput.scale(scattered.weight);
    let scale = if M::TRANSMITS { scale * scattered.radiance_scale } else { scale };
    let alive = alive::<S, L>(&mut path, scale);
    path.origin =
        if M::TRANSMITS { surface.spawn(scattered.transmitted) } else { surface.spawn(L::Mask::splat(false)) };
    path.direction = wi;
    Shaded { path, scale, alive, shadow, connected, normal: surface.ng, first, aims: look }
}

/// One bounce of all paths that hit a surface of kind `M`: those listed, or all that are left where there is no other.
pub struct Shade<'a, M, S> {
    pub q: &'a mut Queues,
    pub of: PhantomData<(M, S)>,
    /// The number of `M`.
    pub kind: Kind,
    pub world: &'a World,
    pub plan: &'a Plan,
    pub spots: &'a Spots,
}

impl<M: Lobe, S: Sampler> Kernel for Shade<'_, M, S>
where
    Materials: Table<M>,
{
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        if self.plan.caustics() {
            self.rows::<W, Focused>();
        } else if !M::TRANSMITS && self.plan.is_plain(self.world) {
            self.rows::<W, Plain>();
        } else {
            self.rows::<W, Rich>();
        }
    }
}

impl<M: Lobe, S: Sampler> Shade<'_, M, S>
where
    Materials: Table<M>,
{
    #[inline(always)]
    fn rows<W: Wide, F: Form>(self) {
        let Self { q, kind, world, plan, spots, .. } = self;
        let far = world.is_far();
        if plan.sole_kind() {
            let mut kept = 0;
            for first in (0..q.paths.len()).step_by(MAX_LANES) {
                let rows = Rows::range(first, MAX_LANES.min(q.paths.len() - first));
                let next = first + MAX_LANES;
                if far && next < q.paths.len() {
                    world.prefetch(q.hits.triangle::<W>(&Rows::range(next, MAX_LANES.min(q.paths.len() - next))));
                }
                let out = shade_group::<M, S, W, F>(q, &rows, world, plan, spots);
                let bits = out.alive.bits() & rows.live();
                q.paths.put(kept, bits, out.path);
                if let Some(scales) = q.scales.as_mut().filter(|_| F::EXTRAS) {
                    scales.put(kept, bits, Scale { scale: out.scale });
                }
                if let Some(normals) = q.normals.as_mut().filter(|_| F::EXTRAS) {
                    normals.put(kept, bits, Normal { normal: out.normal });
                }
                if let Some(firsts) = q.firsts.as_mut().filter(|_| F::FOCUS) {
                    firsts.put(kept, bits, out.first);
                }
                kept += bits.count_ones() as usize;
            }
            q.truncate(kept);
            return;
        }
        let list = std::mem::take(&mut q.by_kind[kind as usize]);
        let mut chunks = list.rows().chunks(MAX_LANES).peekable();
        while let Some(chunk) = chunks.next() {
            let rows = Rows::listed(chunk);
            if let Some(next) = chunks.peek().filter(|_| far) {
                world.prefetch(q.hits.triangle::<W>(&Rows::listed(next)));
            }
            let out = shade_group::<M, S, W, F>(q, &rows, world, plan, spots);
            q.paths.scatter(&rows, out.path);
            if M::TRANSMITS
                && let Some(scales) = &mut q.scales
            {
                scales.scatter(&rows, Scale { scale: out.scale });
            }
            if let Some(firsts) = q.firsts.as_mut().filter(|_| F::FOCUS) {
                firsts.scatter(&rows, out.first);
            }
            if !M::DELTA
                && let Some(normals) = q.normals.as_mut().filter(|_| F::EXTRAS)
            {
                normals.scatter(&rows, Normal { normal: out.normal });
            }
            q.end(&rows, !out.alive.bits());
        }
        q.by_kind[kind as usize] = list;
    }
}

/// Shades a group of rows, and appends its shadow rays and the paths that look for focused light.
#[inline(always)]
fn shade_group<M: Lobe, S: Sampler, W: Wide, F: Form>(
    q: &mut Queues,
    rows: &Rows,
    world: &World,
    plan: &Plan,
    spots: &Spots,
) -> Shaded<W>
where
    Materials: Table<M>,
{
    let scale = q.scales.as_ref().filter(|_| F::EXTRAS).map_or(W::splat(1.0), |scales| scales.scale(rows));
    let first = q.firsts.as_ref().filter(|_| F::FOCUS).map_or(First::none(), |firsts| firsts.gather(rows));
    let (path, hit) = (q.paths.gather(rows), q.hits.gather(rows));
    let out = shade_rows::<M, S, W, F>(world, plan, spots, path, scale, first, &hit);
    if plan.connect && !M::DELTA {
        q.shadows.append(out.connected.bits() & rows.live(), out.shadow);
    }
    if F::FOCUS
        && !M::DELTA
        && let Some(aimed) = &mut q.aimed
    {
        aimed.begin(out.aims.chosen.bits() & rows.live(), Path { rng: out.aims.rng, ..path }, scale, hit);
    }
    out
}
