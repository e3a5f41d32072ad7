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
    /// Of one emitter.
    pub fn of(e: &Emitter) -> Self {
        let corners: Vec<[f64; 3]> = e.corners().map(|c| c.map(f64::from)).collect();
        let centre: [f64; 3] =
            std::array::from_fn(|k| corners.iter().map(|c| c[k]).sum::<f64>() / corners.len() as f64);
        let radius = corners.iter().map(|c| distance(c, &centre)).fold(0.0, f64::max);
        Self {
            centre: centre.map(|c| c as f32),
            radius: radius as f32 * ROUNDING,
            axis: e.normal,
            cos_cone: 1.0,
            power: e.power() as f32,
        }
    }
}

/// Balls are a little larger than what they hold, so that rounding leaves no corner outside.
pub(super) const ROUNDING: f32 = 1.0 + 1e-5;

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// cos(a - b), or 1 where b, given by its sine and cosine, is larger than a: what is left of an angle of which up to b may be
/// taken.
#[inline(always)]
fn cos_less<L: Lanes>(cos_a: L, [sin_b, cos_b]: [L; 2]) -> L {
    let one = L::splat(1.0);
    let sines = safe_sqrt(one - cos_a * cos_a) * sin_b;
    L::select(cos_a.gt(cos_b), one, cos_a.mul_add(cos_b, sines))
}

/// Estimate, up to a factor, of the light that emitters of given power within given bounds send to a receiver: power
/// times the largest cosines at both ends over squared distance (Conty Estevez and Kulla 2018, section 3.3, for two-sided
/// emitters). 0 only where all of them lie behind the receiver, or are seen edge-on. Where not `CONE`, all of them are in one
/// plane, and the cone is but its axis.
///
/// Within the ball all angles are possible, and the distance counts as its radius.
#[inline(always)]
pub fn importance<L: Lanes, const CONE: bool>(
    [x, y, z, radius, u, v, w, cos_cone]: [L; 8],
    power: L,
    from: &Receiver<L>,
) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let way = Vec3::new(x, y, z) - from.point;
    let (distance2, radius2) = (way.length2(), radius * radius);
    let near = distance2.le(radius2);
    let inverse = one / distance2.max(radius2).max(L::splat(f32::MIN_POSITIVE)).sqrt();
    let direction = way * inverse;
    let sin_ball = radius * inverse;
    let ball = [sin_ball, safe_sqrt(one - sin_ball * sin_ball)];
    let cos_axis = Vec3::new(u, v, w).dot(direction).abs().min(one);
    let cos_nearest =
        if CONE { cos_less(cos_axis, [safe_sqrt(one - cos_cone * cos_cone), cos_cone]) } else { cos_axis };
    let cos_light = cos_less(cos_nearest, ball);
    let cos_normal = from.normal.dot(direction).max(-one).min(one);
    let cos_receiver = cos_less(cos_normal, ball).max(zero);
    let cosines = L::select(near, one, cos_light * cos_receiver);
    power * cosines * (inverse * inverse)
}
