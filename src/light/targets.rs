//! Directions in which light meets mirrors and glass first: cones from a point of a light about balls that hold all of them.

use crate::lanes::{Frame, Lanes, Vec3, safe_sqrt, select3, sin_cos_turns};

/// Balls at most; more objects than that are held by one.
pub const MOST: usize = 16;
/// Balls are this much larger than what they hold, so that their silhouette is not that of a surface.
const ROOM: f64 = 1.001;

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle.
    pub centre: [f32; 3],
    /// Its radius.
    pub radius: f32,
}

impl Ball {
    /// A ball about the middle of the points' box; none about no points.
    pub fn about(points: impl Iterator<Item = [f32; 3]> + Clone) -> Option<Self> {
        let (lo, hi) = points.clone().map(|p| (p, p)).reduce(|a, b| {
            let each = |f: fn(f32, f32) -> f32, a: [f32; 3], b: [f32; 3]| std::array::from_fn(|k| f(a[k], b[k]));
            (each(f32::min, a.0, b.0), each(f32::max, a.1, b.1))
        })?;
        let centre: [f32; 3] = std::array::from_fn(|k| 0.5 * (lo[k] + hi[k]));
        let distance2 = |p: [f32; 3]| (0..3).map(|k| f64::from(p[k] - centre[k]).powi(2)).sum::<f64>();
        let radius = points.map(distance2).fold(0.0, f64::max).sqrt();
        Some(Self { centre, radius: (radius * ROOM) as f32 })
    }
}

/// The balls about all surfaces that are aimed at.
#[derive(Clone, Debug, Default)]
pub struct Targets(Vec<Ball>);

/// The cone about a ball: its axis, and one minus the cosine of its half angle, 2 where the point is in the ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone<L> {
    pub axis: Vec3<L>,
    pub height: L,
}

impl<L: Lanes> Cone<L> {
    #[inline(always)]
    fn of(ball: &Ball, point: Vec3<L>) -> Self {
        Self::about(Vec3::splat(ball.centre), L::splat(ball.radius), point)
    }
    /// The cones about balls, seen from points.
    #[inline(always)]
    pub fn about(centre: Vec3<L>, radius: L, point: Vec3<L>) -> Self {
        let one = L::splat(1.0);
        let way = centre - point;
        let distance2 = way.length2();
        let sin2 = radius * radius / distance2.max(L::splat(f32::MIN_POSITIVE));
        // 1 - cos without cancellation for narrow cones.
        let narrow = sin2 / (one + safe_sqrt(one - sin2));
        let axis = way * (one / distance2.max(L::splat(f32::MIN_POSITIVE)).sqrt());
        Self { axis, height: L::select(sin2.lt(one), narrow, L::splat(2.0)) }
    }
    /// Whether a unit direction lies in it.
    #[inline(always)]
    pub fn holds(&self, direction: Vec3<L>) -> L::Mask {
        // One minus the cosine of the angle, from the chord.
        let below = (direction - self.axis).length2() * L::splat(0.5);
        below.le(self.height) | self.height.gt(L::splat(1.5))
    }
    /// A unit direction, uniform in it, by two uniform numbers.
    #[inline(always)]
    pub fn direction(&self, [u, v]: [L; 2]) -> Vec3<L> {
        let below = u * self.height;
        let sin = safe_sqrt(below * (L::splat(2.0) - below));
        let (s, c) = sin_cos_turns(v);
        let local = Vec3::new(sin * c, sin * s, L::splat(1.0) - below);
        Frame::about(self.axis).to_world(local).normalize()
    }
}

impl Targets {
    /// Balls about each object, or one about all where they are many.
    pub fn new(balls: Vec<Ball>) -> Self {
        if balls.len() <= MOST {
            return Self(balls);
        }
        let ends = balls.iter().flat_map(|b| {
            [-b.radius, b.radius].into_iter().flat_map(move |r| {
                (0..8)
                    .map(move |corner| std::array::from_fn(|k| b.centre[k] + if corner >> k & 1 == 1 { r } else { -r }))
            })
        });
        Self(Ball::about(ends).into_iter().collect())
    }
    /// Whether there is nothing to aim at.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
    /// Density per solid angle with which [`Self::sample`] gives a unit direction at a point: the cones that hold it over
    /// the sum of all cones' solid angles.
    #[inline(always)]
    pub fn pdf<L: Lanes>(&self, point: Vec3<L>, direction: Vec3<L>) -> L {
        let (one, zero) = (L::splat(1.0), L::splat(0.0));
        let (mut heights, mut count) = (zero, zero);
        for ball in &self.0 {
            let cone = Cone::of(ball, point);
            heights = heights + cone.height;
            count = count + L::select(cone.holds(direction), one, zero);
        }
        count / (heights * L::splat(std::f32::consts::TAU))
    }
    /// A unit direction at a point, uniform in a cone that is chosen by solid angle, by three uniform numbers.
    #[inline(always)]
    pub fn sample<L: Lanes>(&self, point: Vec3<L>, pick: L, [u, v]: [L; 2]) -> Vec3<L> {
        let zero = L::splat(0.0);
        let mut all = zero;
        for ball in &self.0 {
            all = all + Cone::of(ball, point).height;
        }
        let threshold = pick * all;
        let mut chosen = Cone { axis: Vec3::splat([0.0, 0.0, 1.0]), height: zero };
        let mut sum = zero;
        for ball in &self.0 {
            let cone = Cone::of(ball, point);
            let here = sum.le(threshold);
            chosen.axis = select3(here, cone.axis, chosen.axis);
            chosen.height = L::select(here, cone.height, chosen.height);
            sum = sum + cone.height;
        }
        chosen.direction([u, v])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Decision, Sampler, Xoshiro};

    fn numbers(i: u32) -> [f32; 3] {
        let mut s = Xoshiro::start::<f32>(21, i, 0);
        Xoshiro::draw(&mut s, Decision::Scatter, 0)
    }

    fn balls() -> Targets {
        let ball = |x, y, z, radius| Ball { centre: [x, y, z], radius };
        // Two that overlap as seen from the origin, a small one apart, and for the second point one that holds it.
        Targets::new(vec![ball(2.0, 0.0, 0.0, 0.7), ball(3.0, 0.8, 0.0, 0.9), ball(0.0, 0.0, -1.5, 0.05)])
    }

    /// The mean of 1 / pdf over samples is the solid angle where the density is not 0, which uniform directions give as
    /// well: both within 4 standard errors of each other, about 1 in 10^4. And every sample has a density.
    #[test]
    fn directions_follow_their_density() {
        for point in [[0.0, 0.0, 0.0], [2.2, 0.1, 0.0]] {
            let (targets, point) = (balls(), Vec3::<f32>::splat(point));
            let n = 200_000;
            let (mut sum, mut sum2, mut covered, mut total) = (0.0, 0.0, 0u32, 0.0);
            for i in 0..n {
                let [a, b, c] = numbers(i);
                let d = targets.sample(point, a, [b, c]);
                assert!((d.length2() - 1.0).abs() < 1e-5);
                let pdf = f64::from(targets.pdf(point, d));
                assert!(pdf > 0.0, "{d:?}");
                sum += 1.0 / pdf;
                sum2 += 1.0 / pdf / pdf;
                let [a, b, _] = numbers(n + i);
                let (z, turn) = (2.0 * a - 1.0, b * std::f32::consts::TAU);
                let r = (1.0 - z * z).max(0.0).sqrt();
                let uniform = targets.pdf(point, Vec3::new(r * turn.cos(), r * turn.sin(), z));
                covered += u32::from(uniform > 0.0);
                total += f64::from(uniform);
            }
            let n = f64::from(n);
            let (mean, share) = (sum / n, f64::from(covered) / n);
            let sphere = 4.0 * std::f64::consts::PI;
            let errors = ((sum2 / n - mean * mean) / n + sphere * sphere * share * (1.0 - share) / n).sqrt();
            assert!((mean - share * sphere).abs() < 4.0 * errors, "{mean} for {}", share * sphere);
            assert!((total / n * sphere - 1.0).abs() < 0.05, "the density integrates to {}", total / n * sphere);
        }
    }

    #[test]
    fn many_balls_become_one_that_holds_them() {
        let many: Vec<Ball> =
            (0..20).map(|i| Ball { centre: [i as f32, (i * 7 % 5) as f32, 0.0], radius: 0.5 }).collect();
        let one = Targets::new(many.clone());
        assert_eq!(one.0.len(), 1);
        let away = |b: &Ball| (0..3).map(|k| (b.centre[k] - one.0[0].centre[k]).powi(2)).sum::<f32>().sqrt() + b.radius;
        assert!(many.iter().all(|b| away(b) <= one.0[0].radius));
    }
}
