//! Footprint tables: which samples reach a texel column (or row), and how much.
//!
//! Sheets are axis-aligned and the kernel is separable, so a whole sheet needs one table for u and one for v, rebuilt
//! per sheet in O(U + V). The *difference footprint* `[h(x + d − l) − h(x − d − l)] / 2d` gives the derivative; with
//! the linear kernel and d = 1 that is the trilinearly interpolated central difference. Positions beyond the first
//! and last sample stop there: the outside is empty, not zero density. A smoothed gradient has tables of its own
//! ([`crate::kernel::smoothed`]).

use std::ops::Range;

use wavesplat_compute::simd::{LANES, Lanes, Places};
use wavesplat_core::{Gradient, Kernel};

use crate::kernel::footprint_table::{Footprint, bits};
use crate::kernel::slice_taps::SliceTaps;
use crate::kernel::smoothed::{self, width_of};
use crate::kernel::weights::{MAX_DIFFERENCE_TAPS, MAX_TAPS, mirror_index, n_taps, near_taps, reach, taps};

/// Footprint tables of one axis for a run of positions.
#[derive(Clone, Debug, Default)]
pub struct AxisFootprints {
    /// Weights of the kernel.
    pub value: Footprint,
    /// Weights of the derivative, for gradients; empty where none is wanted.
    pub difference: Footprint,
    /// Weights along this axis for the derivatives along other axes; empty where these are the kernel's.
    pub smooth: Footprint,
    /// First and last sample that the tables reach, before folding.
    pub window: [i64; 2],
    /// Bit mask of the groups that the tables are made for.
    groups: u32,
    /// Recipe of the tables for gradients that are still to be made.
    pending: Option<Pending>,
}

/// Recipe of the tables for gradients, from the kernel's table.
#[derive(Clone, Copy, Debug)]
enum Pending {
    /// Differences over whole samples; half their distance.
    Shifted(usize),
    /// B-splines around `origin + i · step`, clamped to the volume, which ends at the position of the `last` sample.
    Smoothed { origin: f64, step: f64, last: f64, width: f64, margin: usize },
}

impl Pending {
    /// Samples that gradients reach beyond the kernel's, on either side.
    fn margin(self) -> usize {
        match self {
            Self::Shifted(offset) => offset,
            Self::Smoothed { margin, .. } => margin,
        }
    }
}

/// Kernel, length and gradient of an axis, from which footprints are built.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Reconstruction kernel.
    pub kernel: Kernel,
    /// Samples along the axis.
    pub n_samples: usize,
    /// Estimator of gradients, in samples; `None` where none is wanted.
    pub gradient: Option<Gradient>,
}

impl Axis {
    /// Number of taps of the gradient's footprints.
    pub fn n_gradient_taps(&self) -> usize {
        match self.gradient {
            None => 0,
            Some(Gradient::Difference(offset)) => n_taps(self.kernel) + (2.0 * offset).ceil() as usize,
            Some(Gradient::Smoothed(_)) => n_taps(self.kernel) + 2 * self.gradient_margin(),
        }
    }

    /// Samples by which gradients reach further than the kernel, on either side.
    pub fn gradient_margin(&self) -> usize {
        match self.gradient {
            None => 0,
            Some(Gradient::Difference(offset)) => offset.ceil() as usize,
            Some(Gradient::Smoothed(deviation)) => {
                let reached = (2.0 * width_of(self.kernel, deviation)).ceil() as usize;
                reached.saturating_sub(n_taps(self.kernel) / 2)
            }
        }
    }

    /// Position of the last sample.
    pub fn last(&self) -> f64 {
        (self.n_samples - 1) as f64
    }

    /// Taps of `[V(x + d) − V(x − d)] / 2d`.
    fn difference(&self, x: f64, offset: f64) -> (i64, [f64; MAX_DIFFERENCE_TAPS]) {
        let extent = 2.0 * offset;
        let [(first_lo, lo), (first_hi, hi)] =
            [-offset, offset].map(|end| taps(self.kernel, (x + end).clamp(0.0, self.last())));
        let mut weights = [0.0; MAX_DIFFERENCE_TAPS];
        let shift = (first_hi - first_lo) as usize;
        for t in 0..MAX_TAPS {
            weights[t] -= lo[t] / extent;
            weights[t + shift] += hi[t] / extent;
        }
        (first_lo, weights)
    }

    /// Slices that reach the sheet at `w`, folded, with their weights; slices of weight 0 are left out.
    pub fn slice_taps(&self, w: f64) -> SliceTaps {
        let (first, weights) = taps(self.kernel, w.clamp(0.0, self.last()));
        self.folded(first, &weights)
    }

    /// Like [`Axis::slice_taps`], for the derivative through the sheet.
    pub fn slice_difference_taps(&self, w: f64) -> SliceTaps {
        let w = w.clamp(0.0, self.last());
        match self.gradient {
            None => SliceTaps::default(),
            Some(Gradient::Difference(offset)) => {
                let (first, weights) = self.difference(w, offset);
                self.folded(first, &weights)
            }
            Some(Gradient::Smoothed(deviation)) => {
                let (first, [_, weights]) = smoothed::taps(self.kernel, w, deviation);
                self.folded(first, &weights)
            }
        }
    }

    /// Like [`Axis::slice_taps`], for the derivatives along the sheet; `None` where these use the kernel's own values.
    pub fn slice_smooth_taps(&self, w: f64) -> Option<SliceTaps> {
        let Some(Gradient::Smoothed(deviation)) = self.gradient else { return None };
        let (first, [weights, _]) = smoothed::taps(self.kernel, w.clamp(0.0, self.last()), deviation);
        Some(self.folded(first, &weights))
    }

    fn folded(&self, first: i64, weights: &[f64]) -> SliceTaps {
        let mut folded = SliceTaps::default();
        for (t, w) in weights.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            folded.taps[folded.n] = (mirror_index(self.kernel, first + t as i64, self.n_samples), *w as f32);
            folded.n += 1;
        }
        folded
    }
}

/// Sample near the positions `origin + i · step` of a group, and the first position relative to it, so that f32
/// resolves them well. `last`: position of the last sample.
#[inline(always)]
pub fn group_base([origin, step]: [f64; 2], group: usize, last: f64) -> (f64, f32) {
    let first = origin + step * (group * LANES) as f64;
    let base = first.min(first + step * (LANES - 1) as f64).clamp(0.0, last).floor();
    (base, (first - base) as f32)
}

impl AxisFootprints {
    /// Rebuilds the tables for the positions `origin + i · step`, in samples. Of the `n_groups` groups, only those
    /// whose bits are set in `wanted` are made. Tables for gradients are ready after
    /// [`AxisFootprints::make_difference`]. Runs at the SIMD level of the caller.
    #[inline(always)]
    pub fn build(&mut self, axis: &Axis, [origin, step]: [f64; 2], n_groups: usize, wanted: u32) {
        self.groups = wanted;
        self.pending = None;
        let n_value = n_taps(axis.kernel);
        self.value.reset(n_groups, n_value);
        let n_difference = axis.n_gradient_taps();
        self.difference.reset(if n_difference > 0 { n_groups } else { 0 }, n_difference);
        let has_polynomial = near_taps(axis.kernel, 0.0).is_some();
        let Some(Gradient::Smoothed(deviation)) = axis.gradient else {
            self.smooth.reset(0, 0);
            self.build_with_differences(axis, [origin, step], n_groups, has_polynomial);
            return;
        };
        self.smooth.reset(n_groups, n_difference);
        let margin = axis.gradient_margin();
        self.window = if has_polynomial {
            self.build_inside(axis, [origin, step], n_groups, margin)
        } else {
            self.build_anywhere(axis, [origin, step], n_groups)
        };
        let width = width_of(axis.kernel, deviation);
        self.pending = Some(Pending::Smoothed { origin, step, last: axis.last(), width, margin });
    }

    #[inline(always)]
    fn build_with_differences(&mut self, axis: &Axis, [origin, step]: [f64; 2], n_groups: usize, has_polynomial: bool) {
        let offset = if let Some(Gradient::Difference(offset)) = axis.gradient { offset } else { 0.0 };
        let end = origin + step * (n_groups * LANES - 1) as f64;
        let (lo, hi) = (origin.min(end), origin.max(end));
        // A whole offset moves the taps by whole samples, and away from the faces no position is clamped. With the
        // linear kernel clamping a position to a face equals repeating the face's sample.
        let inside = axis.kernel == Kernel::Linear || (lo >= offset && hi + offset <= axis.last());
        self.window = if inside && offset.fract() == 0.0 && has_polynomial {
            self.pending = axis.gradient.is_some().then_some(Pending::Shifted(offset as usize));
            self.build_inside(axis, [origin, step], n_groups, offset as usize)
        } else {
            self.build_anywhere(axis, [origin, step], n_groups)
        };
    }

    /// Copies the tables of an axis that has the same weights at the same positions.
    pub fn copy(&mut self, axis: &Axis, other: &Self) {
        self.window = other.window;
        self.groups = other.groups;
        self.value.clone_from(&other.value);
        if axis.gradient.is_some() {
            self.difference.clone_from(&other.difference);
            self.smooth.clone_from(&other.smooth);
            self.pending = other.pending;
        } else {
            self.difference.reset(0, 0);
            self.smooth.reset(0, 0);
            self.pending = None;
        }
    }

    /// Samples that the value and the difference of a position reach, counted from the window's first.
    pub fn reached(&self, i: usize) -> Range<usize> {
        let first = self.value.first(i);
        let mut reached = first..first + self.value.n_taps;
        if let Some(pending) = self.pending {
            return reached.start - pending.margin()..reached.end + pending.margin();
        }
        if self.difference.n_taps > 0 {
            let first = self.difference.first(i);
            reached = reached.start.min(first)..reached.end.max(first + self.difference.n_taps);
        }
        reached
    }

    /// Makes the tables for gradients, if that is still to be done. Runs at the SIMD level of the caller.
    #[inline(always)]
    pub fn make_difference(&mut self) {
        match self.pending.take() {
            None => {}
            Some(Pending::Shifted(offset)) => self.make_shifted(offset),
            Some(Pending::Smoothed { origin, step, last, width, margin }) => {
                self.make_smoothed([origin, step], last, width, margin);
            }
        }
    }

    /// Makes the tables of smoothed gradients: the kernel's taps and `margin` more on either side, weighted by
    /// B-splines.
    #[inline(always)]
    fn make_smoothed(&mut self, [origin, step]: [f64; 2], last: f64, width: f64, margin: usize) {
        let n = self.difference.n_taps;
        let per_width = 1.0 / width as f32;
        for g in bits(self.groups) {
            for footprint in [&mut self.difference, &mut self.smooth] {
                footprint.base[g] = self.value.base[g] - margin as u32;
                footprint.places[g] = self.value.places[g];
            }
            // Position from the first tap, in widths of the B-spline.
            let mut position = Lanes::default();
            for i in 0..LANES {
                let x = (origin + step * (g * LANES + i) as f64).clamp(0.0, last);
                let first = self.window[0] + i64::from(self.difference.base[g] + self.value.places[g].index().0[i]);
                position.0[i] = (x - first as f64) as f32 * per_width;
            }
            let values = &mut self.smooth.weights[g * n..(g + 1) * n];
            let slopes = &mut self.difference.weights[g * n..(g + 1) * n];
            smoothed::fill(&position, per_width, values, slopes);
        }
    }

    #[inline(always)]
    fn make_shifted(&mut self, offset: usize) {
        let Self { value, difference, .. } = self;
        let (n, n_difference) = (value.n_taps, difference.n_taps);
        let share = 1.0 / (2 * offset) as f32;
        let shift = 2 * offset;
        for g in bits(self.groups) {
            difference.base[g] = value.base[g] - offset as u32;
            difference.places[g] = value.places[g];
            let weights = &value.weights[g * n..(g + 1) * n];
            let difference = &mut difference.weights[g * n_difference..(g + 1) * n_difference];
            for (t, difference) in difference.iter_mut().enumerate() {
                for i in 0..LANES {
                    let lo = if t < n { weights[t].0[i] } else { 0.0 };
                    let hi = if t >= shift { weights[t - shift].0[i] } else { 0.0 };
                    difference.0[i] = (hi - lo) * share;
                }
            }
        }
    }

    /// Builds the tables from f32 positions, counted from a sample near each group, so that the compiler can use whole
    /// vectors. First samples are counted from the window's first sample, which is returned with the last one.
    #[inline(always)]
    fn build_inside(&mut self, axis: &Axis, [origin, step]: [f64; 2], n_groups: usize, offset: usize) -> [i64; 2] {
        let last = axis.last();
        let group_base = |g: usize| group_base([origin, step], g, last);
        let (reach, offset) = (reach(axis.kernel) as i64, offset as i64);
        let lowest = group_base(0).0.min(group_base(n_groups - 1).0) as i64 - reach - offset;
        let mut highest = lowest;
        for g in bits(self.groups) {
            let (base, start) = group_base(g);
            let (begin, end) = (-base as f32, (last - base) as f32);
            let base = base as i64 - lowest;
            let mut first = Lanes::<u32>::default();
            let mut weights = [Lanes::default(); MAX_TAPS];
            let step = step as f32;
            macro_rules! fill {
                ($kernel:expr) => {
                    for i in 0..LANES {
                        let x = start + i as f32 * step;
                        let x = if x > begin { x } else { begin };
                        let x = if x < end { x } else { end };
                        if let Some((tap, w)) = near_taps($kernel, x) {
                            first.0[i] = tap;
                            for t in 0..MAX_TAPS {
                                weights[t].0[i] = w[t];
                            }
                        }
                    }
                };
            }
            // One loop per kernel, so that none of them branches inside.
            match axis.kernel {
                Kernel::Linear => fill!(Kernel::Linear),
                Kernel::CatmullRom => fill!(Kernel::CatmullRom),
                Kernel::Bspline2 => fill!(Kernel::Bspline2),
                _ => fill!(Kernel::Bspline3),
            }
            let last_index = first.0[0].max(first.0[LANES - 1]);
            let n = self.value.n_taps;
            self.value.base[g] = (base - reach) as u32;
            self.value.places[g] = Places::new(first);
            self.value.weights[g * n..(g + 1) * n].copy_from_slice(&weights[..n]);
            highest = highest.max(lowest + base - reach + i64::from(last_index) + n as i64 - 1 + offset);
        }
        [lowest, highest]
    }

    /// Builds the tables for any position, kernel and offset.
    fn build_anywhere(&mut self, axis: &Axis, [origin, step]: [f64; 2], n_groups: usize) -> [i64; 2] {
        let n = n_groups * LANES;
        let mut window = [i64::MAX, i64::MIN];
        let mut firsts = Vec::with_capacity(n);
        for i in 0..n {
            let (g, lane) = (i / LANES, i % LANES);
            let x = (origin + step * i as f64).clamp(0.0, axis.last());
            let (first, weights) = taps(axis.kernel, x);
            for t in 0..self.value.n_taps {
                self.value.weights[g * self.value.n_taps + t].0[lane] = weights[t] as f32;
            }
            let mut first_difference = first;
            if let Some(Gradient::Difference(offset)) = axis.gradient {
                let (first, weights) = axis.difference(x, offset);
                for t in 0..self.difference.n_taps {
                    self.difference.weights[g * self.difference.n_taps + t].0[lane] = weights[t] as f32;
                }
                first_difference = first;
            }
            if let Some(Gradient::Smoothed(_)) = axis.gradient {
                first_difference = first - axis.gradient_margin() as i64;
            }
            let end = (first + self.value.n_taps as i64).max(first_difference + self.difference.n_taps as i64);
            window = [window[0].min(first).min(first_difference), window[1].max(end - 1)];
            firsts.push([first, first_difference]);
        }
        let fill = |which: usize, footprint: &mut Footprint| {
            for g in 0..n_groups {
                let group = &firsts[g * LANES..(g + 1) * LANES];
                let base = group.iter().map(|f| f[which]).fold(i64::MAX, i64::min);
                footprint.base[g] = (base - window[0]) as u32;
                footprint.places[g] = Places::new(Lanes(std::array::from_fn(|i| (group[i][which] - base) as u32)));
            }
        };
        fill(0, &mut self.value);
        if let Some(Gradient::Difference(_)) = axis.gradient {
            fill(1, &mut self.difference);
        }
        window
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(kernel: Kernel, offset: f64) -> Axis {
        Axis { kernel, n_samples: 12, gradient: Some(Gradient::Difference(offset)) }
    }

    /// Builds the tables of all groups.
    fn build(tables: &mut AxisFootprints, axis: &Axis, places: [f64; 2], n_groups: usize) {
        tables.build(axis, places, n_groups, (1 << n_groups) - 1);
        tables.make_difference();
    }

    /// All weights of a position, by sample.
    fn dense(axis: &Axis, tables: &AxisFootprints, table: &Footprint, i: usize) -> [f64; 40] {
        let mut dense = [0.0; 40];
        for t in 0..table.n_taps {
            let sample = tables.window[0] + (table.first(i) + t) as i64;
            assert!(sample <= tables.window[1]);
            dense[mirror_index(axis.kernel, sample, axis.n_samples)] += f64::from(table.weight(i, t));
        }
        dense
    }

    /// The footprint's mass is 1 and its difference's mass is 0, wherever the texel lies between the samples.
    #[test]
    fn mass_is_independent_of_the_sub_pixel_offset() {
        for (name, kernel) in Kernel::NAMES {
            for offset in [0.1, 0.5, 0.75, 1.0, 1.7, 4.0] {
                let mut tables = AxisFootprints::default();
                build(&mut tables, &axis(kernel, offset), [-1.0, 0.037], 25);
                for i in 0..400 {
                    let value: f32 = (0..tables.value.n_taps).map(|t| tables.value.weight(i, t)).sum();
                    let difference: f32 = (0..tables.difference.n_taps).map(|t| tables.difference.weight(i, t)).sum();
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
            build(&mut tables, &axis(kernel, 1.0), [4.0, 0.1], 2);
            for i in 0..30 {
                let sample = |t: usize| (tables.window[0] + (tables.difference.first(i) + t) as i64) as f32;
                let slope: f32 =
                    (0..tables.difference.n_taps).map(|t| tables.difference.weight(i, t) * sample(t)).sum();
                assert!((slope - 1.0).abs() < 1e-5, "{name} texel {i}: {slope}");
            }
        }
    }

    /// A group's tables do not depend on which other groups are made, nor its reach on whether differences are made.
    #[test]
    fn groups_are_made_one_by_one() {
        for (_, kernel) in Kernel::NAMES {
            let differences = [1.0, 0.4, 2.0].map(Gradient::Difference);
            for gradient in differences.into_iter().chain([0.5, 0.8, 1.25].map(Gradient::Smoothed)) {
                for places in [[3.1, 0.11], [9.0, -0.3], [30.0, 0.5], [-2.0, 0.2], [39.0, 0.4]] {
                    let axis = Axis { kernel, n_samples: 40, gradient: Some(gradient) };
                    let mut all = AxisFootprints::default();
                    build(&mut all, &axis, places, 4);
                    for g in 0..4 {
                        let mut one = AxisFootprints::default();
                        one.build(&axis, places, 4, 1 << g);
                        for i in g * LANES..(g + 1) * LANES {
                            let [a, b] = [&one, &all].map(|tables| {
                                let (base, reached) = (tables.window[0], tables.reached(i));
                                base + reached.start as i64..base + reached.end as i64
                            });
                            assert_eq!(a, b, "{kernel:?} {gradient:?} {places:?} texel {i}");
                        }
                        one.make_difference();
                        for i in g * LANES..(g + 1) * LANES {
                            let mut pairs = vec![[&one.value, &all.value], [&one.difference, &all.difference]];
                            if all.smooth.n_taps > 0 {
                                pairs.push([&one.smooth, &all.smooth]);
                            }
                            for [a, b] in pairs {
                                assert_eq!(dense(&axis, &one, a, i), dense(&axis, &all, b, i), "{kernel:?} texel {i}");
                            }
                        }
                    }
                }
            }
        }
    }

    /// Both ways of building reach the same samples with the same weights.
    #[test]
    fn tables_inside_are_the_tables_anywhere() {
        for (_, kernel) in Kernel::NAMES {
            for (origin, step) in [(3.1, 0.11), (2.0, 0.25), (8.9, -0.15), (3.0, 0.5)] {
                let axis = Axis { n_samples: 40, ..axis(kernel, 1.0) };
                let (mut fast, mut slow) = (AxisFootprints::default(), AxisFootprints::default());
                build(&mut fast, &axis, [origin, step], 2);
                slow.value.reset(2, n_taps(kernel));
                slow.difference.reset(2, n_taps(kernel) + 2);
                slow.window = slow.build_anywhere(&axis, [origin, step], 2);
                for i in 0..2 * LANES {
                    for (fast_table, slow_table) in [(&fast.value, &slow.value), (&fast.difference, &slow.difference)] {
                        let (a, b) = (dense(&axis, &fast, fast_table, i), dense(&axis, &slow, slow_table, i));
                        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-5), "{kernel:?} {origin} {i}");
                    }
                }
            }
        }
    }

    /// A difference is taken between the values at its ends, which stop at the faces.
    #[test]
    fn differences_are_of_the_values_at_their_ends() {
        for (_, kernel) in Kernel::NAMES {
            for (offset, step) in [(0.01, 0.3), (1.0, 0.3), (1.0, -0.4), (0.75, 2.5)] {
                let axis = Axis { n_samples: 40, ..axis(kernel, offset) };
                let mut tables = AxisFootprints::default();
                let origin = if step > 0.0 { -1.7 } else { 13.0 };
                build(&mut tables, &axis, [origin, step], 2);
                for i in 0..2 * LANES {
                    let got = dense(&axis, &tables, &tables.difference, i);
                    let x = (origin + step * i as f64).clamp(0.0, 39.0);
                    let mut want = [0.0; 40];
                    for (end, share) in [(x + offset, 0.5 / offset), (x - offset, -0.5 / offset)] {
                        let (first, taps) = taps(kernel, end.clamp(0.0, 39.0));
                        for (sample, weight) in (first..).zip(taps) {
                            want[mirror_index(kernel, sample, 40)] += share * weight;
                        }
                    }
                    // Positions in f32 lie up to 4e-6 samples off, and slopes of weights are at most 2.
                    let differs = got.iter().zip(&want).any(|(got, want)| (got - want).abs() > 2e-5 / offset);
                    assert!(!differs, "{kernel:?} {offset} {step} texel {i}");
                }
            }
        }
    }

    #[test]
    fn slice_taps_leave_out_slices_without_weight() {
        assert_eq!(axis(Kernel::Linear, 1.0).slice_taps(3.0)[..], [(3, 1.0)]);
        assert_eq!(axis(Kernel::Linear, 1.0).slice_difference_taps(3.0)[..], [(2, -0.5), (4, 0.5)]);
        assert_eq!(axis(Kernel::Linear, 1.0).slice_difference_taps(0.0)[..], [(0, -0.5), (1, 0.5)]);
    }
}
