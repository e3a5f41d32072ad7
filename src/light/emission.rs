//! Light paths: where they start, and with which density.

use super::Lights;
use super::targets::Targets;
use crate::lanes::{Lanes, LanesU32, MAX_LANES, Vec3, select3};

/// Draws emitters by power.
#[derive(Clone, Debug, Default)]
pub(super) struct ByPower {
    /// Share of the power of all emitters up to each, itself included.
    sums: Vec<f32>,
    /// One over the power of all.
    pub inverse: f64,
}

impl ByPower {
    pub fn new(powers: &[f64]) -> Self {
        let all: f64 = powers.iter().sum();
        let mut sum = 0.0;
        let sums = powers.iter().map(|p| {
            sum += p;
            (sum / all) as f32
        });
        Self { sums: sums.collect(), inverse: 1.0 / all }
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.sums[..])
    }
    fn draw(&self, u: f32) -> usize {
        self.sums.partition_point(|&s| s <= u).min(self.sums.len() - 1)
    }
}

/// Where light leaves a lamp.
#[derive(Clone, Copy, Debug)]
pub struct Emitted<L: Lanes> {
    /// A point on a light.
    pub point: Vec3<L>,
    /// The largest coordinate of the emitter's corners.
    pub reach: L,
    /// Unit normal of the light on the side to which the direction leads.
    pub normal: Vec3<L>,
    /// Unit direction.
    pub direction: Vec3<L>,
    /// Emitted radiance.
    pub radiance: Vec3<L>,
    /// Density of point and direction, per area and per projected solid angle.
    pub density: L,
}

impl Lights {
    /// Starts light paths towards `targets`: emitters by power, points by area. `picks` choose the emitter and the target.
    #[inline(always)]
    pub fn emit<L: Lanes>(&self, targets: &Targets, picks: [L; 2], at: [L; 2], towards: [L; 2]) -> Emitted<L> {
        let u = picks[0].array();
        let mut chosen = [0; MAX_LANES];
        for (number, &u) in chosen.iter_mut().zip(u.as_ref()) {
            *number = self.by_power.draw(u) as u32;
        }
        let number = L::Uint::load(&chosen);
        let light = self.point_on(number, &self.chosen(number), at);
        let direction = targets.sample(light.point, picks[1], towards);
        let cos = light.normal.dot(direction);
        let start = L::from_fn(|i| self.starts[chosen[i] as usize]);
        let density = start * targets.pdf(light.point, direction) / cos.abs().max(L::splat(f32::MIN_POSITIVE));
        Emitted {
            point: light.point,
            reach: light.reach,
            normal: select3(cos.lt(L::splat(0.0)), -light.normal, light.normal),
            direction,
            radiance: light.radiance,
            density,
        }
    }
    /// Density with which [`Self::emit`] starts at a point of the luminous triangles `row` and goes into the unit direction
    /// `direction`, at an angle of cosine `cos` > 0 with their normal: per area and projected solid angle.
    #[inline(always)]
    pub fn emission_density<L: Lanes>(
        &self,
        targets: &Targets,
        row: impl Fn(usize) -> usize,
        point: Vec3<L>,
        direction: Vec3<L>,
        cos: L,
    ) -> L {
        let start = L::from_fn(|i| self.starts[self.seen[row(i)].emitter as usize]);
        start * targets.pdf(point, direction) / cos.max(L::splat(f32::MIN_POSITIVE))
    }
}
