//! Sampled footprint tables, and noise on the samples: the weights of splatters that are simpler than ours.
//!
//! *Table.* A splatter that knows its kernel only at `n` entries per sample distance gives sample `l` the weight of the
//! entry nearest to it, `h(round(n (x − l)) / n)`: what lies between two entries gets the value of one of them, so that
//! slopes become stairs, which beat with the texels (aliasing).
//!
//! *Noise on the samples.* The samples of a sheet are displaced by up to half an entry, which turns the stairs into
//! grain. Sample `(k, l)` gives the texel at `(x, y)` the weight
//!
//! ```text
//! h(round(n (x − k) − i) / n) · h(round(n (y − l) − j) / n),   |i|, |j| ≤ ½
//! ```
//!
//! whose mean over the noise `(i, j)` is the kernel, taken as linear between its entries. The weights of a texel are
//! scaled to sum 1, else flat regions would be covered with grain as large as their density. Samples that do not reach
//! the texel stay out of reach. The noise is a hash of the sample's place in its slice and of the sheet, so that
//! pictures do not depend on threads. Such weights are not separable.
//!
//! *Nearest slice.* Across the slices, the samples of the nearest one alone.
//!
//! Source: "High Resolution Image Splatting", IJACEN 2(7), 2014.

use wavesplat_core::Kernel;
use wavesplat_splat::kernel::prefilter;
use wavesplat_splat::kernel::weights::{MAX_TAPS, n_taps, taps, weight};

/// Taps that give the nearest sample, as [`taps`] do: its own weight alone, or, for spline coefficients, the weights on
/// it.
pub fn nearest_sample(kernel: Kernel, x: f64) -> (i64, [f64; MAX_TAPS]) {
    let nearest = (x + 0.5).floor();
    if prefilter::pole(kernel).is_some() { taps(kernel, nearest) } else { (nearest as i64, [1.0, 0.0, 0.0, 0.0]) }
}

/// The taps of a table with `per_sample` entries per sample distance, in the form of [`taps`].
pub fn table_taps(kernel: Kernel, x: f64, per_sample: u32) -> (i64, [f64; MAX_TAPS]) {
    let (first, _) = taps(kernel, x);
    let mut weights = [0.0; MAX_TAPS];
    for (t, w) in weights[..n_taps(kernel)].iter_mut().enumerate() {
        *w = entry(kernel, x - (first + t as i64) as f64, per_sample, 0.0);
    }
    // The sum is 1 but for the Gaussian, which is normalised everywhere.
    let sum: f64 = weights.iter().sum();
    (first, weights.map(|w| w / sum))
}

/// Weight of the entry nearest to a distance. `noise`: displacement of the sample, in entries.
fn entry(kernel: Kernel, distance: f64, per_sample: u32, noise: f64) -> f64 {
    let per_sample = f64::from(per_sample);
    weight(kernel, (distance * per_sample - noise + 0.5).floor() / per_sample)
}

/// Smallest sum of noisy weights: where negative weights leave less by chance, there is no noise.
const MIN_SUM: f64 = 0.25;

/// The samples that reach a texel and their weights, row by row along v.
#[derive(Clone, Copy, Debug)]
pub struct NoisyTaps {
    /// The first sample along u and v.
    pub first: [i64; 2],
    /// Weights of sum 1, `[v][u]`.
    pub weights: [[f64; MAX_TAPS]; MAX_TAPS],
}

impl NoisyTaps {
    /// Taps at a position, both coordinates `≥ 0`, of the sheet with a [`sheet_number`].
    pub fn new(kernel: Kernel, at: [f64; 2], per_sample: u32, sheet: i64) -> Self {
        let (mut noisy, mut sum) = Self::not_scaled(kernel, at, per_sample, |sample| displacement(sheet, sample));
        if sum < MIN_SUM {
            (noisy, sum) = Self::not_scaled(kernel, at, per_sample, |_| [0.0; 2]);
        }
        noisy.weights.as_flattened_mut().iter_mut().for_each(|weight| *weight /= sum);
        noisy
    }

    /// The weights before they are scaled, and their sum.
    fn not_scaled(
        kernel: Kernel,
        at: [f64; 2],
        per_sample: u32,
        displacement: impl Fn([i64; 2]) -> [f64; 2],
    ) -> (Self, f64) {
        let first = at.map(|x| taps(kernel, x).0);
        let mut weights = [[0.0; MAX_TAPS]; MAX_TAPS];
        let mut sum = 0.0;
        for (v, row) in (first[1]..).zip(&mut weights[..n_taps(kernel)]) {
            for (u, weight) in (first[0]..).zip(&mut row[..n_taps(kernel)]) {
                let [i, j] = displacement([u, v]);
                *weight =
                    entry(kernel, at[0] - u as f64, per_sample, i) * entry(kernel, at[1] - v as f64, per_sample, j);
                sum += *weight;
            }
        }
        (Self { first, weights }, sum)
    }
}

/// Number by which the noise distinguishes the sheet at `w`.
pub fn sheet_number(w: f64) -> i64 {
    // 4096 numbers per slice distance, so that sheets differ however close they lie.
    (w * 4096.0).round() as i64
}

/// Displacement of a sample along u and v, each `−½..½` entries.
fn displacement(sheet: i64, [u, v]: [i64; 2]) -> [f64; 2] {
    let mixed = mix(mix(mix(sheet as u64) ^ u as u64) ^ v as u64);
    [mixed >> 32, mixed & u64::from(u32::MAX)].map(|half| half as f64 / (1_u64 << 32) as f64 - 0.5)
}

/// A bijection without visible pattern. Source: `SplitMix64` (Steele, Lea, Flood 2014).
fn mix(number: u64) -> u64 {
    let z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavesplat_splat::kernel::weights::overshoot;

    fn along() -> impl Iterator<Item = f64> {
        (0..=997).map(|i| 3.0 + f64::from(i) * 0.003)
    }

    fn positions() -> impl Iterator<Item = [f64; 2]> {
        (0..700).map(|i| [0.613, 0.377].map(|k| (f64::from(i) * k).fract() * 11.0))
    }

    /// At its entries the table is the kernel; between two entries it has the value of one of them.
    #[test]
    fn tables_are_the_kernel_at_their_entries() {
        for (name, kernel) in Kernel::NAMES {
            for per_sample in [2, 3, 8] {
                for x in along() {
                    let at_entry = (x * f64::from(per_sample) + 0.5).floor() / f64::from(per_sample);
                    let dense = |(first, weights): (i64, [f64; MAX_TAPS])| {
                        let mut dense = [0.0; 12];
                        (0..MAX_TAPS).for_each(|t| dense[(first + t as i64) as usize] += weights[t]);
                        dense
                    };
                    let got = dense(table_taps(kernel, x, per_sample));
                    let want = dense(taps(kernel, at_entry));
                    let differs = got.iter().zip(&want).any(|(got, want)| (got - want).abs() > 1e-12);
                    assert!(!differs, "{name} with {per_sample} at {x}: {got:?} for {want:?}");
                }
            }
        }
    }

    #[test]
    fn fine_tables_are_the_kernel() {
        for (name, kernel) in Kernel::NAMES {
            let error = |per_sample| {
                let errors = along().map(|x| {
                    let (got, want) = (table_taps(kernel, x, per_sample).1, taps(kernel, x).1);
                    got.iter().zip(&want).map(|(got, want)| (got - want).abs()).fold(0.0, f64::max)
                });
                errors.fold(0.0, f64::max)
            };
            let (coarse, fine) = (error(4), error(1024));
            // Half an entry, at a slope of at most 1.4; the Gaussian, scaled to sum 1, has less.
            assert!(coarse > 0.05 && fine < 0.5 * STEEPEST / 1024.0, "{name}: {coarse} {fine}");
        }
    }

    #[test]
    fn weights_have_sum_1_and_keep_the_bounds_of_their_kernel() {
        for (name, kernel) in Kernel::NAMES {
            let bound = (1.0 + 2.0 * f64::from(overshoot(kernel))).cbrt();
            for x in along() {
                for (_, taps) in [nearest_sample(kernel, x), table_taps(kernel, x, 2), table_taps(kernel, x, 7)] {
                    let (sum, size) = (taps.iter().sum::<f64>(), taps.iter().map(|w| w.abs()).sum::<f64>());
                    assert!((sum - 1.0).abs() < 1e-12 && size <= bound + 1e-12, "{name} at {x}: {taps:?}");
                }
            }
        }
    }

    #[test]
    fn the_nearest_slice_is_its_samples() {
        for kernel in [Kernel::Linear, Kernel::CatmullRom, Kernel::Gaussian] {
            assert_eq!(nearest_sample(kernel, 3.6), (4, [1.0, 0.0, 0.0, 0.0]));
        }
        let (first, weights) = nearest_sample(Kernel::Bspline3, 3.6);
        assert_eq!(first, 3);
        let want = [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0, 0.0];
        assert!(weights.iter().zip(&want).all(|(got, want)| (got - want).abs() < 1e-15), "{weights:?}");
    }

    /// Flat regions stay flat, and no value leaves the range of the samples where the kernel has no negative weights.
    #[test]
    fn noisy_weights_have_sum_1_and_the_signs_of_their_kernel() {
        for (name, kernel) in Kernel::NAMES {
            for (per_sample, sheet) in [2, 3, 8, 64].into_iter().flat_map(|n| (0..20).map(move |s| (n, s))) {
                for at in positions() {
                    let noisy = NoisyTaps::new(kernel, at, per_sample, sheet);
                    let weights = noisy.weights.as_flattened();
                    assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{name} at {at:?}");
                    assert!(overshoot(kernel) > 0.0 || weights.iter().all(|w| *w >= 0.0), "{name} at {at:?}");
                    let (_, sum) = NoisyTaps::not_scaled(kernel, at, per_sample, |s| displacement(sheet, s));
                    // The Gaussian is not scaled to sum 1 here, and Catmull-Rom can lose more: it falls back to no
                    // noise.
                    assert!(
                        overshoot(kernel) > 0.0 || sum >= MIN_SUM || kernel == Kernel::Gaussian,
                        "{name} at {at:?}: {sum}"
                    );
                }
            }
        }
    }

    /// The mean over many sheets is the kernel, linear between the entries; that is the linear kernel itself.
    #[test]
    fn noise_has_the_kernel_as_its_mean() {
        for at in [[4.1, 5.3], [4.25, 2.5], [7.7, 6.9]] {
            let n = 20_000;
            let value = |sheet| {
                let noisy = NoisyTaps::new(Kernel::Linear, at, 2, sheet);
                let of_row = |row: &[f64; MAX_TAPS]| {
                    (0..MAX_TAPS).map(|u| row[u] * (noisy.first[0] + u as i64) as f64).sum::<f64>()
                };
                noisy.weights.iter().map(of_row).sum::<f64>()
            };
            let values: Vec<f64> = (0..n).map(value).collect();
            let mean = values.iter().sum::<f64>() / n as f64;
            let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
            // Not exactly the kernel, since weights are scaled by their sum; chance leaves a deviation of 0.5 / √n =
            // 0.004.
            assert!((mean - at[0]).abs() < 0.05 && deviation > 0.1, "{at:?}: {mean}, {deviation}");
        }
    }

    /// The largest slope of any kernel, Catmull-Rom's at 5/9 of a sample: 25/18.
    const STEEPEST: f64 = 25.0 / 18.0;

    #[test]
    fn many_entries_are_the_kernel() {
        // A weight along an axis belongs to a place at most one entry away: half by rounding, half by noise. Where the
        // Gaussian is cut off, two samples away, it jumps by exp(−8).
        let apart = STEEPEST / 1024.0 + (-8.0_f64).exp();
        for (name, kernel) in Kernel::NAMES {
            for at in positions() {
                let (noisy, _) = NoisyTaps::not_scaled(kernel, at, 1024, |sample| displacement(3, sample));
                for (v, row) in (noisy.first[1]..).zip(&noisy.weights[..n_taps(kernel)]) {
                    for (u, got) in (noisy.first[0]..).zip(&row[..n_taps(kernel)]) {
                        let [along_u, along_v] = [at[0] - u as f64, at[1] - v as f64].map(|x| weight(kernel, x));
                        let bound = apart * (along_u.abs() + along_v.abs() + apart);
                        let error = (got - along_u * along_v).abs();
                        assert!(error <= bound, "{name} at {at:?}: {error} above {bound}");
                    }
                }
            }
        }
    }

    #[test]
    fn noise_is_even_and_differs_between_samples_and_sheets() {
        let samples = |sheet| (-5..30).flat_map(move |u| (-5..30).map(move |v| displacement(sheet, [u, v])));
        let all: Vec<f64> = (0..20).flat_map(samples).flatten().collect();
        assert!(all.iter().all(|j| (-0.5..0.5).contains(j)));
        let n = all.len() as f64;
        let mean = all.iter().sum::<f64>() / n;
        let variance = all.iter().map(|j| j * j).sum::<f64>() / n;
        let neighbours = all.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / n;
        // Six standard errors of 49 000 draws: √(1/12n), √(1/180n), √(1/144n).
        let [of_mean, of_variance, of_neighbours] = [12.0, 180.0, 144.0].map(|k: f64| 6.0 / (k * n).sqrt());
        assert!(mean.abs() < of_mean && (variance - 1.0 / 12.0).abs() < of_variance, "{mean} {variance}");
        assert!(neighbours.abs() < of_neighbours, "{neighbours}");
    }
}
