//! Sparse synthesis: one level of a box from low-pass samples and the kept details.
//!
//! One axis follows the other: along x every kept detail adds its basis function to a row, and rows without any are
//! skipped from then on; then rows are combined along y, and planes along z. When few coefficients are kept most rows
//! have no detail, and the work is little more than interpolating the low-pass samples.

use std::ops::Range;

use wavesplat_compute::simd::LANES;

use super::wavelet_volume::WaveletVolume;
use crate::transform::step::LevelStep;

/// A box of samples, with rows padded to whole vectors.
#[derive(Default)]
pub struct DecodedBox {
    pub n: [usize; 3],
    stride: usize,
    values: Vec<f32>,
}

impl DecodedBox {
    fn resize(&mut self, n: [usize; 3]) {
        self.n = n;
        self.stride = n[0].next_multiple_of(LANES);
        let wanted = self.stride * n[1] * n[2];
        if self.values.len() < wanted {
            self.values.resize(wanted, 0.0);
        }
    }

    pub fn row(&self, y: usize, z: usize) -> &[f32] {
        &self.values[(z * self.n[1] + y) * self.stride..][..self.n[0]]
    }

    /// Adds a number to all samples.
    pub fn add(&mut self, offset: f32) {
        let n = self.stride * self.n[1] * self.n[2];
        self.values[..n].iter_mut().for_each(|value| *value += offset);
    }

    /// Copies a box out of all samples of a level.
    pub fn copy(&mut self, all: &[f32], [nx, ny, _]: [usize; 3], ranges: &[Range<usize>; 3]) {
        self.resize([0, 1, 2].map(|a| ranges[a].len()));
        for (k, z) in ranges[2].clone().enumerate() {
            for (j, y) in ranges[1].clone().enumerate() {
                let row = &all[(z * ny + y) * nx..][ranges[0].clone()];
                self.values[(k * self.n[1] + j) * self.stride..][..row.len()].copy_from_slice(row);
            }
        }
    }
}

/// Synthesis taps of one axis of a box. Coefficients are counted from the first one needed: low-pass, then details.
#[derive(Default)]
pub struct AxisTaps {
    /// Positions of the samples.
    out: Range<usize>,
    /// Range of low-pass coefficients that the samples need.
    pub low: Range<usize>,
    high: Range<usize>,
    /// End of each sample's taps.
    ends: Vec<usize>,
    /// Coefficient and weight of each tap.
    taps: Vec<(usize, f32)>,
}

impl AxisTaps {
    pub fn build(&mut self, step: &LevelStep, out: Range<usize>) {
        let (mut low, mut high) = ([usize::MAX, 0], [usize::MAX, 0]);
        for tap in out.clone().flat_map(|i| step.taps(i)) {
            let (reached, index) =
                if tap.index < step.n_low { (&mut low, tap.index) } else { (&mut high, tap.index - step.n_low) };
            *reached = [reached[0].min(index), reached[1].max(index + 1)];
        }
        self.low = low[0].min(low[1])..low[1];
        self.high = high[0].min(high[1])..high[1];
        self.ends.clear();
        self.taps.clear();
        for i in out.clone() {
            for tap in step.taps(i) {
                let index = match tap.index.checked_sub(step.n_low) {
                    None => tap.index - self.low.start,
                    Some(detail) => self.low.len() + detail - self.high.start,
                };
                self.taps.push((index, tap.weight as f32));
            }
            self.ends.push(self.taps.len());
        }
        self.out = out;
    }

    /// Number of coefficients that the samples need.
    fn n(&self) -> usize {
        self.low.len() + self.high.len()
    }

    #[inline(always)]
    fn taps(&self, i: usize) -> &[(usize, f32)] {
        let first = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.taps[first..self.ends[i]]
    }
}

/// Work space of one level.
#[derive(Default)]
pub struct LevelScratch {
    pub axes: [AxisTaps; 3],
    columns: BasisColumns,
    /// Rows after synthesis along x, `[coefficient z][coefficient y]`; `has_row`: whether a row is not empty.
    rows: Vec<f32>,
    has_row: Vec<bool>,
    /// Rows after synthesis along y, `[coefficient z][y]`; `has_plane`: whether a plane is not empty.
    planes: Vec<f32>,
    has_plane: Vec<bool>,
    pub samples: DecodedBox,
}

/// Basis functions of the coefficients along x, as vectors of weights.
#[derive(Default)]
struct BasisColumns {
    /// Weights for each vector of outputs and each low-pass coefficient that it needs.
    low: Vec<[f32; LANES]>,
    /// Low-pass coefficients that each vector of outputs needs.
    reached: Vec<Range<usize>>,
    /// First output of each coefficient's function, and the function from there on.
    own: Vec<(usize, [f32; LANES])>,
}

impl BasisColumns {
    fn build(&mut self, axis: &AxisTaps, stride: usize) {
        let n_low = axis.low.len();
        self.low.clear();
        self.reached.clear();
        self.own.clear();
        for first in (0..stride).step_by(LANES) {
            let outputs = first..(first + LANES).min(axis.out.len());
            let low_taps = outputs.clone().flat_map(|i| axis.taps(i)).filter(|tap| tap.0 < n_low);
            let (from, to) = low_taps.fold((usize::MAX, 0), |(from, to), tap| (from.min(tap.0), to.max(tap.0 + 1)));
            let reached = from.min(to)..to;
            let start = self.low.len();
            self.low.resize(start + reached.len(), [0.0; LANES]);
            for i in outputs {
                for &(index, weight) in axis.taps(i).iter().filter(|tap| tap.0 < n_low) {
                    self.low[start + index - reached.start][i - first] += weight;
                }
            }
            self.reached.push(reached);
        }
        self.own.resize(axis.n(), (usize::MAX, [0.0; LANES]));
        for i in 0..axis.out.len() {
            for &(index, weight) in axis.taps(i) {
                let (first, function) = &mut self.own[index];
                if *first == usize::MAX {
                    *first = i.min(stride - LANES);
                }
                function[i - *first] += weight;
            }
        }
    }
}

impl LevelScratch {
    /// Synthesis along x of the low-pass samples of the box.
    #[inline(always)]
    pub fn along_x(&mut self, low: &DecodedBox) {
        let [x, y, z] = &self.axes;
        let n = [x.out.len(), y.out.len(), z.out.len()];
        self.samples.resize(n);
        let stride = self.samples.stride;
        self.columns.build(x, stride);
        let n_rows = y.n() * z.n();
        if self.rows.len() < n_rows * stride {
            self.rows.resize(n_rows * stride, 0.0);
        }
        self.has_row.clear();
        self.has_row.resize(n_rows, false);
        for k in 0..z.low.len() {
            for j in 0..y.low.len() {
                let row_idx = k * y.n() + j;
                self.has_row[row_idx] = true;
                let coefficients = low.row(j, k);
                let row = &mut self.rows[row_idx * stride..][..stride];
                let mut columns = self.columns.low.iter();
                for (out, reached) in row.chunks_exact_mut(LANES).zip(&self.columns.reached) {
                    let mut sum = [0.0; LANES];
                    for (c, column) in coefficients[reached.clone()].iter().zip(&mut columns) {
                        for i in 0..LANES {
                            sum[i] += c * column[i];
                        }
                    }
                    out.copy_from_slice(&sum);
                }
            }
        }
    }

    /// Adds the basis functions along x of all kept details.
    #[inline(always)]
    pub fn add_details(&mut self, volume: &WaveletVolume, level: usize, weight: f32) {
        let stride = self.samples.stride;
        let [x, y, z] = &self.axes;
        for band in 1..8 {
            let reached = |axis: &AxisTaps, bit: usize| {
                if band >> bit & 1 == 0 { (axis.low.clone(), 0) } else { (axis.high.clone(), axis.low.len()) }
            };
            let [(xs, x0), (ys, y0), (zs, z0)] = [reached(x, 0), reached(y, 1), reached(z, 2)];
            let (rows, has_row, own) = (&mut self.rows, &mut self.has_row, &self.columns.own);
            volume.for_each_kept(level, band, &[xs, ys, zs], |[i, j, k], value| {
                let row_idx = (z0 + k) * y.n() + y0 + j;
                let row = &mut rows[row_idx * stride..][..stride];
                if !has_row[row_idx] {
                    has_row[row_idx] = true;
                    row.fill(0.0);
                }
                let (first, function) = &own[x0 + i];
                if let Some(out) = row.get_mut(*first..).and_then(|row| row.first_chunk_mut::<LANES>()) {
                    let value = weight * value;
                    for i in 0..LANES {
                        out[i] += value * function[i];
                    }
                }
            });
        }
    }

    /// Synthesis along y of the rows that are not empty.
    #[inline(always)]
    pub fn along_y(&mut self) {
        let [_, y, z] = &self.axes;
        let (stride, n_y) = (self.samples.stride, y.out.len());
        let n_planes = z.n();
        if self.planes.len() < n_planes * n_y * stride {
            self.planes.resize(n_planes * n_y * stride, 0.0);
        }
        self.has_plane.clear();
        for (k, has_row) in self.has_row.chunks_exact(y.n()).enumerate() {
            let has_plane = has_row.contains(&true);
            self.has_plane.push(has_plane);
            if !has_plane {
                continue;
            }
            let rows = &self.rows[k * y.n() * stride..][..y.n() * stride];
            for j in 0..n_y {
                let out = &mut self.planes[(k * n_y + j) * stride..][..stride];
                sum_rows(rows, stride, 0, y.taps(j), has_row, out);
            }
        }
    }

    /// Synthesis along z of the planes that are not empty.
    #[inline(always)]
    pub fn along_z(&mut self) {
        let [_, y, z] = &self.axes;
        let plane = self.samples.stride * y.out.len();
        for k in 0..z.out.len() {
            let out = &mut self.samples.values[k * plane..][..plane];
            for (c, out) in out.chunks_exact_mut(self.samples.stride).enumerate() {
                sum_rows(&self.planes, plane, c * self.samples.stride, z.taps(k), &self.has_plane, out);
            }
        }
    }
}

/// `out = Σ weight · rows[index]` over the rows that are not empty (`holds`); rows begin `pitch` apart, from `first`
/// on.
#[inline(always)]
fn sum_rows(rows: &[f32], pitch: usize, first: usize, taps: &[(usize, f32)], holds: &[bool], out: &mut [f32]) {
    for (c, out) in out.chunks_exact_mut(LANES).enumerate() {
        let mut sum = [0.0; LANES];
        for &(index, weight) in taps {
            if holds[index]
                && let Some(row) = rows[index * pitch + first + c * LANES..].first_chunk::<LANES>()
            {
                for i in 0..LANES {
                    sum[i] += weight * row[i];
                }
            }
        }
        out.copy_from_slice(&sum);
    }
}
