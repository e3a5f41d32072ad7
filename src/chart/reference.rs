//! What images are held against.

use crate::error::{Error, Result};
use crate::film::Image;
use crate::report::errors::rel_mse_of_noisy_reference;
use crate::report::{Figure, Viewing, errors, flip};

/// An image without visible noise, or two independent ones whose mean it is: then what its noise adds to squared errors
/// is known, and taken off.
#[derive(Clone, Debug)]
pub struct Reference {
    image: Image,
    halves: Option<Halves>,
}

#[derive(Clone, Debug)]
struct Halves {
    images: [Image; 2],
    /// What the noise of their mean adds to every MSE.
    mse: f64,
}

/// Errors of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Relative mean squared error.
    pub rel_mse: Figure,
    /// Mean squared error.
    pub mse: f64,
    /// Mean FLIP; the reference's noise is not taken off.
    pub flip: f64,
}

impl Reference {
    /// An image that is taken as it is.
    ///
    /// # Errors
    /// [`Error::Images`] where no pixel of it is finite.
    pub fn whole(image: Image) -> Result<Self> {
        match image.pixels.as_flattened().iter().any(|c| c.is_finite()) {
            true => Ok(Self { image, halves: None }),
            false => Err(Error::Images {
                found: "a reference without a finite pixel".to_owned(),
                expected: "an image".to_owned(),
            }),
        }
    }
    /// Two independent images of as many samples each.
    ///
    /// # Errors
    /// [`Error::Images`] where their sizes differ, or no pixel is finite in both.
    pub fn halves(halves: [Image; 2]) -> Result<Self> {
        let [a, b] = &halves;
        check_size(a, b)?;
        let pixels = a.pixels.iter().zip(&b.pixels).map(|(a, b)| std::array::from_fn(|k| 0.5 * (a[k] + b[k])));
        let image = Image { width: a.width, height: a.height, pixels: pixels.collect() };
        let whole = Self::whole(image)?;
        // ((a - b) / 2)^2 is an unbiased estimate of the variance of the mean of two halves.
        let mse = errors(&a.pixels, &b.pixels)?.mse.raw / 4.0;
        Ok(Self { halves: Some(Halves { images: halves, mse }), ..whole })
    }
    /// The image: the mean of both halves where there are two.
    pub fn image(&self) -> &Image {
        &self.image
    }
    /// Its own relMSE, where that is known.
    pub fn noise(&self) -> Option<f64> {
        let [a, b] = &self.halves.as_ref()?.images;
        // The mean's distance from itself is 0, less what the noise adds.
        rel_mse_of_noisy_reference(&self.image.pixels, [&a.pixels, &b.pixels]).ok().map(|figure| -figure.raw)
    }
    /// Errors of an image.
    ///
    /// # Errors
    /// [`Error::Images`] where it is of another size, or no pixel is finite in both.
    pub fn measure(&self, image: &Image) -> Result<Measured> {
        check_size(image, &self.image)?;
        let found = errors(&image.pixels, &self.image.pixels)?;
        let flip = flip(&image.pixels, &self.image.pixels, image.width as usize, &Viewing::default())?;
        let mut measured = Measured { rel_mse: found.rel_mse, mse: found.mse.raw, flip: flip.mean.raw };
        if let Some(Halves { images: [a, b], mse }) = &self.halves {
            measured.rel_mse = rel_mse_of_noisy_reference(&image.pixels, [&a.pixels, &b.pixels])?;
            measured.mse -= mse;
        }
        Ok(measured)
    }
}

fn check_size(image: &Image, reference: &Image) -> Result<()> {
    let size = |image: &Image| format!("{}x{}", image.width, image.height);
    if (image.width, image.height) == (reference.width, reference.height) {
        return Ok(());
    }
    Err(Error::Images {
        found: format!("{} pixels", size(image)),
        expected: format!("{} as the reference", size(reference)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::SplitMix64;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    const SIDE: u32 = 64;

    /// 1 with uniform noise of up to `width` up and down, whose variance is `width`^2 / 3.
    fn noisy(width: f64, seed: u64) -> Image {
        let mut random = SplitMix64::seed_from_u64(seed);
        let mut value = || (1.0 + width * (random.next_u64() as f64 / 2f64.powi(63) - 1.0)) as f32;
        Image { width: SIDE, height: SIDE, pixels: (0..SIDE * SIDE).map(|_| [value(), value(), value()]).collect() }
    }

    /// Noise of image and halves has variance v = w^2 / 3. With e, a and b for their noise, a term of the corrected MSE is
    /// e^2 - e (a + b) + a b: its mean is v, and its variance is w^4 (1/5 - 1/9) + 3 v^2. Taken over 12288 values, at a level
    /// of 10^-3.
    #[test]
    fn the_noise_of_the_reference_is_taken_off() {
        let w = 0.05_f64;
        let v = w * w / 3.0;
        let deviation = ((w.powi(4) * (1.0 / 5.0 - 1.0 / 9.0) + 3.0 * v * v) / f64::from(3 * SIDE * SIDE)).sqrt();
        let reference = Reference::halves([noisy(w, 1), noisy(w, 2)]).unwrap();
        let found = reference.measure(&noisy(w, 3)).unwrap();
        assert!((found.mse - v).abs() < 3.29 * deviation, "{} expected {v} +- {deviation}", found.mse);
        // About a reference of 1, relMSE is MSE / 1.01; the noise in R^2 adds v^2, which is less than a tenth of the rest.
        assert!((found.rel_mse.raw - v / 1.01).abs() < 3.6 * deviation, "{found:?}");
        assert!((reference.noise().unwrap() - v / 2.0).abs() < 0.05 * v, "{:?}", reference.noise());
        // Without the halves, half of v is added to it: 28 deviations.
        let whole = Reference::whole(reference.image().clone()).unwrap();
        let raw = whole.measure(&noisy(w, 3)).unwrap().mse;
        assert!(raw > v + 20.0 * deviation, "{raw}");
        assert_eq!(whole.noise(), None);
    }

    #[test]
    fn images_must_fit() {
        let flat = |width, height| Image { width, height, pixels: vec![[0.5; 3]; (width * height) as usize] };
        let same = Reference::whole(flat(4, 2)).unwrap().measure(&flat(4, 2)).unwrap();
        assert_eq!((same.rel_mse.raw, same.mse, same.flip), (0.0, 0.0, 0.0));
        let error = Reference::whole(flat(4, 2)).unwrap().measure(&flat(2, 4)).unwrap_err();
        assert!(error.to_string().contains("2x4 pixels") && error.to_string().contains("4x2"), "{error}");
        assert!(Reference::halves([flat(4, 2), flat(2, 4)]).is_err());
        let broken = Image { pixels: vec![[f32::NAN; 3]; 8], ..flat(4, 2) };
        assert!(Reference::whole(broken.clone()).is_err());
        assert!(Reference::halves([flat(4, 2), broken]).is_err());
    }
}
