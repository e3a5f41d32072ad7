//! What textbooks do, in f32, to show where it fails.

pub type Point = [f32; 3];

pub fn sub(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}
pub fn dot(a: Point, b: Point) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
pub fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
pub fn along(origin: Point, direction: Point, t: f32) -> Point {
    std::array::from_fn(|k| origin[k] + direction[k] * t)
}
pub fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    a.map(|c| c / length)
}

/// Distance and barycentric coordinates of a hit past `t_min` (Moeller and Trumbore 1997).
pub fn moeller_trumbore(
    [a, b, c]: &[Point; 3],
    origin: Point,
    direction: Point,
    t_min: f32,
) -> Option<(f32, f32, f32)> {
    let (e1, e2) = (sub(*b, *a), sub(*c, *a));
    let p = cross(direction, e2);
    let det = dot(e1, p);
    if det == 0.0 {
        return None;
    }
    let inverse = 1.0 / det;
    let s = sub(origin, *a);
    let u = dot(s, p) * inverse;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = cross(s, e1);
    let v = dot(direction, q) * inverse;
    let t = dot(e2, q) * inverse;
    (v >= 0.0 && u + v <= 1.0 && t > t_min).then_some((t, u, v))
}

/// The nearest such hit among triangles: its number and distance.
pub fn nearest(soup: &[[Point; 3]], origin: Point, direction: Point, t_min: f32) -> Option<(usize, f32)> {
    let hits = soup.iter().enumerate().filter_map(|(i, t)| Some((i, moeller_trumbore(t, origin, direction, t_min)?.0)));
    hits.min_by(|a, b| a.1.total_cmp(&b.1))
}
