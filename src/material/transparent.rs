//! A smooth dielectric: Fresnel reflection, refraction, total internal reflection.

use super::{Evaluated, Lobe, Scattered};
use crate::lanes::{Lanes, Vec3, safe_sqrt, select3};

/// Reflects with the probability of Fresnel's equations, else refracts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Transparent;

/// One dielectric.
#[derive(Clone, Copy, Debug)]
pub struct TransparentRow {
    /// What passes through the surface is multiplied by this, per channel.
    pub color: [f32; 3],
    /// Index of refraction on the back side against 1 on the front side.
    pub ref_index: f32,
}

impl From<TransparentRow> for [f32; 4] {
    fn from(row: TransparentRow) -> Self {
        let [r, g, b] = row.color;
        [r, g, b, row.ref_index]
    }
}

/// The dielectrics of a group of rows.
#[derive(Clone, Copy, Debug)]
pub struct TransparentParams<L: Lanes> {
    color: Vec3<L>,
    ref_index: L,
}

/// (unpolarised reflectance, cosine of the refracted angle) for light that meets the boundary at `cos_i` >= 0, where
/// `eta` is the index on the far side over that on the near side. Total internal reflection gives (1, 0).
#[inline(always)]
pub fn fresnel_dielectric<L: Lanes>(cos_i: L, eta: L) -> (L, L) {
    let one = L::splat(1.0);
    // 1 - sin^2 / eta^2, written so that index 1 gives cos_i back without cancellation at grazing angles.
    let inv2 = one / (eta * eta);
    let cos2_t = (cos_i * cos_i).mul_add(inv2, one - inv2);
    let total = cos2_t.le(L::splat(0.0));
    let cos_t = safe_sqrt(cos2_t);
    let parallel = (eta * cos_i - cos_t) / eta.mul_add(cos_i, cos_t);
    let perpendicular = (cos_i - eta * cos_t) / eta.mul_add(cos_t, cos_i);
    let r = L::splat(0.5) * parallel.mul_add(parallel, perpendicular * perpendicular);
    (L::select(total, one, r.min(one)), cos_t)
}

impl Lobe for Transparent {
    const DELTA: bool = true;
    const TRANSMITS: bool = true;
    const NUMBERS: usize = 1;
    const NAME: &'static str = "transparent";
    type Row = TransparentRow;
    type Params<L: Lanes> = TransparentParams<L>;

    #[inline(always)]
    fn params<L: Lanes>([r, g, b, ref_index]: [L; 4]) -> TransparentParams<L> {
        TransparentParams { color: Vec3::new(r, g, b), ref_index }
    }
    #[inline(always)]
    fn sample<L: Lanes>(p: &TransparentParams<L>, wo: Vec3<L>, outside: L::Mask, u: [L; 3]) -> Scattered<L> {
        let one = L::splat(1.0);
        let eta = L::select(outside, p.ref_index, one / p.ref_index);
        let (reflectance, cos_t) = fresnel_dielectric(wo.z, eta);
        let reflect = u[0].lt(reflectance);
        let inv = one / eta;
        let refracted = Vec3::new(-(wo.x * inv), -(wo.y * inv), -cos_t);
        let mirrored = Vec3::new(-wo.x, -wo.y, wo.z);
        // Radiance is squeezed into a cone narrower by eta^2 (Veach 1997, section 5.2).
        let scale = inv * inv;
        Scattered {
            wi: select3(reflect, mirrored, refracted).normalize(),
            weight: select3(reflect, Vec3::splat([1.0; 3]), p.color * scale),
            radiance_scale: L::select(reflect, one, scale),
            transmitted: !reflect,
        }
    }
    #[inline(always)]
    fn eval<L: Lanes>(_p: &TransparentParams<L>, _wo: Vec3<L>, _wi: Vec3<L>) -> Evaluated<L> {
        Evaluated { f_cos: Vec3::splat([0.0; 3]), pdf: L::splat(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_util::*;
    use super::*;

    /// Fresnel's equations in f64, in their textbook form with both sines.
    fn oracle(theta: f64, eta: f64) -> f64 {
        let sin_t = theta.sin() / eta;
        if sin_t >= 1.0 {
            return 1.0;
        }
        let (ci, ct) = (theta.cos(), (1.0 - sin_t * sin_t).sqrt());
        let rp = (eta * ci - ct) / (eta * ci + ct);
        let rs = (ci - eta * ct) / (ci + eta * ct);
        0.5 * (rp * rp + rs * rs)
    }

    /// The bound follows the conditioning: an error of 1e-7 in cos_i moves the reflectance by its slope.
    #[test]
    fn fresnel_matches_f64_around_the_critical_angle_too() {
        for eta in [1.5f64, 1.0 / 1.5, 1.0, 1.0001, 2.4, 1.0 / 2.4, 0.3, 1000.0] {
            let critical = if eta < 1.0 { eta.asin() } else { 1.0 };
            let near = (0..200).map(|i| critical + (f64::from(i) - 100.0) * 1e-5);
            for theta in (0..=900).map(|i| f64::from(i).to_radians() * 0.1).chain(near) {
                let theta = theta.clamp(0.0, std::f64::consts::FRAC_PI_2 - 1e-6);
                // Both sides see the very same rounded inputs.
                let (cos, eta32) = (theta.cos() as f32, eta as f32);
                let theta = f64::from(cos).acos();
                let (r, _) = fresnel_dielectric(cos, eta32);
                let exact = oracle(theta, f64::from(eta32));
                let step = |d: f64| oracle((f64::from(cos) + d).clamp(0.0, 1.0).acos(), f64::from(eta32));
                let slope = (step(2e-7) - step(-2e-7)).abs();
                assert!((f64::from(r) - exact).abs() < 2e-6 + 2.0 * slope, "eta {eta}, theta {theta}: {r} for {exact}");
            }
        }
    }

    #[test]
    fn refraction_obeys_snell_and_reflection_is_total_past_the_critical_angle() {
        let p = Transparent::params(TransparentRow { color: [1.0; 3], ref_index: 1.5 }.into());
        for outside in [true, false] {
            let eta: f64 = if outside { 1.5 } else { 1.0 / 1.5 };
            for theta in [0.0, 10.0, 30.0, 41.0, 42.5, 60.0, 89.0] {
                let wo = direction(theta, 0.5);
                let s = Transparent::sample(&p, wo, outside, [1.0 - f32::EPSILON / 2.0; 3]);
                let sin_t = theta.to_radians().sin() / eta;
                if sin_t > 1.0 {
                    assert!(!s.transmitted && s.wi.z > 0.0, "theta {theta}: total");
                    continue;
                }
                assert!(s.transmitted && s.wi.z < 0.0, "theta {theta}: refracted");
                let sin = f64::from(s.wi.x.hypot(s.wi.y));
                assert!((sin - sin_t).abs() < 1e-5, "theta {theta}: {sin} for {sin_t}");
                assert!((f64::from(s.radiance_scale) - 1.0 / (eta * eta)).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn equal_indices_are_invisible() {
        let p = Transparent::params(TransparentRow { color: [1.0; 3], ref_index: 1.0 }.into());
        for theta in [0.0, 45.0, 89.9] {
            let wo = direction(theta, 0.1);
            let s = Transparent::sample(&p, wo, true, [0.0; 3]);
            assert!(s.transmitted && (s.wi + wo).length2() < 1e-10, "theta {theta}: {:?}", s.wi);
        }
    }
}
