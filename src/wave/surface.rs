//! The point that a ray hit: position and its rounding error, normals, and the way off the surface.

use super::queues::HitRow;
use crate::lanes::{Lanes, LanesU32, Mask, Vec3, largest_coordinate, select3};
use crate::world::World;

/// A surface point as a path sees it.
#[derive(Clone, Copy, Debug)]
pub struct Surface<L: Lanes> {
    /// Where it is.
    pub point: Vec3<L>,
    /// What the rounding errors at `point` are proportional to: the largest coordinate of the triangle.
    pub reach: L,
    /// Unit geometric normal, on the side of the path.
    pub ng: Vec3<L>,
    /// Unit shading normal, on the side of the path: `ns . wo > 0`.
    pub ns: Vec3<L>,
    /// Where the path is on the front side of the triangle.
    pub outside: L::Mask,
    /// Where `ns` had to be tilted to be on the side of the path.
    pub tilted: L::Mask,
}

/// How far off a surface rays start, as a share of the triangle's largest coordinate. Two errors have to be passed: that
/// of the interpolated position, 7 roundings of 2^-24 in each coordinate (Pharr et al. 2023, section 6.8), and that of the
/// distance to the triangle's plane as the triangle test finds it, which grows with the triangle's extent, not with the
/// point's own coordinates: some roundings of coordinates up to sqrt(3) times twice the largest. 32 leaves room for both,
/// except at needles, whose error grows with extent over area.
const POSITION_ERROR: f32 = 32.0 * 0.5 * f32::EPSILON;
/// Interpolated normals are tilted until the path meets them at least at this cosine.
const MIN_COS: f32 = 1e-3;

/// Moves a point off its surface along the unit vector `n`, past the rounding errors of a triangle of reach `reach`.
#[inline(always)]
pub fn off_surface<L: Lanes>(point: Vec3<L>, reach: L, n: Vec3<L>) -> Vec3<L> {
    n.mul_add(reach * L::splat(POSITION_ERROR), point)
}

impl<L: Lanes> Surface<L> {
    /// The points of a group of hits, seen from the unit directions `wo`.
    #[inline(always)]
    pub fn new(world: &World, hit: &HitRow<L>, wo: Vec3<L>) -> Self {
        Self::with(world, world.normals.as_deref(), hit, wo)
    }

    /// The same where it is known which `normals` the world has, if any.
    #[inline(always)]
    pub fn with(world: &World, normals: Option<&[[[f32; 3]; 3]]>, hit: &HitRow<L>, wo: Vec3<L>) -> Self {
        let ids = hit.triangle.array();
        let id = |i: usize| ids.as_ref()[i] as usize;
        let [a, b, c] = Vec3::triple(|i| &world.corners[id(i)]);
        let w = L::splat(1.0) - hit.u - hit.v;
        let point = a.mul_add(w, b.mul_add(hit.u, c * hit.v));
        let front = (b - a).cross(c - a).normalize();
        let outside = front.dot(wo).gt(L::splat(0.0));
        let ng = select3(outside, front, -front);
        let (ns, tilted) = match normals {
            None => (ng, L::Mask::splat(false)),
            Some(normals) => {
                let [na, nb, nc] = Vec3::triple(|i| &normals[id(i)]);
                let sum = na.mul_add(w, nb.mul_add(hit.u, nc * hit.v));
                facing(sum, ng, wo)
            }
        };
        Self { point, reach: largest_coordinate([a, b, c]), ng, ns, outside, tilted }
    }

    /// Where a ray into direction `wi` starts, so that it does not hit the surface again.
    #[inline(always)]
    pub fn spawn(&self, through: L::Mask) -> Vec3<L> {
        off_surface(self.point, self.reach, select3(through, -self.ng, self.ng))
    }

    /// Mirrors `wi` in the surface where it lies on the wrong side of it. An interpolated normal sends some directions
    /// into the surface; folding them back loses no energy, so that silhouettes have no dark rim, and lets none through.
    #[inline(always)]
    pub fn fold(&self, wi: Vec3<L>, through: L::Mask) -> Vec3<L> {
        let side = wi.dot(self.ng);
        let wrong = L::select(through, side, -side).gt(L::splat(0.0));
        select3(wrong, self.mirror(wi), wi)
    }

    /// Whether both normals see a direction at cosines that differ by a factor below 2, and on the side that `through` says.
    /// Where that holds for `wo` and `wi`, neither is tilted or folded, and light goes the way back with the same lobe.
    #[inline(always)]
    pub fn regular(&self, direction: Vec3<L>, through: L::Mask) -> L::Mask {
        let two = L::splat(2.0);
        let (flat, smooth) = (self.ng.dot(direction), self.ns.dot(direction));
        let (flat, smooth) = (L::select(through, -flat, flat), L::select(through, -smooth, smooth));
        // The first: what mirrors the direction in the triangle's plane brings it below the horizon of the other normal.
        let close = smooth.lt(two * flat * self.ng.dot(self.ns)) & flat.lt(two * smooth);
        close & L::splat(MIN_COS).le(smooth) & !self.tilted
    }

    /// `wi` mirrored in the plane of the triangle.
    #[inline(always)]
    pub fn mirror(&self, wi: Vec3<L>) -> Vec3<L> {
        self.ng.mul_add(L::splat(-2.0) * wi.dot(self.ng), wi)
    }
}

/// The interpolated normal `sum`, made unit, on the side of `ng`, and tilted towards `wo` where it looks away from it.
/// Where nothing is left of it, `ng`. Also where it was tilted.
#[inline(always)]
fn facing<L: Lanes>(sum: Vec3<L>, ng: Vec3<L>, wo: Vec3<L>) -> (Vec3<L>, L::Mask) {
    let length2 = sum.length2();
    let usable = length2.gt(L::splat(1e-8));
    let unit = select3(usable, sum * (L::splat(1.0) / length2.sqrt()), ng);
    let ns = select3(unit.dot(ng).lt(L::splat(0.0)), -unit, unit);
    let cos = ns.dot(wo);
    let low = cos.lt(L::splat(MIN_COS));
    if !low.any() {
        return (ns, low);
    }
    let tilted = wo.mul_add(L::splat(2.0 * MIN_COS) - cos, ns).normalize();
    (select3(low, tilted, ns), low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unusable_normals_fall_back_and_backward_ones_turn() {
        let up = Vec3::<f32>::splat([0.0, 0.0, 1.0]);
        let wo = Vec3::splat([0.6, 0.0, 0.8]);
        for (sum, expected) in [([0.0; 3], up), ([0.0, 0.0, -1.0], up), ([f32::NAN, 0.0, 0.0], up)] {
            assert_eq!(facing(Vec3::splat(sum), up, wo).0.lane(0), expected.lane(0));
        }
        // Looks away from wo, though the triangle does not.
        let away = Vec3::splat([-0.9, 0.0, 0.2]).normalize();
        let grazing = Vec3::splat([0.995, 0.0, 0.0998]).normalize();
        let (n, tilted) = facing(away, up, grazing);
        assert!(tilted);
        assert!(n.dot(grazing) > 0.0 && (n.length2() - 1.0).abs() < 1e-6, "{n:?}");
    }
}
