//! Lights: every luminous triangle is an emitter, two-sided, chosen by power and sampled by area.

use crate::lanes::{Lanes, MAX_LANES, Vec3, largest_coordinate};
use crate::sampling::warp;

/// A luminous triangle in world coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// Its corners.
    pub corners: [[f32; 3]; 3],
    /// Unit normal of the front side.
    pub normal: [f32; 3],
    /// Area, > 0.
    pub area: f32,
    /// Emitted radiance per channel.
    pub radiance: [f32; 3],
}

/// A table for drawing an index with given odds in constant time (Walker 1977; built as in Vose 1991).
#[derive(Clone, Debug, Default)]
struct AliasTable {
    keep: Vec<f32>,
    alias: Vec<u32>,
}

impl AliasTable {
    /// `weights` are positive and finite.
    fn new(weights: &[f64]) -> Self {
        let n = weights.len();
        let mean = weights.iter().sum::<f64>() / n as f64;
        let mut scaled: Vec<f64> = weights.iter().map(|w| w / mean).collect();
        let mut table = Self { keep: vec![1.0; n], alias: (0..n as u32).collect() };
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| scaled[i] < 1.0);
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            table.keep[s] = scaled[s] as f32;
            table.alias[s] = l as u32;
            scaled[l] -= 1.0 - scaled[s];
            if scaled[l] < 1.0 {
                large.pop();
                small.push(l);
            }
        }
        table
    }
    #[inline(always)]
    fn draw(&self, u: f32, coin: f32) -> usize {
        let n = self.keep.len();
        let i = ((u * n as f32) as usize).min(n - 1);
        if coin < self.keep[i] { i } else { self.alias[i] as usize }
    }
}

/// A point on a light.
#[derive(Clone, Copy, Debug)]
pub struct LightPoint<L: Lanes> {
    /// The point.
    pub point: Vec3<L>,
    /// The largest coordinate of the light's triangle: what rounding errors on it are proportional to.
    pub reach: L,
    /// Unit normal of the light's front side.
    pub normal: Vec3<L>,
    /// Emitted radiance, the same in all directions.
    pub radiance: Vec3<L>,
    /// Density of choosing the point, per area.
    pub pdf_area: L,
}

/// All emitters of a world, and how one is chosen.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    emitters: Vec<Emitter>,
    /// What sampling reads of each emitter, in one cache line: corners and normal, then radiance and density.
    rows: Vec<[[f32; 8]; 2]>,
    table: AliasTable,
    power: f64,
}

/// Rec. 709 luminance.
pub fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

impl Lights {
    /// Lights of emitters with positive area and radiance.
    pub fn new(emitters: Vec<Emitter>) -> Self {
        let powers: Vec<f64> = emitters.iter().map(|e| f64::from(e.area) * luminance(e.radiance)).collect();
        let table = if powers.is_empty() { AliasTable::default() } else { AliasTable::new(&powers) };
        let mut lights = Self { emitters, rows: Vec::new(), table, power: powers.iter().sum() };
        lights.rows = lights.emitters.iter().map(|e| lights.row(e)).collect();
        lights
    }
    fn row(&self, e: &Emitter) -> [[f32; 8]; 2] {
        let ([[ax, ay, az], [bx, by, bz], [cx, cy, cz]], [nx, ny, nz], [r, g, b]) = (e.corners, e.normal, e.radiance);
        [[ax, ay, az, bx, by, bz, cx, cy], [cz, nx, ny, nz, r, g, b, self.pdf_area(e.radiance)]]
    }
    /// Number of luminous triangles.
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
    /// Density per area with which [`Self::sample`] chooses a point on a surface of this radiance: choice by power makes
    /// it the same on all triangles of a material.
    pub fn pdf_area(&self, radiance: [f32; 3]) -> f32 {
        if self.power > 0.0 { (luminance(radiance) / self.power) as f32 } else { 0.0 }
    }
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.emitters.len() * (size_of::<Emitter>() + 64 + 8)
    }
    /// Chooses a point on a light by four uniform numbers. There must be a light.
    #[inline(always)]
    pub fn sample<L: Lanes>(&self, u: [L; 4]) -> LightPoint<L> {
        let (pick, coin) = (u[0].array(), u[1].array());
        let mut chosen = [0; MAX_LANES];
        for ((chosen, &u), &coin) in chosen.iter_mut().zip(pick.as_ref()).zip(coin.as_ref()) {
            *chosen = self.table.draw(u, coin);
        }
        let row = |i: usize| &self.rows[chosen[i]];
        let [ax, ay, az, bx, by, bz, cx, cy] = L::columns8(|i| &row(i)[0]);
        let [cz, nx, ny, nz, red, green, blue, pdf_area] = L::columns8(|i| &row(i)[1]);
        let (a, b, c) = (Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz));
        let (v, w) = warp::triangle([u[2], u[3]]);
        let t = L::splat(1.0) - v - w;
        LightPoint {
            point: a.mul_add(t, b.mul_add(v, c * w)),
            reach: largest_coordinate([a, b, c]),
            normal: Vec3::new(nx, ny, nz),
            radiance: Vec3::new(red, green, blue),
            pdf_area,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Decision, Sampler, Xoshiro};

    fn emitter(area: f32, radiance: f32) -> Emitter {
        Emitter {
            corners: [[0.0; 3], [2.0 * area, 0.0, 0.0], [0.0, 1.0, 0.0]],
            normal: [0.0, 0.0, 1.0],
            area,
            radiance: [radiance; 3],
        }
    }

    /// Counts of choices against power, by chi-squared with 4 degrees of freedom: 18.47 is p = 10^-3.
    #[test]
    fn lights_are_chosen_by_power_and_the_density_says_so() {
        let lights = Lights::new(
            [(1.0, 1.0), (0.1, 1.0), (3.0, 2.0), (0.5, 10.0), (2.0, 0.05)].map(|(a, r)| emitter(a, r)).to_vec(),
        );
        let n = 100_000u32;
        let mut counts = [0u32; 5];
        for i in 0..n {
            let mut s = Xoshiro::start::<f32>(1, i, 0);
            let u = Xoshiro::draw::<f32, 4>(&mut s, Decision::Light, 0);
            counts[lights.table.draw(u[0], u[1])] += 1;
        }
        let mut chi2 = 0.0;
        for (e, &count) in lights.emitters().iter().zip(&counts) {
            let expected = f64::from(lights.pdf_area(e.radiance) * e.area) * f64::from(n);
            chi2 += (f64::from(count) - expected).powi(2) / expected;
        }
        assert!(chi2 < 18.47, "chi2 = {chi2}, {counts:?}");
    }
}
