//! The order of an object's triangles: it depends on where they lie, not on the file.
//!
//! Where two triangles are hit at the same distance, to the bit, the first one counts; lights are numbered in their order, and
//! the tree's builder breaks ties by it. In an order of their own, a file whose faces are shuffled gives the same image to
//! the bit. It follows a curve through space, so that neighbours lie together in memory. What it costs is in
//! `docs/decisions/order-of-triangles.md`.

use super::Mesh;
use crate::linear::Vec3;

/// Cells of the curve along each axis.
const CELLS: f32 = (1 << 21) as f32;

/// Spreads 21 bits, two zeros after each.
fn spread(bits: u64) -> u64 {
    let steps = [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ];
    steps.iter().fold(bits, |b, (shift, mask)| (b | b << shift) & mask)
}

/// Place of a triangle on the Z-order curve (Morton 1966) through the cube from -1 to 1, by its middle.
fn place([a, b, c]: [Vec3; 3]) -> u64 {
    let middle = (a + b + c) / 3.0;
    let cell = ((middle + Vec3::ONE) * (CELLS / 2.0)).to_array().map(|x| x.clamp(0.0, CELLS - 1.0) as u64);
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

/// The numbers of a mesh's triangles, in their order in the world. `points` are its positions there.
pub(super) fn order(mesh: &Mesh, points: &[Vec3]) -> Vec<u32> {
    let corners = |k: u32| mesh.triangles[k as usize].map(|v| points[v as usize]);
    let corner_bits = |k: u32| corners(k).map(|p| p.to_array().map(f32::to_bits));
    let normal = |n: u32| mesh.normals.get(n as usize).map(|n| n.to_array().map(f64::to_bits));
    let normals = |k: u32| mesh.triangle_normals.get(k as usize).map(|t| t.map(normal));
    let mut placed: Vec<(u64, u32)> = (0..mesh.triangles.len() as u32).map(|k| (place(corners(k)), k)).collect();
    placed.sort_unstable_by(|&(p, a), &(q, b)| {
        p.cmp(&q).then_with(|| corner_bits(a).cmp(&corner_bits(b))).then_with(|| normals(a).cmp(&normals(b)))
    });
    placed.into_iter().map(|(_, k)| k).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::DVec3;

    #[test]
    fn bits_are_spread() {
        for bits in [0, 1, 0b101, 0x1f_ffff, 0x12_3456] {
            let expected = (0..21).fold(0, |all, k| all | (bits >> k & 1) << (3 * k));
            assert_eq!(spread(bits), expected, "{bits:x}");
        }
    }

    #[test]
    fn the_order_is_that_of_places_whatever_the_order_in_the_file() {
        let points: Vec<Vec3> =
            (0..300).map(|i| Vec3::new(i as f32 * 0.37, i as f32 * 0.73, i as f32 * 0.11)).collect();
        let points: Vec<Vec3> = points.into_iter().map(|p| p.fract() * 2.0 - 1.0).collect();
        let mut triangles: Vec<[u32; 3]> = (0..100).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        // The same twice, and once with its corners turned.
        triangles.extend([[0, 1, 2], [1, 2, 0]]);
        let positions = points.iter().map(|p| p.as_dvec3()).collect::<Vec<DVec3>>();
        let mut mesh = Mesh { positions, triangles, ..Mesh::default() };
        let sorted = |mesh: &Mesh| -> Vec<[u32; 3]> {
            order(mesh, &points).into_iter().map(|k| mesh.triangles[k as usize]).collect()
        };
        let before = sorted(&mesh);
        assert!(
            before
                .windows(2)
                .all(|w| place(w[0].map(|v| points[v as usize])) <= place(w[1].map(|v| points[v as usize])))
        );
        mesh.triangles.reverse();
        mesh.triangles.rotate_left(17);
        assert_eq!(sorted(&mesh), before);
        assert_eq!(before.len(), mesh.triangles.len());
    }

    #[test]
    fn equal_corners_are_told_apart_by_their_normals() {
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut mesh = Mesh {
            positions: points.map(|p| p.as_dvec3()).to_vec(),
            triangles: vec![[0, 1, 2]; 2],
            normals: vec![DVec3::X, DVec3::Z],
            triangle_normals: vec![[0; 3], [1; 3]],
        };
        let first = |mesh: &Mesh| mesh.triangle_normals[order(mesh, &points)[0] as usize];
        assert_eq!(first(&mesh), [1; 3]);
        mesh.triangle_normals.swap(0, 1);
        assert_eq!(first(&mesh), [1; 3]);
    }
}
