//! Footprint tables: which samples reach a texel column (or row), and how much.
//!
//! Sheets are axis-aligned and the kernel is separable, so a whole sheet needs one table for u and one for v, rebuilt
//! per sheet in O(U + V). The *difference footprint* `[h(x + d − l) − h(x − d − l)] / 2d` gives the derivative; with
//! the linear kernel and d = 1 that is the trilinearly interpolated central difference. Positions beyond the first
//! and last sample stop there: the outside is empty, not zero density.

use wavesplat_core::Kernel;

use crate::kernel::{MAX_TAPS, fold, n_taps, taps};
use crate::slices::SliceTap;

/// Weights of every position of one axis, tap by tap: `weights[t · n + i]` belongs to sample `first[i] + t`.
#[derive(Clone, Debug, Default)]
pub struct Footprint {
    /// First sample of each position, counted from the window's first sample.
    pub first: Vec<u32>,
    /// Weights, one run of `n` per tap.
    pub weights: Vec<f32>,
    /// Taps per position.
    pub n_taps: usize,
}

impl Footprint {
    fn reset(&mut self, n: usize, n_taps: usize) {
        self.n_taps = n_taps;
        self.first.clear();
        self.first.resize(n, 0);
        self.weights.clear();
        self.weights.resize(n * n_taps, 0.0);
    }

    /// Weights of tap `t`.
    pub fn tap(&self, t: usize) -> &[f32] {
        let n = self.first.len();
        &self.weights[t * n..(t + 1) * n]
    }
}

/// The tables of one axis for a run of positions.
#[derive(Clone, Debug, Default)]
pub struct AxisFootprints {
    /// The kernel.
    pub value: Footprint,
    /// Its difference; empty where no gradient is wanted.
    pub difference: Footprint,
    /// First and last sample that is reached, before folding.
    pub window: [i64; 2],
    firsts: Vec<[i64; 2]>,
}

/// What a footprint is built from.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Reconstruction kernel.
    pub kernel: Kernel,
    /// Samples along the axis.
    pub n_samples: usize,
    /// Half distance of the differences, samples; `None` without gradient.
    pub offset: Option<f64>,
}

impl Axis {
    /// Taps of the difference footprint.
    fn n_difference_taps(&self, offset: f64) -> usize {
        n_taps(self.kernel) + (2.0 * offset).ceil() as usize
    }

    fn last(&self) -> f64 {
        (self.n_samples - 1) as f64
    }

    /// `[V(x + d) − V(x − d)] / 2d` as taps.
    fn difference(&self, x: f64, offset: f64) -> (i64, [f64; 3 * MAX_TAPS]) {
        let (first_lo, lo) = taps(self.kernel, (x - offset).max(0.0));
        let (first_hi, hi) = taps(self.kernel, (x + offset).min(self.last()));
        let mut weights = [0.0; 3 * MAX_TAPS];
        let shift = (first_hi - first_lo) as usize;
        for t in 0..MAX_TAPS {
            weights[t] -= lo[t] / (2.0 * offset);
            weights[t + shift] += hi[t] / (2.0 * offset);
        }
        (first_lo, weights)
    }

    /// Slices that reach the sheet at `w`, folded, with their weights; those of weight 0 are left out.
    pub fn slice_taps(&self, w: f64) -> Vec<SliceTap> {
        let (first, weights) = taps(self.kernel, w.clamp(0.0, self.last()));
        self.folded(first, &weights)
    }

    /// As [`Axis::slice_taps`] for the derivative through the sheet.
    pub fn slice_difference_taps(&self, w: f64) -> Vec<SliceTap> {
        let Some(offset) = self.offset else { return Vec::new() };
        let (first, weights) = self.difference(w.clamp(0.0, self.last()), offset);
        self.folded(first, &weights)
    }

    fn folded(&self, first: i64, weights: &[f64]) -> Vec<SliceTap> {
        let taps = weights.iter().enumerate().filter(|(_, w)| **w != 0.0);
        taps.map(|(t, w)| (fold(self.kernel, first + t as i64, self.n_samples), *w as f32)).collect()
    }
}

impl AxisFootprints {
    /// Rebuilds the tables for the `n` positions `origin + i · step`, in samples.
    pub fn build(&mut self, axis: &Axis, origin: f64, step: f64, n: usize) {
        let position = |i: usize| (origin + step * i as f64).clamp(0.0, axis.last());
        self.value.reset(n, n_taps(axis.kernel));
        let offset = axis.offset;
        self.difference.reset(if offset.is_some() { n } else { 0 }, offset.map_or(0, |d| axis.n_difference_taps(d)));
        self.firsts.clear();
        let mut window = [i64::MAX, i64::MIN];
        for i in 0..n {
            let x = position(i);
            let (first, weights) = taps(axis.kernel, x);
            for t in 0..self.value.n_taps {
                self.value.weights[t * n + i] = weights[t] as f32;
            }
            let mut first_difference = first;
            if let Some(offset) = offset {
                let (first, weights) = axis.difference(x, offset);
                for t in 0..self.difference.n_taps {
                    self.difference.weights[t * n + i] = weights[t] as f32;
                }
                first_difference = first;
            }
            let end = (first + self.value.n_taps as i64).max(first_difference + self.difference.n_taps as i64);
            window = [window[0].min(first).min(first_difference), window[1].max(end - 1)];
            self.firsts.push([first, first_difference]);
        }
        self.window = window;
        for (i, [first, first_difference]) in self.firsts.iter().enumerate() {
            self.value.first[i] = (first - window[0]) as u32;
            if offset.is_some() {
                self.difference.first[i] = (first_difference - window[0]) as u32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(kernel: Kernel, offset: f64) -> Axis {
        Axis { kernel, n_samples: 12, offset: Some(offset) }
    }

    /// The footprint's mass is 1 and its difference's mass is 0, wherever the texel lies between the samples.
    #[test]
    fn mass_is_independent_of_the_sub_pixel_offset() {
        for (name, kernel) in Kernel::NAMES {
            for offset in [0.1, 0.5, 0.75, 1.0, 1.7, 4.0] {
                let mut tables = AxisFootprints::default();
                tables.build(&axis(kernel, offset), -1.0, 0.037, 400);
                for i in 0..400 {
                    let value: f32 = (0..tables.value.n_taps).map(|t| tables.value.tap(t)[i]).sum();
                    let difference: f32 = (0..tables.difference.n_taps).map(|t| tables.difference.tap(t)[i]).sum();
                    assert!((value - 1.0).abs() < 1e-6, "{name} offset {offset} texel {i}: {value}");
                    assert!(difference.abs() < 1e-5, "{name} offset {offset} texel {i}: {difference}");
                }
            }
        }
    }

    #[test]
    fn differences_of_a_ramp_are_its_slope() {
        for (name, kernel) in Kernel::NAMES.into_iter().filter(|(_, k)| *k != Kernel::Gaussian) {
            let mut tables = AxisFootprints::default();
            // Away from the faces, where the ramp goes on; B-spline coefficients of a ramp are the ramp.
            tables.build(&axis(kernel, 1.0), 4.0, 0.1, 30);
            for i in 0..30 {
                let sample = |t: usize| (tables.window[0] + i64::from(tables.difference.first[i]) + t as i64) as f32;
                let slope: f32 = (0..tables.difference.n_taps).map(|t| tables.difference.tap(t)[i] * sample(t)).sum();
                assert!((slope - 1.0).abs() < 1e-5, "{name} texel {i}: {slope}");
            }
        }
    }

    #[test]
    fn slice_taps_leave_out_slices_without_weight() {
        assert_eq!(axis(Kernel::Linear, 1.0).slice_taps(3.0), [(3, 1.0)]);
        assert_eq!(axis(Kernel::Linear, 1.0).slice_difference_taps(3.0), [(2, -0.5), (4, 0.5)]);
        assert_eq!(axis(Kernel::Linear, 1.0).slice_difference_taps(0.0), [(0, -0.5), (1, 0.5)]);
    }
}
