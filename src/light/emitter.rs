//! Emitters: luminous triangles, two of them as one where they make up a parallelogram.

use super::luminance;

/// A luminous triangle in world coordinates.
#[derive(Clone, Copy, Debug)]
pub struct LightTriangle {
    /// Its corners.
    pub corners: [[f32; 3]; 3],
    /// Unit normal of the front side.
    pub normal: [f32; 3],
    /// Emitted radiance per channel, >= 0.
    pub radiance: [f32; 3],
}

/// Outline of an emitter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Half of the parallelogram of its edges.
    Triangle,
    /// The whole of it.
    Parallelogram,
}

/// A flat two-sided emitter.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// One corner.
    pub corner: [f32; 3],
    /// The two edges from there.
    pub edges: [[f32; 3]; 2],
    /// Unit normal of the front side.
    pub normal: [f32; 3],
    /// Emitted radiance per channel, some of it > 0.
    pub radiance: [f32; 3],
    /// Which part of the parallelogram of the edges it is.
    pub shape: Shape,
}

fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

impl Emitter {
    fn of(t: &LightTriangle) -> Self {
        let [a, b, c] = t.corners;
        let edges = [sub(b, a), sub(c, a)];
        Self { corner: a, edges, normal: t.normal, radiance: t.radiance, shape: Shape::Triangle }
    }
    /// Both triangles as one emitter, where they are the halves of a parallelogram to rounding.
    fn of_two(t: &LightTriangle, u: &LightTriangle) -> Option<Self> {
        let cos: f32 = t.normal.iter().zip(&u.normal).map(|(a, b)| a * b).sum();
        if t.radiance != u.radiance || cos < 0.999_999 {
            return None;
        }
        let largest = t.corners.iter().chain(&u.corners).flatten().fold(0.0f32, |m, c| m.max(c.abs()));
        // The corner `a` lies across the edge that both triangles share; so does the fourth corner, on the other side.
        (0..3).find_map(|turn| {
            let [a, b, c] = [0, 1, 2].map(|k| t.corners[(k + turn) % 3]);
            let fourth: [f32; 3] = std::array::from_fn(|k| b[k] + c[k] - a[k]);
            let others = [0, 1, 2].map(|k| u.corners[k]);
            let shared = others.contains(&b) && others.contains(&c);
            let d = others.into_iter().find(|&d| d != b && d != c)?;
            let off = sub(d, fourth).into_iter().fold(0.0f32, |m, c| m.max(c.abs()));
            (shared && off <= 4.0 * f32::EPSILON * largest).then(|| Self {
                corner: a,
                edges: [sub(b, a), sub(c, a)],
                normal: t.normal,
                radiance: t.radiance,
                shape: Shape::Parallelogram,
            })
        })
    }
    /// Area in world units.
    pub fn area(&self) -> f64 {
        let [[ax, ay, az], [bx, by, bz]] = self.edges.map(|e| e.map(f64::from));
        let cross = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
        let whole = cross.iter().map(|c| c * c).sum::<f64>().sqrt();
        if self.shape == Shape::Triangle { 0.5 * whole } else { whole }
    }
    /// Power that it sends out, up to a factor that all share: area times Rec. 709 luminance.
    pub fn power(&self) -> f64 {
        self.area() * luminance(self.radiance)
    }
    /// Corners: three, or four.
    pub fn corners(&self) -> impl Iterator<Item = [f32; 3]> + use<> {
        let ([e, f], a) = (self.edges, self.corner);
        let at = move |u: f32, v: f32| std::array::from_fn(|k| a[k] + u * e[k] + v * f[k]);
        let fourth = (self.shape == Shape::Parallelogram).then(|| at(1.0, 1.0));
        [a, at(1.0, 0.0), at(0.0, 1.0)].into_iter().chain(fourth)
    }
}

/// Emitters of triangles, and for each triangle the number of its emitter. Triangles that follow each other become one
/// where they can: a point on a parallelogram takes two numbers that stay well spread, and no choice between halves.
pub fn merge(triangles: &[LightTriangle]) -> (Vec<Emitter>, Vec<u32>) {
    let (mut emitters, mut of) = (Vec::new(), Vec::with_capacity(triangles.len()));
    let mut rest = triangles;
    while let [first, tail @ ..] = rest {
        let two = tail.first().and_then(|second| Emitter::of_two(first, second));
        let count = 1 + usize::from(two.is_some());
        of.resize(of.len() + count, emitters.len() as u32);
        emitters.push(two.unwrap_or_else(|| Emitter::of(first)));
        rest = &rest[count..];
    }
    (emitters, of)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub fn triangle(corners: [[f32; 3]; 3], radiance: f32) -> LightTriangle {
        let ([a, b, c], f) = (corners, |x: [f32; 3]| x.map(f64::from));
        let (e, g) = (f(sub(b, a)), f(sub(c, a)));
        let n = [e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0]];
        let length = n.iter().map(|c| c * c).sum::<f64>().sqrt();
        LightTriangle { corners, normal: n.map(|c| (c / length) as f32), radiance: [radiance; 3] }
    }

    const SQUARE: [[f32; 3]; 4] = [[0.1, 0.2, 1.0], [0.7, 0.2, 1.0], [0.7, 0.9, 1.0], [0.1, 0.9, 1.0]];

    fn of(indices: [usize; 3], radiance: f32) -> LightTriangle {
        triangle(indices.map(|i| SQUARE[i]), radiance)
    }

    #[test]
    fn halves_of_a_parallelogram_become_one_whichever_way_they_are_numbered() {
        for first in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
            for second in [[0, 2, 3], [2, 3, 0], [3, 0, 2]] {
                let (emitters, numbers) = merge(&[of(first, 2.0), of(second, 2.0), of([0, 1, 2], 2.0)]);
                assert_eq!(numbers, [0, 0, 1]);
                assert_eq!(
                    emitters.iter().map(|e| e.shape).collect::<Vec<_>>(),
                    [Shape::Parallelogram, Shape::Triangle]
                );
                assert!((emitters[0].area() - 0.42).abs() < 1e-7 && (emitters[1].area() - 0.21).abs() < 1e-7);
                let mut corners: Vec<_> = emitters[0].corners().map(|c| c.map(|v| (v * 1e5).round())).collect();
                corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
                let mut expected = SQUARE.map(|c| c.map(|v| (v * 1e5).round()));
                expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
                assert_eq!(corners, expected);
            }
        }
    }

    #[test]
    fn others_stay_apart() {
        let kite = triangle([SQUARE[0], SQUARE[2], [0.2, 0.95, 1.0]], 2.0);
        let folded = triangle([SQUARE[0], SQUARE[2], [0.1, 0.9, 1.01]], 2.0);
        // One corner in common, and the corner of the parallelogram that is left.
        let past = std::array::from_fn(|k| 1.5 * SQUARE[0][k] - 0.5 * SQUARE[1][k]);
        for (what, other) in [
            ("longer", triangle([SQUARE[3], past, SQUARE[2]], 2.0)),
            ("brighter", of([0, 2, 3], 2.1)),
            ("facing away", of([0, 3, 2], 2.0)),
            ("the same triangle", of([0, 1, 2], 2.0)),
            ("a kite's half", kite),
            ("folded", folded),
        ] {
            assert_eq!(merge(&[of([0, 1, 2], 2.0), other]).0.len(), 2, "{what}");
        }
    }
}
