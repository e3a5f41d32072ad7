//! Separable filters on planes of numbers: rows, then columns. Beyond an edge its value goes on.

/// One number per pixel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    /// Numbers in a row, at least 1.
    pub width: usize,
    /// A multiple of `width` of them.
    pub values: Vec<f32>,
}

/// Weights of a filter, an odd number of them, the middle one for the pixel itself.
#[derive(Clone, Debug)]
pub(super) struct Weights(Vec<f32>);

impl Weights {
    /// `value(-radius)` to `value(radius)`; the positive ones scaled to add up to 1, the negative ones to -1.
    pub(super) fn new(radius: usize, value: impl Fn(f64) -> f64) -> Self {
        let values: Vec<f64> = (0..=2 * radius).map(|i| value(i as f64 - radius as f64)).collect();
        let positive: f64 = values.iter().map(|v| v.max(0.0)).sum();
        let negative: f64 = values.iter().map(|v| (-v).max(0.0)).sum();
        // Where no weight is positive, zeros stay zeros.
        let scaled = |v: f64| if v >= 0.0 { v / positive.max(f64::MIN_POSITIVE) } else { v / negative };
        Self(values.into_iter().map(|v| scaled(v) as f32).collect())
    }

    fn radius(&self) -> usize {
        self.0.len() / 2
    }
}

impl Plane {
    /// Filtered along rows.
    pub(super) fn across(&self, weights: &Weights) -> Self {
        let radius = weights.radius();
        let mut values = vec![0.0; self.values.len()];
        let mut padded = Vec::with_capacity(self.width + 2 * radius);
        for (from, to) in self.values.chunks_exact(self.width).zip(values.chunks_exact_mut(self.width)) {
            padded.clear();
            padded.extend(std::iter::repeat_n(from[0], radius));
            padded.extend_from_slice(from);
            padded.extend(std::iter::repeat_n(from[self.width - 1], radius));
            for (k, &weight) in weights.0.iter().enumerate() {
                add(to, &padded[k..k + self.width], weight);
            }
        }
        Self { width: self.width, values }
    }

    /// Filtered along columns.
    pub(super) fn down(&self, weights: &Weights) -> Self {
        let radius = weights.radius();
        let height = self.values.len() / self.width;
        let mut values = vec![0.0; self.values.len()];
        for (y, to) in values.chunks_exact_mut(self.width).enumerate() {
            for (k, &weight) in weights.0.iter().enumerate() {
                let from = (y + k).saturating_sub(radius).min(height - 1) * self.width;
                add(to, &self.values[from..from + self.width], weight);
            }
        }
        Self { width: self.width, values }
    }
}

fn add(to: &mut [f32], from: &[f32], weight: f32) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += weight * from);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same by the definition, in f64.
    fn slowly(plane: &Plane, across: &Weights, down: &Weights) -> Vec<f64> {
        let (width, height) = (plane.width as i64, (plane.values.len() / plane.width) as i64);
        let at =
            |x: i64, y: i64| f64::from(plane.values[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize]);
        let term = |weights: &Weights, k: usize| (f64::from(weights.0[k]), k as i64 - weights.radius() as i64);
        let mut out = Vec::new();
        for i in 0..width * height {
            let mut sum = 0.0;
            for (a, dx) in (0..across.0.len()).map(|k| term(across, k)) {
                for (b, dy) in (0..down.0.len()).map(|k| term(down, k)) {
                    sum += a * b * at(i % width + dx, i / width + dy);
                }
            }
            out.push(sum);
        }
        out
    }

    #[test]
    fn rows_then_columns_are_the_filter_in_two_dimensions() {
        let bell = Weights::new(4, |x| (-0.1 * x * x).exp());
        let slope = Weights::new(3, |x| -x * (-0.2 * x * x).exp());
        for (width, height) in [(13, 9), (1, 7), (7, 1), (1, 1), (3, 2)] {
            let values = (0..width * height).map(|i| ((i * 37 % 23) as f32).sin()).collect();
            let plane = Plane { width, values };
            let found = plane.across(&slope).down(&bell);
            for (found, expected) in found.values.iter().zip(slowly(&plane, &slope, &bell)) {
                assert!((f64::from(*found) - expected).abs() < 1e-6, "{width}x{height}: {found} {expected}");
            }
        }
    }

    #[test]
    fn weights_of_each_sign_add_up_to_one() {
        for weights in [Weights::new(9, |x| (-0.1 * x * x).exp()), Weights::new(9, |x| (0.3 * x * x - 1.0) / 2.0)] {
            let sum = |sign: f32| weights.0.iter().map(|w| (sign * w).max(0.0)).sum::<f32>();
            assert!((sum(1.0) - 1.0).abs() < 1e-6 && (sum(-1.0) == 0.0 || (sum(-1.0) - 1.0).abs() < 1e-6));
        }
        assert_eq!(Weights::new(2, |x| x).0[0], -2.0 / 3.0);
        assert_eq!(Weights::new(0, |_| 0.5).0, [1.0]);
        assert_eq!(Weights::new(0, |x| -x).0, [0.0]);
    }
}
