//! What a chart comes to in numbers: the error at the end of each curve, and what it costs.

use super::curve::{Curve, Point, SceneCurves};

/// Where a curve ends, and how it compares.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// Which curve.
    pub label: String,
    /// Its renders with the most samples.
    pub last: Point,
    /// Error times seconds of the first curve over that of this one, both at their ends: 2 means that the first needs
    /// twice the time to the same error, if both fall as one over time. `None` where an error is not positive.
    pub efficiency: Option<f64>,
    /// The smallest error at which another curve ends; `None` where there is no other.
    pub target: Option<f64>,
    /// When this curve is there.
    pub reach: Reach,
}

/// When a curve comes down to an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// Seconds, interpolated between measured points in logarithms.
    After(f64),
    /// At its first point already, which took so many seconds.
    Within(f64),
    /// Not as far as it was measured; so many seconds if it goes on falling as one over time.
    Beyond(f64),
    /// There is nothing to reach.
    Nothing,
}

/// The figures of each curve of a scene, in their order.
pub fn figures(scene: &SceneCurves) -> Vec<Figures> {
    let ends: Vec<(&Curve, &Point)> = scene.curves.iter().filter_map(|c| Some((c, c.points.last()?))).collect();
    let cost = |point: &Point| Some(point.error.median * point.seconds.median).filter(|&cost| cost > 0.0);
    let first = ends.first().and_then(|(_, end)| cost(end));
    let of = |(i, &(curve, last)): (usize, &(&Curve, &Point))| {
        let others = ends.iter().enumerate().filter(|&(k, _)| k != i).map(|(_, (_, end))| end.error.median);
        let target = others.reduce(f64::min);
        Figures {
            label: curve.label.clone(),
            last: last.clone(),
            efficiency: first.zip(cost(last)).map(|(first, own)| first / own),
            target,
            reach: target.map_or(Reach::Nothing, |target| reach(&curve.points, target)),
        }
    };
    ends.iter().enumerate().map(of).collect()
}

/// When a curve comes down to `target`, which is nothing to reach unless it is positive.
pub fn reach(points: &[Point], target: f64) -> Reach {
    let (Some(last), true) = (points.last(), target > 0.0) else { return Reach::Nothing };
    let there = points.iter().position(|point| point.error.median <= target);
    match there {
        None => Reach::Beyond(last.seconds.median * last.error.median / target),
        Some(0) => Reach::Within(points.first().map_or(0.0, |point| point.seconds.median)),
        Some(i) => match points.get(i - 1).zip(points.get(i)) {
            Some((before, after)) => Reach::After(interpolated(before, after, target)),
            None => Reach::Nothing,
        },
    }
}

/// Seconds at which the straight line in logarithms between two points meets `target`.
fn interpolated(before: &Point, after: &Point, target: f64) -> f64 {
    let (e0, e1) = (before.error.median, after.error.median);
    let (t0, t1) = (before.seconds.median, after.seconds.median);
    // An error that is not positive has no logarithm: the point where it was measured is all that is known.
    if e1 <= 0.0 || e0 <= e1 || t0 <= 0.0 || t1 <= 0.0 {
        return t1;
    }
    let share = (e0 / target).ln() / (e0 / e1).ln();
    t0 * (t1 / t0).powf(share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::curve::Band;

    fn point(spp: u64, seconds: f64, error: f64) -> Point {
        let band = |median| Band { low: median, median, high: median };
        Point { spp, renders: 1, seconds: band(seconds), error: band(error) }
    }

    fn curve(label: &str, points: &[(f64, f64)]) -> Curve {
        let points = points.iter().enumerate().map(|(i, &(t, e))| point(1 << i, t, e)).collect();
        Curve { label: label.to_owned(), points }
    }

    #[test]
    fn a_curve_that_falls_as_one_over_time_is_met_exactly() {
        let c = curve("a", &[(1.0, 1.0), (4.0, 0.25), (16.0, 0.0625)]);
        let Reach::After(t) = reach(&c.points, 0.125) else { panic!("not reached") };
        assert!((t - 8.0).abs() < 1e-12, "{t}");
        assert_eq!(reach(&c.points, 2.0), Reach::Within(1.0));
        assert_eq!(reach(&c.points, 0.03125), Reach::Beyond(32.0));
        assert_eq!(reach(&c.points, 0.0), Reach::Nothing);
        assert_eq!(reach(&[], 1.0), Reach::Nothing);
        // Between errors of which one has no logarithm, and on a curve that rises.
        assert_eq!(reach(&curve("b", &[(1.0, 1.0), (2.0, -0.1)]).points, 0.5), Reach::After(2.0));
        assert_eq!(
            reach(&curve("c", &[(1.0, 0.5), (2.0, 0.7), (3.0, 0.4)]).points, 0.45),
            Reach::After(2.0 * 1.5f64.powf((0.7f64 / 0.45).ln() / (0.7f64 / 0.4).ln()))
        );
    }

    #[test]
    fn curves_are_compared_with_the_first_and_the_best() {
        let curves = vec![
            curve("a", &[(1.0, 1.0), (2.0, 0.5)]),
            curve("b", &[(1.0, 0.5), (2.0, 0.25)]),
            curve("c", &[(2.0, 0.4), (4.0, 0.5)]),
        ];
        let found = figures(&SceneCurves { scene: "s".into(), curves });
        assert_eq!(found.iter().map(|f| f.efficiency.unwrap()).collect::<Vec<_>>(), [1.0, 2.0, 0.5]);
        assert_eq!(found.iter().map(|f| f.target.unwrap()).collect::<Vec<_>>(), [0.25, 0.5, 0.25]);
        assert_eq!(found[0].reach, Reach::Beyond(4.0));
        assert_eq!(found[1].reach, Reach::Within(1.0));
        let alone = figures(&SceneCurves { scene: "s".into(), curves: vec![curve("a", &[(1.0, -1.0)])] });
        assert_eq!((alone[0].efficiency, alone[0].target, alone[0].reach), (None, None, Reach::Nothing));
    }
}
