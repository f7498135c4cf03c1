//! Noise on the samples: texels of a sheet by a footprint table whose samples are displaced by up to half an entry.
//!
//! Sample `(k, l)` of a sheet gives the texel at `(x, y)` the weight
//!
//! ```text
//! h(round(n (x − k) − i) / n) · h(round(n (y − l) − j) / n),   |i|, |j| ≤ ½
//! ```
//!
//! whose mean over the noise `(i, j)` is the kernel, taken as linear between its entries: the stairs that a table makes
//! of slopes ([`crate::kernel::footprint_table`]) become grain. The weights of a texel are scaled to sum 1, else what is flat would be
//! covered with grain as large as its density. Samples that do not reach the texel stay out of reach.
//!
//! The noise is a hash of the sample's place in its slice and of the sheet, so pictures do not depend on threads or
//! tiles. Such weights are not separable: texels are splatted one by one, an order of magnitude slower than sheets are.
//! This is for studies. Source: "High Resolution Image Splatting", IJACEN 2(7), 2014.

use wavesplat_core::{FootprintTable, Kernel, Variant};

use crate::kernel::footprint::{Axis, Difference};
use crate::kernel::footprint_table::entry;
use crate::kernel::weights::{n_taps, overshoot, taps};

/// Entries per sample distance, where a variant has noise.
pub fn noisy_entries(variant: &Variant) -> Option<u32> {
    if let FootprintTable::NearestNoise { per_sample } = variant.footprint { Some(per_sample) } else { None }
}

/// Whether densities stay within the bounds that the kernel's weights keep: not where noise scales up negative ones.
pub fn keeps_bounds(variant: &Variant, kernel: Kernel) -> bool {
    noisy_entries(variant).is_none() || overshoot(kernel) == 0.0
}

/// The number that noise tells the sheet at `w` by.
pub fn sheet_number(w: f64) -> i64 {
    // Many per sheet, however close they lie.
    (w * 4096.0).round() as i64
}

/// Displacement of a sample along u and v, each `−½..½` entries.
pub fn displacement(sheet: i64, [u, v]: [i64; 2]) -> [f64; 2] {
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

/// Where chance leaves weights with a smaller sum, which takes negative ones, there is no noise.
pub const LEAST_SUM: f64 = 0.25;

/// One sheet's noisy texels.
#[derive(Clone, Copy, Debug)]
pub struct NoisySheet<'a> {
    /// Along u and v.
    pub axes: [&'a Axis; 2],
    /// Entries per sample distance.
    pub per_sample: u32,
    /// [`sheet_number`]
    pub sheet: i64,
    /// The samples that `samples` begin with, and how many a row has room for.
    pub first: [i64; 2],
    /// See `first`.
    pub stride: usize,
}

impl NoisySheet<'_> {
    /// Value at a position.
    pub fn value(&self, samples: &[f32], at: [f64; 2]) -> f64 {
        let [mut value, mut sum] = [0.0; 2];
        self.each(at, true, |place, weight| {
            value += weight * f64::from(samples[place]);
            sum += weight;
        });
        if sum < LEAST_SUM {
            [value, sum] = [0.0; 2];
            self.each(at, false, |place, weight| {
                value += weight * f64::from(samples[place]);
                sum += weight;
            });
        }
        value / sum
    }

    /// Derivative along u (0) or v (1) at a position.
    pub fn derivative(&self, samples: &[f32], at: [f64; 2], axis: usize, difference: Difference) -> f64 {
        let value = |offset: f64| {
            let mut at = at;
            at[axis] += offset;
            self.value(samples, at)
        };
        let [from, to] = difference.ends();
        (value(to) - value(from)) / (to - from)
    }

    /// Whether a position reaches a sample that is not 0.
    pub fn reaches(&self, samples: &[f32], at: [f64; 2]) -> bool {
        let mut reaches = false;
        self.each(at, true, |place, weight| reaches |= weight != 0.0 && samples[place] != 0.0);
        reaches
    }

    /// The samples that reach a position, by their places, and their weights.
    fn each(&self, at: [f64; 2], is_noisy: bool, mut add: impl FnMut(usize, f64)) {
        let kernel = self.axes[0].kernel;
        let [x, y] = [0, 1].map(|a| at[a].clamp(0.0, self.axes[a].last()));
        let (u, v) = (taps(kernel, x).0, taps(kernel, y).0);
        let per_sample = f64::from(self.per_sample);
        for sample_v in v..v + n_taps(kernel) as i64 {
            let row = (sample_v - self.first[1]) as usize * self.stride;
            for sample_u in u..u + n_taps(kernel) as i64 {
                let [i, j] = if is_noisy { displacement(self.sheet, [sample_u, sample_v]) } else { [0.0; 2] };
                let weight_u = entry(kernel, x - sample_u as f64, per_sample, i);
                let weight_v = entry(kernel, y - sample_v as f64, per_sample, j);
                add(row + (sample_u - self.first[0]) as usize, weight_u * weight_v);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::footprint_table::Weights;

    fn axis(kernel: Kernel) -> Axis {
        Axis { kernel, n_samples: 12, difference: None, weights: Weights::Exact }
    }

    fn sheet(axis: &Axis, per_sample: u32, sheet: i64) -> NoisySheet<'_> {
        NoisySheet { axes: [axis; 2], per_sample, sheet, first: [-2; 2], stride: 16 }
    }

    fn positions() -> impl Iterator<Item = [f64; 2]> {
        (0..700).map(|i| [0.613, 0.377].map(|k| (f64::from(i) * k).fract() * 11.0))
    }

    #[test]
    fn what_is_flat_stays_flat_and_nothing_leaves_the_range_where_weights_are_not_negative() {
        let flat = vec![3.0; 256];
        let steps: Vec<f32> = (0..256).map(|i| if mix(i).is_multiple_of(2) { 0.0 } else { 1.0 }).collect();
        for (name, kernel) in Kernel::NAMES {
            let axis = axis(kernel);
            let mut least_sum = f64::INFINITY;
            for (per_sample, number) in [2, 3, 8, 64].into_iter().flat_map(|n| (0..20).map(move |s| (n, s))) {
                let noisy = sheet(&axis, per_sample, number);
                for at in positions() {
                    assert!((noisy.value(&flat, at) - 3.0).abs() < 1e-12, "{name} at {at:?}");
                    let value = noisy.value(&steps, at);
                    assert!(
                        overshoot(kernel) > 0.0 || (-1e-12..=1.0 + 1e-12).contains(&value),
                        "{name} at {at:?}: {value}"
                    );
                    let mut sum = 0.0;
                    noisy.each(at, true, |_, weight| sum += weight);
                    least_sum = sum.min(least_sum);
                }
            }
            assert!(
                overshoot(kernel) > 0.0 || least_sum >= LEAST_SUM || kernel == Kernel::Gaussian,
                "{name}: {least_sum}"
            );
        }
    }

    /// The mean over many sheets is the kernel, linear between the entries; that is the linear kernel itself.
    #[test]
    fn noise_has_the_kernel_as_its_mean() {
        let axis = axis(Kernel::Linear);
        let ramp: Vec<f32> = (0..256).map(|i| (i % 16) as f32 - 2.0).collect();
        for at in [[4.1, 5.3], [4.25, 2.5], [7.7, 6.9]] {
            let n = 20_000;
            let values: Vec<f64> = (0..n).map(|number| sheet(&axis, 2, number).value(&ramp, at)).collect();
            let mean = values.iter().sum::<f64>() / n as f64;
            let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
            // Not exactly the kernel, since weights are scaled by their sum.
            assert!((mean - at[0]).abs() < 0.05 && deviation > 0.1, "{at:?}: {mean}, {deviation}");
        }
    }

    #[test]
    fn many_entries_are_the_kernel() {
        let values: Vec<f32> = (0..256).map(|i| (mix(i) % 100) as f32).collect();
        for (name, kernel) in Kernel::NAMES {
            let axis = axis(kernel);
            for at in positions() {
                let [(u, weights_u), (v, weights_v)] = at.map(|x| taps(kernel, x));
                let mut want = 0.0;
                for (k, weight_v) in weights_v.iter().enumerate() {
                    for (i, weight_u) in weights_u.iter().enumerate().take(n_taps(kernel)) {
                        let place = (v + 2) as usize * 16 + (u + 2) as usize + k * 16 + i;
                        want += weight_u * weight_v * f64::from(*values.get(place).unwrap_or(&0.0));
                    }
                }
                let got = sheet(&axis, 1024, 3).value(&values, at);
                assert!((got - want).abs() < 0.5, "{name} at {at:?}: {got} for {want}");
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
        assert!(mean.abs() < 0.01 && (variance - 1.0 / 12.0).abs() < 0.003, "{mean} {variance}");
        assert!(neighbours.abs() < 0.003, "{neighbours}");
    }
}
