//! Images that depend on the order of the faces in a file.

use crate::common::meshes::{join, patch, quad, soup, sphere, v};
use crate::common::random::Random;
use crate::common::worlds::{colored, glass, lamp, room};
use crate::common::{METHODS, film, samples, settings};
use crate::row::{Finding, Part, Row};
use crate::textbook::{nearest, sub};
use wavetrace::Mesh;
use wavetrace::render::SamplerKind;

pub const ROW: Row = Row {
    part: Part::Intersection,
    name: "order",
    title: "Shuffled faces give another image",
    fails: "Where triangles coincide, or a ray meets an edge, two are hit at the same distance, and which of them counts depends on the order \
            in which the tree, or the file, has them. So does the number of each light, and with it which random number chooses it.",
    remedy: "Ties go to the lower number, in every kernel, and numbers follow a curve through space, not the file: an object whose faces are \
             shuffled makes the same world. Triangles without area are left out. Objects keep the order of the scene file.",
    source: "Morton 1966 for the curve",
    run,
};

/// A ball, a step of patches that overlap in one plane, the same patch twice, and triangles without area.
fn pile() -> Mesh {
    let mut mesh = join(&[
        sphere(v(0.35, 0.2, 0.5), 0.4, 2, false),
        patch(-0.4, 0.1, 0.4, 0.6, 0.6),
        patch(-0.3, 0.2, 0.4, 0.6, 0.6),
        quad(v(-0.8, 0.5, 0.1), v(0.9, 0.0, 0.0), v(0.0, 0.2, 1.0)),
        quad(v(-0.8, 0.5, 0.1), v(0.9, 0.0, 0.0), v(0.0, 0.2, 1.0)),
    ]);
    let twice = mesh.triangles[..40].to_vec();
    mesh.triangles.extend(twice);
    mesh.triangles.extend([[0, 0, 1], [2, 3, 2], [5, 5, 5]]);
    mesh
}

/// Many small lamps.
fn lamps() -> Mesh {
    join(
        &(0..24)
            .map(|i| patch(-0.8 + 0.07 * f64::from(i), 0.3, 1.9 - 0.01 * f64::from(i % 5), 0.05, 0.3))
            .collect::<Vec<_>>(),
    )
}

fn shuffled(mut mesh: Mesh, seed: u64) -> Mesh {
    let mut random = Random(seed);
    for i in (1..mesh.triangles.len()).rev() {
        let j = random.below(i + 1);
        mesh.triangles.swap(i, j);
        if !mesh.triangle_normals.is_empty() {
            mesh.triangle_normals.swap(i, j);
        }
    }
    mesh
}

/// The share of rays that hit another triangle, by its corners, after a shuffle.
fn textbook(mesh: &Mesh, other: &Mesh) -> f64 {
    let (a, b) = (soup(mesh), soup(other));
    let (mut random, mut differ, rays) = (Random(4), 0, 20_000);
    for _ in 0..rays {
        let t = random.pick(&a);
        let (s, q) = (random.unit() * 0.5, random.unit() * 0.5);
        let target: [f32; 3] = std::array::from_fn(|k| t[0][k] + (t[1][k] - t[0][k]) * s + (t[2][k] - t[0][k]) * q);
        let from = [random.within(-0.9, 0.9), -0.9, random.within(0.2, 1.8)];
        let hit = |soup: &[[[f32; 3]; 3]]| nearest(soup, from, sub(target, from), 0.0).map(|(id, _)| soup[id]);
        differ += usize::from(hit(&a) != hit(&b));
    }
    f64::from(differ as u32) / f64::from(rays)
}

fn run() -> Finding {
    let (pile, lamps) = (pile(), lamps());
    let world = |seed: Option<u64>| {
        let order = |mesh: &Mesh| seed.map_or(mesh.clone(), |seed| shuffled(mesh.clone(), seed));
        room([32, 32])
            .with(order(&pile), colored([0.8, 0.5, 0.3], 0.6))
            .with(order(&sphere(v(-0.45, -0.2, 0.3), 0.25, 2, true)), glass(0.95, 1.5))
            .with(order(&lamps), lamp(8.0))
            .renderer()
    };
    let (first, mut images) = (world(None), 0);
    for seed in 1..=3 {
        let other = world(Some(seed));
        for method in METHODS {
            for sampler in [SamplerKind::Xoshiro, SamplerKind::Sobol] {
                let settings = settings(method, sampler, samples(16), 3);
                let (a, b) = (film(&first, &settings), film(&other, &settings));
                assert!(a == b, "{method:?}, {sampler:?}, shuffle {seed}: the images differ");
                images += 1;
            }
        }
    }
    let share = textbook(&pile, &shuffled(pile.clone(), 1));
    assert!(share > 0.0, "the textbook's method should depend on the order");
    Finding {
        textbook: format!("{:.1} % of rays find another triangle", 100.0 * share),
        ours: format!("{images} images without a bit of difference"),
        how: "A room with overlapping, doubled and empty triangles, glass and 48 lamps, its meshes' faces shuffled three times; all methods, \
              both samplers. The textbook's form takes the first of the nearest by brute force."
            .into(),
        picture: None,
    }
}
