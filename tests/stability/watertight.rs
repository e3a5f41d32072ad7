//! Closed meshes that leak at edges and corners.

use crate::common::full;
use crate::common::meshes::{Soup, cuboid, soup, sphere, v};
use crate::common::random::Random;
use crate::common::rays::{any_of, closest_of};
use crate::row::{Finding, Part, Row};
use crate::textbook::nearest;
use wavetrace::accel::{Bvh, Many, Ray, Streams};

pub const ROW: Row = Row {
    part: Part::Intersection,
    name: "watertight",
    title: "Closed meshes leak at edges and corners",
    fails: "A ray that is aimed at an edge is tested against two triangles, whose sums are rounded differently: both may say that it passes \
            by. Light leaks into closed rooms, and paths in glass lose count of where they are.",
    remedy: "Edges are tested in a sheared space in which both neighbours compute the same number for their common edge, in f64 where it is 0; \
             boxes are padded by what rounding may do.",
    source: "Woop, Benthin and Wald 2013; Ize 2013",
    run,
};

/// Where a ray of a mesh starts, and a point on an edge (or a corner) that it is aimed at.
fn aimed(random: &mut Random, corners: &Soup, centre: [f32; 3], reach: f32) -> Ray {
    let t = random.pick(corners);
    let (edge, s) = (random.below(3), if random.below(4) == 0 { 0.0 } else { random.unit() });
    let (p, q) = (t[edge], t[(edge + 1) % 3]);
    let target: [f32; 3] = std::array::from_fn(|k| p[k] + (q[k] - p[k]) * s);
    let origin: [f32; 3] = std::array::from_fn(|k| centre[k] + random.within(-reach, reach));
    Ray { origin, direction: std::array::from_fn(|k| target[k] - origin[k]), t_max: f32::INFINITY }
}

fn run() -> Finding {
    let moved = |mut corners: Soup, by: [f32; 3], scale: f32| {
        corners.iter_mut().flatten().for_each(|p| *p = std::array::from_fn(|a| p[a] * scale + by[a]));
        corners
    };
    let ball = soup(&sphere(v(0.0, 0.0, 0.0), 1.0, 3, false));
    let block = soup(&cuboid(v(-1.0, -0.5, -0.4), v(1.0, 0.5, 0.7)));
    // Mesh, a point inside, how far from it rays may start and be inside as well.
    let closed: [(&str, Soup, [f32; 3], f32); 6] = [
        ("ball", ball.clone(), [0.0; 3], 0.4),
        ("tiny ball", moved(ball.clone(), [0.0; 3], 1e-6), [0.0; 3], 4e-7),
        ("ball far from the origin", moved(ball.clone(), [1e3, -3e3, 77.0], 1.0), [1e3, -3e3, 77.0], 0.4),
        ("huge ball", moved(ball.clone(), [0.0; 3], 1e6), [0.0; 3], 4e5),
        ("block", block.clone(), [0.0; 3], 0.3),
        ("block far from the origin", moved(block, [-1e4, 2e4, 5e3], 1.0), [-1e4, 2e4, 5e3], 0.3),
    ];
    let each = if full() { 2_000_000 } else { 200_000 };
    let (mut traced, mut leaks, mut naive_leaks, mut naive) = (0usize, 0usize, 0usize, 0usize);
    for (number, (name, corners, centre, reach)) in closed.iter().enumerate() {
        let bvh = Bvh::build(corners);
        let mut random = Random(60 + number as u64);
        for _ in 0..each / 20_000 {
            let rays: Vec<Ray> = (0..20_000).map(|_| aimed(&mut random, corners, *centre, *reach)).collect();
            let missed = closest_of::<Many>(&bvh, &rays).iter().filter(|hit| !hit.is_some()).count()
                + closest_of::<Streams>(&bvh, &rays).iter().filter(|hit| !hit.is_some()).count()
                + any_of::<Many>(&bvh, &rays).iter().filter(|hit| !**hit).count();
            assert_eq!(missed, 0, "{name}");
            leaks += missed;
            traced += rays.len();
        }
        for _ in 0..10_000 {
            let ray = aimed(&mut random, corners, *centre, *reach);
            naive_leaks += usize::from(nearest(corners, ray.origin, ray.direction, 0.0).is_none());
            naive += 1;
        }
    }
    assert!(naive_leaks > 0, "the textbook's test should leak");
    Finding {
        textbook: format!("{naive_leaks} of {naive} rays leave a closed mesh"),
        ours: format!("{leaks} of {:.1} million, in each of three kernels", traced as f64 / 1e6),
        how: "Rays from inside balls and blocks, small, large, and far from the origin, aimed at edges and corners; the textbook's test \
              (Moeller and Trumbore 1997) tries every triangle."
            .into(),
        picture: None,
    }
}
