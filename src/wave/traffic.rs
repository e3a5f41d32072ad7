//! What each stage moves through the queues for a row: by how far a stage is from the limits of the machine. What is looked up in
//! the scene (tree, corners, materials, lights) is not counted: it depends on the scene.

use super::plan::Plan;
use super::queues::{FirstQueue, HitQueue, NormalQueue, PathQueue, ScaleQueue, ShadowQueue};
use crate::probe::Stage;

/// Bytes of three numbers.
const V3: usize = 12;
/// Bytes of one.
const ONE: usize = 4;
/// A sample that is added to: read and written.
const SAMPLE: usize = 2 * V3;

impl Plan {
    /// What one path takes in all queues: names and bytes. A connection, a hit and lists have a row for each path.
    pub fn columns(&self) -> Vec<(String, usize)> {
        let kinds = if self.sole_kind() { 0 } else { self.kinds.len() };
        let queues = [
            (1, "path", PathQueue::COLUMNS),
            (1, "hit", HitQueue::COLUMNS),
            (usize::from(self.transmit), "refraction", ScaleQueue::COLUMNS),
            (usize::from(self.receivers), "receiver", NormalQueue::COLUMNS),
            (usize::from(self.caustics()), "first bounce", FirstQueue::COLUMNS),
            (usize::from(self.connect), "connection", ShadowQueue::COLUMNS),
            (kinds, "lists", &[("surfaces", ONE)]),
            (usize::from(self.emit), "lists", &[("lights", ONE)]),
            (usize::from(self.escape), "lists", &[("escaped", ONE)]),
            // Bits among those that go on and those that nothing blocks, rounded up.
            (1, "flags", &[("bits", 1)]),
        ];
        let used = queues.into_iter().filter(|queue| queue.0 > 0);
        let mut all: Vec<(String, usize)> = used
            .flat_map(|(times, queue, columns)| {
                columns.iter().map(move |(name, bytes)| (format!("{queue}.{name}"), times * bytes))
            })
            .collect();
        if self.caustics() {
            all.push(("paths that look for focused light".to_owned(), self.of_aimed_paths().path_bytes()));
        }
        all
    }
    /// Bytes that one path takes in all queues.
    pub fn path_bytes(&self) -> usize {
        self.columns().iter().map(|(_, bytes)| bytes).sum()
    }
    /// Bytes of what only some scenes carry along with a path.
    fn extra_bytes(&self) -> usize {
        let part = |has: bool, bytes: usize| if has { bytes } else { 0 };
        part(self.transmit, ScaleQueue::ROW_BYTES)
            + part(self.receivers, NormalQueue::ROW_BYTES)
            + part(self.caustics(), FirstQueue::ROW_BYTES)
    }
    /// Bytes of columns that a stage reads and writes for a row, counted from the source; `None` for stages of light paths and
    /// aimed paths, which are several stages in one.
    pub fn stage_bytes(&self, stage: Stage) -> Option<usize> {
        let path = PathQueue::ROW_BYTES + self.extra_bytes();
        let shadow = if self.connect { ShadowQueue::ROW_BYTES } else { 0 };
        match stage {
            Stage::Generate => Some(path),
            // Origin and direction; the hit.
            Stage::Intersect => Some(2 * V3 + HitQueue::ROW_BYTES),
            // The triangle, the depth; the row in a list, or one bit.
            Stage::Route => Some(2 * ONE + if self.sole_kind() { 0 } else { ONE }),
            Stage::Escape => Some(2 * V3 + ONE + SAMPLE),
            Stage::Emit => Some(path + HitQueue::ROW_BYTES + SAMPLE),
            // Of a path its slot stays as it is.
            Stage::Shade => Some(2 * path - ONE + HitQueue::ROW_BYTES + shadow),
            Stage::Connect => Some(shadow + SAMPLE),
            // Before shading, what shading makes anew stays behind.
            Stage::Compact if self.sole_kind() => {
                let made_anew = V3 + ONE + if self.receivers { NormalQueue::ROW_BYTES } else { 0 };
                Some(2 * (path - made_anew + HitQueue::ROW_BYTES))
            }
            Stage::Compact => Some(2 * path),
            Stage::Accumulate => Some(V3),
            Stage::Aim | Stage::Start | Stage::Scatter | Stage::Expose => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::queues::tests::plan;
    use super::*;
    use crate::world::MaterialInput;

    #[test]
    fn scenes_move_what_they_need() {
        let lamp = MaterialInput::Luminous { radiance: [1.0; 3] };
        let matt = MaterialInput::Diffuse { color: [0.5; 3], mattness: 1.0 };
        let glass = MaterialInput::Transparent { color: [1.0; 3], ref_index: 1.5 };
        let room = plan(&[matt.clone(), lamp.clone()], 0.0);
        let bytes = |plan: &Plan| Stage::ALL.map(|stage| plan.stage_bytes(stage));
        // A path of 56, a hit of 12, a connection of 40.
        let of = |stage: Stage| room.stage_bytes(stage).unwrap();
        assert_eq!([Stage::Generate, Stage::Intersect, Stage::Compact].map(of), [56, 36, 2 * (40 + 12)]);
        assert_eq!([Stage::Shade, Stage::Connect].map(of), [2 * 56 - 4 + 12 + 40, 40 + 24]);
        assert_eq!([Stage::Route, Stage::Escape, Stage::Emit].map(of), [4 + 4, 24 + 4 + 24, 56 + 12 + 24]);
        assert_eq!(of(Stage::Accumulate), 12);
        // Glass adds a scale to all that moves paths, and light paths more.
        let rich = plan(&[matt, glass, lamp], 0.0);
        for (with, without) in bytes(&rich).into_iter().zip(bytes(&room)) {
            assert!(with >= without, "{with:?} {without:?}");
        }
        // A list of rows; a scale and two densities.
        let of = |stage: Stage| rich.stage_bytes(stage).unwrap();
        assert_eq!([Stage::Route, Stage::Compact].map(of), [4 + 4 + 4, 2 * (56 + 4 + 8)]);
    }
}
