//! One panel of a chart as SVG: the curves of a scene over seconds or over samples, both axes logarithmic.
//!
//! Lines and text take the colour of what they stand in, so that a page can show the same drawing on a dark ground.

use super::axis::Axis;
use super::curve::{Band, Curve, Metric, Point, SceneCurves};
use super::legend::Legend;
use super::number::{count, figure};
use super::style::Style;
use super::svg::escape;
use std::fmt::Write;

/// Pixels across a panel.
pub const WIDTH: f64 = 500.0;
/// Pixels down a panel.
pub const HEIGHT: f64 = 360.0;
/// Pixels at the top that are left free for a title.
pub const TITLE: f64 = 26.0;
/// Pixels to the left of the curves.
pub const LEFT: f64 = 76.0;
pub(super) const RIGHT: f64 = WIDTH - 14.0;
pub(super) const TOP: f64 = TITLE + 8.0;
pub(super) const BOTTOM: f64 = HEIGHT - 52.0;
/// The guide runs above all curves by this factor.
const GUIDE: f64 = 1.8;

/// What is drawn to the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// Median wall seconds of a render.
    Seconds,
    /// Samples per pixel.
    Samples,
}

impl Across {
    /// Both, in the order of a chart.
    pub const ALL: [Self; 2] = [Self::Seconds, Self::Samples];

    fn of(self, point: &Point) -> f64 {
        match self {
            Self::Seconds => point.seconds.median,
            Self::Samples => point.spp as f64,
        }
    }
    fn name(self) -> &'static str {
        match self {
            Self::Seconds => "seconds of a render",
            Self::Samples => "samples per pixel",
        }
    }
    fn guide(self) -> &'static str {
        match self {
            Self::Seconds => "∝ 1 / time",
            Self::Samples => "∝ 1 / samples",
        }
    }
}

/// The panel as the content of an SVG element of [`WIDTH`] by [`HEIGHT`].
pub fn panel(scene: &SceneCurves, legend: &Legend, metric: Metric, across: Across) -> String {
    let mut out = String::new();
    names(&mut out, across.name(), metric.name());
    let points = || scene.curves.iter().flat_map(|curve| &curve.points).filter(|p| is_shown(p, across));
    let ups = points().flat_map(|p| [p.error.low, p.error.median, p.error.high]);
    // The quantiles alone may lie far below the rest, where the reference's noise was taken off.
    let least = points().map(|p| p.error.median).fold(f64::INFINITY, f64::min) * 0.25;
    let axes = Axis::new(points().map(|p| across.of(p)), LEFT, RIGHT).zip(Axis::new(
        ups.map(|up| if up > 0.0 { up.max(least) } else { up }),
        BOTTOM,
        TOP,
    ));
    let Some((x, y)) = axes else {
        frame(&mut out);
        let place = ((LEFT + RIGHT) / 2.0, (TOP + BOTTOM) / 2.0);
        text(&mut out, place, "middle", r#"font-size="13" opacity="0.7""#, "nothing to draw: no error is above 0");
        return out;
    };
    let plot = Plot { x, y, metric, across };
    plot.grid(&mut out);
    if metric.is_squared() {
        plot.guide(&mut out, points());
    }
    frame(&mut out);
    for curve in &scene.curves {
        plot.curve(&mut out, curve, &legend.style(&curve.label));
    }
    out
}

/// Whether a point has a place on logarithmic axes.
fn is_shown(point: &Point, across: Across) -> bool {
    point.error.median > 0.0 && across.of(point) > 0.0
}

struct Plot {
    x: Axis,
    y: Axis,
    metric: Metric,
    across: Across,
}

// Writing to a string cannot fail: what `write!` returns is dropped throughout.
impl Plot {
    fn grid(&self, out: &mut String) {
        for (axis, upright) in [(&self.x, true), (&self.y, false)] {
            for tick in axis.ticks() {
                rule(out, tick.at, upright, if tick.decade { 0.22 } else { 0.09 }, tick.label.as_deref());
            }
        }
    }

    /// The slope of independent samples, above all points.
    fn guide<'a>(&self, out: &mut String, points: impl Iterator<Item = &'a Point>) {
        let constant = points.map(|p| p.error.median * self.across.of(p)).fold(0.0, f64::max) * GUIDE;
        let ((x0, x1), (y0, y1)) = (self.x.range(), self.y.range());
        let (from, to) = (x0.max(constant / y1), x1.min(constant / y0));
        if from >= to {
            return;
        }
        let at = |x: f64| (self.x.place(x), self.y.place(constant / x));
        let ((ax, ay), (bx, by)) = (at(from), at(to));
        let _ = write!(
            out,
            r#"<path class="guide" d="M{ax:.1} {ay:.1}L{bx:.1} {by:.1}" stroke="currentColor" stroke-opacity="0.45" stroke-dasharray="1 4" stroke-linecap="round" stroke-width="1.5"/>"#
        );
        // Along the line, on its upper side, nearer to its lower end.
        let (mx, my) = (ax + 0.7 * (bx - ax), ay + 0.7 * (by - ay));
        let angle = (by - ay).atan2(bx - ax).to_degrees();
        let attributes = format!(r#"font-size="11" opacity="0.7" transform="rotate({angle:.1} {mx:.1} {my:.1})""#);
        text(out, (mx, my - 5.0), "middle", &attributes, self.across.guide());
    }

    fn curve(&self, out: &mut String, curve: &Curve, style: &Style) {
        let shown: Vec<&Point> = curve.points.iter().filter(|p| is_shown(p, self.across)).collect();
        let at = |p: &Point, up: f64| format!("{:.1} {:.1}", self.x.place(self.across.of(p)), self.y.place(up));
        let path = |points: Vec<String>| format!("M{}", points.join("L"));
        let _ = write!(out, r#"<g class="line s{}" color="{}">"#, style.colour, style.on_white());
        if !shown.is_empty() {
            let high = shown.iter().map(|p| at(p, p.error.high));
            let low = shown.iter().rev().map(|p| at(p, p.error.low));
            let band = path(high.chain(low).collect());
            let _ = write!(out, r#"<path class="band" d="{band}Z" fill="currentColor" fill-opacity="0.14"/>"#);
            let line = path(shown.iter().map(|p| at(p, p.error.median)).collect());
            let _ = write!(
                out,
                r#"<path d="{line}" fill="none" stroke="currentColor" stroke-width="1.8" stroke-dasharray="{}"/>"#,
                style.dash
            );
        }
        for point in shown {
            self.point(out, curve, point, style);
        }
        out.push_str("</g>");
    }

    /// A marker that tells what it stands for: as the title of its group.
    fn point(&self, out: &mut String, curve: &Curve, point: &Point, style: &Style) {
        let (x, y) = (self.x.place(self.across.of(point)), self.y.place(point.error.median));
        let title = escape(&description(&curve.label, point, self.metric));
        let fill = if style.hollow { r##"class="hollow" fill="#ffffff""## } else { r#"fill="currentColor""# };
        let marker = style.marker.path(x, y);
        let _ = write!(
            out,
            r#"<g class="point"><title>{title}</title><path {fill} stroke="currentColor" stroke-width="1.2" d="{marker}"/><circle cx="{x:.1}" cy="{y:.1}" r="9" fill="none" pointer-events="all"/></g>"#
        );
    }
}

/// What a point stands for, in lines: the curve, samples, seconds, error.
pub fn description(label: &str, point: &Point, metric: Metric) -> String {
    let samples = if point.spp == 1 { "sample" } else { "samples" };
    let renders = if point.renders == 1 { "render" } else { "renders" };
    format!(
        "{label}\n{} {samples} per pixel, {} {renders}\n{} s\n{} {}",
        count(point.spp),
        count(point.renders as u64),
        banded(&point.seconds),
        metric.name(),
        banded(&point.error),
    )
}

/// A median with its band: `1.23 (1.20 to 1.31)`.
pub fn banded(band: &Band) -> String {
    let [low, median, high] = [band.low, band.median, band.high].map(figure);
    if low == high { median } else { format!("{median} ({low} to {high})") }
}

/// Writes what both axes are.
pub(super) fn names(out: &mut String, across: &str, up: &str) {
    text(out, ((LEFT + RIGHT) / 2.0, HEIGHT - 12.0), "middle", r#"font-size="13""#, across);
    let middle = (TOP + BOTTOM) / 2.0;
    let turned = format!(r#"font-size="13" transform="rotate(-90 16 {middle:.1})""#);
    text(out, (16.0, middle), "middle", &turned, up);
}

/// Draws a line across the curves, with its label: from the bottom up, or to the right.
pub(super) fn rule(out: &mut String, at: f64, upright: bool, opacity: f64, label: Option<&str>) {
    let path = if upright { format!("M{at:.1} {TOP}V{BOTTOM}") } else { format!("M{LEFT} {at:.1}H{RIGHT}") };
    let _ = write!(out, r#"<path d="{path}" stroke="currentColor" stroke-opacity="{opacity}"/>"#);
    let Some(label) = label else { return };
    let (place, anchor) = if upright { ((at, BOTTOM + 17.0), "middle") } else { ((LEFT - 7.0, at + 4.0), "end") };
    text(out, place, anchor, r#"font-size="12" opacity="0.85""#, label);
}

/// Draws the border of the curves.
pub(super) fn frame(out: &mut String) {
    let (width, height) = (RIGHT - LEFT, BOTTOM - TOP);
    let _ = write!(
        out,
        r#"<rect x="{LEFT}" y="{TOP}" width="{width}" height="{height}" fill="none" stroke="currentColor" stroke-opacity="0.5"/>"#
    );
}

/// Writes a line of text.
pub(super) fn text(out: &mut String, (x, y): (f64, f64), anchor: &str, attributes: &str, text: &str) {
    let text = escape(text);
    let _ = write!(
        out,
        r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" fill="currentColor" {attributes}>{text}</text>"#
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(points: &[(u64, f64, f64)]) -> SceneCurves {
        let band = |median: f64| Band { low: median * 0.9, median, high: median * 1.1 };
        let point = |&(spp, t, e): &(u64, f64, f64)| Point { spp, renders: 3, seconds: band(t), error: band(e) };
        let curve = Curve { label: "a<b".into(), points: points.iter().map(point).collect() };
        SceneCurves { scene: "room & more".into(), curves: vec![curve] }
    }

    fn drawn(points: &[(u64, f64, f64)], across: Across) -> String {
        panel(&scene(points), &Legend::new(["a<b".to_owned()], []), Metric::RelMse, across)
    }

    #[test]
    fn points_say_what_they_stand_for() {
        let text = drawn(&[(1, 0.5, 0.25), (1024, 512.0, 2.5e-4)], Across::Seconds);
        let title = "<title>a&lt;b\n1,024 samples per pixel, 3 renders\n512 (461 to 563) s\nrelMSE 2.50e-4 (2.25e-4 to 2.75e-4)</title>";
        assert!(text.contains(title), "{text}");
        assert!(text.contains("1 sample per pixel"));
        assert_eq!(text.matches("class=\"point\"").count(), 2);
        assert!(text.contains("∝ 1 / time") && text.contains("seconds of a render"));
        assert!(drawn(&[(1, 0.5, 0.25), (4, 1.0, 0.1)], Across::Samples).contains("∝ 1 / samples"));
    }

    #[test]
    fn what_has_no_logarithm_is_left_out() {
        let text = drawn(&[(1, 0.5, 0.25), (2, 1.0, -0.1), (4, 0.0, 0.1)], Across::Seconds);
        assert_eq!(text.matches("class=\"point\"").count(), 1);
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        let none = drawn(&[(1, 1.0, 0.0)], Across::Samples);
        assert!(none.contains("nothing to draw") && !none.contains("class=\"point\""));
        assert!(drawn(&[], Across::Samples).contains("nothing to draw"));
    }

    /// Points that fall as one over samples lie along the guide.
    #[test]
    fn the_guide_has_the_slope_of_independent_samples() {
        let text = drawn(&[(1, 1.0, 0.5), (16, 16.0, 0.03125), (64, 64.0, 0.0078125)], Across::Samples);
        let line = text.split("class=\"guide\" d=\"M").nth(1).unwrap().split('"').next().unwrap();
        let ends: Vec<f64> = line.split(['L', ' ']).map(|n| n.parse().unwrap()).collect();
        let centre = |i: usize, key: &str| -> f64 {
            let hit = text.split("<circle ").nth(i + 1).unwrap();
            hit.split(&format!("{key}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
        };
        let guide = (ends[3] - ends[1]) / (ends[2] - ends[0]);
        let curve = (centre(2, "cy") - centre(0, "cy")) / (centre(2, "cx") - centre(0, "cx"));
        assert!((guide / curve - 1.0).abs() < 0.01, "{guide} {curve}");
    }
}
