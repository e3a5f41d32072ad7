//! The table of a scene: where each curve ends, and what that costs.

use super::Row;
use super::curve::{Band, Metric, Point, SceneCurves, curves};
use super::figures::{Figures, Reach, figures};
use super::number::{count, figure};
use super::svg::escape;

/// The table of a scene as HTML; nothing where it has no row.
pub fn html(scene: &str, rows: &[Row]) -> String {
    let own: Vec<Row> = rows.iter().filter(|row| row.scene == scene).cloned().collect();
    let (raw, trimmed) = (curves(&own, Metric::RelMse), curves(&own, Metric::RelMseTrimmed));
    let Some(raw) = raw.first() else { return String::new() };
    let lines: String = figures(raw).iter().map(|line| html_line(line, last(trimmed.first(), &line.label))).collect();
    format!(
        r#"<h3>At the largest budget</h3><div class="scroll"><table><thead><tr><th scope="col">series</th><th scope="col">samples<br>per pixel</th><th scope="col">seconds</th><th scope="col">relMSE</th><th scope="col">without the<br>worst 0.1 %</th><th scope="col">time to the error<br>of the best other</th><th scope="col">efficiency</th></tr></thead><tbody>{lines}</tbody></table></div><p class="quiet">Medians, and in grey what the middle 80 % of the renders lie between. Efficiency is relMSE times seconds of the first series over that of this one: 2 is twice as good. The best other series is the one with the smallest relMSE in this table, but for the series itself; times in brackets go on from the last point as 1 / time.</p>"#
    )
}

/// The last point of a label's curve.
fn last<'a>(scene: Option<&'a SceneCurves>, label: &str) -> Option<&'a Point> {
    scene?.curve(label)?.points.last()
}

fn html_line(line: &Figures, trimmed: Option<&Point>) -> String {
    // A trimmed figure of another budget is none of this line.
    let trimmed = trimmed.filter(|point| point.spp == line.last.spp).map(|point| cell(&point.error));
    let cells = [
        count(line.last.spp),
        cell(&line.last.seconds),
        cell(&line.last.error),
        trimmed.unwrap_or_else(|| "–".to_owned()),
        reach(line.reach),
        line.efficiency.map_or_else(|| "–".to_owned(), figure),
    ];
    let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
    format!(r#"<tr><td>{}</td>{cells}</tr>"#, escape(&line.label))
}

fn cell(band: &Band) -> String {
    let [low, median, high] = [band.low, band.median, band.high].map(figure);
    if low == high { median } else { format!("{median}<span>{low} to {high}</span>") }
}

/// When the error is reached, in words.
pub fn reach(reach: Reach) -> String {
    match reach {
        Reach::After(seconds) => format!("{} s", figure(seconds)),
        Reach::Within(seconds) => format!("under {} s", figure(seconds)),
        Reach::Beyond(seconds) => format!("({} s)", figure(seconds)),
        Reach::Nothing => "–".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_hold_medians_and_bands() {
        let row = |label: &str, seconds: f64, relmse: f64, trimmed: Option<f64>| Row {
            scene: "a".to_owned(),
            label: label.to_owned(),
            spp: 1024,
            seed: None,
            seconds,
            relmse,
            relmse_trimmed: trimmed,
            mse: None,
            flip: None,
        };
        let rows = [row("<x>", 1.0, 0.02, Some(0.01)), row("<x>", 3.0, 0.02, Some(0.01)), row("y", 1.0, 0.01, None)];
        let html = html("a", &rows);
        for part in [
            "<td>&lt;x&gt;</td><td>1,024</td><td>2.00<span>1.20 to 2.80</span></td><td>0.0200</td><td>0.0100</td>",
            "<td>(4.00 s)</td><td>1.00</td>",
            "<td>y</td><td>1,024</td><td>1.00</td><td>0.0100</td><td>–</td><td>under 1.00 s</td><td>4.00</td>",
        ] {
            assert!(html.contains(part), "{part} in {html}");
        }
        assert_eq!(super::html("b", &rows), "");
    }
}
