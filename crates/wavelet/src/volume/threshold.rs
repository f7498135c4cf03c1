//! Wavelet thresholding: the smallest amplitude that is kept, by share of the coefficients or by PSNR.
//!
//! Coefficients whose amplitude ([`Norm`]) is below the threshold become 0 (hard thresholding).

use wavesplat_compute::{extent, parallel};

use crate::transform::norm::{Norm, for_each_row, for_each_row_of_slice};
use crate::transform::plan::TransformPlan;
use crate::transform::separable::synthesise;

/// Bisection steps of the search for a threshold: they narrow an interval of 17 in the logarithm to a thousandth.
const N_BISECTIONS: usize = 14;

/// Bits of half an f32.
const HALF: u32 = 16;

/// Number of runs of slices over which amplitudes are gathered in parallel.
const N_RUNS: usize = 16;

/// Sets coefficients to 0 whose amplitude is below a threshold.
pub fn drop_below(plan: &TransformPlan, norm: Norm, threshold: f64, coefficients: &mut [f32]) {
    for_each_row(plan, norm, coefficients, |row, norms| {
        for (c, norm) in row.iter_mut().zip(norms.iter()) {
            if f64::from(amplitude(*c, norm)) < threshold {
                *c = 0.0;
            }
        }
    });
}

fn amplitude(coefficient: f32, norm: f64) -> f32 {
    (coefficient * norm as f32).abs()
}

/// Folds all amplitudes by `add`, one result per run of slices.
fn fold_amplitudes<T: Send>(
    plan: &TransformPlan,
    norm: Norm,
    coefficients: &[f32],
    zero: impl Fn() -> T + Sync + Send,
    add: impl Fn(&mut T, f32) + Sync + Send,
) -> Vec<T> {
    let [nx, ny, nz] = plan.size();
    let n_runs = nz.min(N_RUNS);
    parallel::map(n_runs, |run| {
        let mut sum = zero();
        for z in run * nz / n_runs..(run + 1) * nz / n_runs {
            let slice = &coefficients[z * nx * ny..][..nx * ny];
            for_each_row_of_slice(plan, norm, z, |first, norms| {
                slice[first..].iter().zip(norms.iter()).for_each(|(c, norm)| add(&mut sum, amplitude(*c, norm)));
            });
        }
        sum
    })
}

/// Amplitude that this share of the coefficients reaches. f32 of 0 or more have the order of their bits, so this is a
/// radix selection: a histogram gives the upper half of the bits, and one of the amplitudes with that half the lower.
pub fn threshold_of_fraction(plan: &TransformPlan, norm: Norm, coefficients: &[f32], fraction: f64) -> f64 {
    let n_kept = (fraction * coefficients.len() as f64).round() as usize;
    if n_kept == 0 {
        return f64::INFINITY;
    }
    let mut left = n_kept.min(coefficients.len());
    let mut bits = 0;
    for shift in [HALF, 0] {
        let counts = fold_amplitudes(
            plan,
            norm,
            coefficients,
            || vec![0_usize; 1 << HALF],
            |counts, amplitude| {
                let own = amplitude.to_bits();
                if shift == HALF || own >> HALF == bits >> HALF {
                    counts[(own >> shift) as usize & ((1 << HALF) - 1)] += 1;
                }
            },
        );
        for half in (0..1 << HALF).rev() {
            let n: usize = counts.iter().map(|counts| counts[half]).sum();
            if n >= left {
                bits |= (half as u32) << shift;
                break;
            }
            left -= n;
        }
    }
    f64::from(f32::from_bits(bits))
}

/// A threshold, and the PSNR of the samples from the coefficients it keeps, dB.
#[derive(Clone, Copy, Debug)]
pub struct ThresholdOfPsnr {
    pub threshold: f64,
    pub psnr_db: f64,
}

/// Largest threshold, to a thousandth, that reaches a PSNR; 0, and the PSNR it gives, where none does. `offset`: added
/// to the samples when they are decoded, which rounds them.
pub fn threshold_of_psnr(
    plan: &TransformPlan,
    norm: Norm,
    coefficients: &[f32],
    samples: &[f32],
    offset: f32,
    psnr_db: f64,
) -> ThresholdOfPsnr {
    let [lo, hi] = extent::of(samples);
    let square_range = f64::from(hi - lo).powi(2);
    let mut kept = coefficients.to_vec();
    let mut psnr_of = |threshold: f64| {
        kept.copy_from_slice(coefficients);
        drop_below(plan, norm, threshold, &mut kept);
        synthesise(plan, &mut kept);
        let error = |(a, b): (&f32, &f32)| f64::from(a + offset) - f64::from(offset) - f64::from(*b);
        let square: f64 = kept.iter().zip(samples).map(|pair| error(pair).powi(2)).sum();
        if square == 0.0 { f64::INFINITY } else { 10.0 * (square_range * samples.len() as f64 / square).log10() }
    };
    let largest = fold_amplitudes(plan, norm, coefficients, || 0.0_f32, |all, a| *all = all.max(a));
    let largest = largest.into_iter().fold(0.0_f32, f32::max);
    // In the logarithm, since amplitudes span many orders.
    let (mut below, mut above) = (1e-7_f64.ln(), 2.0_f64.ln());
    let threshold = |t: f64| f64::from(largest) * t.exp();
    let mut reached_db = psnr_of(threshold(below));
    if reached_db < psnr_db {
        return ThresholdOfPsnr { threshold: 0.0, psnr_db: psnr_of(0.0) };
    }
    for _ in 0..N_BISECTIONS {
        let middle = 0.5 * (below + above);
        let found_db = psnr_of(threshold(middle));
        if found_db >= psnr_db {
            (below, reached_db) = (middle, found_db);
        } else {
            above = middle;
        }
    }
    ThresholdOfPsnr { threshold: threshold(below), psnr_db: reached_db }
}
