//! The oracle: every triangle, one after another.

use super::ray::Prepared;
use super::triangle::closest_of_one;
use super::{Hit, Ray};

/// The nearest hit among all triangles.
pub fn brute_force(corners: &[[[f32; 3]; 3]], ray: &Ray) -> Hit {
    let prepared = Prepared::new(ray);
    let mut hit = Hit::miss(ray.t_max);
    for (id, triangle) in corners.iter().enumerate() {
        closest_of_one(triangle, id as u32, &prepared, &mut hit);
    }
    hit
}

#[cfg(test)]
mod tests {
    use super::super::{BatchTracer, Bvh, Many, Scalar, Single, Streams, Tiles};
    use super::*;
    use crate::sampling::{Decision, Sampler, Xoshiro};

    /// Numbers in [-1, 1).
    fn numbers(i: u32) -> [f32; 6] {
        let mut s = Xoshiro::start::<f32>(5, i, 1);
        Xoshiro::draw::<f32, 6>(&mut s, Decision::Scatter, 0).map(|u| 2.0 * u - 1.0)
    }

    /// Small triangles and some large ones, two of each.
    fn cloud(count: u32) -> Vec<[[f32; 3]; 3]> {
        let of = |i: u32| {
            let [x, y, z, a, b, c] = numbers(i / 2);
            let size = if i % 16 < 2 { 0.9 } else { 0.1 };
            [[x, y, z], [x + size * a, y + size * b, z - size], [x - size * c, y + size, z + size * a]]
        };
        (0..count).map(of).collect()
    }

    /// Rays from around into the cloud, along axes too, half of them bundles of neighbours, some of them short.
    fn rays(count: u32) -> Vec<Ray> {
        let of = |i: u32| {
            let bundled = (i / 64).is_multiple_of(2);
            let [x, y, z, a, b, c] = numbers(1_000_000 + if bundled { i / 64 * 64 } else { i });
            let jitter = if bundled { numbers(2_000_000 + i).map(|u| 0.05 * u) } else { [0.0; 6] };
            let mut direction = [a - x + jitter[0], b - y + jitter[1], c - z + jitter[2]];
            if i % 1024 >= 960 {
                direction = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]][i as usize % 3];
            }
            let t_max = if i.is_multiple_of(5) { 0.3 } else { f32::INFINITY };
            Ray { origin: [1.5 * x, 1.5 * y, 1.5 * z], direction, t_max }
        };
        (0..count).map(of).collect()
    }

    fn batch<T: BatchTracer + Default>(bvh: &Bvh, rays: &[Ray]) -> Vec<(Hit, bool)> {
        let mut found = vec![(Hit::miss(0.0), false); rays.len()];
        let mut seen = vec![0; rays.len()];
        T::default().closest(bvh, rays.len(), rays, |i, hit| (found[i].0, seen[i]) = (hit, seen[i] + 1));
        T::default().any(bvh, rays.len(), rays, |i, any| (found[i].1, seen[i]) = (any, seen[i] + 1));
        assert!(seen.iter().all(|&times| times == 2), "each ray is answered once");
        found
    }

    /// All kernels, on trees of all sizes and in all qualities: the same hits to the bit.
    #[test]
    fn every_kernel_finds_what_trying_all_finds() {
        use super::super::{BuildOptions, Quality};
        let rays = rays(6000);
        for (count, quality) in
            [(1, Quality::Best), (40, Quality::Balanced), (300, Quality::Fast), (800, Quality::Best)]
        {
            let corners = cloud(count);
            let bvh = Bvh::build_with(&corners, &BuildOptions { quality, ..BuildOptions::default() }).unwrap();
            let (nodes, leaves) = bvh.counts();
            assert!(nodes >= 1 && leaves >= count as usize / 8 && leaves <= 2 * count as usize, "{nodes}, {leaves}");
            let (mut single, mut scalar) = (Single::new(&bvh), Scalar::new(&bvh));
            let batches = [batch::<Many>(&bvh, &rays), batch::<Streams>(&bvh, &rays), batch::<Tiles>(&bvh, &rays)];
            let mut hits = 0;
            for (i, ray) in rays.iter().enumerate() {
                let expected = brute_force(&corners, ray);
                let blocked = expected.is_some() && expected.t < ray.t_max;
                hits += usize::from(blocked);
                let one = [
                    (single.closest(&bvh, ray), single.any(&bvh, ray)),
                    (scalar.closest(&bvh, ray), scalar.any(&bvh, ray)),
                ];
                for (kernel, found) in one.iter().chain(batches.iter().map(|b| &b[i])).enumerate() {
                    assert_eq!(*found, (expected, blocked), "kernel {kernel}, {count} triangles, {ray:?}");
                }
            }
            assert!(count < 300 || (500..5500).contains(&hits), "{hits} hits");
        }
    }
}
