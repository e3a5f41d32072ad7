//! Rays per second in generated meshes, by each kernel.

use super::{Room, short};
use crate::bench::files::HitRecord;
use crate::bench::kernel::{Kernel, Tracer};
use crate::bench::measure::{Case, Pace, Unit};
use crate::bench::sets::{Options, RaySet, SetKind, make};
use crate::error::Result;
use std::cell::RefCell;

/// The sets that are traced.
const KINDS: [SetKind; 3] = [SetKind::Primary, SetKind::Bounce, SetKind::Shadow];
/// Pixels across and down: a set is a quarter of a million rays.
const RES: u32 = 512;

/// A set of rays in a mesh.
pub(super) struct Set<'a> {
    room: &'a Room,
    set: RaySet,
    hits: RefCell<Vec<HitRecord>>,
}

/// The sets of all meshes, as long as it goes on; those without rays are left out.
pub(super) fn sets<'a>(rooms: &'a [Room], threads: usize, goes_on: &mut impl FnMut() -> bool) -> Result<Vec<Set<'a>>> {
    let mut all = Vec::new();
    for room in rooms.iter().take_while(|_| goes_on()) {
        let tracer = Tracer { bvh: &room.bvh, kernel: Kernel::Auto, threads };
        let options = Options { res: RES, ..Options::default() };
        let (sets, _) = make(&room.corners, &tracer, &options, &KINDS)?;
        let full = sets.into_iter().filter(|set| !set.rays.is_empty());
        all.extend(full.map(|set| {
            let hits = RefCell::new(vec![HitRecord::MISS; set.rays.len()]);
            Set { room, set, hits }
        }));
    }
    Ok(all)
}

/// Each set with each kernel.
pub(super) fn cases<'a>(sets: &'a [Set<'a>], threads: usize) -> Vec<Case<'a>> {
    let with = |set: &'a Set<'a>| Kernel::ALL.iter().map(move |&(kernel, name)| (set, kernel, name));
    let case = |(set, kernel, name): (&'a Set<'a>, Kernel, &'static str)| {
        let tracer = Tracer { bvh: &set.room.bvh, kernel, threads };
        let name = format!("rays/{}/{}/{name}", short(set.room.size), set.set.kind.name());
        trace(name, tracer, &set.set, &set.hits)
    };
    sets.iter().flat_map(with).map(case).collect()
}

/// Rays per second of a tracer on a set; the hits are left in `hits`.
///
/// A time is that from the first ray read to the last hit written, with the start and the end of all threads.
pub fn trace<'a>(name: String, tracer: Tracer<'a>, set: &'a RaySet, hits: &'a RefCell<Vec<HitRecord>>) -> Case<'a> {
    let mut pace = Pace::default();
    let run = move || {
        let mut hits = hits.borrow_mut();
        let seconds = pace.seconds(|passes| tracer.trace(&set.rays, &mut hits, set.kind.query(), passes));
        vec![set.rays.len() as f64 / seconds / 1e6]
    };
    Case::new(vec![(name, Unit::Mrays)], run)
}
