//! Which rays are traced: the same five sets for every tracer, from the image of a camera in a mesh.

use super::camera::{Axis, MAX_RES, View, choose};
use super::files::{HitRecord, RayRecord};
use super::kernel::{Query, Tracer};
use super::mesh::{Bounds, normal, vector};
use crate::error::{Error, Result};
use crate::lanes::{Frame, Vec3};
use crate::linear::DVec3;
use crate::sampling::{Decision, Sampler, State, Xoshiro, warp};

/// A kind of ray set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetKind {
    /// One ray per pixel, through its centre.
    Primary,
    /// One from each primary hit, cosine-weighted.
    Bounce,
    /// The rays of `Bounce` in random order.
    Shuffled,
    /// One from each primary hit to a point of a light; any hit counts.
    Shadow,
    /// What leaves the fourth hit of each path that is still alive.
    Deep,
}

impl SetKind {
    /// All kinds, in the order of reports.
    pub const ALL: [Self; 5] = [Self::Primary, Self::Bounce, Self::Shuffled, Self::Shadow, Self::Deep];

    /// Its name, which is that of its files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Bounce => "bounce",
            Self::Shuffled => "shuffled",
            Self::Shadow => "shadow",
            Self::Deep => "deep",
        }
    }
    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
    /// What is asked of its rays.
    pub fn query(self) -> Query {
        match self {
            Self::Primary => Query::Camera,
            Self::Shadow => Query::Any,
            _ => Query::Closest,
        }
    }
}

/// Rays of a kind.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySet {
    /// Which kind.
    pub kind: SetKind,
    /// The rays, in the documented order.
    pub rays: Vec<RayRecord>,
}

/// How sets are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Pixels across and down, a multiple of 8.
    pub res: u32,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Which axis points up.
    pub up: Axis,
    /// The camera; chosen by the mesh where there is none.
    pub view: Option<View>,
}

impl Default for Options {
    fn default() -> Self {
        Self { res: 1024, seed: 1, up: Axis::Y, view: None }
    }
}

impl Options {
    /// Looks whether sets can be made with them.
    ///
    /// # Errors
    /// [`Error::Setting`] of `--res` or `--camera`.
    pub fn check(&self) -> Result<()> {
        if self.res == 0 || !self.res.is_multiple_of(8) || self.res > MAX_RES {
            let expected = format!("a multiple of 8 from 8 to {MAX_RES}");
            return Err(Error::Setting { setting: "--res", found: self.res.to_string(), expected });
        }
        self.view.map_or(Ok(()), |view| view.check())
    }
}

/// Hits after which the rays of `Deep` leave.
const DEEP: u32 = 4;
/// Where shadow rays end, so that the light itself is not met.
const SHADOW_END: f32 = 0.999;
/// Number of a path that no image has, for random numbers that belong to none.
const NO_PATH: u32 = u32::MAX;

/// Makes the sets of `kinds`, in that order, for a mesh; also returns the camera. `tracer` finds the hits from which
/// further rays start; the rays depend neither on its kernel nor on its threads.
///
/// # Errors
/// [`Error::Setting`] for options out of range.
pub fn make(
    corners: &[[[f32; 3]; 3]],
    tracer: &Tracer<'_>,
    options: &Options,
    kinds: &[SetKind],
) -> Result<(Vec<RaySet>, View)> {
    options.check()?;
    let maker = Maker { corners, bounds: Bounds::of(corners), seed: options.seed, up: options.up };
    let hits = |rays: &[RayRecord]| tracer.hits(rays, Query::Closest);
    let view = options.view.unwrap_or_else(|| choose(&maker.bounds, options.up, |rays| distinct(&hits(rays))));
    let wants = |kind| kinds.contains(&kind);

    let rays = view.rays(options.res, options.up);
    let mut paths = Paths { ids: (0..rays.len() as u32).collect(), rays };
    let mut made = Vec::new();
    let mut add = |kind, rays: Vec<RayRecord>| made.push(RaySet { kind, rays });
    if wants(SetKind::Primary) {
        add(SetKind::Primary, paths.rays.clone());
    }
    if kinds.iter().any(|&kind| kind != SetKind::Primary) {
        let found = hits(&paths.rays);
        if wants(SetKind::Shadow) {
            add(SetKind::Shadow, maker.shadow(&paths, &found));
        }
        paths = maker.bounce(&paths, &found, 1);
        if wants(SetKind::Shuffled) {
            add(SetKind::Shuffled, maker.shuffled(paths.rays.clone()));
        }
        if wants(SetKind::Bounce) {
            add(SetKind::Bounce, paths.rays.clone());
        }
        if wants(SetKind::Deep) {
            for depth in 2..=DEEP {
                let found = hits(&paths.rays);
                paths = maker.bounce(&paths, &found, depth);
            }
            add(SetKind::Deep, paths.rays);
        }
    }
    made.sort_by_key(|set| kinds.iter().position(|&kind| kind == set.kind));
    Ok((made, view))
}

/// Number of different triangles among hits.
fn distinct(hits: &[HitRecord]) -> usize {
    let mut seen: Vec<u32> = hits.iter().filter(|hit| hit.is_some()).map(|hit| hit.triangle).collect();
    seen.sort_unstable();
    seen.dedup();
    seen.len()
}

/// Paths that are alive: their next rays, and their numbers, which are those of their primary rays.
struct Paths {
    rays: Vec<RayRecord>,
    ids: Vec<u32>,
}

struct Maker<'a> {
    corners: &'a [[[f32; 3]; 3]],
    bounds: Bounds,
    seed: u64,
    up: Axis,
}

/// Where a path leaves a surface.
struct Departure {
    /// Number of the path.
    id: u32,
    /// Where it starts again, off the surface.
    origin: [f32; 3],
    /// Unit normal on the side that it came from.
    normal: DVec3,
}

impl Maker<'_> {
    /// Where the paths that hit something leave it.
    fn departures(&self, paths: &Paths, hits: &[HitRecord]) -> impl Iterator<Item = Departure> {
        let offset = self.bounds.offset();
        paths.rays.iter().zip(&paths.ids).zip(hits).filter_map(move |((ray, &id), hit)| {
            // Of a miss there is no such triangle.
            let n = normal(self.corners.get(hit.triangle as usize)?);
            let d = vector(ray.direction);
            let n = if n == DVec3::ZERO { -d.normalize_or_zero() } else { n };
            let normal = if n.dot(d) > 0.0 { -n } else { n };
            let point = vector(ray.origin) + d * f64::from(hit.t) + normal * offset;
            Some(Departure { id, origin: point.as_vec3().to_array(), normal })
        })
    }

    /// The rays that leave hit number `depth`, cosine-weighted about the normal.
    fn bounce(&self, from: &Paths, hits: &[HitRecord], depth: u32) -> Paths {
        let mut next = Paths { rays: Vec::new(), ids: Vec::new() };
        for Departure { id, origin, normal } in self.departures(from, hits) {
            let local = warp::cosine_hemisphere(draw(&mut self.stream(id, depth)));
            let direction = Frame::about(Vec3::<f32>::splat(normal.as_vec3().to_array())).to_world(local);
            let direction = direction.normalize().lane(0);
            next.rays.push(RayRecord { origin, t_min: 0.0, direction, t_max: f32::INFINITY });
            next.ids.push(id);
        }
        next
    }

    /// The rays from the primary hits to points of the light: a horizontal square near the top of the box.
    fn shadow(&self, from: &Paths, hits: &[HitRecord]) -> Vec<RayRecord> {
        let [up, a, b] = self.up.cycle();
        let (centre, extent) = (self.bounds.centre(), self.bounds.extent());
        let side = 0.1 * extent[a].min(extent[b]);
        let ray = |Departure { id, origin, .. }| {
            let [s, t] = draw::<2>(&mut self.stream(id, 0)).map(|x| f64::from(x) - 0.5);
            let mut target = centre;
            target[up] = self.bounds.lo[up] + 0.9 * extent[up];
            target[a] += side * s;
            target[b] += side * t;
            let direction = (target - vector(origin)).as_vec3().to_array();
            RayRecord { origin, t_min: 0.0, direction, t_max: SHADOW_END }
        };
        self.departures(from, hits).map(ray).collect()
    }

    /// The rays in random order: Fisher and Yates, in the form of Durstenfeld 1964.
    fn shuffled(&self, mut rays: Vec<RayRecord>) -> Vec<RayRecord> {
        let mut stream = self.stream(NO_PATH, 0);
        for last in (1..rays.len()).rev() {
            // One number has 24 bits: too few to choose evenly among millions.
            let [high, low] = draw::<2>(&mut stream).map(f64::from);
            let unit = high + low / f64::from(1 << 24);
            rays.swap(last, ((unit * (last + 1) as f64) as usize).min(last));
        }
        rays
    }

    /// The random numbers of a path at one of its vertices.
    fn stream(&self, path: u32, depth: u32) -> State<f32> {
        Xoshiro::start::<f32>(self.seed, path, depth)
    }
}

fn draw<const N: usize>(stream: &mut State<f32>) -> [f32; N] {
    Xoshiro::draw::<f32, N>(stream, Decision::Scatter, 0)
}
