//! Streams of rays (kernel D): all rays of a batch that run the same way enter the tree together. Eight of them meet a
//! box at a time, and each child gets the list of those that meet it; eight rays of a list meet a triangle at a time. At
//! the top of a tree lists are long and lanes full, and no ray waits for a mispredicted branch of its own.
//! What is left of a ray where lists get short is traced by kernel B, from the nodes that wait for it.
//!
//! Rays are put in order of their way first, one octant and one main axis, so that a list reads the same planes of boxes
//! and the same coordinates of triangles. After Barringer and Akenine-Möller, "Dynamic Ray Stream Traversal", 2014.

mod frame;
mod rays;

use super::batch::BatchTracer;
use super::feed::Feed;
use super::many::{Many, Slot};
use super::ray::{Prepared8, RaySource, RaysFrom};
use super::way::{WAYS, Way, way_of};
use super::{Bvh, Hit, LEAF, Tree};
use crate::columns::Rows;
use crate::lanes::{LanesU32, MAX_LANES, Wide};
use frame::Frame;
use rays::{Later, Rays};

/// Rays that are put in order of their ways at a time.
const BATCH: usize = 4096;
/// Rays of one way that go through the tree together: they and their lists stay in the cache of the core.
const STREAM: usize = 256;
/// Rays that wait for kernel B.
const WAITING: usize = 512;
/// Rays of a list below which an inner node waits for kernel B.
const SHORT: usize = 12;
/// Rays of a batch below which all of it is left to kernel B: its lists would be short.
const FEW: usize = 256;
/// Share of a batch that waits, in per cent, above which the next rays are left to kernel B at once: where nearest hits and where any
/// are looked for, as that takes less per ray and putting rays in order as much;
const MOST: [usize; 2] = [40, 20];
/// and how many.
const DIRECT: usize = 32 * BATCH;
/// Size of trees, in bytes, from which on kernel B alone looks for any hit: lists save it less there than they cost.
const LARGE: usize = 4 << 20;

/// A ray that waits for kernel B.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    later: Later,
    ray: u32,
    hit: Hit,
}

/// Traces batches of rays that run anywhere; holds its lists between batches.
#[derive(Clone, Debug)]
pub struct Streams {
    ways: Box<[u32; BATCH + MAX_LANES]>,
    sorted: Box<[u32; BATCH]>,
    rays: Box<Rays>,
    frames: Vec<Frame>,
    waiting: Vec<Waiting>,
    many: Many,
    /// Rays yet to go to kernel B at once, where nearest hits and where any are looked for.
    direct: [usize; 2],
    allowed: bool,
}

impl Default for Streams {
    fn default() -> Self {
        Self {
            ways: Box::new([0; BATCH + MAX_LANES]),
            sorted: Box::new([0; BATCH]),
            rays: Box::new(Rays::empty()),
            frames: Vec::new(),
            waiting: Vec::with_capacity(WAITING),
            many: Many::new(),
            direct: [0; 2],
            allowed: true,
        }
    }
}

impl Streams {
    /// Room for any batch; lists of a tree's deeper levels are added when a batch first gets there.
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether streams are tried at all; else kernel B traces everything.
    pub fn allow(&mut self, streams: bool) {
        self.allowed = streams;
    }

    /// Forgets what earlier batches showed of whether streams pay.
    pub fn restart(&mut self) {
        self.direct = [0; 2];
    }
}

impl BatchTracer for Streams {
    #[inline(always)]
    fn trace<W: Wide, const ANY: bool>(
        &mut self,
        bvh: &Bvh,
        count: usize,
        rays: &(impl RaySource + ?Sized),
        mut found: impl FnMut(usize, Hit),
    ) {
        if bvh.is_empty() || !self.allowed || ANY && bvh.bytes() >= LARGE {
            self.many.trace::<W, ANY>(bvh, count, rays, found);
            return;
        }
        let mut first = 0;
        while first < count {
            let left = count - first;
            let direct = &mut self.direct[usize::from(ANY)];
            let n = if *direct > 0 { left.min(*direct) } else { left.min(BATCH) };
            if *direct > 0 || n < FEW {
                *direct = direct.saturating_sub(n);
                self.many.trace::<W, ANY>(bvh, n, &RaysFrom { rays, first }, |i, hit| found(first + i, hit));
            } else if self.batch::<W, ANY>(bvh, rays, first, n, &mut found) * 100 > n * MOST[usize::from(ANY)] {
                self.direct[usize::from(ANY)] = DIRECT;
            }
            first += n;
        }
    }
}

impl Streams {
    /// Traces `n` rays from `first` on; returns how many of them waited for kernel B.
    #[inline(always)]
    fn batch<W: Wide, const ANY: bool>(
        &mut self,
        bvh: &Bvh,
        rays: &(impl RaySource + ?Sized),
        first: usize,
        n: usize,
        found: &mut impl FnMut(usize, Hit),
    ) -> usize {
        let ends = self.sort::<W>(rays, first, n);
        let (mut from, mut waited) = (0, 0);
        for (way, &end) in ends.iter().enumerate() {
            let (way, end) = (Way::new(way as u32), end as usize);
            while from < end {
                let n = STREAM.min(end - from);
                if self.waiting.len() + n > WAITING {
                    waited += self.land::<W, ANY>(bvh, rays, found);
                }
                self.stream::<W, ANY>(bvh.tree_for::<ANY>(), &way, rays, from, n, found);
                from += n;
            }
        }
        waited + self.land::<W, ANY>(bvh, rays, found)
    }

    /// Puts the numbers of `n` rays from `first` on in order of their ways; returns where each way ends.
    #[inline(always)]
    fn sort<W: Wide>(&mut self, rays: &(impl RaySource + ?Sized), first: usize, n: usize) -> [u32; WAYS] {
        let mut ends = [0u32; WAYS];
        for at in (0..n).step_by(MAX_LANES) {
            let live = MAX_LANES.min(n - at);
            let ways = way_of(&rays.rays::<W>(&Rows::range(first + at, live)));
            ways.store(&mut self.ways[at..]);
            for &way in &ways.array()[..live] {
                ends[(way as usize) % WAYS] += 1;
            }
        }
        let mut sum = 0;
        for end in &mut ends {
            (*end, sum) = (sum, sum + *end);
        }
        for (i, &way) in self.ways[..n].iter().enumerate() {
            let end = &mut ends[(way as usize) % WAYS];
            self.sorted[*end as usize % BATCH] = (first + i) as u32;
            *end += 1;
        }
        ends
    }

    /// Traces what waits, by kernel B; returns how many rays that are.
    #[inline(always)]
    fn land<W: Wide, const ANY: bool>(
        &mut self,
        bvh: &Bvh,
        rays: &(impl RaySource + ?Sized),
        found: &mut impl FnMut(usize, Hit),
    ) -> usize {
        let Self { waiting, many, .. } = self;
        let feed = FromNodes { rays, waiting };
        many.feed::<W, ANY>(bvh, &feed, |i, hit| found(waiting[i].ray as usize, hit));
        let waited = waiting.len();
        waiting.clear();
        waited
    }

    /// Traces `n` rays of one way, those at `from` in the order: to their ends, or to where they wait.
    #[inline(always)]
    fn stream<W: Wide, const ANY: bool>(
        &mut self,
        tree: Tree,
        way: &Way,
        source: &(impl RaySource + ?Sized),
        from: usize,
        n: usize,
        found: &mut impl FnMut(usize, Hit),
    ) {
        let Self { sorted, rays, frames, waiting, .. } = self;
        let sorted = &sorted[from..from + n];
        if frames.is_empty() {
            frames.push(Frame::empty());
        }
        rays.start::<W>(tree.node(0), way, source, sorted, &mut frames[0], tree.slack);
        let mut level = 0;
        loop {
            let frame = &mut frames[level];
            let Some(lane) = frame.turn() else {
                if level == 0 {
                    break;
                }
                level -= 1;
                continue;
            };
            let code = tree.node(frame.code).child(lane);
            let list = &frame.lists[lane];
            if code & LEAF != 0 {
                rays.meet_leaf::<W, ANY>(tree.leaf(code), way, list, tree.slack);
                continue;
            }
            if list.len < SHORT && rays.postpone(list, code) {
                continue;
            }
            level += 1;
            if frames.len() == level {
                frames.push(Frame::empty());
            }
            if let [above, below, ..] = &mut frames[level - 1..] {
                rays.meet_node::<W>(tree.node(code), code, way, &above.lists[lane], below, tree.slack);
            }
        }
        for (i, &ray) in sorted.iter().enumerate() {
            match rays.later::<W>(i, tree.slack) {
                Some(later) => waiting.push(Waiting { later, ray, hit: rays.hit(i) }),
                None => found(ray as usize, rays.hit(i)),
            }
        }
    }
}

/// Rays that wait, as a feed of kernel B.
struct FromNodes<'a, R: ?Sized> {
    rays: &'a R,
    waiting: &'a [Waiting],
}

impl<R: RaySource + ?Sized> Feed for FromNodes<'_, R> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.waiting.len()
    }
    #[inline(always)]
    fn fill<W: Wide>(&self, ready: &mut Prepared8, first: usize) {
        let n = MAX_LANES.min(self.waiting.len() - first);
        let mut numbers = [0; MAX_LANES];
        for (number, waiting) in numbers.iter_mut().zip(&self.waiting[first..first + n]) {
            *number = waiting.ray;
        }
        ready.fill::<W>(&self.rays.rays(&Rows::scattered(&numbers[..n])));
    }
    #[inline(always)]
    fn start<W: Wide, const ANY: bool>(&self, slot: &mut Slot, i: usize) -> u32 {
        let Waiting { later, hit, .. } = &self.waiting[i];
        slot.resume::<W, ANY>(*hit, &later.near, &later.codes)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Ray;
    use super::*;
    use crate::lanes::F32x8;

    /// Of a closed box with `n` x `n` cells to a side, rays from the middle to all sides: those of an even spiral.
    fn waited(n: usize) -> (usize, [usize; 2]) {
        let at = |i: usize| i as f32 / n as f32 * 2.0 - 1.0;
        let mut corners = Vec::new();
        for side in 0..6 {
            let place = |i: usize, k: usize| {
                let mut p = [0.0; 3];
                (p[side % 3], p[(side + 1) % 3], p[(side + 2) % 3]) = ([-1.0, 1.0][side / 3], at(i), at(k));
                p
            };
            for (i, k) in (0..n).flat_map(|i| (0..n).map(move |k| (i, k))) {
                corners.push([place(i, k), place(i + 1, k), place(i, k + 1)]);
                corners.push([place(i + 1, k + 1), place(i, k + 1), place(i + 1, k)]);
            }
        }
        let bvh = Bvh::build(&corners);
        let rays: Vec<Ray> = (0..BATCH)
            .map(|i| {
                let z = (i as f32 + 0.5) / BATCH as f32 * 2.0 - 1.0;
                let (sin, cos) = (2.4 * i as f32).sin_cos();
                let r = (1.0 - z * z).sqrt();
                Ray { origin: [0.01, 0.02, 0.03], direction: [r * cos, r * sin, z], t_max: f32::INFINITY }
            })
            .collect();
        let mut streams = Streams::new();
        let waited = streams.batch::<F32x8, false>(&bvh, rays.as_slice(), 0, BATCH, &mut |_, hit: Hit| {
            assert!(hit.is_some());
        });
        streams.trace::<F32x8, false>(&bvh, BATCH, rays.as_slice(), |_, hit| assert!(hit.is_some()));
        (waited, streams.direct)
    }

    #[test]
    fn small_trees_are_for_streams_and_large_ones_for_the_other_kernel() {
        assert_eq!(waited(1), (0, [0, 0]), "a box");
        let (rays, direct) = waited(80);
        assert!(rays > BATCH * 9 / 10, "{rays} of {BATCH} waited");
        assert_eq!(direct, [DIRECT, 0], "nearest hits, of which alone there were");
    }
}
