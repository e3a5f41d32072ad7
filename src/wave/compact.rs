//! Removal of paths that ended: those that go on close up, in order, so that whole registers move.

use super::queues::Queues;
use crate::columns::Rows;
use crate::lanes::{Kernel, MAX_LANES, Wide};

/// Moves the rows that go on to the front of the queue.
pub struct Compact<'a> {
    pub q: &'a mut Queues,
    /// Whether they have been shaded: then their hits stay behind. Else what shading makes anew does: where rays began, with
    /// which density, and normals. (A wave that shades more than one kind removes paths after that only.)
    pub shaded: bool,
}

impl Kernel for Compact<'_> {
    type Out = ();
    #[inline(always)]
    fn run<W: Wide>(self) {
        let Self { q, shaded } = self;
        let mut kept = 0;
        for (group, &alive) in q.alive.iter().enumerate() {
            let (first, bits) = (group * MAX_LANES, u32::from(alive));
            let rows = Rows::range(first, MAX_LANES.min(q.paths.len() - first));
            if first != kept || bits != rows.live() {
                // What is overwritten lies before the end of this group, which has been read.
                let paths = q.paths.gather::<W>(&rows);
                if shaded {
                    q.paths.put(kept, bits, paths);
                } else {
                    q.paths.put_unshaded(kept, bits, paths);
                    q.hits.put(kept, bits, q.hits.gather::<W>(&rows));
                }
                if let Some(scales) = &mut q.scales {
                    scales.put(kept, bits, scales.gather::<W>(&rows));
                }
                if shaded && let Some(normals) = &mut q.normals {
                    normals.put(kept, bits, normals.gather::<W>(&rows));
                }
                if let Some(firsts) = &mut q.firsts {
                    firsts.put(kept, bits, firsts.gather::<W>(&rows));
                }
            }
            kept += bits.count_ones() as usize;
        }
        q.truncate(kept);
    }
}

#[cfg(test)]
mod tests {
    use crate::columns::Rows;
    use crate::lanes::{Vec3, dispatch};
    use crate::wave::compact::Compact;
    use crate::wave::queues::tests::plan;
    use crate::wave::queues::{HitRow, Path, Queues};
    use crate::world::MaterialInput;

    #[test]
    fn what_goes_on_keeps_its_order_and_what_is_read_again() {
        let plan = plan(&[MaterialInput::Diffuse { color: [0.5; 3], mattness: 1.0 }], 1.0);
        for alive in [[0xffu8, 0xff, 0x03], [0, 0, 0], [0x81, 0xff, 0x02], [0xff, 0x7f, 0x01], [0, 0x10, 0]] {
            for shaded in [false, true] {
                let mut q = Queues::new(&plan);
                for slot in 0..18 {
                    let at = |k: u32| Vec3::splat([(k + slot) as f32; 3]);
                    let path = Path::<f32> {
                        origin: at(200),
                        direction: at(300),
                        throughput: at(400),
                        prev_pdf: (500 + slot) as f32,
                        slot,
                        depth: 600 + slot,
                        rng: [700 + slot, 800 + slot],
                    };
                    q.paths.append(1, path);
                    q.hits.put(slot as usize, 1, HitRow::<f32> { u: 0.0, v: 0.0, triangle: 100 + slot });
                }
                q.alive.extend(alive);
                dispatch(Compact { q: &mut q, shaded });
                let expected: Vec<u32> = (0..18).filter(|&i| alive[i as usize / 8] >> (i % 8) & 1 == 1).collect();
                assert_eq!(q.paths.len(), expected.len());
                for (row, &slot) in expected.iter().enumerate() {
                    let path = q.paths.gather::<f32>(&Rows::range(row, 1));
                    assert_eq!((path.slot, path.depth, path.rng), (slot, 600 + slot, [700 + slot, 800 + slot]));
                    assert_eq!((path.direction.x, path.throughput.z), ((300 + slot) as f32, (400 + slot) as f32));
                    if shaded {
                        assert_eq!((path.origin.y, path.prev_pdf), ((200 + slot) as f32, (500 + slot) as f32));
                    } else {
                        assert_eq!(q.hits.triangle::<f32>(&Rows::range(row, 1)), 100 + slot);
                    }
                }
            }
        }
    }
}
