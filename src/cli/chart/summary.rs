//! The last lines of a sweep: where each series ends, and what that costs.

use wavetrace::chart::number::{count, figure};
use wavetrace::chart::{SceneCurves, figures};

/// A table of each scene in plain text, one line per series.
pub fn text(scenes: &[SceneCurves]) -> String {
    let longest = scenes.iter().flat_map(|scene| &scene.curves).map(|curve| curve.label.chars().count()).max();
    let wide = longest.unwrap_or(0).max(8);
    let mut lines = Vec::new();
    for scene in scenes {
        lines.push(scene.scene.clone());
        lines.push(format!(
            "  {:<wide$} {:>9} {:>9} {:>9} {:>10}",
            "series", "samples", "seconds", "relMSE", "efficiency"
        ));
        for line in figures(scene) {
            let efficiency = line.efficiency.map_or_else(|| "-".to_owned(), figure);
            let [seconds, error] = [line.last.seconds.median, line.last.error.median].map(figure);
            let samples = count(line.last.spp);
            lines.push(format!("  {:<wide$} {samples:>9} {seconds:>9} {error:>9} {efficiency:>10}", line.label));
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavetrace::chart::{Metric, Row, curves};

    #[test]
    fn each_series_has_a_line() {
        let row = |label: &str, seconds, relmse| Row {
            scene: "room".to_owned(),
            label: label.to_owned(),
            spp: 1024,
            seed: Some(1),
            seconds,
            relmse,
            relmse_trimmed: None,
            mse: None,
            flip: None,
        };
        let rows = [row("path xoshiro", 2.0, 0.5), row("mis sobol", 1.0, 0.0125), row("x", 1.0, -1e-6)];
        let expected = [
            "room",
            "  series         samples   seconds    relMSE efficiency",
            "  path xoshiro     1,024      2.00     0.500       1.00",
            "  mis sobol        1,024      1.00    0.0125       80.0",
            "  x                1,024      1.00  -1.00e-6          -",
        ];
        assert_eq!(text(&curves(&rows, Metric::RelMse)).lines().collect::<Vec<_>>(), expected);
    }
}
