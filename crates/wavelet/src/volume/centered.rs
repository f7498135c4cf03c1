//! Samples less an offset, as they are transformed, so that samples far from 0 keep their digits.
//!
//! A transform in f32 rounds to about 1e-7 of the largest sample, whatever the range: for samples from 10 000 to 10 001
//! the error would be a thousandth of the range. So their middle is subtracted first, in f64, and added to the decoded
//! samples.

use wavesplat_core::{Sample as _, Samples, Statistics, with_samples};

/// Largest magnitude, in ranges of the samples, above which an offset is subtracted. Below, it would win less than
/// three bits, and lose the zeros of empty space, which cost no coefficients.
const MIN_DISTANCE: f64 = 8.0;

/// Samples less an offset, and that offset.
#[derive(Clone, Debug)]
pub struct CenteredSamples {
    pub(super) values: Vec<f32>,
    /// An f32, so that `offset + value` in f32 is the nearest one to the exact sum.
    pub(super) offset: f32,
    /// Smallest and largest sample, before the offset is subtracted.
    pub(super) range: [f64; 2],
}

fn offset_of([lo, hi]: [f64; 2]) -> f32 {
    if lo.abs().max(hi.abs()) > MIN_DISTANCE * (hi - lo) { (0.5 * (lo + hi)) as f32 } else { 0.0 }
}

impl From<Samples<'_>> for CenteredSamples {
    fn from(samples: Samples<'_>) -> Self {
        let Statistics { min, max, .. } = Statistics::of(&samples);
        let range = [min, max];
        let offset = offset_of(range);
        let values = if offset == 0.0 {
            samples.to_f32()
        } else {
            with_samples!(samples, s => s.iter().map(|s| (s.to_f64() - f64::from(offset)) as f32).collect())
        };
        Self { values, offset, range }
    }
}

impl From<Vec<f32>> for CenteredSamples {
    fn from(mut values: Vec<f32>) -> Self {
        let Statistics { min, max, .. } = Statistics::of(&Samples::F32(&values));
        let range = [min, max];
        let offset = offset_of(range);
        if offset != 0.0 {
            for value in &mut values {
                *value = (f64::from(*value) - f64::from(offset)) as f32;
            }
        }
        Self { values, offset, range }
    }
}
