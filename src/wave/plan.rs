//! What a scene needs: which stages run and which variant of each. Made once per render; what no entity of the scene has
//! is neither allocated nor run.

use crate::material::Kind;
use crate::world::World;
use std::fmt;

/// How light is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// By scattering alone.
    Path,
    /// By connecting to lights alone; lobes that no light can be connected to are followed.
    Nee,
    /// By both, combined by multiple importance sampling.
    #[default]
    Mis,
}

/// Choices that change the speed, not the image; the default is what measurements say. For experiments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tuning {
    /// Whether rows of paths that ended are filled with new ones at once; else once all have ended, so that all paths of a
    /// wave have the same number of bounces.
    pub refill: bool,
    /// Whether camera rays are traced in tiles of neighbours; else like those after a bounce.
    pub tiles: bool,
    /// Whether other rays are put in order and traced in streams where that pays; else many in flight, in their order.
    pub streams: bool,
    /// Whether rows are sorted into lists by kind of surface even where there is one kind alone.
    pub sort_always: bool,
    /// Paths of a job at least, where the image has as many.
    pub job: u32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self { refill: true, tiles: true, streams: true, sort_always: false, job: DEFAULT_JOB }
    }
}

/// Paths of a job at least unless set: enough to fill a wave.
pub const DEFAULT_JOB: u32 = 4096;

/// Bounces after which a path is cut in any case, so that a lossless scene ends too. What is lost is reported.
pub const BOUNCE_LIMIT: u32 = 4096;

/// What is stored as the density of the last scattering, for the weight of a light that is hit next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrevPdf {
    /// The density itself: multiple importance sampling.
    Density,
    /// 0: lights that could have been connected to count nothing when hit.
    Never,
    /// Infinity: lights count in full when hit.
    Always,
}

/// Which stages run, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Kinds of surface in the scene that scatter.
    pub kinds: Vec<Kind>,
    /// Whether lights are connected to: shadow rays exist.
    pub connect: bool,
    /// What the shade stage stores for the emit stage.
    pub prev_pdf: PrevPdf,
    /// Whether there are lights to hit.
    pub emit: bool,
    /// Whether rays that leave the scene bring radiance.
    pub escape: bool,
    /// Whether some triangle has vertex normals.
    pub smooth: bool,
    /// Whether a ray that hits a light needs the normal where it began: lights are chosen by it.
    pub receivers: bool,
    /// Light paths per sample of every pixel, by which light that mirrors and glass focus is found; 0 where none are traced.
    pub light_paths: f32,
    /// Whether some surface transmits, so that paths carry the scale of their radiance.
    pub transmit: bool,
    /// Bounces at most.
    pub max_depth: u32,
    /// Paths in flight per worker.
    pub wave_size: usize,
    /// Choices of speed.
    pub tuning: Tuning,
    method: Method,
}

impl Plan {
    /// The plan for a scene; `max_depth` bounces at most, if given. `light_paths` per camera path, if the scene needs any.
    pub fn new(world: &World, method: Method, max_depth: Option<u32>, wave_size: usize, light_paths: f32) -> Self {
        let used = |kind: Kind| world.lobes.iter().any(|l| l.kind() == kind as usize);
        let kinds: Vec<Kind> = Kind::SCATTERING.iter().copied().filter(|&k| used(k)).collect();
        let lit = !world.lights.is_empty();
        let connect = lit && method != Method::Path && max_depth != Some(0) && kinds.iter().any(|k| !k.is_delta());
        let prev_pdf = match method {
            _ if !connect => PrevPdf::Always,
            Method::Path => PrevPdf::Always,
            Method::Nee => PrevPdf::Never,
            Method::Mis => PrevPdf::Density,
        };
        let max_depth = max_depth.unwrap_or(BOUNCE_LIMIT).min(BOUNCE_LIMIT);
        let focused = method == Method::Mis && connect && max_depth > 1 && !world.targets.is_empty();
        let pixels = world.width() as f32 * world.height() as f32;
        Self {
            connect,
            prev_pdf,
            light_paths: if focused { light_paths * pixels } else { 0.0 },
            receivers: prev_pdf == PrevPdf::Density && world.lights.depend_on_receiver(),
            emit: lit,
            escape: world.background.is_some(),
            smooth: world.normals.is_some(),
            transmit: kinds.contains(&Kind::Transparent),
            max_depth,
            wave_size,
            tuning: Tuning::default(),
            method,
            kinds,
        }
    }
}

impl Plan {
    /// Whether light that mirrors and glass focus is found by light paths and by paths that look for it, too.
    pub fn caustics(&self) -> bool {
        self.light_paths > 0.0
    }
    /// Light of the scene that this plan finds only where a path happens to hit a lamp, in words; such light shows as bright
    /// dots until there are very many samples, most of all where lamps are small.
    pub fn left_to_chance(&self) -> Option<&'static str> {
        let focuses = self.kinds.iter().any(|kind| kind.is_delta());
        let receives = self.kinds.iter().any(|kind| !kind.is_delta());
        match (self.emit && focuses && receives && self.max_depth > 1, self.method) {
            (false, _) => None,
            (true, Method::Path) => None,
            (true, _) if self.caustics() => None,
            (true, _) => Some("all light that mirrors or glass focus on other surfaces"),
        }
    }
    /// The plan of light paths: they meet the same surfaces, and connect to the camera.
    pub fn of_light_paths(&self) -> Self {
        Self { emit: false, escape: false, receivers: false, light_paths: 0.0, transmit: true, ..self.clone() }
    }
    /// The plan of paths that look for focused light: they follow mirrors and glass alone, and bring what lamps radiate.
    pub fn of_aimed_paths(&self) -> Self {
        Self { emit: true, connect: false, ..self.of_light_paths() }
    }
    /// Whether all surfaces that scatter are of one kind, so that their rows need no list.
    pub fn sole_kind(&self) -> bool {
        self.kinds.len() == 1 && !self.tuning.sort_always
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line =
            |runs: bool, stage: &str, how: &str| writeln!(f, "  {} {stage:<11} {how}", if runs { "+" } else { "-" });
        line(true, "generate", "camera rays, in lanes")?;
        line(true, "intersect", "8-wide BVH; camera rays in tiles, others in streams and many in flight")?;
        line(
            true,
            "route",
            if self.sole_kind() { "hits from the rest: one kind of surface" } else { "by kind of surface" },
        )?;
        line(self.escape, "escape", if self.escape { "constant background" } else { "the background is black" })?;
        line(
            self.emit,
            "emit",
            match (self.emit, self.prev_pdf) {
                (false, _) => "nothing emits",
                (_, PrevPdf::Density) => "lights hit, weighted against their connection",
                (_, PrevPdf::Never) => "lights hit from the camera or after a delta lobe",
                (_, PrevPdf::Always) => "lights hit, in full",
            },
        )?;
        for &kind in Kind::SCATTERING {
            let how = match (self.kinds.contains(&kind), kind.is_delta()) {
                (false, _) => "no such surface",
                (true, true) => "delta lobe: connects to no light",
                (true, false) => "finite lobe",
            };
            line(self.kinds.contains(&kind), "shade", &format!("{}: {how}", kind.name()))?;
        }
        line(self.smooth, "normals", if self.smooth { "interpolated" } else { "all surfaces are flat" })?;
        line(
            self.receivers,
            "receivers",
            if self.receivers { "normal per path, by which lights are chosen" } else { "no light is chosen by them" },
        )?;
        line(self.transmit, "scale", if self.transmit { "radiance scale per path" } else { "nothing transmits" })?;
        line(
            self.connect,
            "connect",
            match (self.connect, self.method) {
                (true, _) => "a shadow ray per hit on a finite lobe, in streams and many in flight",
                (false, Method::Path) => "method path",
                (false, _) => "no light, or no surface that could be connected to one",
            },
        )?;
        line(
            self.caustics(),
            "light paths",
            if self.caustics() {
                "from lamps towards mirrors and glass, connected to the camera"
            } else {
                "nothing to focus light, or none asked for"
            },
        )?;
        line(
            self.caustics(),
            "aim",
            if self.caustics() {
                "second paths, to where focused light was seen to come from"
            } else {
                "nothing to focus light, or none asked for"
            },
        )?;
        line(true, "compact", "and regenerate")?;
        line(true, "accumulate", "f64 sums per pixel")?;
        let bounces = if self.max_depth == BOUNCE_LIMIT {
            "until roulette ends it".into()
        } else {
            format!("at most {}", self.max_depth)
        };
        write!(
            f,
            "  bounces {bounces}; {} paths in flight per worker, {} bytes each",
            self.wave_size,
            self.path_bytes()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::queues::tests::plan;
    use super::*;
    use crate::world::MaterialInput;

    /// Light that mirrors focus is left to chance where there are lamps, mirrors and other surfaces, and nothing else finds it.
    #[test]
    fn what_is_left_to_chance_is_told() {
        let lamp = MaterialInput::Luminous { radiance: [1.0; 3] };
        let matt = MaterialInput::Diffuse { color: [0.5; 3], mattness: 1.0 };
        let mirror = MaterialInput::Specular { color: [0.5; 3] };
        let with = |method: Method, depth: u32, light_paths: f32, materials: &[MaterialInput]| {
            let plan = plan(materials, 0.0);
            Plan { method, max_depth: depth, light_paths, ..plan }.left_to_chance().is_some()
        };
        let all = [lamp.clone(), matt.clone(), mirror.clone()];
        assert!(with(Method::Mis, 8, 0.0, &all) && with(Method::Nee, 8, 0.0, &all));
        assert!(!with(Method::Mis, 8, 1.0, &all), "light paths find it");
        assert!(!with(Method::Path, 8, 0.0, &all), "all light is found by chance");
        assert!(!with(Method::Mis, 1, 0.0, &all), "a mirror's light is two bounces away");
        assert!(!with(Method::Mis, 8, 0.0, &[lamp.clone(), matt.clone()]));
        assert!(!with(Method::Mis, 8, 0.0, &[lamp, mirror.clone()]));
        assert!(!with(Method::Mis, 8, 0.0, &[matt, mirror]));
        assert_eq!(plan(&all, 0.0).left_to_chance().map(str::is_empty), None, "by default light paths are traced");
    }
}
