//! Reconstruction kernels h(x): trilinear, Catmull-Rom, B-splines, Gaussian; separable, x in samples.
//!
//! | kernel | h | radius | source |
//! | --- | --- | --- | --- |
//! | linear | `1 − |x|` | 1 | |
//! | catmull-rom | Keys' cubic with a = −½ | 2 | Keys 1981 |
//! | bspline2, bspline3 | centred B-splines of degree 2 and 3 | 1.5, 2 | Unser, Aldroubi, Eden 1993 |
//! | gaussian | `exp(−2x²)`, cut off and normalised to unit sum | 2 | Westover 1990 |
//!
//! The B-splines become interpolating through the prefilter of the samples ([`crate::kernel::prefilter`]). Beyond the
//! first and the last sample the taps repeat the edge sample; prefiltered coefficients are mirrored, as the prefilter
//! assumes, else they would not interpolate at the faces.

use wavesplat_core::Kernel;

/// Largest number of taps of any kernel.
pub const MAX_TAPS: usize = 4;

/// Largest number of taps of a difference footprint.
pub const MAX_DIFFERENCE_TAPS: usize = 3 * MAX_TAPS;

/// Distance beyond which h is 0, samples.
pub fn radius(kernel: Kernel) -> f64 {
    match kernel {
        Kernel::Linear => 1.0,
        Kernel::Bspline2 => 1.5,
        Kernel::CatmullRom | Kernel::Bspline3 | Kernel::Gaussian => 2.0,
    }
}

/// Number of samples that reach a position: twice the radius.
pub fn n_taps(kernel: Kernel) -> usize {
    (2.0 * radius(kernel)) as usize
}

/// h at `x` samples from its centre.
pub fn weight(kernel: Kernel, x: f64) -> f64 {
    let r = x.abs();
    match kernel {
        Kernel::Linear => (1.0 - r).max(0.0),
        Kernel::CatmullRom if r < 1.0 => (1.5 * r - 2.5) * r * r + 1.0,
        Kernel::CatmullRom if r < 2.0 => ((-0.5 * r + 2.5) * r - 4.0) * r + 2.0,
        Kernel::Bspline2 if r < 0.5 => 0.75 - r * r,
        Kernel::Bspline2 if r < 1.5 => 0.5 * (1.5 - r) * (1.5 - r),
        Kernel::Bspline3 if r < 1.0 => 2.0 / 3.0 + r * r * (0.5 * r - 1.0),
        Kernel::Bspline3 if r < 2.0 => (2.0 - r).powi(3) / 6.0,
        Kernel::Gaussian if r < 2.0 => (-2.0 * r * r).exp(),
        _ => 0.0,
    }
}

/// Largest overshoot of a reconstructed value beyond the range of its samples, as a fraction of that range.
///
/// Non-negative weights of sum 1 stay inside. Catmull-Rom has absolute sum at most 5/4 per axis, so at most
/// (125/64 − 1) / 2 on either side for three axes.
pub fn overshoot(kernel: Kernel) -> f32 {
    if kernel == Kernel::CatmullRom { 61.0 / 128.0 } else { 0.0 }
}

/// Taps at position `x ≥ 0`: index of the first sample and the weights, which sum to 1.
///
/// The formulas of [`weight`] at the distances that the taps have, written out: tables are rebuilt for every sheet.
#[inline]
pub fn taps(kernel: Kernel, x: f64) -> (i64, [f64; MAX_TAPS]) {
    let below = x as i64;
    let t = x - below as f64;
    match kernel {
        Kernel::Linear => (below, [1.0 - t, t, 0.0, 0.0]),
        Kernel::CatmullRom => {
            let w0 = ((-0.5 * t + 1.0) * t - 0.5) * t;
            let w1 = (1.5 * t - 2.5) * t * t + 1.0;
            let w3 = (0.5 * t - 0.5) * t * t;
            (below - 1, [w0, w1, 1.0 - w0 - w1 - w3, w3])
        }
        Kernel::Bspline2 => {
            let nearest = (x + 0.5) as i64;
            let t = x - nearest as f64;
            let (w0, w2) = (0.5 * (0.5 - t) * (0.5 - t), 0.5 * (0.5 + t) * (0.5 + t));
            (nearest - 1, [w0, 0.75 - t * t, w2, 0.0])
        }
        Kernel::Bspline3 => {
            let s = 1.0 - t;
            let (w0, w3) = (s * s * s / 6.0, t * t * t / 6.0);
            let w1 = 2.0 / 3.0 + t * t * (0.5 * t - 1.0);
            (below - 1, [w0, w1, 1.0 - w0 - w1 - w3, w3])
        }
        Kernel::Gaussian => {
            // As multiples of exp(−2t²), all four are powers of exp(4t).
            const E2: f64 = 0.135_335_283_236_612_7;
            const E8: f64 = 3.354_626_279_025_118_5e-4;
            let q = (4.0 * t).exp();
            // Two samples away the kernel is cut off.
            let last = if t > 0.0 { E8 * q * q } else { 0.0 };
            let w = [E2 / q, 1.0, E2 * q, last];
            let share = 1.0 / (w[0] + w[1] + w[2] + w[3]);
            (below - 1, [w[0] * share, w[1] * share, w[2] * share, w[3] * share])
        }
    }
}

/// Number of taps before the sample that [`near_taps`] returns.
pub fn reach(kernel: Kernel) -> usize {
    (n_taps(kernel) - 1) / 2
}

/// Taps at position `x ≥ 0` in f32, for loops over neighbouring positions: the first sample plus [`reach`], and the
/// weights. `None` for kernels that have no polynomial.
#[inline(always)]
pub fn near_taps(kernel: Kernel, x: f32) -> Option<(u32, [f32; MAX_TAPS])> {
    let below = x as u32;
    let t = x - below as f32;
    match kernel {
        Kernel::Linear => Some((below, [1.0 - t, t, 0.0, 0.0])),
        Kernel::CatmullRom => {
            let w0 = ((-0.5 * t + 1.0) * t - 0.5) * t;
            let w1 = (1.5 * t - 2.5) * t * t + 1.0;
            let w3 = (0.5 * t - 0.5) * t * t;
            Some((below, [w0, w1, 1.0 - w0 - w1 - w3, w3]))
        }
        Kernel::Bspline2 => {
            let nearest = (x + 0.5) as u32;
            let t = x - nearest as f32;
            let (w0, w2) = (0.5 * (0.5 - t) * (0.5 - t), 0.5 * (0.5 + t) * (0.5 + t));
            Some((nearest, [w0, 1.0 - w0 - w2, w2, 0.0]))
        }
        Kernel::Bspline3 => {
            let s = 1.0 - t;
            let (w0, w3) = (s * s * s / 6.0, t * t * t / 6.0);
            let w1 = 2.0 / 3.0 + t * t * (0.5 * t - 1.0);
            Some((below, [w0, w1, 1.0 - w0 - w1 - w3, w3]))
        }
        Kernel::Gaussian => None,
    }
}

/// Index of the sample that is used at `index`, which may lie beyond the faces of an axis of `n` samples.
#[inline]
pub fn mirror_index(kernel: Kernel, index: i64, n: usize) -> usize {
    let last = n as i64 - 1;
    match kernel {
        Kernel::Bspline2 | Kernel::Bspline3 => {
            let m = index.rem_euclid(2 * last);
            (if m > last { 2 * last - m } else { m }) as usize
        }
        _ => index.clamp(0, last) as usize,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn positions() -> impl Iterator<Item = f64> {
        (0..=400).map(|i| 3.0 + f64::from(i) * 0.01)
    }

    #[test]
    fn taps_are_a_partition_of_unity_and_cover_the_kernel() {
        for (name, kernel) in Kernel::NAMES {
            for x in positions() {
                let (first, weights) = taps(kernel, x);
                assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{name} at {x}");
                let outside = [first - 1, first + n_taps(kernel) as i64];
                assert!(outside.iter().all(|&i| weight(kernel, x - i as f64) < 1e-12), "{name} at {x}");
            }
        }
    }

    #[test]
    fn taps_are_the_kernel_at_their_distances() {
        for (name, kernel) in Kernel::NAMES {
            for x in positions() {
                let (first, weights) = taps(kernel, x);
                let direct: Vec<f64> =
                    (0..n_taps(kernel)).map(|t| weight(kernel, x - (first + t as i64) as f64)).collect();
                let sum: f64 = direct.iter().sum();
                for (w, d) in weights.iter().zip(&direct) {
                    assert!((w - d / sum).abs() < 1e-12, "{name} at {x}");
                }
            }
        }
    }

    #[test]
    fn taps_have_linear_precision() {
        // A ramp is reconstructed exactly by every kernel with vanishing first moment. The cut-off Gaussian is not one.
        for (name, kernel) in Kernel::NAMES.into_iter().filter(|(_, k)| *k != Kernel::Gaussian) {
            for x in positions() {
                let (first, weights) = taps(kernel, x);
                let ramp: f64 = weights.iter().enumerate().map(|(t, w)| w * (first + t as i64) as f64).sum();
                assert!((ramp - x).abs() < 1e-12, "{name} at {x}: {ramp}");
            }
        }
    }

    #[test]
    fn overshoot_bounds_the_absolute_weights() {
        for (name, kernel) in Kernel::NAMES {
            for x in positions() {
                let sum: f64 = taps(kernel, x).1.iter().map(|w| w.abs()).sum();
                assert!((sum.powi(3) - 1.0) / 2.0 <= f64::from(overshoot(kernel)) + 1e-12, "{name} at {x}");
            }
        }
    }

    #[test]
    fn folding_repeats_or_mirrors() {
        let mirrored = |kernel, i| mirror_index(kernel, i, 3);
        assert_eq!([-2, -1, 0, 2, 3, 4].map(|i| mirrored(Kernel::CatmullRom, i)), [0, 0, 0, 2, 2, 2]);
        assert_eq!([-2, -1, 0, 2, 3, 4, 5].map(|i| mirrored(Kernel::Bspline3, i)), [2, 1, 0, 2, 1, 0, 1]);
    }
}
