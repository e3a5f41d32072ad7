//! A roofline as SVG, of the size of [`panel`](super::panel): what is computed per second against what is computed for each byte
//! that is moved, below the limits of the machine (Williams, Waterman and Patterson 2009).

use super::axis::Axis;
use super::panel::{BOTTOM, LEFT, RIGHT, TOP, frame, names, rule, text};
use super::style::Style;
use super::svg::escape;
use std::fmt::Write;

/// Width of a letter of a name, about, half its height, and half the width of a point.
const LETTER: f64 = 6.2;
const HALF: f64 = 6.0;
const POINT: f64 = 4.0;

/// What the machine can do at most.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// 10^9 floating-point operations per second.
    pub gflops: f64,
    /// 10^9 bytes per second of each memory, with its name.
    pub memories: Vec<(String, f64)>,
}

/// Something that computes and moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Its name.
    pub name: String,
    /// Operations for each byte.
    pub intensity: f64,
    /// 10^9 operations per second.
    pub gflops: f64,
    /// What it stands for, in lines.
    pub tip: String,
}

/// The roofline as the content of an SVG element.
pub fn roof(limits: &Limits, loads: &[Load]) -> String {
    let mut out = String::new();
    names(&mut out, "floating-point operations for each byte", "Gflop/s of a thread");
    frame(&mut out);
    let shown = || loads.iter().filter(|load| load.intensity > 0.0 && load.gflops > 0.0);
    // Where a memory gives way to arithmetic.
    let ridges = limits.memories.iter().map(|(_, rate)| limits.gflops / rate);
    let across: Vec<f64> =
        ridges.clone().chain(ridges.map(|x| 4.0 * x)).chain(shown().map(|load| load.intensity)).collect();
    let least = across.iter().copied().fold(f64::INFINITY, f64::min) / 4.0;
    let Some(x) = Axis::new(across.iter().copied().chain([least]), LEFT, RIGHT) else { return out };
    let lowest = limits.memories.iter().map(|(_, rate)| rate * x.range().0);
    let ups = lowest.chain([limits.gflops * 1.5]).chain(shown().map(|load| load.gflops));
    let Some(y) = Axis::new(ups, BOTTOM, TOP) else { return out };
    for (axis, upright) in [(&x, true), (&y, false)] {
        for tick in axis.ticks() {
            rule(&mut out, tick.at, upright, if tick.decade { 0.2 } else { 0.07 }, tick.label.as_deref());
        }
    }
    for (i, (name, rate)) in limits.memories.iter().enumerate() {
        let style = Style::new(i + 1, false);
        let (from, ridge) = (x.range().0, limits.gflops / rate);
        let at = |intensity: f64| (x.place(intensity), y.place((rate * intensity).min(limits.gflops)));
        let ((ax, ay), (bx, by), (cx, cy)) = (at(from), at(ridge), at(x.range().1));
        // Writing to a string cannot fail.
        let _ = write!(
            out,
            r#"<path d="M{ax:.1} {ay:.1}L{bx:.1} {by:.1}L{cx:.1} {cy:.1}" fill="none" class="s{}" color="{}" stroke="currentColor" stroke-width="1.6"/>"#,
            style.colour,
            style.on_white()
        );
        let (mx, my) = ((ax + bx) / 2.0, (ay + by) / 2.0);
        let angle = (by - ay).atan2(bx - ax).to_degrees();
        let turned = format!(r#"font-size="11" opacity="0.8" transform="rotate({angle:.1} {mx:.1} {my:.1})""#);
        text(&mut out, (mx, my - 5.0), "middle", &turned, name);
    }
    let style = Style::new(0, false);
    let _ = write!(out, r#"<g class="line s{}" color="{}">"#, style.colour, style.on_white());
    let places: Vec<(f64, f64)> = shown().map(|load| (x.place(load.intensity), y.place(load.gflops))).collect();
    let mut taken: Vec<Area> =
        places.iter().map(|&(cx, cy)| [cx - POINT, cx + POINT, cy - POINT, cy + POINT]).collect();
    for (load, &(cx, cy)) in shown().zip(&places) {
        let _ = write!(
            out,
            r#"<g class="point"><title>{}</title><path fill="currentColor" d="{}"/><circle cx="{cx:.1}" cy="{cy:.1}" r="9" fill="none" pointer-events="all"/></g>"#,
            escape(&load.tip),
            style.marker.path(cx, cy)
        );
        let name = label(&load.name, (cx, cy), &taken);
        text(&mut out, name.at, name.anchor, r#"font-size="11""#, &load.name);
        taken.push(name.area);
    }
    out + "</g>"
}

/// From the left to the right, and from the top to the bottom.
type Area = [f64; 4];

/// Where the name of a point stands.
struct Label {
    at: (f64, f64),
    anchor: &'static str,
    area: Area,
}

/// To the right of its point; or to the left, below or above, where that is within the frame and free.
fn label(name: &str, (cx, cy): (f64, f64), taken: &[Area]) -> Label {
    let width = LETTER * name.chars().count() as f64;
    let sides = [
        (7.0, 0.0, "start", [7.0, 7.0 + width]),
        (-7.0, 0.0, "end", [-7.0 - width, -7.0]),
        (0.0, 15.0, "middle", [-width / 2.0, width / 2.0]),
        (0.0, -13.0, "middle", [-width / 2.0, width / 2.0]),
    ];
    let labels = sides.map(|(dx, dy, anchor, [from, to])| Label {
        at: (cx + dx, cy + dy + 4.0),
        anchor,
        area: [cx + from, cx + to, cy + dy - HALF, cy + dy + HALF],
    });
    let apart = |a: &Area, b: &Area| a[0] >= b[1] || b[0] >= a[1] || a[2] >= b[3] || b[2] >= a[3];
    let fits = |label: &Label| label.area[0] >= LEFT && label.area[1] <= RIGHT;
    let free = |label: &&Label| fits(label) && taken.iter().all(|area| apart(area, &label.area));
    let best = labels.iter().position(|label| free(&label)).or_else(|| labels.iter().position(fits)).unwrap_or(0);
    let [right, left, below, above] = labels;
    match best {
        0 => right,
        1 => left,
        2 => below,
        _ => above,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_lie_below_the_limits() {
        let limits = Limits { gflops: 100.0, memories: vec![("cache".into(), 100.0), ("memory".into(), 25.0)] };
        let load =
            |name: &str, intensity: f64, gflops: f64| Load { name: name.into(), intensity, gflops, tip: name.into() };
        let text = roof(&limits, &[load("shade", 2.0, 20.0), load("compact", 0.0, 0.0)]);
        assert_eq!((text.matches("class=\"point\"").count(), text.matches("stroke-width=\"1.6\"").count()), (1, 2));
        assert!(text.contains(">shade</text>") && text.contains(">memory</text>") && !text.contains("NaN"));
        // The rightmost is named to its left.
        let far = roof(&limits, &[load("shade", 2.0, 20.0), load("intersect", 200.0, 30.0)]);
        let anchor = |name: &str| {
            let text = far.split("<text").find(|text| text.contains(&format!(">{name}</text>"))).unwrap();
            text.contains(r#"text-anchor="end""#)
        };
        assert_eq!(["shade", "intersect"].map(anchor), [false, true], "{far}");
        let none = roof(&Limits { gflops: 0.0, memories: Vec::new() }, &[]);
        assert!(!none.contains("NaN") && !none.contains("class=\"point\""));
    }

    #[test]
    fn names_stand_neither_on_points_nor_on_each_other() {
        let (cx, cy) = ((LEFT + RIGHT) / 2.0, (TOP + BOTTOM) / 2.0);
        let beside = |dx: f64, dy: f64| [cx + dx - POINT, cx + dx + POINT, cy + dy - POINT, cy + dy + POINT];
        let (right, left, below) = (beside(20.0, 1.0), beside(-20.0, -1.0), beside(3.0, 15.0));
        let side = |taken: &[Area]| {
            let label = label("shade", (cx, cy), taken);
            (label.anchor, (label.at.1 - cy).round())
        };
        assert_eq!(side(&[]), ("start", 4.0));
        assert_eq!(side(&[right]), ("end", 4.0));
        assert_eq!(side(&[right, left]), ("middle", 19.0));
        assert_eq!(side(&[right, left, below]), ("middle", -9.0));
        // Nowhere is free: within the frame at least.
        assert_eq!(label("shade", (RIGHT - 9.0, cy), &[[LEFT, RIGHT, TOP, BOTTOM]]).anchor, "end");
    }
}
