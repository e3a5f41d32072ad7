//! From rows to curves: per scene and label, per number of samples, the median over seeds and the band about it.

use super::Row;

/// What is drawn upwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Relative mean squared error.
    #[default]
    RelMse,
    /// The same without the worst 0.1 % of pixels.
    RelMseTrimmed,
    /// Mean squared error.
    Mse,
    /// Mean FLIP.
    Flip,
}

impl Metric {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::RelMse, Self::RelMseTrimmed, Self::Mse, Self::Flip];

    /// Its name on an axis.
    pub fn name(self) -> &'static str {
        match self {
            Self::RelMse => "relMSE",
            Self::RelMseTrimmed => "relMSE without the worst 0.1 %",
            Self::Mse => "MSE",
            Self::Flip => "FLIP",
        }
    }
    /// Its value of a row, where there is one.
    pub fn of(self, row: &Row) -> Option<f64> {
        match self {
            Self::RelMse => Some(row.relmse),
            Self::RelMseTrimmed => row.relmse_trimmed,
            Self::Mse => row.mse,
            Self::Flip => row.flip,
        }
    }
    /// Whether it falls as one over the number of independent samples.
    pub fn is_squared(self) -> bool {
        self != Self::Flip
    }
}

/// A median and the 10 % and 90 % quantiles about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// 10 % are below.
    pub low: f64,
    /// Half are below.
    pub median: f64,
    /// 90 % are below.
    pub high: f64,
}

impl Band {
    /// The band of some values, none of which is NaN; `None` of no value.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |share| quantile(&sorted, share);
        Some(Self { low: at(0.1)?, median: at(0.5)?, high: at(0.9)? })
    }
}

/// Quantile of sorted values, interpolated between neighbours (Hyndman and Fan 1996, definition 7).
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * sorted.len().checked_sub(1)? as f64;
    let below = *sorted.get(place as usize)?;
    let above = sorted.get(place as usize + 1).copied().unwrap_or(below);
    // Equal neighbours give their very value, whatever the rounding.
    Some(if above == below { below } else { below + (above - below) * place.fract() })
}

/// Renders of one scene by one label with one number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Samples per pixel.
    pub spp: u64,
    /// How many renders it stands for.
    pub renders: usize,
    /// Seconds of a render.
    pub seconds: Band,
    /// Its error.
    pub error: Band,
}

/// A line of the chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What it is called.
    pub label: String,
    /// In the order of samples, no two with the same number.
    pub points: Vec<Point>,
}

/// All lines of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCurves {
    /// Name of the scene.
    pub scene: String,
    /// Those labels that have rows of this scene, in the order in which labels appear in the whole table.
    pub curves: Vec<Curve>,
}

impl SceneCurves {
    /// The curve of a label.
    pub fn curve(&self, label: &str) -> Option<&Curve> {
        self.curves.iter().find(|curve| curve.label == label)
    }
}

/// Labels of rows, in the order in which they appear.
pub fn labels(rows: &[Row]) -> Vec<String> {
    distinct(rows.iter().map(|row| &row.label))
}

/// The curves of rows: scenes and labels in the order in which they appear. Rows without the metric are left out.
pub fn curves(rows: &[Row], metric: Metric) -> Vec<SceneCurves> {
    let labels = labels(rows);
    let scene_curves = |scene: String| {
        let curve = |label: &String| {
            let of_curve = |row: &&Row| row.scene == scene && row.label == *label;
            let rows: Vec<&Row> = rows.iter().filter(of_curve).collect();
            let curve = Curve { label: label.clone(), points: points(&rows, metric) };
            (!curve.points.is_empty()).then_some(curve)
        };
        SceneCurves { curves: labels.iter().filter_map(curve).collect(), scene }
    };
    distinct(rows.iter().map(|row| &row.scene)).into_iter().map(scene_curves).collect()
}

fn points(rows: &[&Row], metric: Metric) -> Vec<Point> {
    let mut budgets: Vec<u64> = rows.iter().map(|row| row.spp).collect();
    budgets.sort_unstable();
    budgets.dedup();
    let point = |spp: u64| {
        let with = rows.iter().filter(|row| row.spp == spp);
        let (seconds, errors): (Vec<f64>, Vec<f64>) =
            with.filter_map(|row| Some((row.seconds, metric.of(row)?))).unzip();
        Some(Point { spp, renders: errors.len(), seconds: Band::of(&seconds)?, error: Band::of(&errors)? })
    };
    budgets.into_iter().filter_map(point).collect()
}

fn distinct<'a>(names: impl Iterator<Item = &'a String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for name in names {
        if !found.contains(name) {
            found.push(name.clone());
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: &str, label: &str, spp: u64, seconds: f64, relmse: f64) -> Row {
        let (scene, label) = (scene.to_owned(), label.to_owned());
        Row { scene, label, spp, seed: None, seconds, relmse, relmse_trimmed: None, mse: None, flip: None }
    }

    #[test]
    fn bands_are_interpolated_quantiles() {
        assert_eq!(Band::of(&[]), None);
        assert_eq!(Band::of(&[0.1]), Some(Band { low: 0.1, median: 0.1, high: 0.1 }));
        // Eleven values: the quantiles are values themselves.
        let eleven: Vec<f64> = (0..11).rev().map(f64::from).collect();
        assert_eq!(Band::of(&eleven), Some(Band { low: 1.0, median: 5.0, high: 9.0 }));
        let band = Band::of(&[1.0, 2.0]).unwrap();
        assert!((band.low - 1.1).abs() < 1e-15 && (band.high - 1.9).abs() < 1e-15, "{band:?}");
        assert_eq!(band.median, 1.5);
        assert_eq!(Band::of(&[-2.0, 4.0, -1.0]).unwrap().median, -1.0);
    }

    #[test]
    fn rows_become_curves_in_the_order_of_the_table() {
        let rows = [
            row("b", "y", 4, 4.0, 0.25),
            row("b", "x", 1, 1.0, 1.0),
            row("b", "y", 1, 1.0, 3.0),
            row("b", "y", 1, 2.0, 1.0),
            row("a", "x", 2, 1.0, 1.0),
        ];
        let found = curves(&rows, Metric::RelMse);
        let shape: Vec<_> = found.iter().flat_map(|s| s.curves.iter().map(|c| (&*s.scene, &*c.label))).collect();
        assert_eq!(shape, [("b", "y"), ("b", "x"), ("a", "x")]);
        let y = found[0].curve("y").unwrap();
        assert_eq!(y.points.iter().map(|p| (p.spp, p.renders)).collect::<Vec<_>>(), [(1, 2), (4, 1)]);
        assert_eq!((y.points[0].seconds.median, y.points[0].error.median), (1.5, 2.0));
        assert_eq!(labels(&rows), ["y", "x"]);
        assert_eq!(found[1].curve("y"), None);
    }

    #[test]
    fn what_was_not_measured_has_no_curve() {
        let mut rows = vec![row("a", "x", 1, 1.0, 1.0), row("a", "y", 1, 1.0, 1.0)];
        rows[1].flip = Some(0.5);
        let found = curves(&rows, Metric::Flip);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].curves.iter().map(|c| &*c.label).collect::<Vec<_>>(), ["y"]);
        assert!(curves(&[], Metric::RelMse).is_empty());
    }
}
