//! Multiple importance sampling: the one weight of the whole program.

use crate::lanes::Lanes;

/// Weight of a sample from a technique of density `pdf` when another technique has density `other` there: the power
/// heuristic with exponent 2 (Veach 1997, equation 9.13). An infinite `pdf` (a delta lobe) has weight 1, a `pdf` of 0
/// (a technique not in use) weight 0 wherever the other one reaches.
#[inline(always)]
pub fn power_heuristic<L: Lanes>(pdf: L, other: L) -> L {
    let ratio = other / pdf.max(L::splat(f32::MIN_POSITIVE));
    L::splat(1.0) / ratio.mul_add(ratio, L::splat(1.0))
}

/// [`power_heuristic`] over `pdf`, from `inverse` = 1 / `pdf`, in one division.
#[inline(always)]
pub fn power_heuristic_over_pdf<L: Lanes>(inverse: L, other: L) -> L {
    let ratio = other * inverse;
    inverse / ratio.mul_add(ratio, L::splat(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_both_techniques_sum_to_one() {
        for (p, q) in [(1.0f32, 1.0), (0.3, 7.0), (1e-10, 1e10), (1e15, 1e-15)] {
            assert!((power_heuristic(p, q) + power_heuristic(q, p) - 1.0).abs() < 1e-6, "{p} {q}");
        }
        for (p, q) in [(1.0f32, 1.0), (0.3, 7.0), (1e-10, 1e10), (1e15, 1e-15), (2.0, 0.0)] {
            let (split, joint) = (power_heuristic(p, q) / p, power_heuristic_over_pdf(1.0 / p, q));
            assert!((split - joint).abs() <= 1e-6 * split, "{p} {q}");
        }
        assert_eq!(power_heuristic_over_pdf(0.0, 3.0), 0.0);
        assert_eq!(power_heuristic(f32::INFINITY, 3.0), 1.0);
        assert_eq!(power_heuristic(2.0, 0.0), 1.0);
        assert_eq!(power_heuristic(0.0, 1e-3), 0.0);
    }
}
