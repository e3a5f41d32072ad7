//! Balls about a surface: one, or where that would be mostly empty, as about a pane or a rod, several about its parts.
//!
//! Light is sent at balls, and what misses the surface in them is lost. Seen from all sides a convex body covers a quarter of its
//! area on average (Cauchy 1841), a ball of radius r pi r^2: as long as a ball's surface covers little of it, it is cut in two
//! across its longest side.

use super::targets::Ball;

/// The share of a ball that its surface has to cover. A cube covers 0.64.
const ENOUGH: f64 = 0.6;

/// A part of a surface.
struct Part {
    /// Flat convex polygons.
    polygons: Vec<Vec<[f64; 3]>>,
    ball: Ball,
    /// By how much the ball is larger than what the surface covers of it; 0 where it covers enough.
    waste: f64,
}

impl Part {
    fn new(polygons: Vec<Vec<[f64; 3]>>) -> Option<Self> {
        let corners = polygons.iter().flatten().map(|p| p.map(|c| c as f32));
        let ball = Ball::about(corners)?;
        let whole = std::f64::consts::PI * f64::from(ball.radius).powi(2);
        let covered = polygons.iter().map(|p| area(p)).sum::<f64>() / 4.0;
        let waste = if covered < ENOUGH * whole { whole - covered } else { 0.0 };
        Some(Self { polygons, ball, waste })
    }
    /// Both halves.
    fn cut(&self) -> [Vec<Vec<[f64; 3]>>; 2] {
        let bounds = |axis: usize| {
            let ends = self.polygons.iter().flatten().map(|p| p[axis]);
            ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], c| [lo.min(c), hi.max(c)])
        };
        let sides = [0, 1, 2].map(bounds);
        let length = |axis: usize| sides[axis][1] - sides[axis][0];
        let axis = (1..3).fold(0, |longest, axis| if length(axis) > length(longest) { axis } else { longest });
        let middle = (sides[axis][0] + sides[axis][1]) / 2.0;
        [-1.0, 1.0].map(|side| {
            let halves = self.polygons.iter().map(|polygon| clip(polygon, |p| side * (p[axis] - middle)));
            halves.filter(|polygon| polygon.len() > 2).collect()
        })
    }
}

/// Balls that together hold all triangles, `most` at most.
pub fn cover(triangles: &[[[f32; 3]; 3]], most: usize) -> Vec<Ball> {
    let polygons = triangles.iter().map(|t| t.map(|p| p.map(f64::from)).to_vec()).collect();
    let mut parts: Vec<Part> = Part::new(polygons).into_iter().collect();
    while parts.len() < most {
        let worst = (0..parts.len()).max_by(|&a, &b| parts[a].waste.total_cmp(&parts[b].waste));
        let Some(worst) = worst.filter(|&worst| parts[worst].waste > 0.0) else { break };
        let halves = parts[worst].cut().map(Part::new);
        parts.swap_remove(worst);
        parts.extend(halves.into_iter().flatten());
    }
    parts.into_iter().map(|part| part.ball).collect()
}

/// The part of a convex polygon where `height` is not negative (Sutherland and Hodgman 1974).
fn clip(polygon: &[[f64; 3]], height: impl Fn(&[f64; 3]) -> f64) -> Vec<[f64; 3]> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let (ha, hb) = (height(a), height(b));
        if ha >= 0.0 {
            kept.push(*a);
        }
        if ha * hb < 0.0 {
            let t = ha / (ha - hb);
            kept.push(std::array::from_fn(|k| a[k] + t * (b[k] - a[k])));
        }
    }
    kept
}

/// Area of a flat convex polygon.
fn area(polygon: &[[f64; 3]]) -> f64 {
    let from = |p: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| p[k] - polygon[0][k]) };
    let corners = polygon.iter().skip(1).zip(polygon.iter().skip(2));
    let twice = corners.fold([0.0; 3], |sum: [f64; 3], (p, q)| {
        let (a, b) = (from(p), from(q));
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        std::array::from_fn(|k| sum[k] + cross[k])
    });
    twice.iter().map(|c| c * c).sum::<f64>().sqrt() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clipped_polygon_has_each_corner_once() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        // Along an edge, across, corner to corner, and beside it.
        assert_eq!(clip(&square, |p| p[0]), square);
        assert_eq!(clip(&square, |p| p[0] - 0.5), [[0.5, 0.0, 0.0], square[1], square[2], [0.5, 1.0, 0.0]]);
        assert_eq!(clip(&square, |p| p[0] - p[1]), square[..3]);
        assert_eq!(clip(&square, |p| p[0] - 1.0), square[1..3]);
        assert!(clip(&square, |p| p[0] - 2.0).is_empty());
    }

    /// Two faces of a box and its sides, `x` by `y` by `z`.
    fn cuboid(size: [f32; 3]) -> Vec<[[f32; 3]; 3]> {
        let corner = |i: usize| -> [f32; 3] { std::array::from_fn(|k| if i >> k & 1 == 1 { size[k] } else { 0.0 }) };
        let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]].map(|t| t.map(corner))).collect()
    }

    fn holds(balls: &[Ball], p: [f32; 3]) -> bool {
        let inside = |b: &Ball| (0..3).map(|k| (p[k] - b.centre[k]).powi(2)).sum::<f32>().sqrt() <= b.radius;
        balls.iter().any(inside)
    }

    #[test]
    fn a_cube_has_one_ball_and_a_pane_or_a_rod_several_that_hold_all_of_it() {
        assert_eq!(cover(&cuboid([1.0, 1.0, 1.0]), 16).len(), 1);
        assert!(cover(&[], 16).is_empty());
        for size in [[2.0, 0.05, 1.5], [0.1, 0.1, 3.0]] {
            let triangles = cuboid(size);
            let balls = cover(&triangles, 16);
            assert!((8..=16).contains(&balls.len()), "{size:?}: {}", balls.len());
            let whole = cover(&triangles, 1)[0].radius;
            assert!(balls.iter().all(|b| b.radius < 0.5 * whole), "{size:?}");
            for [a, b, c] in &triangles {
                for (i, j) in (0..20).flat_map(|i| (0..20 - i).map(move |j| (i, j))) {
                    let (u, v) = (i as f32 / 20.0, j as f32 / 20.0);
                    let p = std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
                    assert!(holds(&balls, p), "{size:?}: {p:?}");
                }
            }
        }
    }
}
