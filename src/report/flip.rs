//! FLIP: how visible the differences of two images are when one flips between them on a screen.
//!
//! LDR-FLIP of Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for
//! Alternating Images", HPG 2020; names and numbers of the sections are theirs. Every filter is separable, so that the
//! cost per pixel grows with the radius alone.

use super::colour::{lab, lab_of_rgb, opponents};
use super::errors::{self, Figure};
use super::filter::{Plane, Weights};
use crate::error::{Error, Result};
use std::f64::consts::PI;

/// How the images are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewing {
    /// Pixels per degree of the visual field, 1 to 1000.
    pub pixels_per_degree: f64,
    /// Exposure in stops, as of 8-bit output: radiance times 2^EV is shown, limited to [0, 1]. Finite.
    pub exposure_ev: f64,
}

impl Default for Viewing {
    /// 67 pixels per degree, the default of FLIP: 3840 pixels on 0.7 m, from 0.7 m away.
    fn default() -> Self {
        Self { pixels_per_degree: 3840.0 * PI / 180.0, exposure_ev: 0.0 }
    }
}

/// Visible differences, from 0 for none to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// Their mean over the pixels that are finite in both images.
    pub mean: Figure,
    /// Of each pixel, in the order of the images.
    pub map: Vec<f32>,
}

/// The contrast sensitivity function of an opponent channel: a sum of two bells (a1, b1, a2, b2 of table 1).
const SENSITIVITY: [[f64; 4]; 3] = [[1.0, 0.0047, 0.0, 1e-5], [1.0, 0.0053, 0.0, 1e-5], [34.1, 0.04, 13.5, 0.025]];
/// The largest b of the table, which sets the radius of all filters.
const WIDEST: f64 = 0.04;
/// Width of the feature detectors, in degrees (section 4.2).
const FEATURE_WIDTH: f64 = 0.082;
/// Exponents of the colour and the feature difference (q_c, q_f).
const COLOUR_EXPONENT: f32 = 0.7;
const FEATURE_EXPONENT: f32 = 0.5;
/// Where the range of colour differences has its knee (p_c), and what it is mapped to (p_t).
const KNEE: f32 = 0.4;
const KNEE_TARGET: f32 = 0.95;

/// Compares an image of `width` pixels across with a reference. What is no colour is looked at as 8-bit output shows it,
/// and left out of the mean: NaN as black, infinity as white.
///
/// # Errors
/// [`Error::Images`] if the images differ in size, have no pixels, or are no whole number of rows; [`Error::Setting`] if
/// `viewing` is out of its range.
pub fn flip(image: &[[f32; 3]], reference: &[[f32; 3]], width: usize, viewing: &Viewing) -> Result<Flip> {
    errors::check(image, reference)?;
    errors::check_rows(image, width)?;
    viewing.check()?;
    let filters = Filters::new(viewing.pixels_per_degree);
    let seen = [image, reference].map(|pixels| filters.look(pixels, width, viewing.exposure_ev));
    let largest = hyab(hunt(lab_of_rgb([0.0, 1.0, 0.0])), hunt(lab_of_rgb([0.0, 0.0, 1.0]))).powf(COLOUR_EXPONENT);
    let [a, b] = &seen;
    let map: Vec<f32> = (0..image.len())
        .map(|i| {
            let colour = redistribute(hyab(a.colours[i], b.colours[i]).powf(COLOUR_EXPONENT), largest);
            let feature = (a.edges[i] - b.edges[i]).abs().max((a.points[i] - b.points[i]).abs());
            // Of two filters of weight 1 in each direction no difference exceeds the square root of 2.
            let feature = (feature * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
            colour.powf(1.0 - feature)
        })
        .collect();
    let finite = |pixel: &[f32; 3]| pixel.iter().all(|c| c.is_finite());
    let pixels = map.iter().zip(image.iter().zip(reference));
    let counted: Vec<f64> =
        pixels.filter(|(_, (a, b))| finite(a) && finite(b)).map(|(&value, _)| f64::from(value)).collect();
    let mean = errors::mean(counted.iter().copied(), &errors::worst(&counted));
    Ok(Flip { mean, map })
}

impl Viewing {
    fn check(&self) -> Result<()> {
        let wrong = |setting, found: f64, expected: &str| {
            Err(Error::Setting { setting, found: found.to_string(), expected: expected.to_owned() })
        };
        match *self {
            Self { pixels_per_degree: ppd, .. } if !(1.0..=1000.0).contains(&ppd) => {
                wrong("pixels per degree", ppd, "1 to 1000")
            }
            Self { exposure_ev, .. } if !exposure_ev.is_finite() => {
                wrong("--exposure", exposure_ev, "a finite number of stops")
            }
            _ => Ok(()),
        }
    }
}

/// An image as the eye takes it.
struct Seen {
    /// CIELAB after the blur of the eye, with the Hunt effect.
    colours: Vec<[f32; 3]>,
    /// Strength of edges and of points, both of the luminance before the blur.
    edges: Vec<f32>,
    points: Vec<f32>,
}

/// The filters for a distance from the screen.
struct Filters {
    /// Per opponent channel the bells of its sensitivity, each with its share.
    sensitivity: [Vec<(f32, Weights)>; 3],
    bell: Weights,
    slope: Weights,
    curvature: Weights,
}

impl Filters {
    fn new(pixels_per_degree: f64) -> Self {
        let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize;
        let sensitivity = SENSITIVITY.map(|[a1, b1, a2, b2]| {
            let bells = [(a1, b1), (a2, b2)].into_iter().filter(|&(a, _)| a > 0.0).map(|(a, b)| {
                let bell = move |x: f64| (-(PI * x / pixels_per_degree).powi(2) / b).exp();
                let across: f64 = (0..=2 * radius).map(|i| bell(i as f64 - radius as f64)).sum();
                // In two dimensions the sum over one, squared.
                (a * (PI / b).sqrt() * across * across, Weights::new(radius, bell))
            });
            let bells: Vec<(f64, Weights)> = bells.collect();
            let whole: f64 = bells.iter().map(|bell| bell.0).sum();
            bells.into_iter().map(|(weight, bell)| ((weight / whole) as f32, bell)).collect()
        });
        let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let radius = (3.0 * deviation).ceil() as usize;
        let bell = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        Self {
            sensitivity,
            bell: Weights::new(radius, bell),
            slope: Weights::new(radius, |x| -x * bell(x)),
            curvature: Weights::new(radius, |x| (x * x / (deviation * deviation) - 1.0) * bell(x)),
        }
    }

    fn look(&self, pixels: &[[f32; 3]], width: usize, exposure_ev: f64) -> Seen {
        let scale = exposure_ev.exp2();
        // Each channel by itself: large images fill the memory.
        let opponents = pixels.iter().map(|&rgb| opponents(rgb.map(|c| shown(c, scale))));
        let plane = |k: usize| Plane { width, values: opponents.clone().map(|channels| channels[k]).collect() };
        let luminance = plane(0);
        let (edges, points) = self.features(&luminance);
        let blurred = [self.blur(0, &luminance), self.blur(1, &plane(1)), self.blur(2, &plane(2))];
        let colours = (0..pixels.len()).map(|i| hunt(lab(blurred.each_ref().map(|channel| channel[i])))).collect();
        Seen { colours, edges, points }
    }

    /// An opponent channel through the eye's sensitivity (section 4.1.1).
    fn blur(&self, channel: usize, plane: &Plane) -> Vec<f32> {
        let mut sum = vec![0.0; plane.values.len()];
        for (share, bell) in &self.sensitivity[channel] {
            let blurred = plane.across(bell).down(bell);
            sum.iter_mut().zip(blurred.values).for_each(|(sum, value)| *sum += share * value);
        }
        sum
    }

    /// Edges and points: lengths of the first and of the second derivatives along both axes (section 4.2).
    fn features(&self, luminance: &Plane) -> (Vec<f32>, Vec<f32>) {
        let smooth = luminance.across(&self.bell);
        let length = |across: &Weights, down: &Weights| -> Vec<f32> {
            let (x, y) = (luminance.across(across).down(&self.bell), smooth.down(down));
            x.values.iter().zip(y.values).map(|(x, y)| (x * x + y * y).sqrt()).collect()
        };
        (length(&self.slope, &self.slope), length(&self.curvature, &self.curvature))
    }
}

/// A component as 8-bit output shows it before it is encoded and rounded: limited to [0, 1], NaN as 0.
fn shown(radiance: f32, scale: f64) -> f32 {
    // Infinity times a scale that underflowed to 0 would be NaN.
    let scaled = if radiance == f32::INFINITY { 1.0 } else { f64::from(radiance) * scale };
    if scaled > 0.0 { scaled.min(1.0) as f32 } else { 0.0 }
}

/// The Hunt effect: what is darker looks less colourful (section 4.1.2).
fn hunt([l, a, b]: [f32; 3]) -> [f32; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

/// Distance of colours far apart (Abasi, Amani Tehran and Fairchild 2020).
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + ((a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}

/// Colour differences onto [0, 1], most of it for the small ones (section 4.1.3).
fn redistribute(difference: f32, largest: f32) -> f32 {
    let knee = KNEE * largest;
    if difference < knee {
        KNEE_TARGET / knee * difference
    } else {
        (KNEE_TARGET + (difference - knee) / (largest - knee) * (1.0 - KNEE_TARGET)).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Code = fn(usize, usize, usize) -> usize;
    /// Reference and test image, width and height, pixels per degree; the mean and five pixels.
    type Golden = (Code, Code, [usize; 2], f64, f64, [f32; 5]);

    // Images as 8-bit sRGB codes of column, row and channel, which another program can make too.
    fn ramp(x: usize, y: usize, c: usize) -> usize {
        (3 * x + 5 * y + 40 * c) % 256
    }
    fn noisy(x: usize, y: usize, c: usize) -> usize {
        (ramp(x, y, c) + (73 * x + 151 * y + 199 * c + 31 * x * y) % 41).clamp(20, 275) - 20
    }
    fn lines(x: usize, y: usize, _: usize) -> usize {
        if x.is_multiple_of(8) || y.is_multiple_of(11) { 255 } else { 30 }
    }
    fn moved(x: usize, y: usize, c: usize) -> usize {
        lines(x + 1, y + 1, c)
    }
    fn blocks(x: usize, y: usize, c: usize) -> usize {
        (x / 9 * 57 + y / 7 * 91 + 83 * c) % 256
    }
    fn tinted(x: usize, y: usize, c: usize) -> usize {
        (blocks(x, y, c) + if c == x / 9 % 3 { 12 } else { 0 }).min(255)
    }

    fn image(width: usize, height: usize, code: Code) -> Vec<[f32; 3]> {
        let linear = |code: usize| {
            let encoded = code as f64 / 255.0;
            (if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }) as f32
        };
        (0..width * height).map(|i| [0, 1, 2].map(|c| linear(code(i % width, i / width, c)))).collect()
    }

    fn at(pixels_per_degree: f64) -> Viewing {
        Viewing { pixels_per_degree, ..Viewing::default() }
    }

    /// Means and some pixels by the authors' own program: `flip_evaluator` 1.7, `evaluate(reference, test,
    /// "LDR", applyMagma=False, parameters={"ppd": ...})` on these images. Both compute in f32, with sums in different
    /// orders: L* up to 100 errs by some 10^-5. That to the power of 0.7 moves a pixel by up to 10^-3 where there is no
    /// difference, and by some 10^-6 where there is one.
    #[test]
    fn the_figures_are_those_of_the_authors_program() {
        let golden: [Golden; 8] = [
            (ramp, noisy, [61, 47], 67.020645, 0.0929195, [0.15915, 0.320062, 0.069138, 0.085004, 0.10707]),
            (lines, moved, [61, 47], 67.020645, 0.4815421, [0.985592, 0.470456, 0.00011, 0.471629, 0.389492]),
            (blocks, tinted, [61, 47], 67.020645, 0.1711656, [0.03072, 0.149185, 0.20763, 0.100907, 0.213621]),
            (ramp, noisy, [61, 47], 20.0, 0.2406344, [0.239792, 0.451243, 0.370035, 0.047431, 0.163909]),
            (lines, moved, [61, 47], 20.0, 0.5077432, [0.981608, 0.000379, 0.0, 0.000352, 0.990568]),
            (blocks, tinted, [61, 47], 20.0, 0.1688632, [0.028364, 0.139617, 0.198278, 0.142153, 0.198373]),
            (lines, moved, [61, 47], 67.0, 0.4815813, [0.985593, 0.470355, 0.0, 0.471618, 0.389706]),
            (ramp, noisy, [3, 2], 67.020645, 0.0798965, [0.156442, 0.052396, 0.059815, 0.059815, 0.03876]),
        ];
        for (reference, test, [w, h], ppd, mean, pixels) in golden {
            let found = flip(&image(w, h, test), &image(w, h, reference), w, &at(ppd)).unwrap();
            assert!((found.mean.raw - mean).abs() < 1e-4, "found {}, expected {mean}", found.mean.raw);
            let places = [(0, 0), (w - 1, h - 1), (w / 2, h / 2), (w / 3, h - 1), (w - 1, h / 4)];
            for ((x, y), expected) in places.into_iter().zip(pixels) {
                let found = found.map[y * w + x];
                let allowed = if expected < 0.01 { 1e-3 } else { 1e-5 };
                assert!((found - expected).abs() < allowed, "{x},{y}: found {found}, expected {expected}");
            }
        }
    }

    #[test]
    fn from_nothing_to_everything() {
        let (a, b) = (image(61, 47, ramp), image(61, 47, noisy));
        let same = flip(&a, &a, 61, &Viewing::default()).unwrap();
        assert!(same.mean.raw == 0.0 && same.map.iter().all(|&value| value == 0.0));
        // The largest difference of colours that the measure knows.
        let found = flip(&[[0.0, 1.0, 0.0]; 300], &[[0.0, 0.0, 1.0]; 300], 20, &Viewing::default()).unwrap();
        assert!(found.map.iter().all(|value| (value - 1.0).abs() < 1e-5), "{:?}", found.map);
        // Images change places without a change.
        let [forth, back] = [flip(&a, &b, 61, &at(67.0)).unwrap(), flip(&b, &a, 61, &at(67.0)).unwrap()];
        assert_eq!(forth, back);
    }

    #[test]
    fn the_worst_pixels_are_left_out() {
        let (a, b) = (image(61, 47, ramp), image(61, 47, noisy));
        let found = flip(&a, &b, 61, &Viewing::default()).unwrap();
        let mut sorted: Vec<f64> = found.map.iter().map(|&v| f64::from(v)).collect();
        sorted.sort_by(f64::total_cmp);
        let kept = &sorted[..61 * 47 - 2];
        assert!((found.mean.trimmed - kept.iter().sum::<f64>() / kept.len() as f64).abs() < 1e-12);
        assert!(found.mean.trimmed < found.mean.raw);
    }

    #[test]
    fn exposure_comes_before_the_screen() {
        let (a, b) = (image(61, 47, ramp), image(61, 47, noisy));
        let brighter = |pixels: &[[f32; 3]]| pixels.iter().map(|p| p.map(|c| 4.0 * c)).collect::<Vec<_>>();
        let darkened = Viewing { exposure_ev: -2.0, ..Viewing::default() };
        let found = flip(&brighter(&a), &brighter(&b), 61, &darkened).unwrap();
        assert_eq!(found, flip(&a, &b, 61, &Viewing::default()).unwrap());
        // Beyond white there is nothing to see.
        let found = flip(&[[7.0; 3]; 40], &[[1.0; 3]; 40], 8, &Viewing::default()).unwrap();
        assert_eq!(found.mean.raw, 0.0);
    }

    #[test]
    fn what_is_no_colour_is_seen_but_not_counted() {
        let grey = vec![[0.5_f32; 3]; 400];
        let mut odd = grey.clone();
        odd[0] = [f32::NAN, f32::NEG_INFINITY, -1.0];
        odd[399] = [f32::INFINITY; 3];
        let mut shown = grey.clone();
        (shown[0], shown[399]) = ([0.0; 3], [1.0; 3]);
        let [found, expected] = [&odd, &shown].map(|image| flip(image, &grey, 20, &Viewing::default()).unwrap());
        assert_eq!(found.map, expected.map);
        assert!(found.map.iter().all(|value| value.is_finite()));
        let counted = expected.map[1..399].iter().map(|&v| f64::from(v)).sum::<f64>() / 398.0;
        assert!((found.mean.raw - counted).abs() < 1e-12 && found.mean.raw < expected.mean.raw);
        for exposure_ev in [-1e4, 1e4] {
            let viewing = Viewing { exposure_ev, ..Viewing::default() };
            assert!(flip(&odd, &grey, 20, &viewing).unwrap().map.iter().all(|value| value.is_finite()));
        }
    }

    #[test]
    fn faults_are_named() {
        let fails = |a: usize, b: usize, width, viewing: Viewing| {
            flip(&vec![[0.0; 3]; a], &vec![[0.0; 3]; b], width, &viewing).unwrap_err().to_string()
        };
        assert!(fails(4, 6, 2, at(67.0)).contains("4 and 6 pixels"));
        assert!(fails(0, 0, 2, at(67.0)).contains("0 and 0 pixels"));
        assert_eq!(fails(7, 7, 2, at(67.0)), "images: found 7 pixels, expected whole rows of 2");
        assert!(fails(7, 7, 0, at(67.0)).contains("whole rows of 0"));
        for ppd in [0.9, 1001.0, f64::NAN, f64::INFINITY, -67.0] {
            assert!(fails(4, 4, 2, at(ppd)).contains("expected 1 to 1000"), "{ppd}");
        }
        assert!(fails(4, 4, 2, Viewing { exposure_ev: f64::NAN, ..at(67.0) }).contains("--exposure: found NaN"));
        for ppd in [1.0, 1000.0] {
            assert_eq!(flip(&[[0.5; 3]; 4], &[[0.5; 3]; 4], 2, &at(ppd)).unwrap().map, [0.0; 4]);
        }
    }
}
