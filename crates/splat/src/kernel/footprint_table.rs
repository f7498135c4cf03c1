//! Weights of the samples that reach a position: those of the kernel, or of a simpler splatter ([`Variant`]).
//!
//! *Table.* A splatter that knows its kernel only at `n` entries per sample distance gives sample `l` the weight of the
//! entry nearest to it, `h(round(n (x − l)) / n)`: what lies between two entries gets the value of one of them, so that
//! slopes become stairs, which beat with the texels (aliasing). With noise on the samples: [`crate::kernel::noise`].
//!
//! *Nearest.* Across the slices, the samples of the nearest one alone.
//!
//! Source: "High Resolution Image Splatting", IJACEN 2(7), 2014.

use wavesplat_core::{FootprintTable, Kernel, Variant};

use crate::kernel::prefilter;
use crate::kernel::weights::{MAX_TAPS, n_taps, taps, weight};

/// First sample and its weight and that of those after it.
pub type Taps = (i64, [f64; MAX_TAPS]);

/// How the weights along an axis are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// By the kernel.
    Exact,
    /// As at the nearest sample.
    Nearest,
    /// By the nearest entry of a table.
    Table {
        /// Entries per sample distance.
        per_sample: u32,
    },
}

impl Weights {
    /// Within the sheets, noise apart.
    pub fn within(variant: &Variant) -> Self {
        match variant.footprint {
            FootprintTable::Exact => Self::Exact,
            FootprintTable::Nearest { per_sample } | FootprintTable::NearestNoise { per_sample } => {
                Self::Table { per_sample }
            }
        }
    }

    /// Across the slices. One weight serves a whole slice, so a table would save nothing.
    pub fn across(variant: &Variant) -> Self {
        if variant.kernel_slicing { Self::Exact } else { Self::Nearest }
    }

    /// Taps at position `x ≥ 0`, as [`taps`] has them.
    pub fn taps(self, kernel: Kernel, x: f64) -> Taps {
        match self {
            Self::Exact => taps(kernel, x),
            Self::Nearest => at_sample(kernel, x),
            Self::Table { per_sample } => looked_up(kernel, x, f64::from(per_sample)),
        }
    }
}

/// What gives back the nearest sample: its own weight alone, or, of spline coefficients, the weights on it.
fn at_sample(kernel: Kernel, x: f64) -> Taps {
    let nearest = (x + 0.5).floor();
    if prefilter::pole(kernel).is_some() { taps(kernel, nearest) } else { (nearest as i64, [1.0, 0.0, 0.0, 0.0]) }
}

/// Weight of the entry nearest to a distance, of a table with `per_sample` entries per sample distance. `noise`: how far
/// the sample is displaced, in entries.
pub fn entry(kernel: Kernel, distance: f64, per_sample: f64, noise: f64) -> f64 {
    weight(kernel, (distance * per_sample - noise + 0.5).floor() / per_sample)
}

/// Taps by a table.
fn looked_up(kernel: Kernel, x: f64, per_sample: f64) -> Taps {
    let (first, _) = taps(kernel, x);
    let mut weights = [0.0; MAX_TAPS];
    for (t, w) in weights[..n_taps(kernel)].iter_mut().enumerate() {
        *w = entry(kernel, x - (first + t as i64) as f64, per_sample, 0.0);
    }
    // 1 but for the Gaussian, which is normalised everywhere.
    let sum: f64 = weights.iter().sum();
    (first, weights.map(|w| w / sum))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::weights::overshoot;

    fn positions() -> impl Iterator<Item = f64> {
        (0..=997).map(|i| 3.0 + f64::from(i) * 0.003)
    }

    /// At its entries the table is the kernel; between them it is that of one of them.
    #[test]
    fn tables_are_the_kernel_at_their_entries() {
        for (name, kernel) in Kernel::NAMES {
            for per_sample in [2, 3, 8] {
                for x in positions() {
                    let at_entry = (x * f64::from(per_sample) + 0.5).floor() / f64::from(per_sample);
                    let dense = |(first, weights): Taps| {
                        let mut dense = [0.0; 12];
                        (0..MAX_TAPS).for_each(|t| dense[(first + t as i64) as usize] += weights[t]);
                        dense
                    };
                    let got = dense(Weights::Table { per_sample }.taps(kernel, x));
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
                let errors = positions().map(|x| {
                    let (got, want) = (Weights::Table { per_sample }.taps(kernel, x).1, taps(kernel, x).1);
                    got.iter().zip(&want).map(|(got, want)| (got - want).abs()).fold(0.0, f64::max)
                });
                errors.fold(0.0, f64::max)
            };
            let (coarse, fine) = (error(4), error(1024));
            assert!(coarse > 0.05 && fine < 0.001, "{name}: {coarse} {fine}");
        }
    }

    /// What bounds the density of a brick relies on this.
    #[test]
    fn weights_have_sum_1_and_keep_the_bounds_of_their_kernel() {
        for (name, kernel) in Kernel::NAMES {
            let bound = (1.0 + 2.0 * f64::from(overshoot(kernel))).cbrt();
            for weights in [Weights::Nearest, Weights::Table { per_sample: 2 }, Weights::Table { per_sample: 7 }] {
                for x in positions() {
                    let (_, taps) = weights.taps(kernel, x);
                    let (sum, size) = (taps.iter().sum::<f64>(), taps.iter().map(|w| w.abs()).sum::<f64>());
                    assert!((sum - 1.0).abs() < 1e-12 && size <= bound + 1e-12, "{name} {weights:?} at {x}: {taps:?}");
                }
            }
        }
    }

    #[test]
    fn the_nearest_slice_is_its_samples() {
        let nearest = |kernel| Weights::Nearest.taps(kernel, 3.6);
        for kernel in [Kernel::Linear, Kernel::CatmullRom, Kernel::Gaussian] {
            assert_eq!(nearest(kernel), (4, [1.0, 0.0, 0.0, 0.0]));
        }
        let (first, weights) = nearest(Kernel::Bspline3);
        assert_eq!(first, 3);
        let want = [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0, 0.0];
        assert!(weights.iter().zip(&want).all(|(got, want)| (got - want).abs() < 1e-15), "{weights:?}");
    }
}
