//! Rays along axes, in planes of boxes and triangles, and at grazing angles.

use crate::common::meshes::Soup;
use crate::common::random::Random;
use crate::common::rays::{any_of, bits, bounds, cases, closest_of, ray};
use crate::common::samples;
use crate::row::{Finding, Part, Row};
use wavetrace::accel::{Bvh, Hit, Many, Ray, Scalar, Single, Streams, Tiles, brute_force};

pub const ROW: Row = Row {
    part: Part::Intersection,
    name: "grazing",
    title: "Rays along axes, in planes, at grazing angles",
    fails: "A slab test divides by the components of the direction. At 0 that is infinite, and 0 times infinity is no number: a ray in \
            the plane of a box misses what the box holds. Rounding at grazing angles puts a hit just outside its box.",
    remedy: "Components below 10<sup>-20</sup> count as that in box tests, slabs are padded by their rounding error, and boxes behind a hit \
             are entered as long as the distance's error could bring a nearer one.",
    source: "Ize 2013",
    run,
};

/// Whether a ray misses the box of a triangle by the slab test as it is usually written.
fn misses_box(triangle: &[[f32; 3]; 3], ray: &Ray) -> bool {
    let (mut near, mut far) = (0.0f32, ray.t_max);
    for k in 0..3 {
        let (low, high) = (
            triangle.iter().map(|p| p[k]).fold(f32::MAX, f32::min),
            triangle.iter().map(|p| p[k]).fold(f32::MIN, f32::max),
        );
        let inverse = 1.0 / ray.direction[k];
        let (a, b) = ((low - ray.origin[k]) * inverse, (high - ray.origin[k]) * inverse);
        let (a, b) = if a > b { (b, a) } else { (a, b) };
        // As written, a comparison with what is no number is false, and the box is missed.
        near = if a > near { a } else { near };
        far = if b < far { b } else { far };
        if a.is_nan() || b.is_nan() {
            return true;
        }
    }
    near > far
}

/// What kernels find beside what brute force finds.
struct Compared {
    expected: Vec<Hit>,
    /// Rays for which any kernel finds another distance, another place, or a triangle with other corners.
    differing: usize,
    /// Rays for which any finds another of several triangles with the same corners.
    twins: usize,
}

fn compare(corners: &Soup, rays: &[Ray]) -> Compared {
    let bvh = Bvh::build(corners);
    let expected: Vec<Hit> = rays.iter().map(|r| brute_force(corners, r)).collect();
    let (mut single, mut scalar) = (Single::new(&bvh), Scalar::new(&bvh));
    let kernels: [Vec<Hit>; 5] = [
        rays.iter().map(|r| single.closest(&bvh, r)).collect(),
        rays.iter().map(|r| scalar.closest(&bvh, r)).collect(),
        closest_of::<Many>(&bvh, rays),
        closest_of::<Streams>(&bvh, rays),
        closest_of::<Tiles>(&bvh, rays),
    ];
    let blocked = [any_of::<Many>(&bvh, rays), any_of::<Streams>(&bvh, rays), any_of::<Tiles>(&bvh, rays)];
    let twin = |a: &Hit, b: &Hit| {
        let same = bits(&Hit { triangle: b.triangle, ..*a }) == bits(b);
        same && (a.is_some() && b.is_some() && corners[a.triangle as usize] == corners[b.triangle as usize])
    };
    let (mut differing, mut twins) = (0, 0);
    for (i, (e, ray)) in expected.iter().zip(rays).enumerate() {
        let others: Vec<&Hit> = kernels.iter().map(|hits| &hits[i]).filter(|hit| bits(hit) != bits(e)).collect();
        twins += usize::from(!others.is_empty());
        let blocks = e.is_some() && e.t < ray.t_max;
        if !others.iter().all(|hit| twin(hit, e)) || blocked.iter().any(|any| any[i] != blocks) {
            println!("{ray:?} gave {others:?}, not {e:?}");
            differing += 1;
        }
    }
    Compared { expected, differing, twins: twins - differing.min(twins) }
}

fn run() -> Finding {
    let (mut total, mut lost, mut found, mut twins) = (0, 0, 0, 0);
    let each = samples(4_000) as usize;
    for (number, (name, corners)) in cases().into_iter().enumerate() {
        let mut random = Random(500 + number as u64);
        let bounds = bounds(&corners);
        // Trying every triangle is what costs.
        let count = each.min(samples(60_000_000) as usize / corners.len().max(1)).max(500);
        let kinds = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11];
        let rays: Vec<Ray> = (0..count).map(|i| ray(&mut random, &corners, &bounds, kinds[i % kinds.len()])).collect();
        let compared = compare(&corners, &rays);
        let differ = compared.differing;
        assert_eq!(differ, 0, "{name}: {differ} of {count} rays find something else than by brute force");
        twins += compared.twins;
        let hits = rays.iter().zip(&compared.expected).filter(|(_, hit)| hit.is_some());
        found += hits.clone().count();
        lost += hits.filter(|(ray, hit)| misses_box(&corners[hit.triangle as usize], ray)).count();
        total += count;
    }
    let share = 100.0 * lost as f64 / found as f64;
    assert!(share > 1.0, "the textbook's slab test should lose hits: {share} %");
    Finding {
        textbook: format!("{share:.1} % of hits are lost by their own triangle's box"),
        ours: format!(
            "none of {total} rays differs from brute force by a bit, in any of 5 kernels; {twins} in the plane of many coincident \
             triangles name another of these"
        ),
        how: "Fifteen meshes (slivers, doubled triangles, boxes in planes at 0, all scales); random rays, and rays aimed at corners and edges, \
              parallel to axes exactly and but for 10<sup>-30</sup>, in planes of boxes and triangles, from far away."
            .into(),
        picture: None,
    }
}
