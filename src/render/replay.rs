//! One sample of a pixel, traced again by itself: what a sample that is not finite is made of.

use super::{Renderer, SamplerKind, Settings};
use crate::error::{Error, Result};
use crate::probe::NoProbe;
use crate::sampling::{Sampler, Screen, Sobol, Xoshiro};
use crate::wave::{Context, Counts, Job, Wave};

impl Renderer {
    /// Radiance that sample number `sample` of `pixel` (x, y) adds to a render with these settings, to the bit, whether finite
    /// or not: a render of even effort without a target error, as others share out random numbers in other ways. What light
    /// paths splat is no part of it.
    ///
    /// # Errors
    /// [`Error::Setting`] if a setting is out of its range, or there is no such pixel.
    pub fn sample(&self, settings: &Settings, pixel: [u32; 2], sample: u32) -> Result<[f32; 3]> {
        let size = [self.world.width(), self.world.height()];
        if pixel[0] >= size[0] || pixel[1] >= size[1] {
            return Err(Error::Setting {
                setting: "pixel",
                found: format!("{}, {}", pixel[0], pixel[1]),
                expected: format!("below {}, {}", size[0], size[1]),
            });
        }
        let plan = self.plan(settings)?;
        let (spots, _) = self.survey(&plan, settings)?;
        let cx = self.context(&plan, &spots, settings.seed, Screen::new(size[0], settings.spp));
        let job = Job { pixels: vec![pixel], first_sample: sample, samples: 1, ..Job::default() };
        Ok(match settings.sampler {
            SamplerKind::Xoshiro => trace::<Xoshiro>(&cx, &job),
            SamplerKind::Sobol => trace::<Sobol>(&cx, &job),
        })
    }
}

fn trace<S: Sampler>(cx: &Context<'_>, job: &Job) -> [f32; 3] {
    Wave::<S>::new(cx).run(cx, job, &mut NoProbe, &mut Counts::default())[0]
}

#[cfg(test)]
mod tests {
    use super::super::Control;
    use super::super::closed_forms::{floor, lamp, patch, seen};
    use super::*;
    use crate::film::Pixel;
    use crate::world::MaterialInput;

    #[test]
    fn samples_by_themselves_add_up_to_the_render() {
        let light = patch([0.4, 0.0, 0.6], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0]);
        let mirror = patch([-1.0, 0.0, 1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.99]);
        let mirror = (mirror.mesh(), [-1.0, 0.0, 1.0].into(), MaterialInput::Specular { color: [0.8; 3] });
        let lit = (light.mesh(), [0.4, 0.0, 0.6].into(), lamp(5.0));
        let renderer = seen(&[lit, floor(0.7), mirror], [0.1, 0.2, 0.0].into(), 0.5);
        for sampler in [SamplerKind::Xoshiro, SamplerKind::Sobol] {
            // No light paths: what they splat is no part of a sample.
            let settings = Settings { sampler, spp: 8, seed: 3, light_paths: 0.0, ..Settings::default() };
            let film = renderer.render(&settings, &Control::default()).unwrap().film;
            for at in [[0, 0], [15, 0], [7, 9]] {
                let mut pixel = Pixel::default();
                (0..8).for_each(|i| _ = pixel.add(renderer.sample(&settings, at, i).unwrap()));
                assert_eq!(pixel, film.pixels()[(at[1] * 16 + at[0]) as usize], "{sampler:?}, {at:?}");
                assert!(pixel.sum2[0] > 0.0);
            }
            let error = renderer.sample(&settings, [16, 0], 0).unwrap_err().to_string();
            assert!(error.contains("16, 0") && error.contains("below 16, 16"), "{error}");
        }
    }
}
