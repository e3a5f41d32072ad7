//! Numbers as colours, for people: perceptually ordered maps. The only file that names `colorous`.

use colorous::{Gradient, INFERNO, MAGMA};

/// What is no number, and no colour of the maps: green.
const NO_NUMBER: [u8; 3] = [0, 255, 0];

/// Which numbers become which colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Relative squared errors on a logarithmic scale: 10^-5 and below black, 1 and above pale yellow (inferno).
    RelativeError,
    /// FLIP from 0, black, to 1, pale yellow (magma), the map of its authors.
    Flip,
}

impl Scale {
    /// Which numbers the ends of the map stand for.
    #[must_use]
    pub fn range(self) -> [f64; 2] {
        match self {
            Self::RelativeError => [1e-5, 1.0],
            Self::Flip => [0.0, 1.0],
        }
    }

    /// The colour of a number as 8-bit sRGB; of NaN and infinity a green that is in no map.
    #[must_use]
    pub fn colour(self, value: f64) -> [u8; 3] {
        if !value.is_finite() {
            return NO_NUMBER;
        }
        let [low, high] = self.range();
        let (map, place): (Gradient, f64) = match self {
            Self::RelativeError => (INFERNO, (value.max(low) / low).ln() / (high / low).ln()),
            Self::Flip => (MAGMA, value),
        };
        let colour = map.eval_continuous(place);
        [colour.r, colour.g, colour.b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_order() {
        let grey = |colour: [u8; 3]| {
            0.2126 * f64::from(colour[0]) + 0.7152 * f64::from(colour[1]) + 0.0722 * f64::from(colour[2])
        };
        for scale in [Scale::RelativeError, Scale::Flip] {
            let [low, high] = scale.range();
            assert!(grey(scale.colour(low)) < 2.0 && grey(scale.colour(high)) > 240.0);
            assert_eq!((scale.colour(-1.0), scale.colour(7.0)), (scale.colour(low), scale.colour(high)));
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                assert_eq!(scale.colour(value), NO_NUMBER);
            }
        }
        // A decade is a fifth of the way; both maps grow lighter all along, but for a code.
        let lightness = |scale: Scale, i: i32| match scale {
            Scale::RelativeError => grey(scale.colour(10_f64.powf(f64::from(i) / 20.0 - 5.0))),
            Scale::Flip => grey(scale.colour(f64::from(i) / 100.0)),
        };
        for scale in [Scale::RelativeError, Scale::Flip] {
            assert!((1..=100).all(|i| lightness(scale, i) > lightness(scale, i - 1) - 1.0), "{scale:?}");
        }
        assert_eq!(Scale::RelativeError.colour(1e-3), {
            let colour = INFERNO.eval_continuous(0.4);
            [colour.r, colour.g, colour.b]
        });
    }
}
