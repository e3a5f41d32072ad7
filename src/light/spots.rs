//! Where focused light comes from: for each cell of space that such light reaches, balls about the places on mirrors and
//! glass from which it was seen to arrive, and how often it is worth looking there (after Jensen 1995, "Importance Driven
//! Path Tracing using the Photon Map"). Any such map gives right images; a good one gives them sooner.

use super::targets::{Ball, Cone};
use crate::lanes::{Lanes, LanesU32, MAX_LANES, Vec3, select3};
use std::collections::BTreeMap;

/// Balls of a cell at most.
const MOST: usize = 4;
/// Cells along the longest side of the box about all that was lit.
const SIDE: usize = 24;
/// Boxes along that side by which places on mirrors and glass are told apart.
const PLACES: f32 = 16.0;
/// Focused light that arrived.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// Where.
    pub at: [f32; 3],
    /// The last place on a mirror or on glass before.
    pub from: [f32; 3],
    /// How much: more than 0.
    pub energy: f32,
}

/// The map of all cells.
#[derive(Clone, Debug)]
pub struct Spots {
    low: [f32; 3],
    cells_per_unit: f32,
    /// Row of each cell; 0 where no light arrives.
    cells: Vec<u16>,
    /// Per row, how likely a path looks there.
    chances: Vec<f32>,
    /// Per row, with which probability each ball is aimed at.
    shares: Vec<[f32; MOST]>,
    /// Per row, centre and radius of each ball.
    balls: Vec<[[f32; 4]; MOST]>,
}

impl Spots {
    /// The map of what arrived. `mean_chance`: the share of the paths that look for the light of a cell of mean energy, while
    /// they have lost none of their own. It grows with the root of the energy, as does the deviation of what is left to
    /// chance.
    pub fn new(arrivals: &[Arrival], mean_chance: f32) -> Self {
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        if let Some(first) = arrivals.first() {
            (low, high) = (first.at, first.at);
        }
        for a in arrivals {
            low = std::array::from_fn(|k| low[k].min(a.at[k]));
            high = std::array::from_fn(|k| high[k].max(a.at[k]));
        }
        let extent = (0..3).map(|k| high[k] - low[k]).fold(f32::MIN_POSITIVE.sqrt(), f32::max);
        let mut map = Self {
            low,
            cells_per_unit: SIDE as f32 / extent,
            cells: vec![0; SIDE * SIDE * SIDE],
            chances: vec![0.0],
            shares: vec![[0.0; MOST]],
            balls: vec![[[0.0; 4]; MOST]],
        };
        let mut lit: BTreeMap<usize, Vec<(f32, Ball)>> = BTreeMap::new();
        for group in map.groups(arrivals, PLACES / extent).chunk_by(|a, b| a.0 == b.0) {
            let of = group.iter().map(|&(_, index)| &arrivals[index]);
            let Some(mut ball) = Ball::about(of.clone().map(|a| a.from)) else { continue };
            // Few points say little about where others would be.
            let few = 1.0 / group.len() as f32;
            ball.radius = ball.radius * (1.0 + few.sqrt()) + 0.5 * extent / PLACES * few;
            lit.entry(group[0].0.0).or_default().push((of.map(|a| a.energy).sum(), ball));
        }
        let mean = arrivals.iter().map(|a| a.energy).sum::<f32>() / lit.len().max(1) as f32;
        for (cell, mut from) in lit {
            from.sort_by(|a, b| b.0.total_cmp(&a.0));
            from.truncate(MOST);
            map.add(cell, &from, mean_chance / mean.sqrt());
        }
        map
    }

    /// Arrivals by cell and place, sorted: those of one group lie together.
    fn groups(&self, arrivals: &[Arrival], places_per_unit: f32) -> Vec<((usize, [i32; 3]), usize)> {
        let key = |a: &Arrival| {
            (self.cells(Vec3::<f32>::splat(a.at)) as usize, a.from.map(|c| (c * places_per_unit).floor() as i32))
        };
        let mut keys: Vec<_> = arrivals.iter().enumerate().map(|(index, a)| (key(a), index)).collect();
        keys.sort_unstable();
        keys
    }

    /// A cell, lit from some balls; `chance` of looking there is for an energy of 1.
    fn add(&mut self, cell: usize, from: &[(f32, Ball)], chance: f32) {
        let Ok(row) = u16::try_from(self.balls.len()) else { return };
        let energy: f32 = from.iter().map(|f| f.0).sum();
        let (mut shares, mut balls) = ([0.0; MOST], [[0.0; 4]; MOST]);
        for (k, (part, Ball { centre: [x, y, z], radius })) in from.iter().enumerate() {
            // Half by energy, so that a ball of which little is known yet is not left out.
            shares[k] = 0.5 * (part / energy + 1.0 / from.len() as f32);
            balls[k] = [*x, *y, *z, *radius];
        }
        self.cells[cell] = row;
        self.chances.push(chance * energy.sqrt());
        self.shares.push(shares);
        self.balls.push(balls);
    }

    /// The cells of points; those outside the box belong to a cell at its border.
    #[inline(always)]
    fn cells<L: Lanes>(&self, point: Vec3<L>) -> L::Uint {
        let at = (point - Vec3::splat(self.low)) * L::splat(self.cells_per_unit);
        let side = L::splat(SIDE as f32);
        whole((side_cell(at.z) * side + side_cell(at.y)) * side + side_cell(at.x))
    }
    #[inline(always)]
    fn rows<L: Lanes>(&self, point: Vec3<L>) -> [usize; MAX_LANES] {
        let cells = self.cells(point).array();
        let mut rows = [0; MAX_LANES];
        for (row, &cell) in rows.iter_mut().zip(cells.as_ref()) {
            *row = usize::from(self.cells[cell as usize]);
        }
        rows
    }

    /// How likely a path that has so much of its energy left, 1 at the camera, looks for focused light at a point.
    #[inline(always)]
    pub fn chance<L: Lanes>(&self, point: Vec3<L>, energy: L) -> L {
        let rows = self.rows(point);
        (L::from_fn(|i| self.chances[rows[i]]) * energy).min(L::splat(1.0))
    }
    /// Density per solid angle with which [`Self::sample`] gives a unit direction at a point; 0 where no light arrives.
    #[inline(always)]
    pub fn pdf<L: Lanes>(&self, point: Vec3<L>, direction: Vec3<L>) -> L {
        let rows = self.rows(point);
        let shares = L::columns4(|i| &self.shares[rows[i]]);
        let (zero, mut sum) = (L::splat(0.0), L::splat(0.0));
        for (k, share) in shares.into_iter().enumerate() {
            let cone = self.cone(&rows, k, point);
            let solid_angle = cone.height.max(L::splat(f32::MIN_POSITIVE)) * L::splat(std::f32::consts::TAU);
            sum = sum + L::select(cone.holds(direction), share / solid_angle, zero);
        }
        sum
    }
    /// A unit direction at a point, uniform in a cone about a ball of its cell, by three uniform numbers. Where there is no
    /// ball it is a direction all the same.
    #[inline(always)]
    pub fn sample<L: Lanes>(&self, point: Vec3<L>, pick: L, [u, v]: [L; 2]) -> Vec3<L> {
        let rows = self.rows(point);
        let shares = L::columns4(|i| &self.shares[rows[i]]);
        let zero = L::splat(0.0);
        let mut chosen = self.cone(&rows, 0, point);
        let mut sum = shares[0];
        for (k, share) in shares.into_iter().enumerate().skip(1) {
            let cone = self.cone(&rows, k, point);
            let here = sum.le(pick) & share.gt(zero);
            chosen.axis = select3(here, cone.axis, chosen.axis);
            chosen.height = L::select(here, cone.height, chosen.height);
            sum = sum + share;
        }
        chosen.direction([u, v])
    }
    #[inline(always)]
    fn cone<L: Lanes>(&self, rows: &[usize; MAX_LANES], k: usize, point: Vec3<L>) -> Cone<L> {
        let [x, y, z, radius] = L::columns4(|i| &self.balls[rows[i]][k]);
        Cone::about(Vec3::new(x, y, z), radius, point)
    }
}

/// The cell along one side, for a place in units of cells.
#[inline(always)]
fn side_cell<L: Lanes>(at: L) -> L {
    let zero = L::splat(0.0);
    // What is no number is not above 0.
    let inside = L::select(at.gt(zero), at, zero).min(L::splat(SIDE as f32));
    (inside - L::splat(0.5)).round().max(zero).min(L::splat((SIDE - 1) as f32))
}

/// Numbers below 2^23 without a fraction, as integers.
#[inline(always)]
fn whole<L: Lanes>(value: L) -> L::Uint {
    let shift = 8_388_608.0f32;
    (value + L::splat(shift)).to_bits().xor(L::Uint::splat(shift.to_bits()))
}

impl Default for Spots {
    /// No light arrives anywhere.
    fn default() -> Self {
        Self::new(&[], 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Kernel, Wide, dispatch};
    use crate::sampling::{Decision, Sampler, Xoshiro};
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    const MEAN_CHANCE: f32 = 0.5;

    fn numbers<const N: usize>(seed: u64, i: u32) -> [f32; N] {
        let mut s = Xoshiro::start::<f32>(seed, i, 0);
        Xoshiro::draw(&mut s, Decision::Scatter, 0)
    }

    /// One of 64 points of a cube.
    fn point(seed: u64, i: u32) -> [f32; 3] {
        numbers(seed, i).map(|c: f32| (4.0 * c).floor() / 3.0)
    }

    /// Light that arrives at them, from some boxes of side `size`.
    fn arrival(places: u32, size: f32, i: u32) -> Arrival {
        let [x, y, z, energy] = numbers(2, i);
        let [a, b, c] = numbers(3, i % places).map(|c: f32| 4.0 * c - 1.5);
        Arrival { at: point(1, i), from: [a + size * x, b + size * y, c + size * z], energy: 0.1 + energy }
    }

    fn spots(places: u32, size: f32) -> Spots {
        Spots::new(&(0..20_000).map(|i| arrival(places, size, i)).collect::<Vec<_>>(), MEAN_CHANCE)
    }

    #[test]
    fn every_cell_has_its_number() {
        let map = spots(1, 0.2);
        for number in 0..SIDE * SIDE * SIDE {
            let place = [number % SIDE, number / SIDE % SIDE, number / (SIDE * SIDE)];
            let centre = place.map(|i| (i as f32 + 0.5) / map.cells_per_unit);
            let point: [f32; 3] = std::array::from_fn(|axis| map.low[axis] + centre[axis]);
            assert_eq!(map.cells(Vec3::<f32>::splat(point)) as usize, number, "{place:?}");
        }
    }

    /// Directions against the stated density: chi-squared over 8 x 16 cells of the sphere, whose integrals are sums over
    /// 2^20 uniform directions with an error of their own; cells below 5 pooled, and nothing outside of what it covers. 6 tests
    /// at 10^-3 in all (Sidak): each at 1.7e-4.
    #[test]
    fn directions_follow_the_density() {
        let cell = |d: [f32; 3]| {
            let turn = (d[1].atan2(d[0]) / std::f32::consts::TAU + 0.5).clamp(0.0, 0.999_99);
            ((0.5 * d[2] + 0.5).clamp(0.0, 0.999_99) * 8.0) as usize * 16 + (turn * 16.0) as usize
        };
        for places in [1, 3, 20] {
            let map = spots(places, 0.2);
            for i in 0..2 {
                let point = Vec3::splat(point(1, i));
                let n = 1 << 20;
                let (mut expected, mut variance) = (vec![0.0f64; 128], vec![0.0f64; 128]);
                for i in 0..n {
                    let [u, v] = numbers(4, i);
                    let (z, turn) = (2.0 * u - 1.0, v * std::f32::consts::TAU);
                    let r = (1.0 - z * z).max(0.0).sqrt();
                    let d = [r * turn.cos(), r * turn.sin(), z];
                    let part = f64::from(map.pdf(point, Vec3::splat(d))) * 4.0 * std::f64::consts::PI / f64::from(n);
                    expected[cell(d)] += part;
                    variance[cell(d)] += part * part;
                }
                let (all, error) = (expected.iter().sum::<f64>(), variance.iter().sum::<f64>().sqrt());
                // 3.8 standard deviations: 6 tests at 10^-3 in all.
                assert!((all - 1.0).abs() < 3.8 * error, "{places} places: the density integrates to {all}");
                let samples = 4000;
                let mut counts = vec![0u32; 128];
                for i in 0..samples {
                    let [a, b, c] = numbers(5, i);
                    let d = map.sample(point, a, [b, c]);
                    assert!(map.pdf(point, d) > 0.0, "{places} places, sample {i}");
                    counts[cell(d.lane(0))] += 1;
                }
                let (mut chi2, mut cells, mut rare) = (0.0, 0, (0.0, 0.0));
                for (&count, (&p, &variance)) in counts.iter().zip(expected.iter().zip(&variance)) {
                    let mean = p * f64::from(samples);
                    if mean < 5.0 {
                        rare = (rare.0 + mean, rare.1 + f64::from(count));
                    } else {
                        chi2 += (f64::from(count) - mean).powi(2) / (mean + variance * f64::from(samples).powi(2));
                        cells += 1;
                    }
                }
                assert!(rare.1 <= rare.0 + 5.0 * rare.0.sqrt() + 5.0, "{places} places: {rare:?}");
                let p = if cells > 0 { ChiSquared::new(f64::from(cells)).unwrap().sf(chi2) } else { 1.0 };
                assert!(p > 1.7e-4, "{places} places: p = {p}");
            }
        }
    }

    /// From where light arrives, the balls of the cell hold where it came from.
    #[test]
    fn light_is_looked_for_where_it_came_from() {
        for places in [1, 2, 4] {
            let map = spots(places, 1e-3);
            for i in 0..500 {
                let Arrival { at, from, .. } = arrival(places, 1e-3, i);
                let (point, from) = (Vec3::splat(at), Vec3::splat(from));
                assert!(map.pdf(point, (from - point).normalize()) > 0.0, "arrival {i} of {places} places");
                assert!(map.chance(point, 1.0) > 0.0);
            }
        }
    }

    #[test]
    fn where_nothing_arrives_nothing_is_looked_for() {
        let none = Spots::default();
        let one = Spots::new(&[Arrival { at: [0.0; 3], from: [1.0; 3], energy: 1.0 }], MEAN_CHANCE);
        for i in 0..100 {
            let [x, y, z, u, v, w] = numbers(8, i).map(|c: f32| 2.0 * c - 1.0);
            let (point, direction) = (Vec3::splat([x, y, z]), Vec3::splat([u, v, w]).normalize());
            assert_eq!((none.chance(point, 1.0), none.pdf(point, direction)), (0.0, 0.0));
            assert!(none.sample(point, 0.5, [0.5, 0.5]).length2().is_finite());
            assert!(one.pdf(Vec3::splat([0.0; 3]), direction).is_finite());
        }
        assert_eq!(none.chance(Vec3::splat([f32::NAN; 3]), 1.0), 0.0);
        assert_eq!(one.chance(Vec3::splat([0.0; 3]), 0.2), 0.2 * MEAN_CHANCE);
    }

    /// Eight points at once.
    struct Eight<'a>(&'a Spots, u32);
    impl Kernel for Eight<'_> {
        type Out = [[f32; 8]; 5];
        #[inline(always)]
        fn run<W: Wide>(self) -> Self::Out {
            let number = |k: usize| W::from_fn(|i| numbers::<3>(6, self.1 + i as u32)[k]);
            let point = Vec3::from_fn(|i| point(7, self.1 + i as u32));
            let d = self.0.sample(point, number(0), [number(1), number(2)]);
            [d.x, d.y, d.z, self.0.pdf(point, d), self.0.chance(point, number(0))].map(Lanes::array)
        }
    }

    #[test]
    fn wide_matches_scalar() {
        let map = spots(20, 0.2);
        for first in (0..400).step_by(8) {
            let wide = dispatch(Eight(&map, first));
            for i in 0..8 {
                let [a, b, c] = numbers(6, first + i as u32);
                let point = Vec3::<f32>::splat(point(7, first + i as u32));
                let d = map.sample(point, a, [b, c]);
                let expected = [d.x, d.y, d.z, map.pdf(point, d), map.chance(point, a)];
                assert_eq!(wide.map(|column| column[i]), expected);
            }
        }
    }
}
