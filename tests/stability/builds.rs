//! Meshes that give a builder of trees nothing to go by.

use crate::common::meshes::{Soup, patch, soup};
use crate::common::random::Random;
use crate::common::rays::{bits, bounds, degenerate, ray};
use crate::row::{Finding, Part, Row};
use std::time::Instant;
use wavetrace::accel::{BuildOptions, Bvh, Quality, Single, brute_force};

pub const ROW: Row = Row {
    part: Part::Intersection,
    name: "builds",
    title: "Meshes that no builder can split",
    fails: "A tree that halves the box of its triangles' middles never ends where all middles coincide, and goes as deep as there are triangles \
            where each is twice as far away as the one before. Stacks of a fixed size then overflow.",
    remedy: "Sets of triangles are cut where the surface area heuristic is least; where their size leaves no other choice, they are \
             halved by number, so that no way is longer than 70 nodes. Where reinsertion makes a way too long for a traversal's stack \
             of 512 entries, the tree before it is taken. Every tree is checked to need no more.",
    source: "Wald 2007 for the heuristic in bins; halving by number is our own",
    run,
};

/// Levels after which a tree counts as endless.
const ENDLESS: usize = 10_000;

/// Depth of a tree that halves the box of the middles along its longest side, down to leaves of four.
fn textbook(corners: &Soup) -> usize {
    let middles: Vec<[f32; 3]> =
        corners.iter().map(|t| std::array::from_fn(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0)).collect();
    let (mut stack, mut deepest) = (vec![(middles, 1)], 0);
    while let Some((points, depth)) = stack.pop() {
        deepest = deepest.max(depth);
        if points.len() <= 4 || depth >= ENDLESS {
            continue;
        }
        let end = |k: usize, f: fn(f32, f32) -> f32| points.iter().map(|p| p[k]).fold(points[0][k], f);
        let (low, high) = ([0, 1, 2].map(|k| end(k, f32::min)), [0, 1, 2].map(|k| end(k, f32::max)));
        let axis = (1..3).fold(0, |axis, k| if high[k] - low[k] > high[axis] - low[axis] { k } else { axis });
        let middle = 0.5 * low[axis] + 0.5 * high[axis];
        let (left, right): (Vec<_>, Vec<_>) = points.into_iter().partition(|p| p[axis] < middle);
        if left.is_empty() || right.is_empty() {
            // The same box again, for ever.
            return ENDLESS;
        }
        stack.extend([(left, depth + 1), (right, depth + 1)]);
    }
    deepest
}

fn run() -> Finding {
    let (mut deepest, mut slowest, mut endless, mut deep) = (0, 0.0f64, 0, 0);
    let mut cases = degenerate(100_000);
    let triangles = cases.len();
    cases.push(("nothing", Vec::new()));
    cases.push(("one triangle", soup(&patch(0.0, 0.0, 0.0, 1.0, 1.0))[..1].to_vec()));
    cases.push(("two triangles", soup(&patch(0.0, 0.0, 0.0, 1.0, 1.0))));
    for (number, (name, corners)) in cases.iter().enumerate() {
        let depth = textbook(corners);
        endless += usize::from(depth == ENDLESS);
        deep = if depth < ENDLESS { deep.max(depth) } else { deep };
        for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
            let start = Instant::now();
            let bvh = Bvh::build_with(corners, &BuildOptions { quality, threads: 0, ..BuildOptions::default() }).unwrap();
            slowest = slowest.max(start.elapsed().as_secs_f64());
            assert!(bvh.stack_bound() <= 512, "{name}, {quality:?}: {}", bvh.stack_bound());
            deepest = deepest.max(bvh.stack_bound());
            let (mut single, mut random, bounds) = (Single::new(&bvh), Random(number as u64), bounds(corners));
            for kind in [0, 1, 2, 3, 4, 5] {
                let ray = ray(&mut random, corners, &bounds, kind);
                assert_eq!(bits(&single.closest(&bvh, &ray)), bits(&brute_force(corners, &ray)), "{name}, {quality:?}");
            }
        }
    }
    assert!(endless > 0, "the textbook's method should not end somewhere");
    // A minute for 100,000 triangles is what a square of their number would take.
    assert!(slowest < 60.0, "{slowest} s");
    println!("slowest build: {slowest:.1} s");
    Finding {
        textbook: format!("{endless} of {triangles} meshes never end; of the others {deep} levels"),
        ours: format!("at most {deepest} entries on a stack of 512; none took a minute"),
        how: "100,000 triangles: the same one, middles on a point, on lines, evenly or farther and farther apart, sizes from 10<sup>-6</sup> \
              to 10<sup>6</sup>, no area; and none, one, two. Three qualities; rays find what brute force finds."
            .into(),
        picture: None,
    }
}
