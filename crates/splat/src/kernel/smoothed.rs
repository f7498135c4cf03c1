//! Smoothed gradients: the derivative of the samples under a cubic B-spline that is widened to a standard deviation.
//!
//! Samples are weighted by the B-spline's derivative along the axis of a derivative, and by the B-spline itself across
//! it. Widened B-splines do not sum to 1 everywhere, so the sum is divided by the sum of the weights, and its
//! derivative follows by the quotient rule. Differences show the steps of voxels on smooth surfaces as rings; this does
//! not.

use wavesplat_compute::simd::{LANES, Lanes};
use wavesplat_core::Kernel;

use crate::kernel::weights::MAX_DIFFERENCE_TAPS;

/// Width of the cubic B-spline with a standard deviation, in samples per unit of its argument. Prefiltered coefficients
/// are sharper than the samples by the variance of their kernel, which is added.
pub fn width_of(kernel: Kernel, deviation: f64) -> f64 {
    let of_coefficients = match kernel {
        Kernel::Bspline2 => 3.0 / 12.0,
        Kernel::Bspline3 => 4.0 / 12.0,
        _ => 0.0,
    };
    // The variance of the cubic B-spline is 4 / 12.
    (3.0 * (deviation * deviation + of_coefficients)).sqrt()
}

/// Taps of the smoothed value and derivative at a position; the first may lie beyond the border.
pub fn taps(kernel: Kernel, x: f64, deviation: f64) -> (i64, [[f64; MAX_DIFFERENCE_TAPS]; 2]) {
    let width = width_of(kernel, deviation);
    let first = (x - 2.0 * width).floor() as i64 + 1;
    let [mut value, mut derivative] = [[0.0; MAX_DIFFERENCE_TAPS]; 2];
    for t in 0..MAX_DIFFERENCE_TAPS {
        let distance = (x - (first + t as i64) as f64) / width;
        [value[t], derivative[t]] = bspline3(distance);
    }
    let [sum, slope] = [&value, &derivative].map(|weights| weights.iter().sum::<f64>());
    for t in 0..MAX_DIFFERENCE_TAPS {
        value[t] /= sum;
        derivative[t] = (derivative[t] - slope * value[t]) / (sum * width);
    }
    (first, [value, derivative])
}

/// Writes the weights of smoothed values and of derivatives, tap by tap, for positions counted from the first tap in
/// widths.
#[inline(always)]
pub fn fill(position: &Lanes, per_width: f32, values: &mut [Lanes], slopes: &mut [Lanes]) {
    let [mut sum, mut slope] = [Lanes::<f32>::default(); 2];
    for (t, (values, slopes)) in values.iter_mut().zip(&mut *slopes).enumerate() {
        let before = t as f32 * per_width;
        for i in 0..LANES {
            let [v, d] = bspline3_f32(position.0[i] - before);
            values.0[i] = v;
            slopes.0[i] = d;
            sum.0[i] += v;
            slope.0[i] += d;
        }
    }
    let mut share = Lanes::<f32>::default();
    for i in 0..LANES {
        share.0[i] = 1.0 / sum.0[i];
    }
    for (values, slopes) in values.iter_mut().zip(slopes) {
        for i in 0..LANES {
            let value = values.0[i] * share.0[i];
            values.0[i] = value;
            slopes.0[i] = (slopes.0[i] - slope.0[i] * value) * share.0[i] * per_width;
        }
    }
}

/// The cubic B-spline and its derivative.
fn bspline3(x: f64) -> [f64; 2] {
    let r = x.abs();
    let [value, slope] = if r < 1.0 {
        [2.0 / 3.0 + r * r * (0.5 * r - 1.0), r * (1.5 * r - 2.0)]
    } else {
        let rest = (2.0 - r).max(0.0);
        [rest * rest * rest / 6.0, -0.5 * rest * rest]
    };
    [value, if x < 0.0 { -slope } else { slope }]
}

/// [`bspline3`] in f32, without branches.
#[inline(always)]
fn bspline3_f32(x: f32) -> [f32; 2] {
    let r = x.abs();
    let rest = if r < 2.0 { 2.0 - r } else { 0.0 };
    let is_near = r < 1.0;
    let value = if is_near { 2.0 / 3.0 + r * r * (0.5 * r - 1.0) } else { rest * rest * rest * (1.0 / 6.0) };
    let slope = if is_near { r * (1.5 * r - 2.0) } else { -0.5 * rest * rest };
    [value, if x < 0.0 { -slope } else { slope }]
}

#[cfg(test)]
mod tests {
    use wavesplat_core::Gradient;

    use super::*;
    use crate::kernel::footprint::{Axis, AxisFootprints};
    use crate::kernel::footprint_table::Footprint;

    /// Widened B-splines have the mass, the slope on a ramp and the standard deviation that they are named by.
    #[test]
    fn smoothed_gradients_are_of_a_b_spline_with_a_standard_deviation() {
        for (name, kernel) in Kernel::NAMES {
            for deviation in [0.5, 0.8, 1.25] {
                let axis = Axis { kernel, n_samples: 40, gradient: Some(Gradient::Smoothed(deviation)) };
                let mut tables = AxisFootprints::default();
                tables.build(&axis, [15.3, 0.083], 2, 0b11);
                tables.make_difference();
                let dense = |table: &Footprint, i: usize| {
                    let mut dense = [0.0; 40];
                    for t in 0..table.n_taps {
                        let sample = (tables.window[0] + (table.first(i) + t) as i64) as usize;
                        dense[sample] += f64::from(table.weight(i, t));
                    }
                    dense
                };
                let mut variance = 0.0;
                for i in 0..2 * LANES {
                    let x = 15.3 + 0.083 * i as f64;
                    let [value, slope] = [&tables.smooth, &tables.difference].map(|table| dense(table, i));
                    let moment = |weights: &[f64; 40], power: i32| {
                        let terms = weights.iter().enumerate().map(|(k, weight)| weight * (k as f64 - x).powi(power));
                        terms.sum::<f64>()
                    };
                    assert!((moment(&value, 0) - 1.0).abs() < 1e-5 && moment(&slope, 0).abs() < 1e-5, "{name}");
                    let of_ramp = moment(&slope, 1);
                    assert!((of_ramp - 1.0).abs() < 0.06, "{name} {deviation}: a ramp has slope {of_ramp}");
                    variance += moment(&value, 2) / (2 * LANES) as f64;
                    let (first, want) = taps(kernel, x, deviation);
                    for (t, (v, d)) in want[0].iter().zip(&want[1]).enumerate() {
                        let sample = (first + t as i64) as usize;
                        let differs = (v - value[sample]).abs().max((d - slope[sample]).abs()) > 2e-5;
                        assert!(!differs, "{name} {deviation} texel {i}: both ways give the same weights");
                    }
                }
                let wanted = width_of(kernel, deviation).powi(2) / 3.0;
                assert!((variance / wanted - 1.0).abs() < 0.05, "{name} {deviation}: {variance} for {wanted}");
            }
        }
    }
}
