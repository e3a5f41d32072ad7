//! Lights: luminous triangles as two-sided emitters, chosen by their importance at the point that they light, and sampled
//! by solid angle where they are near, by area elsewhere.

mod cover;
mod emission;
mod emitter;
mod few;
mod importance;
mod solid;
mod spots;
mod targets;
mod tree;

pub use cover::cover;
pub use emission::Emitted;
pub use emitter::{Emitter, LightTriangle, Shape};
pub use importance::Receiver;
pub use spots::{Arrival, Spots};
pub use targets::{Ball, MOST as TARGETS, Targets};

use crate::lanes::{Lanes, LanesU32, MAX_LANES, Mask, Vec3, select3};
use crate::sampling::warp;
use emission::ByPower;
use few::Few;
use importance::Bounds;
use solid::Sides;
use tree::Tree;

/// Emitters up to this number are told apart one by one.
const FEW: usize = 8;

/// Rec. 709 luminance.
pub fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

/// How an emitter is chosen.
#[derive(Clone, Debug, Default)]
enum Choice {
    /// There is no other.
    #[default]
    Only,
    Few(Few),
    Many(Tree),
}

/// A point on a light.
#[derive(Clone, Copy, Debug)]
pub struct LightPoint<L: Lanes> {
    /// The point.
    pub point: Vec3<L>,
    /// The largest coordinate of the emitter's corners: what rounding errors on it are proportional to.
    pub reach: L,
    /// Unit normal of the light's front side.
    pub normal: Vec3<L>,
    /// Emitted radiance, the same in all directions.
    pub radiance: Vec3<L>,
    /// Density of choosing the point, per area; 0 where no light was found that can be of use.
    pub pdf_area: L,
}

/// What the rows of emitters hold.
struct Chosen<L: Lanes> {
    sides: Sides<L>,
    normal: Vec3<L>,
    radiance: Vec3<L>,
    /// One over the area.
    density: L,
}

/// What a ray sees that hits a light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Seen {
    radiance: [f32; 3],
    /// One over the area of the emitter.
    density: f32,
    emitter: u32,
}

/// All emitters of a world, and how one is chosen.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    emitters: Vec<Emitter>,
    /// What sampling reads of each emitter, in one cache line: corner, edges, normal, radiance, and one over the area,
    /// negative where it is a triangle.
    rows: Vec<[[f32; 8]; 2]>,
    /// Per emitter, the largest coordinate of its corners.
    reaches: Vec<f32>,
    /// Per luminous triangle, black ones included.
    seen: Vec<Seen>,
    choice: Choice,
    by_power: ByPower,
    /// Per emitter, the density per area with which light paths start on it.
    starts: Vec<f32>,
}

impl Lights {
    /// Lights of the luminous triangles of a world, in their order.
    pub fn new(triangles: &[LightTriangle]) -> Self {
        let lit = |t: &LightTriangle| t.radiance.iter().any(|&r| r > 0.0);
        let shining: Vec<LightTriangle> = triangles.iter().filter(|t| lit(t)).copied().collect();
        let (emitters, of) = emitter::merge(&shining);
        let mut numbers = of.into_iter();
        let see = |t: &LightTriangle| match lit(t).then(|| numbers.next()).flatten() {
            Some(emitter) => {
                let area = emitters[emitter as usize].area();
                Seen { radiance: t.radiance, density: (1.0 / area) as f32, emitter }
            }
            None => Seen::default(),
        };
        let seen = triangles.iter().map(see).collect();
        let bounds: Vec<Bounds> = emitters.iter().map(Bounds::of).collect();
        let choice = match bounds.len() {
            0 | 1 => Choice::Only,
            2..=FEW => Choice::Few(Few::new(&bounds)),
            _ => Choice::Many(Tree::new(&bounds)),
        };
        let rows = emitters.iter().map(Self::row).collect();
        let reach = |e: &Emitter| e.corners().flatten().fold(0.0, |most: f32, c| most.max(c.abs()));
        let reaches = emitters.iter().map(reach).collect();
        let powers: Vec<f64> = emitters.iter().map(Emitter::power).collect();
        let by_power = ByPower::new(&powers);
        let starts = emitters.iter().map(|e| (luminance(e.radiance) * by_power.inverse) as f32).collect();
        Self { emitters, rows, reaches, seen, choice, by_power, starts }
    }
    fn row(e: &Emitter) -> [[f32; 8]; 2] {
        let ([ax, ay, az], [[ex, ey, ez], [fx, fy, fz]]) = (e.corner, e.edges);
        let ([nx, ny, nz], [r, g, b]) = (e.normal, e.radiance);
        let density = (1.0 / e.area()) as f32;
        let signed = if e.shape == Shape::Triangle { -density } else { density };
        [[ax, ay, az, ex, ey, ez, fx, fy], [fz, nx, ny, nz, r, g, b, signed]]
    }
    /// Number of emitters: two triangles that make up a parallelogram are one.
    pub fn len(&self) -> usize {
        self.emitters.len()
    }
    /// Whether nothing emits.
    pub fn is_empty(&self) -> bool {
        self.emitters.is_empty()
    }
    /// The emitters.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }
    /// Number of triangles that emit.
    pub fn triangles(&self) -> usize {
        self.seen.iter().filter(|s| s.density > 0.0).count()
    }
    /// Whether the point that is lit has a say in which emitter is chosen: then its normal is needed again where a ray
    /// from there hits a light.
    pub fn depend_on_receiver(&self) -> bool {
        !matches!(self.choice, Choice::Only)
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let choice = match &self.choice {
            Choice::Only => 0,
            Choice::Few(few) => few.bytes(),
            Choice::Many(tree) => tree.bytes(),
        };
        let numbers = size_of_val(&self.reaches[..]) + size_of_val(&self.starts[..]) + self.by_power.bytes();
        size_of_val(&self.emitters[..]) + size_of_val(&self.rows[..]) + size_of_val(&self.seen[..]) + numbers + choice
    }

    /// Chooses a point on a light: the emitter by the uniform number `pick`, where there is a choice, and the point by two
    /// others. There must be a light.
    #[inline(always)]
    pub fn sample<L: Lanes>(&self, from: &Receiver<L>, pick: L, u: [L; 2]) -> LightPoint<L> {
        let (number, chance) = match &self.choice {
            Choice::Only => (L::Uint::splat(0), L::splat(1.0)),
            Choice::Few(few) => few.pick(from, pick),
            Choice::Many(tree) => tree.pick(from, pick),
        };
        let emitter = self.chosen::<L>(number);
        let light = self.point_on(number, &emitter, u);
        let Chosen { sides, normal, .. } = &emitter;
        let near = sides.near(from.point, *normal);
        let light = if near.any() { Self::by_angle(light, near, sides, *normal, from.point, u) } else { light };
        LightPoint { pdf_area: chance * light.pdf_area, ..light }
    }
    /// Chooses anew where emitters are `near`.
    #[inline(always)]
    fn by_angle<L: Lanes>(
        by_area: LightPoint<L>,
        near: L::Mask,
        sides: &Sides<L>,
        normal: Vec3<L>,
        from: Vec3<L>,
        u: [L; 2],
    ) -> LightPoint<L> {
        let (solid, good) = sides.seen(from);
        let wi = solid.sample(u);
        let cos = normal.dot(wi);
        let distance = normal.dot(sides.corner - from) / cos;
        let pdf_area = cos.abs() / (solid.angle() * distance * distance);
        let use_it = near & good & distance.gt(L::splat(0.0)) & pdf_area.lt(L::splat(f32::INFINITY));
        LightPoint {
            point: select3(use_it, wi.mul_add(distance, from), by_area.point),
            pdf_area: L::select(use_it, pdf_area, by_area.pdf_area),
            ..by_area
        }
    }
    /// The given emitters.
    #[inline(always)]
    fn chosen<L: Lanes>(&self, number: L::Uint) -> Chosen<L> {
        let chosen = lanes_of::<L>(number);
        let [ax, ay, az, ex, ey, ez, fx, fy] = self.half_rows::<L>(&chosen, 0);
        let [fz, nx, ny, nz, red, green, blue, density] = self.half_rows::<L>(&chosen, 1);
        Chosen {
            sides: Sides {
                corner: Vec3::new(ax, ay, az),
                edges: [Vec3::new(ex, ey, ez), Vec3::new(fx, fy, fz)],
                half: density.lt(L::splat(0.0)),
            },
            normal: Vec3::new(nx, ny, nz),
            radiance: Vec3::new(red, green, blue),
            density: density.abs(),
        }
    }
    /// Points of the given emitters, by area; the density is that of the point alone.
    #[inline(always)]
    fn point_on<L: Lanes>(&self, number: L::Uint, emitter: &Chosen<L>, u: [L; 2]) -> LightPoint<L> {
        let Chosen { sides: Sides { corner, edges: [e, f], half }, normal, radiance, density } = *emitter;
        let reach = match self.choice {
            Choice::Only => L::splat(self.reaches[0]),
            _ => {
                let chosen = lanes_of::<L>(number);
                L::from_fn(|i| self.reaches[chosen[i] as usize])
            }
        };
        let (v, w) = warp::triangle(u);
        let (v, w) = (L::select(half, v, u[0]), L::select(half, w, u[1]));
        LightPoint { point: e.mul_add(v, f.mul_add(w, corner)), reach, normal, radiance, pdf_area: density }
    }
    /// One half of the rows of the given emitters. Where there is one emitter, nothing is looked up.
    #[inline(always)]
    fn half_rows<L: Lanes>(&self, chosen: &[u32; MAX_LANES], half: usize) -> [L; 8] {
        if let Choice::Only = self.choice {
            let [a, b, c, d, e, f, g, h] = self.rows[0][half];
            let (a, b, c, d) = (L::splat(a), L::splat(b), L::splat(c), L::splat(d));
            return [a, b, c, d, L::splat(e), L::splat(f), L::splat(g), L::splat(h)];
        }
        L::columns8(|i| &self.rows[chosen[i] as usize][half])
    }
    /// Radiance of luminous triangles, by their numbers, and the density per solid angle with which [`Self::sample`] would
    /// have chosen a point on them from `from`: the point `way` from there, where they are hit at an angle of cosine `cos` > 0
    /// with their normal.
    #[inline(always)]
    pub fn seen<L: Lanes>(
        &self,
        row: impl Fn(usize) -> usize,
        from: &Receiver<L>,
        way: Vec3<L>,
        cos: L,
    ) -> (Vec3<L>, L) {
        let seen = |i: usize| self.seen[row(i)];
        let emitter = L::Uint::from_fn(|i| seen(i).emitter);
        let chance = match &self.choice {
            Choice::Only => L::splat(1.0),
            Choice::Few(few) => few.probability(from, emitter),
            Choice::Many(tree) => tree.probability(from, emitter),
        };
        let by_area = L::from_fn(|i| seen(i).density) * way.length2() / cos.max(L::splat(f32::MIN_POSITIVE));
        let Chosen { sides, normal, .. } = self.chosen::<L>(emitter);
        let near = sides.near(from.point, normal);
        let density = if near.any() {
            let (solid, good) = sides.seen(from.point);
            L::select(near & good, L::splat(1.0) / solid.angle(), by_area)
        } else {
            by_area
        };
        (Vec3::from_fn(|i| seen(i).radiance), chance * density)
    }
}

/// The numbers of as many emitters as there are lanes.
#[inline(always)]
fn lanes_of<L: Lanes>(number: L::Uint) -> [u32; MAX_LANES] {
    let mut chosen = [0; MAX_LANES];
    chosen[..L::N].copy_from_slice(number.array().as_ref());
    chosen
}

#[cfg(test)]
mod tests {
    use super::emitter::tests::triangle;
    use super::*;
    use crate::lanes::{Kernel, Wide, dispatch};
    use crate::sampling::{Decision, Sampler, Xoshiro};
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    /// `n` triangles of all sizes, directions and powers about the origin.
    fn lights(n: u32) -> Lights {
        let triangles: Vec<_> = (0..n)
            .map(|i| {
                let mut s = Xoshiro::start::<f32>(5, i, 0);
                let [x, y, z, size] = Xoshiro::draw::<f32, 4>(&mut s, Decision::Light, 0);
                let u = Xoshiro::draw::<f32, 7>(&mut s, Decision::Light, 0);
                let (a, size) = ([x, y, z].map(|c| 2.0 * c - 1.0), 0.02 + 0.3 * size * size);
                let b = std::array::from_fn(|k| a[k] + size * (u[k] - 0.5));
                let c = std::array::from_fn(|k| a[k] + size * (u[k + 3] - 0.5));
                triangle([a, b, c], 0.1 + 10.0 * u[6] * u[6])
            })
            .collect();
        Lights::new(&triangles)
    }

    fn receiver(i: u32) -> Receiver<f32> {
        let mut s = Xoshiro::start::<f32>(6, i, 0);
        let [x, y, z, a, b] = Xoshiro::draw::<f32, 5>(&mut s, Decision::Light, 0);
        let turn = b * std::f32::consts::TAU;
        let (c, r) = (2.0 * a - 1.0, (1.0 - (2.0 * a - 1.0) * (2.0 * a - 1.0)).max(0.0).sqrt());
        Receiver {
            point: Vec3::new(3.0 * x - 1.5, 3.0 * y - 1.5, 3.0 * z - 1.5),
            normal: Vec3::new(r * turn.cos(), r * turn.sin(), c),
        }
    }

    fn pick(lights: &Lights, from: &Receiver<f32>, u: f32) -> (u32, f32) {
        match &lights.choice {
            Choice::Only => (0, 1.0),
            Choice::Few(few) => few.pick(from, u),
            Choice::Many(tree) => tree.pick(from, u),
        }
    }

    fn chance(lights: &Lights, from: &Receiver<f32>, emitter: u32) -> f32 {
        match &lights.choice {
            Choice::Only => 1.0,
            Choice::Few(few) => few.probability(from, emitter),
            Choice::Many(tree) => tree.probability(from, emitter),
        }
    }

    #[test]
    fn all_that_is_held_is_counted() {
        for n in [1, 5, 300] {
            let l = lights(n);
            let lists = [size_of_val(&l.emitters[..]), size_of_val(&l.rows[..]), size_of_val(&l.seen[..])];
            let numbers = [size_of_val(&l.reaches[..]), size_of_val(&l.starts[..]), l.by_power.bytes()];
            let columns = [lists, numbers].concat();
            let choice = match &l.choice {
                Choice::Only => 0,
                Choice::Few(few) => few.bytes(),
                Choice::Many(tree) => tree.bytes(),
            };
            assert!(n == 1 || choice > 4 * l.emitters.len(), "{choice}");
            assert_eq!(l.bytes(), columns.iter().sum::<usize>() + choice);
        }
    }

    /// Counts of choices against the stated probabilities: chi-squared, cells below 5 pooled. 5 x 6 tests at 10^-3 in all
    /// (Sidak): each at 3.3e-5.
    #[test]
    fn emitters_are_chosen_with_the_probability_that_is_stated() {
        for n in [1, 2, 8, 9, 300] {
            let lights = lights(n);
            assert_eq!(lights.len(), n as usize);
            for r in 0..6 {
                let from = receiver(r);
                let stated: Vec<f64> = (0..n).map(|e| f64::from(chance(&lights, &from, e))).collect();
                // Where all that is left of a choice is of no use, none is made.
                let all: f64 = stated.iter().sum();
                assert!(all < 1.0 + 1e-5, "{n} lights, receiver {r}: the sum is {all}");
                let samples = 100_000;
                let (mut counts, mut none) = (vec![0u32; n as usize], 0u32);
                for i in 0..samples {
                    let mut s = Xoshiro::start::<f32>(7, r, i);
                    let [u] = Xoshiro::draw::<f32, 1>(&mut s, Decision::Pick, 0);
                    let (emitter, p) = pick(&lights, &from, u);
                    if p == 0.0 {
                        none += 1;
                        continue;
                    }
                    assert_eq!(p, chance(&lights, &from, emitter), "{n} lights: pick and probability agree");
                    counts[emitter as usize] += 1;
                }
                let (mut chi2, mut cells, mut rare) = (0.0, 0, (0.0, 0.0));
                counts.push(none);
                for (&count, p) in counts.iter().zip(stated.into_iter().chain([(1.0 - all).max(0.0)])) {
                    let expected = p * f64::from(samples);
                    if expected < 5.0 {
                        rare = (rare.0 + expected, rare.1 + f64::from(count));
                    } else {
                        chi2 += (f64::from(count) - expected).powi(2) / expected;
                        cells += 1;
                    }
                }
                if rare.0 > 5.0 {
                    chi2 += (rare.1 - rare.0) * (rare.1 - rare.0) / rare.0;
                    cells += 1;
                }
                if cells > 1 {
                    let p = ChiSquared::new(f64::from(cells - 1)).unwrap().sf(chi2);
                    assert!(p > 3.3e-5, "{n} lights, receiver {r}: p = {p}");
                }
            }
        }
    }

    /// A light that is in sight of the receiver's side is never without a chance.
    #[test]
    fn no_light_that_may_be_of_use_is_left_out() {
        for n in [2, 8, 9, 300, 5000] {
            let lights = lights(n);
            for r in 0..200 {
                let from = receiver(r);
                for (number, e) in lights.emitters().iter().enumerate() {
                    let front = |p: [f32; 3]| {
                        let way = Vec3::<f32>::splat(p) - from.point;
                        let cos = way.dot(from.normal) / way.length2().sqrt();
                        cos > 1e-3 && (Vec3::splat(e.normal).dot(way) / way.length2().sqrt()).abs() > 1e-3
                    };
                    if e.corners().any(front) {
                        assert!(
                            chance(&lights, &from, number as u32) > 0.0,
                            "{n} lights, receiver {r}, light {number}"
                        );
                    }
                }
            }
        }
    }

    /// From a receiver to where a light is hit, in tests that do not care.
    const WAY: [f32; 3] = [0.3, 0.2, -0.6];

    /// Eight receivers at once.
    struct Eight<'a>(&'a Lights, u32);
    impl Kernel for Eight<'_> {
        type Out = ([[f32; 8]; 4], [f32; 8]);
        #[inline(always)]
        fn run<W: Wide>(self) -> Self::Out {
            let at = |i: usize| receiver(self.1 + i as u32);
            let point = Vec3::from_fn(|i| at(i).point.lane(0));
            let from = Receiver { point, normal: Vec3::from_fn(|i| at(i).normal.lane(0)) };
            let u = |k: u32| W::from_fn(|i| unit(i as u32, k));
            let p = self.0.sample(&from, u(0), [u(1), u(2)]);
            let (_, pdf) = self.0.seen(|i| i % self.0.len(), &from, Vec3::splat(WAY), W::splat(0.5));
            ([p.point.x.array(), p.point.y.array(), p.point.z.array(), p.pdf_area.array()], pdf.array())
        }
    }

    fn unit(i: u32, k: u32) -> f32 {
        let mut s = Xoshiro::start::<f32>(8, i, k);
        Xoshiro::draw::<f32, 1>(&mut s, Decision::Light, 0)[0]
    }

    #[test]
    fn wide_matches_scalar() {
        for n in [1, 5, 40, 1000] {
            let lights = lights(n);
            for first in (0..800).step_by(8) {
                let (sampled, pdf) = dispatch(Eight(&lights, first));
                for i in 0..8 {
                    let from = receiver(first + i as u32);
                    let u = |k: u32| unit(i as u32, k);
                    let p = lights.sample(&from, u(0), [u(1), u(2)]);
                    let [x, y, z] = p.point.lane(0);
                    assert_eq!(sampled.map(|c| c[i]), [x, y, z, p.pdf_area], "{n} lights");
                    assert_eq!(pdf[i], lights.seen(|_| i % lights.len(), &from, Vec3::splat(WAY), 0.5).1);
                }
            }
        }
    }
}
