//! Renders whose samples, or their mean, have a closed form: faults of light transport show here within a second. The suites
//! in `tests/` are the sharp form, with their levels and power.

use super::{Control, Renderer, Settings};
use crate::camera::Camera;
use crate::film::Film;
use crate::linear::DVec3;
use crate::wave::Method;
use crate::world::{MaterialInput, Mesh, Object, Size, WorldBuilder};
use std::f64::consts::PI;

const METHODS: [Method; 3] = [Method::Path, Method::Nee, Method::Mis];

/// A parallelogram by its middle and half its edges.
#[derive(Clone, Copy)]
pub(super) struct Patch {
    middle: DVec3,
    edges: [DVec3; 2],
}

impl Patch {
    fn corners(&self) -> [DVec3; 4] {
        let [e, f] = self.edges;
        [-e - f, e - f, e + f, f - e].map(|offset| self.middle + offset)
    }
    pub fn mesh(&self) -> Mesh {
        let positions = self.corners().map(|corner| corner - self.middle).to_vec();
        Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
    }
    /// Irradiance at `p` with normal `n` where all of it is before `n`, for a radiance of 1 (Lambert 1760).
    fn irradiance(&self, p: DVec3, n: DVec3) -> f64 {
        let to = self.corners().map(|corner| (corner - p).normalize());
        let edge = |k: usize| {
            let (a, b) = (to[k], to[(k + 1) % 4]);
            a.dot(b).acos() * a.cross(b).normalize().dot(n)
        };
        0.5 * (0..4).map(edge).sum::<f64>().abs()
    }
}

pub(super) fn patch(middle: [f64; 3], e: [f64; 3], f: [f64; 3]) -> Patch {
    Patch { middle: middle.into(), edges: [e.into(), f.into()] }
}

/// A scene of objects about their middles, seen from `eye` towards `at`, `angle` degrees wide.
fn scene(objects: &[(Mesh, DVec3, MaterialInput)], sky: f32, eye: DVec3, at: DVec3, angle: f64) -> Renderer {
    let direction = at - eye;
    let camera = Camera { focal_point: eye, direction, width: 16, height: 16, x_angle: angle, y_angle: angle };
    let mut builder = WorldBuilder::new(camera);
    builder.background([sky; 3]);
    for (mesh, mid_point, material) in objects {
        let (mesh, material) = (builder.mesh(mesh.clone()), builder.material(material.clone()));
        let (rotation, size) = (DVec3::ZERO, Size::Scale(1.0));
        builder.object(Object { mesh, material, rotation, size, mid_point: *mid_point });
    }
    Renderer::new(builder.build().unwrap())
}

fn render(renderer: &Renderer, method: Method, spp: u32) -> Film {
    let settings = Settings { method, spp, seed: 7, ..Settings::default() };
    let rendered = renderer.render(&settings, &Control::default()).unwrap();
    assert!(rendered.bad.is_empty() && rendered.counts.camera == u64::from(spp) * 256);
    rendered.film
}

/// Mean of the first channel, and its standard error from the spread of pixels: they see next to the same.
fn mean(film: &Film) -> (f64, f64) {
    let means: Vec<f64> = film.pixels().iter().map(|p| p.sum[0] / p.count as f64).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

fn diffuse(albedo: f32, mattness: f32) -> MaterialInput {
    MaterialInput::Diffuse { color: [albedo; 3], mattness }
}

pub(super) fn lamp(radiance: f32) -> MaterialInput {
    MaterialInput::Luminous { radiance: [radiance; 3] }
}

pub(super) fn floor(albedo: f32) -> (Mesh, DVec3, MaterialInput) {
    let floor = patch([0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]);
    (floor.mesh(), floor.middle, diffuse(albedo, 1.0))
}

/// The floor seen from the side and below lamps that are `height` above it at least.
pub(super) fn seen(objects: &[(Mesh, DVec3, MaterialInput)], at: DVec3, height: f64) -> Renderer {
    scene(objects, 0.0, at + DVec3::new(0.9, -1.1, 0.5) * height, at, 0.1)
}

/// The radiance of a floor under lamps, one and many, near and far, by all methods.
#[test]
fn lamps_light_a_floor_as_lambert_says() {
    let one = vec![patch([0.2, 0.3, 1.2], [0.4, 0.1, 0.0], [0.0, 0.3, 0.2])];
    let near = vec![patch([0.0, 0.1, 0.15], [0.6, 0.0, 0.0], [0.0, 0.5, 0.05])];
    let many: Vec<Patch> = (0..12)
        .map(|i| (f64::from(i % 4) - 1.5, f64::from(i / 4) - 1.0))
        .map(|(x, y)| patch([0.8 * x, 0.9 * y, 0.9 + 0.1 * x], [0.1, 0.02 * x, 0.0], [0.0, 0.12, 0.05 * y]))
        .collect();
    let at = DVec3::new(-0.1, 0.15, 0.0);
    for (name, height, lamps) in [("one", 0.9, one), ("near", 0.1, near), ("many", 0.7, many)] {
        let objects: Vec<_> = lamps.iter().map(|l| (l.mesh(), l.middle, lamp(2.5))).chain([floor(0.6)]).collect();
        let exact = 0.6 / PI * 2.5 * lamps.iter().map(|l| l.irradiance(at, DVec3::Z)).sum::<f64>();
        for method in METHODS {
            let (found, error) = mean(&render(&seen(&objects, at, height), method, 64));
            // Within 4.5 standard errors, and close enough for that to mean something.
            assert!((found - exact).abs() < 4.5 * error, "{name}, {method:?}: {found} +- {error}, not {exact}");
            let most = if method == Method::Path { 0.2 } else { 0.02 };
            assert!(error < most * exact, "{name}, {method:?}: {error} of {exact}");
        }
    }
}

/// A mirror adds the light of the lamp that is seen in it, found by chance and by light paths.
#[test]
fn a_mirror_lights_the_floor_with_its_lamp() {
    let light = patch([0.4, 0.0, 0.6], [0.12, 0.0, 0.0], [0.0, 0.12, 0.0]);
    // Upright, in the plane x = -1; the lamp's image lies behind it, all of it in sight.
    let mirror = patch([-1.0, 0.0, 1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.99]);
    let image = Patch { middle: DVec3::new(-2.0 - light.middle.x, light.middle.y, light.middle.z), ..light };
    let at = DVec3::new(0.1, 0.2, 0.0);
    let objects = [
        (light.mesh(), light.middle, lamp(5.0)),
        (mirror.mesh(), mirror.middle, MaterialInput::Specular { color: [0.8; 3] }),
        floor(0.7),
    ];
    let (direct, mirrored) = (light.irradiance(at, DVec3::Z), 0.8 * image.irradiance(at, DVec3::Z));
    let exact = 0.7 / PI * 5.0 * (direct + mirrored);
    for (method, spp) in [(Method::Path, 1024), (Method::Nee, 256), (Method::Mis, 256)] {
        let (found, error) = mean(&render(&seen(&objects, at, 0.5), method, spp));
        assert!((found - exact).abs() < 4.5 * error, "{method:?}: {found} +- {error}, not {exact}");
        assert!(error < 0.1 * exact, "{method:?}: {error} of {exact}");
    }
}

/// Light that meets a convex body under a constant sky meets it once: each sample is the sky, or the body's albedo times it;
/// clear glass is not to be seen.
#[test]
fn a_convex_body_under_a_constant_sky_is_its_albedo() {
    // An octahedron, front sides outwards.
    let positions = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z].to_vec();
    let triangles = (0..4).flat_map(|k| [[k, (k + 1) % 4, 4], [(k + 1) % 4, k, 5]]).collect();
    let flat = Mesh { positions: positions.clone(), triangles, ..Mesh::default() };
    let smooth = Mesh { normals: positions, triangle_normals: flat.triangles.clone(), ..flat.clone() };
    let materials =
        [diffuse(0.5, 1.0), diffuse(0.5, 0.3), diffuse(0.5, 0.0), MaterialInput::Specular { color: [0.5; 3] }];
    for (name, mesh) in [("flat", flat), ("smooth", smooth)] {
        let look = |material: &MaterialInput| {
            let eye = DVec3::new(2.0, -3.0, 1.0);
            scene(&[(mesh.clone(), DVec3::ZERO, material.clone())], 2.0, eye, DVec3::ZERO, 35.0)
        };
        for material in &materials {
            let film = render(&look(material), Method::Mis, 16);
            // (s - 2) (s - 1) summed over the samples: 0 where all are 2 or 1.
            let off = |p: &crate::film::Pixel| p.sum2[0] - 3.0 * p.sum[0] + 2.0 * p.count as f64;
            let most = film.pixels().iter().map(|p| off(p).abs()).fold(0.0, f64::max);
            assert!(most < 0.01, "{name}, {material:?}: {most}");
            let (mean, _) = mean(&film);
            assert!((1.2..1.9).contains(&mean), "{mean}: the view holds the body and the sky");
        }
        let glass = MaterialInput::Transparent { color: [1.0; 3], ref_index: 1.5 };
        let film = render(&look(&glass), Method::Mis, 16);
        let (found, error) = mean(&film);
        assert!((found - 2.0).abs() < 1e-5 + 4.5 * error, "{name}, glass: {found} +- {error}");
    }
}

/// A white room with a lamp in it, of albedo 0.5: what is cut at `depth` bounces is the tail of a geometric series.
#[test]
fn paths_are_cut_where_it_is_said() {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let walls = [([1.0, 0.0, 0.0], y, z), ([-1.0, 0.0, 0.0], y, z), ([0.0, 1.0, 0.0], x, z), ([0.0, -1.0, 0.0], x, z)];
    let caps = [([0.0, 0.0, 1.0], x, y), ([0.0, 0.0, -1.0], x, y)];
    let of = |(middle, e, f): ([f64; 3], [f64; 3], [f64; 3])| {
        let wall = patch(middle, e, f);
        (wall.mesh(), wall.middle, diffuse(0.5, 1.0))
    };
    let objects: Vec<_> = walls.into_iter().chain(caps).map(of).collect();
    let eye = DVec3::new(0.1, 0.2, -0.1);
    let renderer = scene(&objects, 1.0, eye, eye + DVec3::new(0.3, 1.0, 0.2), 60.0);
    for depth in [0, 1, 3] {
        let settings = Settings { spp: 4, max_depth: Some(depth), ..Settings::default() };
        let counts = renderer.render(&settings, &Control::default()).unwrap().counts;
        // Nothing leaves: paths are cut, but for those that roulette ends, with what albedo leaves of them.
        let (exact, n) = (1024.0 * 0.5f64.powi(depth as i32), counts.cut as f64);
        let each = counts.cut_throughput / n;
        let error = each * (n * (1.0 - n / 1024.0)).sqrt();
        assert!((counts.cut_throughput - exact).abs() <= 4.5 * error, "{depth}: {counts:?}");
        assert!(counts.bounce >= counts.cut * u64::from(depth) && counts.bounce <= 1024 * u64::from(depth));
        assert!(depth > 1 || counts.cut == 1024, "roulette does not begin so soon: {counts:?}");
        assert_eq!(counts.rays(), counts.camera + counts.bounce);
    }
}
