//! How much light a group of emitters may send to a point of a surface: what they are chosen by.

use super::Emitter;
use crate::lanes::{Lanes, Vec3, safe_sqrt};

/// Where light arrives: a point just off a surface, and the geometric normal there, on the lit side.
#[derive(Clone, Copy, Debug)]
pub struct Receiver<L: Lanes> {
    /// The point.
    pub point: Vec3<L>,
    /// Unit normal.
    pub normal: Vec3<L>,
}

/// Bounds of some emitters: a ball about them and a cone about their normals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Middle of the ball.
    pub centre: [f32; 3],
    /// Its radius.
    pub radius: f32,
    /// Unit axis of the cone. Emitters are two-sided: a normal and its opposite are the same.
    pub axis: [f32; 3],
    /// Cosine of the cone's half angle, in [0, 1].
    pub cos_cone: f32,
    /// Sum of the emitters' powers.
    pub power: f32,
}

impl Bounds {
    /// Ball, axis and cone as the eight numbers that [`importance`] reads.
    pub fn row(&self) -> [f32; 8] {
        let ([x, y, z], [u, v, w]) = (self.centre, self.axis);
        [x, y, z, self.radius, u, v, w, self.cos_cone]
    }
    /// Power, and sine of the cone's half angle.
    pub fn scale(&self) -> [f32; 2] {
        [self.power, (1.0 - self.cos_cone * self.cos_cone).max(0.0).sqrt()]
    }
    /// Of one emitter.
    pub fn of(e: &Emitter) -> Self {
        let corners: Vec<[f64; 3]> = e.corners().map(|c| c.map(f64::from)).collect();
        let centre: [f32; 3] =
            std::array::from_fn(|k| (corners.iter().map(|c| c[k]).sum::<f64>() / corners.len() as f64) as f32);
        // About the middle as it is kept.
        let radius = corners.iter().map(|c| distance(c, &centre.map(f64::from))).fold(0.0, f64::max);
        Self { centre, radius: radius as f32 * ROUNDING, axis: e.normal, cos_cone: 1.0, power: e.power() as f32 }
    }
}

/// Balls are a little larger than what they hold, so that rounding leaves no corner outside.
pub(super) const ROUNDING: f32 = 1.0 + 1e-5;

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Estimate, up to a factor, of the light that emitters of given power within given bounds send to a receiver: power
/// times the largest cosines at both ends over squared distance (Conty Estevez and Kulla 2018, section 3.3, for two-sided
/// emitters). 0 only where all of them lie behind the receiver. Where not `CONE`, all of them are in one plane, and the cone
/// is but its axis.
///
/// Of the ball, of radius r at distance d, the cosines take r / d more than that of its middle, which is no less than any of
/// its points has; the squared distance is the mean over its surface, d^2 + r^2. So nothing is special about its inside, and
/// but for the cone there is no root.
#[inline(always)]
pub fn importance<L: Lanes, const CONE: bool>(
    [x, y, z, radius, u, v, w, cos_cone]: [L; 8],
    [power, sin_cone]: [L; 2],
    from: &Receiver<L>,
) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let way = Vec3::new(x, y, z) - from.point;
    let distance2 = way.length2();
    let along = Vec3::new(u, v, w).dot(way).abs();
    // d cos(a - c) of the angle a to the axis and the cone's c; d where the way lies in the cone.
    let nearest = if CONE {
        let across = safe_sqrt((-along).mul_add(along, distance2));
        let outside = along.mul_add(cos_cone, across * sin_cone);
        L::select((across * cos_cone).le(along * sin_cone), distance2.sqrt(), outside)
    } else {
        along
    };
    let inverse = one / radius.mul_add(radius, distance2).max(L::splat(f32::MIN_POSITIVE));
    let receiver = (from.normal.dot(way) + radius).max(zero);
    power * (receiver * inverse) * ((nearest + radius) * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::emitter::Shape;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    #[test]
    fn balls_hold_their_emitters_whatever_is_rounded() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut number = |power: i32| ((rng.next_u32() >> 8) as f32 / 8_388_608.0 - 1.0) * 2f32.powi(power);
        let mut three = |power: i32| [number(power), number(power), number(power)];
        for i in 0..1000 {
            let emitter = Emitter {
                corner: three(0),
                edges: [three(-(i % 8)), three(-(i % 8))],
                normal: [0.0, 0.0, 1.0],
                radiance: [2.0; 3],
                shape: if i % 2 == 0 { Shape::Triangle } else { Shape::Parallelogram },
            };
            let bounds = Bounds::of(&emitter);
            let centre = bounds.centre.map(f64::from);
            let apart = |c: [f32; 3]| {
                let [x, y, z] = std::array::from_fn(|k| f64::from(c[k]) - centre[k]);
                x.hypot(y).hypot(z)
            };
            let farthest = emitter.corners().map(apart).fold(0.0, f64::max);
            let radius = f64::from(bounds.radius);
            assert!(farthest <= radius && radius < farthest * 1.0001, "{emitter:?}: {bounds:?}, {farthest}");
            assert_eq!((bounds.cos_cone, bounds.axis, bounds.power), (1.0, emitter.normal, emitter.power() as f32));
        }
    }
}
