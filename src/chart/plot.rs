//! A panel of any figure against a setting as SVG, of the size of [`panel`](super::panel): upwards from 0, across on
//! a logarithmic axis, or by names in their order.

use super::axis::Axis;
use super::curve::Band;
use super::number::figure;
use super::panel::{BOTTOM, LEFT, RIGHT, TOP, frame, names, rule};
use super::style::Style;
use super::svg::escape;
use std::fmt::Write;

/// A setting and what was measured with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// Where it is: a number above 0, or the index of a name.
    pub x: f64,
    /// The figure.
    pub band: Band,
    /// What it stands for, in lines.
    pub tip: String,
}

/// What lies across.
#[derive(Clone, Debug, PartialEq)]
pub enum Scale {
    /// Numbers above 0.
    Numbers,
    /// Names, from left to right.
    Names(Vec<String>),
}

/// Most lines between 0 and the top.
const TICKS: f64 = 8.0;

/// The panel as the content of an SVG element.
pub fn plot(across: &str, up: &str, scale: &Scale, spots: &[Spot]) -> String {
    let mut out = String::new();
    names(&mut out, across, up);
    frame(&mut out);
    let most = spots.iter().map(|spot| spot.band.high).fold(0.0, f64::max);
    let Some(place) = places(&mut out, scale, spots).filter(|_| most > 0.0 && most.is_finite()) else { return out };
    let height = heights(&mut out, most);
    let style = Style::new(0, false);
    let path = |points: Vec<String>| format!("M{}", points.join("L"));
    let at = |spot: &Spot, up: f64| format!("{:.1} {:.1}", place(spot.x), height(up));
    // Writing to a string cannot fail.
    let _ = write!(out, r#"<g class="line s{}" color="{}">"#, style.colour, style.on_white());
    let high = spots.iter().map(|spot| at(spot, spot.band.high));
    let low = spots.iter().rev().map(|spot| at(spot, spot.band.low));
    let band = path(high.chain(low).collect());
    let line = path(spots.iter().map(|spot| at(spot, spot.band.median)).collect());
    let _ = write!(
        out,
        r#"<path class="band" d="{band}Z" fill="currentColor" fill-opacity="0.14"/><path d="{line}" fill="none" stroke="currentColor" stroke-width="1.8"/>"#
    );
    for spot in spots {
        let (x, y) = (place(spot.x), height(spot.band.median));
        let _ = write!(
            out,
            r#"<g class="point"><title>{}</title><path fill="currentColor" d="{}"/><circle cx="{x:.1}" cy="{y:.1}" r="9" fill="none" pointer-events="all"/></g>"#,
            escape(&spot.tip),
            style.marker.path(x, y)
        );
    }
    out + "</g>"
}

/// Draws lines from 0 up to a little more than `most`, and returns where a value is.
pub(super) fn heights(out: &mut String, most: f64) -> impl Fn(f64) -> f64 + use<> {
    let top = 1.06 * most;
    let height = move |value: f64| BOTTOM + (TOP - BOTTOM) * value / top;
    let step = step(top);
    for k in 0..=(top / step) as u32 {
        let value = f64::from(k) * step;
        rule(out, height(value), false, 0.15, Some(&figure(value)));
    }
    height
}

/// Draws what lies across, and returns where a value is; none where there is no value.
fn places(out: &mut String, scale: &Scale, spots: &[Spot]) -> Option<Box<dyn Fn(f64) -> f64>> {
    match scale {
        Scale::Numbers => {
            let axis = Axis::new(spots.iter().map(|spot| spot.x), LEFT, RIGHT)?;
            for tick in axis.ticks() {
                rule(out, tick.at, true, if tick.decade { 0.15 } else { 0.07 }, tick.label.as_deref());
            }
            Some(Box::new(move |x| axis.place(x)))
        }
        Scale::Names(all) => {
            let width = (RIGHT - LEFT) / all.len().max(1) as f64;
            let at = move |x: f64| LEFT + width * (x + 0.5);
            for (i, name) in all.iter().enumerate() {
                rule(out, at(i as f64), true, 0.07, Some(name));
            }
            Some(Box::new(at))
        }
    }
}

/// A round distance of lines below `top`: 1, 2 or 5 times a power of ten.
fn step(top: f64) -> f64 {
    let least = top / TICKS;
    let power = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|digit| digit * power).find(|step| *step >= least).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(x: f64, median: f64) -> Spot {
        Spot { x, band: Band { low: median * 0.9, median, high: median * 1.1 }, tip: format!("<{x}>") }
    }

    #[test]
    fn lines_are_a_round_distance_apart() {
        for (top, expected) in [(8.0, 1.0), (9.0, 2.0), (17.0, 5.0), (0.05, 0.01), (45.0, 10.0)] {
            assert!((step(top) / expected - 1.0).abs() < 1e-9, "{top}: {}", step(top));
        }
    }

    #[test]
    fn spots_say_what_they_stand_for_and_heights_are_in_proportion() {
        let numbers = plot("wave", "Mrays/s", &Scale::Numbers, &[spot(64.0, 5.0), spot(4096.0, 10.0)]);
        assert_eq!(numbers.matches("class=\"point\"").count(), 2);
        assert!(numbers.contains("<title>&lt;64&gt;</title>") && numbers.contains(">wave</text>"));
        let height = |i: usize| -> f64 {
            let circle = numbers.split("<circle ").nth(i + 1).unwrap();
            circle.split("cy=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
        };
        assert!(((BOTTOM - height(1)) / (BOTTOM - height(0)) - 2.0).abs() < 0.01);
        let named =
            plot("bvh", "x", &Scale::Names(vec!["fast".into(), "best".into()]), &[spot(0.0, 1.0), spot(1.0, 1.0)]);
        assert!(named.contains(">fast</text>") && named.contains(">best</text>"));
        for nothing in [plot("a", "b", &Scale::Numbers, &[]), plot("a", "b", &Scale::Numbers, &[spot(1.0, 0.0)])] {
            assert!(!nothing.contains("point") && !nothing.contains("NaN"));
        }
    }
}
