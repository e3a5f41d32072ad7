//! Colours as FLIP needs them: opponent channels to blur in, and CIELAB to measure distances in.
//!
//! X, Y and Z are relative to the white point throughout, so that white is (1, 1, 1).

/// From linear RGB to (X, Y, Z) over white: Rec. 709 primaries, and the white of the CIE's table of D65, (0.950428545, 1,
/// 1.088900371), which FLIP's authors use.
const TO_XYZ: [[f32; 3]; 3] = [
    [0.433_895_4, 0.376_242_37, 0.189_862_24],
    [0.212_636_82, 0.715_183, 0.072_180_2],
    [0.017_752_423, 0.109_465_63, 0.872_781_95],
];

/// The inverse of [`TO_XYZ`].
const FROM_XYZ: [[f32; 3]; 3] = [
    [3.080_342, -1.537_399, -0.542_943],
    [-0.921_178_4, 1.875_93, 0.045_248_41],
    [0.052_881_293, -0.204_011_2, 1.151_129_9],
];

/// Y, X - Y and Y - Z of linear RGB: the channels of YCxCz, the linearised CIELAB (Flohr et al. 1993), but for their
/// scales and a shift, through which filters of weight 1 pass.
pub(super) fn opponents(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = product(&TO_XYZ, rgb);
    [y, x - y, y - z]
}

/// Linear RGB of [`opponents`], limited to [0, 1], as CIELAB.
pub(super) fn lab([y, x_y, y_z]: [f32; 3]) -> [f32; 3] {
    lab_of_rgb(product(&FROM_XYZ, [y + x_y, y, y - y_z]).map(|c| c.clamp(0.0, 1.0)))
}

/// CIELAB of linear RGB (CIE 15: L* from 0 to 100).
pub(super) fn lab_of_rgb(rgb: [f32; 3]) -> [f32; 3] {
    const KNEE: f32 = 6.0 / 29.0;
    let [x, y, z] = product(&TO_XYZ, rgb)
        .map(|t| if t > KNEE * KNEE * KNEE { t.cbrt() } else { t / (3.0 * KNEE * KNEE) + 4.0 / 29.0 });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn product(m: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: [f32; 3], expected: [f32; 3], within: f32) {
        let close = found.iter().zip(&expected).all(|(f, e)| (f - e).abs() <= within);
        assert!(close, "found {found:?}, expected {expected:?}");
    }

    #[test]
    fn the_matrices_are_inverse() {
        for i in 0..3 {
            let mut unit = [0.0; 3];
            unit[i] = 1.0;
            near(product(&FROM_XYZ, product(&TO_XYZ, unit)), unit, 1e-6);
        }
    }

    #[test]
    fn white_and_primaries() {
        near(opponents([1.0; 3]), [1.0, 0.0, 0.0], 1e-6);
        near(lab_of_rgb([1.0; 3]), [100.0, 0.0, 0.0], 1e-3);
        near(lab_of_rgb([0.0; 3]), [0.0; 3], 1e-4);
        // Published CIELAB values of the sRGB primaries for D65.
        near(lab_of_rgb([1.0, 0.0, 0.0]), [53.24, 80.09, 67.20], 0.03);
        near(lab_of_rgb([0.0, 1.0, 0.0]), [87.73, -86.18, 83.18], 0.03);
        near(lab_of_rgb([0.0, 0.0, 1.0]), [32.30, 79.19, -107.86], 0.03);
    }

    #[test]
    fn what_no_screen_shows_is_limited() {
        for rgb in [[0.25, 0.5, 0.125], [0.0, 1.0, 0.001]] {
            near(lab(opponents(rgb)), lab_of_rgb(rgb), 1e-3);
        }
        near(lab(opponents([2.0, -1.0, 0.5])), lab_of_rgb([1.0, 0.0, 0.5]), 1e-3);
    }
}
