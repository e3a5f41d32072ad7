//! Points on a near emitter by the solid angle under which they are seen.
//!
//! By area, a point's weight is cos / d^2, which varies without bound where the emitter is much nearer than it is large. By
//! solid angle all weights are alike. Far away both are the same, and area is cheaper and keeps its digits: so each emitter is
//! sampled by solid angle from about its own size on, where enough of it is in sight.

use crate::lanes::{Lanes, Vec3, atan2_turns, safe_sqrt, select3, sin_cos_turns};

/// Squared distance, over squared size, from within which an emitter is sampled by solid angle.
const NEAR: f32 = 1.5;
/// The least solid angle, in sr, that is told from rounding errors to five digits.
const LEAST: f32 = 0.02;

/// A corner and two edges, as an emitter has them.
#[derive(Clone, Copy, Debug)]
pub struct Sides<L: Lanes> {
    pub corner: Vec3<L>,
    pub edges: [Vec3<L>; 2],
    /// Where it is a triangle, not a parallelogram.
    pub half: L::Mask,
}

/// An emitter as it is seen from a point.
#[derive(Clone, Copy, Debug)]
pub struct Solid<L: Lanes> {
    /// Directions to the corner and to the fourth corner.
    apexes: [Vec3<L>; 2],
    /// The arc that both halves share, between the ends of the edges: the direction to the first, and that at a quarter turn from
    /// it along the arc.
    arc: [Vec3<L>; 2],
    /// Solid angles in sr of both halves, without the fourth corner and without the first; a triangle has no second half.
    angles: [L; 2],
}

impl<L: Lanes> Sides<L> {
    /// Seen from where the distance to the middle is about the size of the emitter, or less; but not from beside it, where little of
    /// it is in sight.
    #[inline(always)]
    pub fn near(&self, from: Vec3<L>, normal: Vec3<L>) -> L::Mask {
        let [e, f] = self.edges;
        let to = self.corner - from;
        let middle = L::select(self.half, L::splat(1.0 / 3.0), L::splat(0.5));
        let distance2 = (e + f).mul_add(middle, to).length2();
        let size2 = e.length2() + f.length2();
        let near = distance2.lt(size2 * L::splat(NEAR));
        let height = normal.dot(to);
        let before = (size2 * L::splat(0.01)).lt(height * height) | distance2.lt(size2 * L::splat(0.25));
        near & before
    }
    /// The emitter as it is seen from `from`, and where that is good to sample by.
    #[inline(always)]
    pub fn seen(&self, from: Vec3<L>) -> (Solid<L>, L::Mask) {
        let [e, f] = self.edges;
        let to = self.corner - from;
        let [a, b, c, d] = [unit(to), unit(to + e), unit(to + f), unit(to + e + f)];
        let second = L::select(self.half, L::splat(0.0), solid_angle([d, b, c]));
        // From the edges themselves: both ends are nearly opposite where the emitter is very near.
        let across = unit(unit(cross(to + e, f - e)).cross(b));
        let solid = Solid { apexes: [a, d], arc: [b, across], angles: [solid_angle([a, b, c]), second] };
        (solid, solid.angle().gt(L::splat(LEAST)))
    }
}

impl<L: Lanes> Solid<L> {
    /// The whole solid angle in sr: one over the density of [`Self::sample`].
    #[inline(always)]
    pub fn angle(&self) -> L {
        self.angles[0] + self.angles[1]
    }
    /// A unit direction to the emitter, uniform in solid angle (after Arvo 1995, "Stratified Sampling of Spherical Triangles",
    /// without its angles).
    #[inline(always)]
    pub fn sample(&self, [u, v]: [L; 2]) -> Vec3<L> {
        let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
        let [first, second] = self.angles;
        let at = u * self.angle();
        let other = first.le(at) & second.gt(zero);
        let part = L::select(other, at - first, at.min(first));
        let apex = select3(other, self.apexes[1], self.apexes[0]);

        // The arc ends at cos(x) start + sin(x) across, so that the triangle over it has the part's solid angle p. With
        // t = tan(x / 2), `solid_angle` says tan(p / 2) = t D / (1 + start.apex + t E), where D = start x apex . across and
        // E = apex . across.
        let [start, across] = self.arc;
        let (d, e) = (cross(start, apex).dot(across).abs(), apex.dot(across));
        let (sin, cos) = sin_cos_turns(part * L::splat(0.5 / std::f32::consts::TAU));
        let below = (cos * d - sin * e).max(L::splat(1e-20));
        let t = (sin * (one + start.dot(apex)) / below).min(L::splat(1e9));
        let scale = one / t.mul_add(t, one);
        let end = start * ((one - t * t) * scale) + across * (two * t * scale);

        // Then a point between there and the apex.
        let cos = one - v * (one - end.dot(apex));
        let across = unit(end - apex * end.dot(apex));
        apex * cos + across * safe_sqrt((-cos).mul_add(cos, one))
    }
}

/// The cross product; its differences keep their digits where lanes have a fused multiply-add (Kahan, after Jeannerod, Louvet and
/// Muller 2013).
#[inline(always)]
fn cross<L: Lanes>(a: Vec3<L>, b: Vec3<L>) -> Vec3<L> {
    Vec3::new(
        difference([a.y, b.z], [a.z, b.y]),
        difference([a.z, b.x], [a.x, b.z]),
        difference([a.x, b.y], [a.y, b.x]),
    )
}

/// The difference of two products.
#[inline(always)]
fn difference<L: Lanes>([a, b]: [L; 2], [c, d]: [L; 2]) -> L {
    let product = c * d;
    let error = (-c).mul_add(d, product);
    a.mul_add(b, -product) + error
}

/// The vector at length 1; of no length where it has none.
#[inline(always)]
fn unit<L: Lanes>(v: Vec3<L>) -> Vec3<L> {
    v * (L::splat(1.0) / v.length2().max(L::splat(f32::MIN_POSITIVE)).sqrt())
}

/// Solid angle of the triangle of three unit directions, in sr (Van Oosterom and Strackee 1983, equation 8).
#[inline(always)]
fn solid_angle<L: Lanes>([a, b, c]: [Vec3<L>; 3]) -> L {
    let volume = a.dot(b.cross(c)).abs();
    let below = L::splat(1.0) + a.dot(b) + b.dot(c) + c.dot(a);
    atan2_turns(volume, below) * L::splat(2.0 * std::f32::consts::TAU)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Decision, Sampler, Xoshiro};
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    fn sides(corner: [f32; 3], edges: [[f32; 3]; 2], half: bool) -> Sides<f32> {
        Sides { corner: Vec3::splat(corner), edges: edges.map(Vec3::splat), half }
    }

    /// Solid angle of a rectangle of half sides a and b, seen from distance h above its middle.
    fn above(a: f64, b: f64, h: f64) -> f64 {
        4.0 * (a * b / (h * (a * a + b * b + h * h).sqrt())).atan()
    }

    /// Of nearly equal products nothing is lost, where a multiply-add is fused.
    #[test]
    fn differences_keep_their_digits() {
        let (a, c) = (1.0 + f32::EPSILON, 1.0 + 2.0 * f32::EPSILON);
        let fused = Lanes::mul_add(a, a, -(a * a)) != 0.0;
        let found = difference([a, a], [c, 1.0]);
        assert_eq!(found, if fused { f32::EPSILON * f32::EPSILON } else { 0.0 });
        assert_eq!(difference([3.0, 5.0], [7.0, 2.0]), 1.0f32);
    }

    #[test]
    fn solid_angles_are_those_of_rectangles_down_to_contact() {
        for h in [0.9f32, 0.3, 0.1, 1e-2, 1e-4, 1e-6] {
            let s = sides([-0.7, -0.4, h], [[1.4, 0.0, 0.0], [0.0, 0.8, 0.0]], false);
            let (solid, good) = s.seen(Vec3::splat([0.0; 3]));
            let exact = above(0.7, 0.4, f64::from(h));
            let found = f64::from(solid.angle());
            assert!(s.near(Vec3::splat([0.0; 3]), Vec3::splat([0.0, 0.0, 1.0])) && good, "{h}");
            assert!((found - exact).abs() < 1e-5 * exact, "{h}: {found} for {exact}");
        }
        // In the plane beside it, nothing is seen; far away, area will do.
        let s = sides([0.1, 0.1, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], false);
        assert!(!s.seen(Vec3::splat([0.0; 3])).1);
        let up = Vec3::splat([0.0, 0.0, 1.0]);
        assert!(!s.near(Vec3::splat([0.0; 3]), up) && !s.near(Vec3::splat([0.6, 0.6, 2.0]), up));
    }

    /// Counts of directions in 8 x 8 cells along the emitter's edges against the cells' solid angles, which a fine sum gives:
    /// chi-squared, four tests at 10^-3 in all (Sidak).
    #[test]
    fn directions_are_uniform_in_solid_angle() {
        let shapes = [
            sides([-0.7, -0.4, 0.3], [[1.4, 0.0, 0.0], [0.0, 0.8, 0.0]], false),
            sides([-0.7, -0.4, 0.01], [[1.4, 0.0, 0.0], [0.0, 0.8, 0.0]], false),
            sides([0.1, -0.4, 0.2], [[1.4, 0.3, 0.5], [-0.2, 0.8, 0.1]], false),
            sides([-0.3, -0.2, 0.2], [[1.0, 0.0, 0.1], [0.1, 0.8, 0.0]], true),
        ];
        for (number, s) in shapes.iter().enumerate() {
            let (solid, good) = s.seen(Vec3::splat([0.0; 3]));
            assert!(good);
            let samples = 200_000;
            let mut counts = [0u32; 64];
            for i in 0..samples {
                let mut rng = Xoshiro::start::<f32>(11, number as u32, i);
                let u = Xoshiro::draw::<f32, 2>(&mut rng, Decision::Light, 0);
                let [x, y] = place(s, solid.sample(u));
                assert!((-1e-3..1.001).contains(&x) && (-1e-3..1.001).contains(&y), "{number}: {x}, {y}");
                let cell = |c: f64| (c * 8.0).clamp(0.0, 7.0) as usize;
                counts[cell(y) * 8 + cell(x)] += 1;
            }
            let shares = cells(s);
            let whole: f64 = shares.iter().sum();
            let exact = f64::from(solid.angle());
            assert!((whole - exact).abs() < 2e-3 * exact, "{number}: {whole} for {exact}");
            let (mut chi2, mut used) = (0.0, 0);
            for (&count, share) in counts.iter().zip(shares) {
                let expected = share / whole * f64::from(samples);
                if expected >= 5.0 {
                    chi2 += (f64::from(count) - expected).powi(2) / expected;
                    used += 1;
                } else {
                    assert!(count < 30, "{number}: {count} for {expected}");
                }
            }
            let p = ChiSquared::new(f64::from(used - 1)).unwrap().sf(chi2);
            assert!(p > 2.5e-4, "shape {number}: p = {p}");
        }
    }

    fn of(v: Vec3<f32>) -> [f64; 3] {
        v.lane(0).map(f64::from)
    }

    fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// Where a direction from the origin meets the emitter, along its edges.
    fn place(s: &Sides<f32>, direction: Vec3<f32>) -> [f64; 2] {
        let ([e, f], a, d) = (s.edges.map(of), of(s.corner), of(direction));
        let below = dot(d, cross(e, f));
        [dot(d, cross(f, a)) / below, dot(d, cross(a, e)) / below]
    }

    /// Solid angles of 8 x 8 cells along the edges, from 64 x 64 points in each.
    fn cells(s: &Sides<f32>) -> [f64; 64] {
        const FINE: usize = 512;
        let ([e, f], a) = (s.edges.map(of), of(s.corner));
        let normal = cross(e, f);
        let mut shares = [0.0; 64];
        for (i, j) in (0..FINE).flat_map(|i| (0..FINE).map(move |j| (i, j))) {
            let [x, y] = [i, j].map(|c| (c as f64 + 0.5) / FINE as f64);
            if s.half && x + y > 1.0 {
                continue;
            }
            let p: [f64; 3] = std::array::from_fn(|k| a[k] + x * e[k] + y * f[k]);
            let d2 = dot(p, p);
            shares[j * 8 / FINE * 8 + i * 8 / FINE] += dot(p, normal).abs() / (d2 * d2.sqrt() * (FINE * FINE) as f64);
        }
        shares
    }
}
