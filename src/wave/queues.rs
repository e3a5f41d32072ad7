//! The state of a wave: paths, hits, shadow rays in columns, and lists of rows.

use super::plan::Plan;
use crate::columns::{Column, Field, Rows, U, U2, V3, columns};
use crate::lanes::{Lanes, LanesU32, MAX_LANES, Wide};
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
        rng: U2,
    }
}

impl PathQueue {
    /// How many bounces each path has.
    pub(super) fn depths(&self) -> &[u32] {
        &self.depth[..self.len]
    }
    /// [`Self::put`] before shading: where rays began, and with which density, is made anew there.
    #[inline(always)]
    pub(super) fn put_unshaded<W: Wide>(&mut self, at: usize, bits: u32, path: Path<W>) {
        // Named in full, so that no new field is forgotten.
        let Self { len: _, origin: _, direction, throughput, prev_pdf: _, slot, depth, rng } = self;
        V3::append::<W>(direction, at, bits, path.direction);
        V3::append::<W>(throughput, at, bits, path.throughput);
        U::append::<W>(slot, at, bits, path.slot);
        U::append::<W>(depth, at, bits, path.depth);
        U2::append::<W>(rng, at, bits, path.rng);
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
    /// Normal of the surface that each ray left, on its side; only where lights are chosen by it.
    pub struct NormalQueue of Normal {
        /// Unit normal; unspecified after the camera and delta lobes.
        normal: V3,
    }
}

columns! {
    /// What the weight of light that was focused needs to know of a path's first bounce; only where light paths are traced.
    pub struct FirstQueue of First {
        /// Density of the first surface point, per area and camera ray, times that of the direction of scattering there,
        /// per projected solid angle. Infinite while there is none, and where no light path could be this path's reverse.
        density: F,
        /// After a finite lobe, how likely the path was to look for focused light from there. After delta lobes since, the
        /// density of aiming into the direction in which it left that lobe, over that of scattering.
        aimed: F,
    }
}

impl<L: Lanes> First<L> {
    /// Before the first bounce.
    #[inline(always)]
    pub fn none() -> Self {
        Self { density: L::splat(f32::INFINITY), aimed: L::splat(0.0) }
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

/// A list of rows, in ascending order.
#[derive(Clone, Debug, Default)]
pub struct RowList {
    rows: Column<u32>,
    len: usize,
}

impl RowList {
    /// An empty list with room for `capacity` rows; with no room nothing is held.
    pub fn with_capacity(capacity: usize) -> Self {
        Self { rows: Column::zeros(if capacity == 0 { 0 } else { capacity + MAX_LANES }), len: 0 }
    }
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.len
    }
    /// The rows.
    #[inline(always)]
    pub fn rows(&self) -> &[u32] {
        &self.rows[..self.len]
    }
    /// Forgets all rows.
    pub fn clear(&mut self) {
        self.len = 0;
    }
    /// Appends those of the eight rows from `first` on whose bit is set.
    #[inline(always)]
    pub fn append<W: Wide>(&mut self, first: usize, bits: u32) {
        let rows = W::Uint::load(&[0, 1, 2, 3, 4, 5, 6, 7]).add(W::Uint::splat(first as u32));
        rows.pack(bits).store(&mut self.rows[self.len..]);
        self.len += bits.count_ones() as usize;
    }
}

/// All that one worker keeps for its paths.
#[derive(Clone, Debug)]
pub struct Queues {
    pub(super) paths: PathQueue,
    pub(super) scales: Option<ScaleQueue>,
    pub(super) normals: Option<NormalQueue>,
    pub(super) firsts: Option<FirstQueue>,
    /// Paths that look for focused light; only where light paths are traced.
    pub(super) aimed: Option<Box<Queues>>,
    pub(super) hits: HitQueue,
    pub(super) shadows: ShadowQueue,
    /// Rows by the kind of surface that they hit; lists of kinds that the scene lacks stay empty.
    pub(super) by_kind: [RowList; Kind::COUNT],
    /// Rows that hit nothing.
    pub(super) escaped: RowList,
    /// Which paths go on: a bit per row, eight rows to a byte.
    pub(super) alive: Vec<u8>,
    /// Which connections nothing blocks, likewise.
    pub(super) open: Vec<u8>,
}

impl Queues {
    /// Queues for what the plan needs.
    pub fn new(plan: &Plan) -> Self {
        let n = plan.wave_size;
        let list = |needed: bool| RowList::with_capacity(if needed { n } else { 0 });
        Self {
            paths: PathQueue::with_capacity(n),
            scales: plan.transmit.then(|| ScaleQueue::with_capacity(n)),
            normals: plan.receivers.then(|| NormalQueue::with_capacity(n)),
            firsts: plan.caustics().then(|| FirstQueue::with_capacity(n)),
            aimed: plan.caustics().then(|| Box::new(Self::new(&plan.of_aimed_paths()))),
            hits: HitQueue::with_capacity(n),
            shadows: ShadowQueue::with_capacity(if plan.connect { n } else { 0 }),
            by_kind: std::array::from_fn(|k| {
                let listed = !plan.sole_kind() && plan.kinds.iter().any(|&kind| kind as usize == k);
                list(listed || (plan.emit && k == Kind::Luminous as usize))
            }),
            escaped: list(plan.escape),
            alive: Vec::with_capacity(n.div_ceil(MAX_LANES)),
            open: Vec::with_capacity(if plan.connect { n.div_ceil(MAX_LANES) } else { 0 }),
        }
    }
    /// Ends the paths of the live lanes whose bit is set.
    #[inline(always)]
    pub(super) fn end(&mut self, rows: &Rows, bits: u32) {
        let mut ended = bits & rows.live();
        while ended != 0 {
            let row = rows.at(ended.trailing_zeros() as usize);
            self.alive[row / MAX_LANES] &= !(1 << (row % MAX_LANES));
            ended &= ended - 1;
        }
    }
    /// Appends paths as they hit a surface.
    #[inline(always)]
    pub(super) fn begin<W: Wide>(&mut self, bits: u32, path: Path<W>, scale: W, hit: HitRow<W>) {
        if bits == 0 {
            return;
        }
        self.hits.put(self.paths.len(), bits, hit);
        self.paths.append(bits, path);
        if let Some(scales) = &mut self.scales {
            scales.append(bits, Scale { scale });
        }
    }
    /// Ends all paths that hit a surface of this kind.
    pub(super) fn end_all(&mut self, kind: Kind) {
        let list = std::mem::take(&mut self.by_kind[kind as usize]);
        list.rows().chunks(MAX_LANES).for_each(|rows| self.end(&Rows::listed(rows), u32::MAX));
        self.by_kind[kind as usize] = list;
    }
    /// Keeps the first `len` paths.
    pub(super) fn truncate(&mut self, len: usize) {
        self.paths.truncate(len);
        if let Some(scales) = &mut self.scales {
            scales.truncate(len);
        }
        if let Some(normals) = &mut self.normals {
            normals.truncate(len);
        }
        if let Some(firsts) = &mut self.firsts {
            firsts.truncate(len);
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::linear::DVec3;
    use crate::wave::Method;
    use crate::world::{MaterialInput, Mesh, Object, Size, WorldBuilder};

    /// The plan of a scene with a triangle of each material.
    pub fn plan(materials: &[MaterialInput], background: f32) -> Plan {
        let (focal_point, direction) = (DVec3::ZERO, DVec3::Y);
        let mut b =
            WorldBuilder::new(Camera { focal_point, direction, width: 4, height: 4, x_angle: 45.0, y_angle: 45.0 });
        b.background([background; 3]);
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Z].to_vec();
        let mesh = b.mesh(Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() });
        for m in materials {
            let material = b.material(m.clone());
            b.object(Object { mesh, material, rotation: DVec3::ZERO, size: Size::Scale(1.0), mid_point: DVec3::ZERO });
        }
        Plan::new(&b.build().unwrap(), Method::Mis, None, 64, 0.25)
    }

    /// The queues hold what the plan counts; nothing is held for what the scene lacks; all of it stays small.
    #[test]
    fn paths_are_small_and_absent_features_take_nothing() {
        let (matt, diffuse, mirror, glass, lamp) = (
            MaterialInput::Diffuse { color: [0.5; 3], mattness: 0.5 },
            MaterialInput::Diffuse { color: [0.5; 3], mattness: 1.0 },
            MaterialInput::Specular { color: [0.5; 3] },
            MaterialInput::Transparent { color: [0.5; 3], ref_index: 1.5 },
            MaterialInput::Luminous { radiance: [1.0; 3] },
        );
        let all = plan(&[matt, diffuse.clone(), mirror.clone(), glass, lamp.clone()], 1.0);
        // Paths that look for focused light have rows of their own, as many: few of them are used at a time.
        let aimed = all.of_aimed_paths().path_bytes();
        assert!(all.path_bytes() - aimed <= 156 && aimed <= 96, "{} and {aimed} bytes", all.path_bytes());
        let box_ = plan(&[diffuse, lamp.clone()], 0.0);
        let q = Queues::new(&box_);
        assert!(q.scales.is_none() && q.escaped.rows.is_empty() && q.by_kind[..4].iter().all(|l| l.rows.is_empty()));
        assert!(box_.sole_kind() && box_.connect && !box_.transmit && !box_.smooth && !box_.escape);
        // 56 of the path, 12 of the hit, 40 of the connection, a list for lights, a flag.
        assert_eq!(box_.path_bytes(), 56 + 12 + 40 + 4 + 1);
        // Nothing can be connected to from a mirror.
        let mirrors = plan(&[mirror, lamp], 0.0);
        assert!(!mirrors.connect && mirrors.path_bytes() == 56 + 12 + 4 + 1);
    }
}
