//! Building the tree of lights, from the top: sets of emitters are split where power, extent and spread of the normals of
//! both sides, multiplied, have the least sum.

use super::{LEAF, Node, Tree};
use crate::light::importance::{Bounds, ROUNDING};

/// Places at which a split is tried, per axis, and one.
const BINS: usize = 16;
/// Levels at most; then a way would not fit its bits.
const LEVELS: u32 = 32;

/// What a set of emitters spans.
#[derive(Clone, Copy)]
struct Extent {
    lo: [f32; 3],
    hi: [f32; 3],
    power: f64,
    /// Sum of normals, on the side of a common axis, by power.
    normals: [f64; 3],
    count: usize,
}

impl Extent {
    const NONE: Self =
        Self { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3], power: 0.0, normals: [0.0; 3], count: 0 };

    fn add(&mut self, b: &Bounds, axis: [f32; 3]) {
        let power = f64::from(b.power);
        let signed = if dot(b.axis, axis) < 0.0 { -power } else { power };
        for k in 0..3 {
            self.lo[k] = self.lo[k].min(b.centre[k] - b.radius);
            self.hi[k] = self.hi[k].max(b.centre[k] + b.radius);
            self.normals[k] += signed * f64::from(b.axis[k]);
        }
        self.power += power;
        self.count += 1;
    }
    fn join(&mut self, other: &Self) {
        for k in 0..3 {
            self.lo[k] = self.lo[k].min(other.lo[k]);
            self.hi[k] = self.hi[k].max(other.hi[k]);
            self.normals[k] += other.normals[k];
        }
        self.power += other.power;
        self.count += other.count;
    }
    /// Power times surface of the box times spread: 1 where all normals are parallel, up to 4 where they cancel.
    fn cost(&self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let [x, y, z] = std::array::from_fn(|k| f64::from(self.hi[k] - self.lo[k]));
        let mean = self.normals.iter().map(|n| n * n).sum::<f64>().sqrt() / self.power;
        self.power * (x * y + y * z + z * x) * (4.0 - 3.0 * mean)
    }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Bounds of a set of emitters.
fn bounds_of(set: &[u32], all: &[Bounds]) -> Bounds {
    let of = || set.iter().map(|&i| &all[i as usize]);
    let first = all[set[0] as usize].axis;
    let mut extent = Extent::NONE;
    of().for_each(|b| extent.add(b, first));
    let centre: [f32; 3] = std::array::from_fn(|k| 0.5 * (extent.lo[k] + extent.hi[k]));
    let radius = of().map(|b| length(std::array::from_fn(|k| b.centre[k] - centre[k])) + b.radius).fold(0.0, f32::max);
    let sum = extent.normals.map(|n| (n / extent.power) as f32);
    let norm = length(sum);
    let axis = if norm > 1e-3 { sum.map(|n| n / norm) } else { first };
    let cos = of().map(|b| dot(b.axis, axis).abs()).fold(1.0, f32::min);
    Bounds {
        centre,
        radius: radius * ROUNDING,
        axis,
        cos_cone: (cos - (ROUNDING - 1.0)).max(0.0),
        power: extent.power as f32,
    }
}

fn length(v: [f32; 3]) -> f32 {
    dot(v, v).sqrt()
}

/// Parts `set` in two, none of them empty; in halves where no split is better or few levels are left.
fn split<'a>(set: &'a mut [u32], all: &[Bounds], whole: &Bounds, level: u32) -> (&'a mut [u32], &'a mut [u32]) {
    let needed = usize::BITS - (set.len() - 1).leading_zeros();
    let crowded = level + needed + 1 >= LEVELS;
    let middle = |i: u32, k: usize| all[i as usize].centre[k];
    let range = |k: usize| {
        set.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), &i| (lo.min(middle(i, k)), hi.max(middle(i, k))))
    };
    let ranges = [range(0), range(1), range(2)];
    let widest = (0..3).max_by(|&a, &b| (ranges[a].1 - ranges[a].0).total_cmp(&(ranges[b].1 - ranges[b].0)));
    let longest = widest.map_or(0.0, |k| ranges[k].1 - ranges[k].0);
    let bin = |i: u32, k: usize| {
        let (lo, hi) = ranges[k];
        (((middle(i, k) - lo) / (hi - lo) * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for k in (0..3).filter(|&k| !crowded && ranges[k].1 - ranges[k].0 > 1e-6 * longest) {
        let mut bins = [Extent::NONE; BINS];
        set.iter().for_each(|&i| bins[bin(i, k)].add(&all[i as usize], whole.axis));
        let mut right = [Extent::NONE; BINS];
        for b in (0..BINS - 1).rev() {
            right[b] = right[b + 1];
            right[b].join(&bins[b + 1]);
        }
        // Long thin sets are rather cut across.
        let shape = f64::from(longest / (ranges[k].1 - ranges[k].0));
        let mut left = Extent::NONE;
        for b in 0..BINS - 1 {
            left.join(&bins[b]);
            if left.count == 0 || right[b].count == 0 {
                continue;
            }
            let cost = shape * (left.cost() + right[b].cost());
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, k, b));
            }
        }
    }
    if let Some((_, k, b)) = best {
        let mut at = 0;
        for i in 0..set.len() {
            if bin(set[i], k) <= b {
                set.swap(at, i);
                at += 1;
            }
        }
        return set.split_at_mut(at);
    }
    if let Some(k) = widest {
        let half = set.len() / 2;
        set.select_nth_unstable_by(half, |&a, &b| middle(a, k).total_cmp(&middle(b, k)).then(a.cmp(&b)));
    }
    set.split_at_mut(set.len() / 2)
}

/// Adds the subtree of `set`; its number as a child.
fn add(tree: &mut Tree, set: &mut [u32], all: &[Bounds], whole: &Bounds, way: u32, level: u32) -> u32 {
    if let [emitter] = *set {
        tree.ways[emitter as usize] = way;
        return emitter | LEAF;
    }
    let number = tree.nodes.len();
    tree.nodes.push(Node::default());
    let (left, right) = split(set, all, whole, level);
    let sides = [bounds_of(left, all), bounds_of(right, all)];
    let children = [
        add(tree, left, all, &sides[0], way, level + 1),
        add(tree, right, all, &sides[1], way | 1 << level, level + 1),
    ];
    let mut scales = [0.0; 8];
    scales[..4].copy_from_slice(sides.map(|b| b.scale()).as_flattened());
    tree.nodes[number] = Node { bounds: sides.map(|b| b.row()), scales, children };
    number as u32
}

/// The tree of two emitters or more.
pub(super) fn build(all: &[Bounds]) -> Tree {
    let mut tree = Tree { nodes: Vec::with_capacity(all.len()), ways: vec![0; all.len()] };
    let mut set: Vec<u32> = (0..all.len() as u32).collect();
    let whole = bounds_of(&set, all);
    add(&mut tree, &mut set, all, &whole, 0, 0);
    tree
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Emitters of many sizes, powers and directions; every third one far away.
    fn emitters(count: u32) -> Vec<Bounds> {
        let wave = |i: u32, by: f32| (i as f32 * by).sin();
        let of = |i: u32| {
            let away = if i.is_multiple_of(3) { 5.0 } else { 0.0 };
            let axis = [wave(i, 0.9), wave(i, 1.9), 1.5];
            Bounds {
                centre: [wave(i, 0.37) + away, 2.0 * wave(i, 0.73), 0.5 * wave(i, 0.11)],
                radius: 0.02 + 0.1 * wave(i, 1.7).powi(2),
                axis: axis.map(|x| x / length(axis) * if i.is_multiple_of(2) { 1.0 } else { -1.0 }),
                cos_cone: 1.0,
                power: 0.1 + 3.0 * wave(i, 2.3).powi(4),
            }
        };
        (0..count).map(of).collect()
    }

    /// Power, surface of the box and spread of the normals of a set, multiplied.
    fn cost(set: &[u32], all: &[Bounds], axis: [f32; 3]) -> f64 {
        let of =
            |least: &dyn Fn(&Bounds) -> f32| set.iter().map(|&i| least(&all[i as usize])).fold(f32::INFINITY, f32::min);
        let [x, y, z] = [0, 1, 2].map(|k: usize| {
            f64::from(-of(&|b| -(b.centre[k] + b.radius))) - f64::from(of(&|b| b.centre[k] - b.radius))
        });
        let (mut power, mut sum) = (0.0, [0.0; 3]);
        for b in set.iter().map(|&i| &all[i as usize]) {
            let side = if dot(b.axis, axis) < 0.0 { -1.0 } else { 1.0 };
            power += f64::from(b.power);
            (0..3).for_each(|k| sum[k] += side * f64::from(b.power) * f64::from(b.axis[k]));
        }
        let aligned = sum.iter().map(|x| x * x).sum::<f64>().sqrt() / power;
        power * (x * y + y * z + z * x) * (4.0 - 3.0 * aligned)
    }

    /// No plane between bins, across any axis, parts a set at less cost.
    #[test]
    fn sets_are_split_where_it_costs_least() {
        let all = emitters(300);
        for (first, count) in [(0, 2), (10, 3), (30, 5), (50, 17), (100, 40), (0, 300)] {
            let mut set: Vec<u32> = (first..first + count).collect();
            let whole = bounds_of(&set, &all);
            let centre = |i: u32, k: usize| all[i as usize].centre[k];
            let ends = |k: usize| {
                let of = set.iter().map(|&i| centre(i, k));
                (of.clone().fold(f32::INFINITY, f32::min), of.fold(f32::NEG_INFINITY, f32::max))
            };
            let longest = (0..3).map(|k| ends(k).1 - ends(k).0).fold(0.0, f32::max);
            let mut least = (f64::INFINITY, Vec::new());
            for k in 0..3 {
                let (lo, hi) = ends(k);
                for bin in 1..BINS {
                    let goes_left = |i: u32| (centre(i, k) - lo) / (hi - lo) * (BINS as f32) < bin as f32;
                    let (left, right): (Vec<u32>, Vec<u32>) = set.iter().partition(|&&i| goes_left(i));
                    if left.is_empty() || right.is_empty() {
                        continue;
                    }
                    let sides = cost(&left, &all, whole.axis) + cost(&right, &all, whole.axis);
                    let cost = f64::from(longest / (hi - lo)) * sides;
                    if cost < least.0 * (1.0 - 1e-9) {
                        least = (cost, left);
                    }
                }
            }
            let (left, right) = split(&mut set, &all, &whole, 0);
            assert_eq!(left.len() + right.len(), count as usize);
            left.sort_unstable();
            assert_eq!(left, least.1, "{count} emitters");
        }
    }

    /// Where all are at one place, or few levels are left, halves.
    #[test]
    fn sets_that_cannot_be_split_are_halved() {
        let one = emitters(1)[0];
        let (mut set, all) = ((0..9).collect::<Vec<u32>>(), vec![one; 9]);
        assert_eq!(split(&mut set, &all, &one, 0).0.len(), 4);
        let all = emitters(64);
        let mut set: Vec<u32> = (0..64).collect();
        let whole = bounds_of(&set, &all);
        // 64 emitters need six levels more.
        let (left, right) = split(&mut set, &all, &whole, LEVELS - 7);
        assert_eq!(left.len(), 32);
        let widest = |i: u32| all[i as usize].centre[0];
        let last = left.iter().map(|&i| widest(i)).fold(f32::NEG_INFINITY, f32::max);
        assert!(right.iter().all(|&i| widest(i) >= last));
    }

    #[test]
    fn bounds_hold_their_emitters() {
        let all = emitters(100);
        for count in [1, 2, 7, 100] {
            let set: Vec<u32> = (0..count).collect();
            let bounds = bounds_of(&set, &all);
            let power: f32 = all[..count as usize].iter().map(|b| b.power).sum();
            assert!((bounds.power - power).abs() < 1e-5 * power);
            assert!((length(bounds.axis) - 1.0).abs() < 1e-5);
            for b in &all[..count as usize] {
                let away = length(std::array::from_fn(|k| b.centre[k] - bounds.centre[k]));
                assert!(away + b.radius <= bounds.radius);
                assert!(dot(b.axis, bounds.axis).abs() >= bounds.cos_cone);
            }
            // Not much more than that: the ball reaches some emitter, the cone some normal.
            let far = |b: &Bounds| length(std::array::from_fn(|k| b.centre[k] - bounds.centre[k])) + b.radius;
            assert!(all[..count as usize].iter().any(|b| far(b) >= bounds.radius / ROUNDING.powi(2)));
            assert!(all[..count as usize].iter().any(|b| dot(b.axis, bounds.axis).abs() < bounds.cos_cone + 1e-3));
        }
    }
}
