//! The state of a wave: paths, hits, shadow rays in columns, and lists of rows.

use super::plan::Plan;
use crate::columns::columns;
use crate::material::Kind;

columns! {
    /// Paths in flight.
    pub struct PathQueue of Path {
        /// Where the current ray starts.
        origin: V3,
        /// Unit direction of the current ray.
        direction: V3,
        /// Weight of the radiance that the ray brings.
        throughput: V3,
        /// Density with which the direction was chosen, per solid angle; infinite after the camera and delta lobes.
        prev_pdf: F,
        /// Which sample of the job this is.
        slot: U,
        /// Bounces so far.
        depth: U,
        /// State of the random numbers.
        rng: U4,
    }
}

columns! {
    /// By how much the radiance of each path is scaled by refraction; only where something transmits.
    pub struct ScaleQueue of Scale {
        /// Product of squared ratios of indices.
        scale: F,
    }
}

columns! {
    /// What each ray hit.
    pub struct HitQueue of HitRow {
        /// Weight of the triangle's second corner.
        u: F,
        /// Weight of the third.
        v: F,
        /// The triangle.
        triangle: U,
    }
}

columns! {
    /// Connections to lights, yet to be tested.
    pub struct ShadowQueue of Shadow {
        /// A point off the surface.
        origin: V3,
        /// To a point off the light: the whole way.
        direction: V3,
        /// What the connection adds if nothing is in between.
        radiance: V3,
        /// Which sample of the job it adds to.
        slot: U,
    }
}

/// All that one worker keeps for its paths.
#[derive(Clone, Debug)]
pub struct Queues {
    pub(super) paths: PathQueue,
    pub(super) scales: Option<ScaleQueue>,
    pub(super) hits: HitQueue,
    pub(super) shadows: ShadowQueue,
    /// Rows by the kind of surface that they hit; lists of kinds that the scene lacks stay empty.
    pub(super) by_kind: [Vec<u32>; Kind::COUNT],
    /// Rows that hit nothing.
    pub(super) escaped: Vec<u32>,
    /// Whether the path of a row has ended.
    pub(super) ended: Vec<bool>,
}

impl Queues {
    /// Queues for what the plan needs.
    pub fn new(plan: &Plan) -> Self {
        let n = plan.wave_size;
        let list = |needed: bool| Vec::with_capacity(if needed { n } else { 0 });
        Self {
            paths: PathQueue::with_capacity(n),
            scales: plan.transmit.then(|| ScaleQueue::with_capacity(n)),
            hits: HitQueue::with_capacity(n),
            shadows: ShadowQueue::with_capacity(if plan.connect { n } else { 0 }),
            by_kind: std::array::from_fn(|k| {
                let listed = !plan.sole_kind() && plan.kinds.iter().any(|&kind| kind as usize == k);
                list(listed || (plan.emit && k == Kind::Luminous as usize))
            }),
            escaped: list(plan.escape),
            ended: vec![false; n],
        }
    }
}

impl Plan {
    /// Bytes that one path takes in all queues.
    pub fn path_bytes(&self) -> usize {
        let kinds = if self.sole_kind() { 0 } else { self.kinds.len() };
        let lists = kinds + usize::from(self.emit) + usize::from(self.escape);
        PathQueue::ROW_BYTES
            + HitQueue::ROW_BYTES
            + if self.transmit { ScaleQueue::ROW_BYTES } else { 0 }
            + if self.connect { ShadowQueue::ROW_BYTES } else { 0 }
            + lists * size_of::<u32>()
            + size_of::<bool>()
    }
}
