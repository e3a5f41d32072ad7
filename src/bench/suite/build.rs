//! Building the tree: triangles per second, the corners in memory, the tree thrown away.

use super::{Room, short};
use crate::accel::{BuildOptions, Bvh};
use crate::bench::measure::{Case, Pace, Unit};
use std::hint::black_box;

/// The build over one mesh.
pub(super) fn case(room: &Room, options: BuildOptions) -> Case<'_> {
    let mut pace = Pace::default();
    let run = move || {
        let seconds = pace.seconds(|passes| {
            (0..passes).for_each(|_| drop(black_box(Bvh::build_with(&room.corners, &options))));
        });
        vec![room.corners.len() as f64 / seconds / 1e6]
    };
    Case::new(vec![(format!("build/{}", short(room.size)), Unit::Mtriangles)], run)
}
