//! The rays of a stream: where they enter boxes, what they hit in leaves, and what waits for kernel B.

use super::super::Hit;
use super::super::group::RayHits;
use super::super::layout::{Leaf, Node};
use super::super::ray::{RaySource, prepare};
use super::super::way::Way;
use super::STREAM;
use super::frame::{Frame, List, Slabs};
use crate::columns::Rows;
use crate::lanes::{LanesU32, MAX_LANES, Mask, Wide};

/// A ray of a stream: what boxes need of it; what triangles need, and what it has hit.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Row {
    /// Reciprocals of the direction, the origin, and the hit's weights of corners.
    slabs: [f32; 8],
    /// The shear, the origin with permuted axes, the distance of the hit and its triangle's id as bits.
    shear: [f32; 8],
}

/// Children that wait for kernel B.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Later {
    /// Where the ray enters them; not a number past the last.
    pub near: [f32; 8],
    pub codes: [u32; 8],
}

const NOTHING: Later = Later { near: [f32::NAN; 8], codes: [0; 8] };

impl Row {
    /// Behind this distance nothing is looked for, with `slack` as in [`super::super::ray::Prepared::pad`].
    #[inline(always)]
    fn end(&self, slack: f32) -> f32 {
        self.shear[6] + self.shear[2].abs() * slack
    }
}

/// The rays of a stream.
#[derive(Clone, Debug)]
pub struct Rays {
    rows: [Row; STREAM],
    later: [Later; STREAM],
    /// How many of `later` each has.
    laters: [u8; STREAM],
}

impl Rays {
    /// No rays.
    pub fn empty() -> Self {
        let row = Row { slabs: [0.0; 8], shear: [0.0; 8] };
        Self { rows: [row; STREAM], later: [NOTHING; STREAM], laters: [0; STREAM] }
    }

    /// What ray `i` has hit.
    #[inline(always)]
    pub fn hit(&self, i: usize) -> Hit {
        let Row { slabs: [.., u, v], shear: [.., t, id] } = self.rows[i];
        Hit { t, u, v, triangle: id.to_bits() }
    }

    /// What waits for ray `i` and is not behind its hit.
    #[inline(always)]
    pub fn later<W: Wide>(&self, i: usize, slack: f32) -> Option<Later> {
        let waits = self.laters[i] > 0 && W::load(&self.later[i].near).le(W::splat(self.rows[i].end(slack))).any();
        if waits { Some(self.later[i]) } else { None }
    }

    /// Takes the rays of these numbers, and lets them meet the children of the root.
    #[inline(always)]
    pub fn start<W: Wide>(
        &mut self,
        root: &Node,
        way: &Way,
        source: &(impl RaySource + ?Sized),
        numbers: &[u32],
        frame: &mut Frame,
        slack: f32,
    ) {
        frame.start(0, root.order(way.octant()));
        let none = W::from_bits(W::Uint::splat(Hit::NONE));
        let zero = W::splat(0.0);
        for (g, chunk) in numbers.chunks(MAX_LANES).enumerate() {
            let at = g * MAX_LANES;
            let batch = source.rays::<W>(&Rows::listed(chunk));
            let (numbers, ..) = prepare(&batch);
            let [ix, iy, iz, _, _, _, _, _, _, sx, sy, sz, ox, oy, oz, t] = numbers;
            let o = batch.origin;
            let slabs = W::transpose([ix, iy, iz, o.x, o.y, o.z, zero, zero]);
            let shear = W::transpose([sx, sy, sz, ox, oy, oz, t, none]);
            for (i, row) in self.rows[at..at + MAX_LANES].iter_mut().enumerate() {
                slabs[i].store(&mut row.slabs);
                shear[i].store(&mut row.shear);
            }
            self.laters[at..at + MAX_LANES].fill(0);
            let slabs = Slabs::new([ix, iy, iz], [o.x, o.y, o.z], t + sz.abs() * W::splat(slack));
            let numbers = W::Uint::load(&[0, 1, 2, 3, 4, 5, 6, 7]).add(W::Uint::splat(at as u32));
            frame.enter(root, way, &slabs, numbers, Rows::range(0, chunk.len()).live());
        }
    }

    /// Leaves a child to kernel B; false if one of the rays has no room for it.
    #[inline(always)]
    pub fn postpone(&mut self, list: &List, code: u32) -> bool {
        let rays = &list.rays[..list.len];
        if rays.iter().any(|&ray| usize::from(self.laters[ray as usize % STREAM]) == MAX_LANES) {
            return false;
        }
        for (&ray, &near) in rays.iter().zip(&list.near) {
            let ray = ray as usize % STREAM;
            let (later, count) = (&mut self.later[ray], &mut self.laters[ray]);
            if *count == 0 {
                later.near = NOTHING.near;
            }
            let at = usize::from(*count) % MAX_LANES;
            (later.near[at], later.codes[at]) = (near, code);
            *count += 1;
        }
        true
    }

    /// Rays of a list meet the children of an inner node.
    #[inline(always)]
    pub fn meet_node<W: Wide>(&self, node: &Node, code: u32, way: &Way, list: &List, below: &mut Frame, slack: f32) {
        below.start(code, node.order(way.octant()));
        for at in (0..list.len).step_by(MAX_LANES) {
            let n = MAX_LANES.min(list.len - at);
            let row = |i: usize| &self.rows[list.rays[at + i.min(n - 1)] as usize % STREAM];
            let [ix, iy, iz, ox, oy, oz, ..] = W::columns8(|i| &row(i).slabs);
            let end = W::from_fn(|i| row(i).end(slack));
            // Not those that have hit something before this node.
            let late = W::load(&list.near[at..]).le(end).bits();
            let slabs = Slabs::new([ix, iy, iz], [ox, oy, oz], end);
            below.enter(node, way, &slabs, W::Uint::load(&list.rays[at..]), late & Rows::range(0, n).live());
        }
    }

    /// Rays of a list meet the triangles of a leaf.
    #[inline(always)]
    pub fn meet_leaf<W: Wide, const ANY: bool>(&mut self, leaf: &Leaf, way: &Way, list: &List, slack: f32) {
        for at in (0..list.len).step_by(MAX_LANES) {
            let n = MAX_LANES.min(list.len - at);
            let index = |i: usize| list.rays[at + i.min(n - 1)] as usize % STREAM;
            let [sx, sy, sz, ox, oy, oz, t, id] = W::columns8(|i| &self.rows[index(i)].shear);
            let end = t + sz.abs() * W::splat(slack);
            let late = W::load(&list.near[at..]).le(end).bits() & Rows::range(0, n).live();
            if late == 0 {
                continue;
            }
            let (origin, shear) = ([ox, oy, oz], [sx, sy, sz]);
            let mut hits = RayHits { t, u: W::splat(0.0), v: W::splat(0.0), triangle: id.to_bits() };
            let changed = if ANY {
                hits.any::<false>(leaf, way, origin, shear)
            } else {
                hits.closest::<false>(leaf, way, origin, shear)
            };
            let mut bits = changed.bits() & late;
            let (t, u, v, triangle) = (hits.t.array(), hits.u.array(), hits.v.array(), hits.triangle.array());
            while bits != 0 {
                let i = (bits.trailing_zeros() & 7) as usize;
                let row = &mut self.rows[index(i)];
                (row.slabs[6], row.slabs[7]) = (u[i], v[i]);
                (row.shear[6], row.shear[7]) = (t[i], f32::from_bits(triangle[i]));
                bits &= bits - 1;
            }
        }
    }
}
