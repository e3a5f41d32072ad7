//! Curves on logarithmic axes, as SVG.

use plotters::prelude::*;
use std::ops::Range;

/// One line of a chart, or its points alone.
pub struct Curve {
    pub label: String,
    pub points: Vec<(f64, f64)>,
    pub dots: bool,
}

/// The chart: its axes, in words and as ranges.
pub struct Axes {
    pub x: (&'static str, Range<f64>),
    pub y: (&'static str, Range<f64>),
    /// Where the names of the curves stand.
    pub legend: SeriesLabelPosition,
}

const COLOURS: [RGBColor; 6] = [
    RGBColor(220, 50, 32),
    RGBColor(0, 90, 181),
    RGBColor(230, 140, 0),
    RGBColor(0, 140, 70),
    RGBColor(120, 94, 240),
    RGBColor(80, 80, 80),
];

pub fn curve(label: impl Into<String>, points: Vec<(f64, f64)>) -> Curve {
    Curve { label: label.into(), points, dots: false }
}

pub fn dots(label: impl Into<String>, points: Vec<(f64, f64)>) -> Curve {
    Curve { dots: true, ..curve(label, points) }
}

/// Points beyond the range of y stand at its ends.
pub fn svg(axes: &Axes, curves: &[Curve]) -> Vec<u8> {
    let mut text = String::new();
    draw(&mut text, axes, curves).expect("a string takes any drawing");
    text.into_bytes()
}

fn draw(
    text: &mut String,
    Axes { x, y, legend }: &Axes,
    curves: &[Curve],
) -> Result<(), Box<dyn std::error::Error + 'static>> {
    let root = SVGBackend::with_string(text, (720, 420)).into_drawing_area();
    let fault = |e: &dyn std::fmt::Display| e.to_string();
    root.fill(&WHITE).map_err(|e| fault(&e))?;
    let mut chart = ChartBuilder::on(&root)
        .margin(14)
        .x_label_area_size(44)
        .y_label_area_size(70)
        .build_cartesian_2d(x.1.clone().log_scale(), y.1.clone().log_scale())
        .map_err(|e| fault(&e))?;
    chart
        .configure_mesh()
        .x_desc(x.0)
        .y_desc(y.0)
        .light_line_style(WHITE)
        .x_label_formatter(&|v| number(*v))
        .y_label_formatter(&|v| number(*v))
        .label_style(("sans-serif", 14))
        .draw()
        .map_err(|e| fault(&e))?;
    for (c, colour) in curves.iter().zip(COLOURS) {
        let points = c.points.iter().map(|&(a, b)| (a, b.clamp(y.1.start, y.1.end)));
        let line = colour.stroke_width(2);
        let series = if c.dots {
            chart.draw_series(points.map(|at| Circle::new(at, 4, line)))
        } else {
            chart.draw_series(LineSeries::new(points, line))
        };
        let dotted = c.dots;
        series.map_err(|e| fault(&e))?.label(&c.label).legend(move |(x, y)| {
            let ends = if dotted { [(x + 7, y), (x + 15, y)] } else { [(x, y), (x + 22, y)] };
            PathElement::new(ends, colour.stroke_width(if dotted { 8 } else { 2 }))
        });
    }
    chart
        .configure_series_labels()
        .position(legend.clone())
        .background_style(WHITE.mix(0.9))
        .border_style(BLACK.mix(0.3))
        .label_font(("sans-serif", 14))
        .draw()
        .map_err(|e| fault(&e))?;
    root.present().map_err(|e| fault(&e))?;
    Ok(())
}

/// Powers of ten as such where they are long.
fn number(v: f64) -> String {
    if (0.001..=10_000.0).contains(&v) { format!("{}", (v * 1e6).round() / 1e6) } else { format!("{v:.0e}") }
}
