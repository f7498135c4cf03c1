//! Samples of any box, straight from the retained coefficients.
//!
//! A sample at level `k` is a sum over the axes' synthesis taps of low samples of level `k + 1` and details of level
//! `k`. So the box asks for a box of low samples half as large and a few samples wider, and that one for the next, up
//! to a level small enough to be held as a whole. Within a level the axes follow each other: along x every kept detail
//! adds its function to a row, and rows that nothing is added to stay out of all that follows; then rows are combined
//! along y, and planes along z. At the shares that are worth storing most rows have no detail, and the work is that of
//! interpolating the low samples.
//!
//! Each sample is summed in the order of its taps, so it does not depend on the box. To rounding it is that of
//! [`crate::synthesise`], which goes by lifting.

use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

use wavesplat_compute::simd::{LANES, Level};
use wavesplat_compute::{extent, parallel};
use wavesplat_core as core;

use crate::step::Step;
use crate::volume::WaveletVolume;

/// Levels above the decoder's own from which low samples are held: they are a 512th of its samples.
const LEVELS_ABOVE: usize = 3;

/// Sides of the boxes that everything is decoded in.
const SIDE: usize = 32;

/// Decodes one level of a wavelet volume, with a weight for each level's details.
pub struct Decoder {
    volume: Arc<WaveletVolume>,
    weights: Vec<f32>,
    level: usize,
    /// The low samples that are held, and their level.
    held: Vec<f32>,
    held_level: usize,
}

impl Decoder {
    /// `level` 0 gives the samples, each further one the low samples at half the resolution. `weights`: a factor for
    /// each level's details, the finest first, and for the last low box; those beyond the slice are 1.
    ///
    /// # Panics
    /// Where there is no such level.
    pub fn new(volume: Arc<WaveletVolume>, level: usize, weights: &[f32]) -> Self {
        let coarsest = volume.plan().n_levels();
        assert!(level <= coarsest, "level {level} of {coarsest}");
        let weight = |k: usize| weights.get(k).copied().unwrap_or(1.0);
        let weights: Vec<f32> = (0..=coarsest).map(weight).collect();
        let mut held = vec![0.0; volume.plan().low_size(coarsest).iter().product()];
        volume.unpack_low(weights[coarsest], &mut held);
        let mut decoder = Self { volume, weights, level: coarsest, held, held_level: coarsest };
        while decoder.held_level > level + LEVELS_ABOVE {
            decoder.level = decoder.held_level - 1;
            decoder.held = decoder.all();
            decoder.held_level = decoder.level;
        }
        decoder.level = level;
        decoder
    }

    /// All samples of the level, `[z][y][x]`.
    pub fn all(&self) -> Vec<f32> {
        let size @ [nx, ny, nz] = core::Decoder::size(self);
        let layer = nx * ny * SIDE;
        let mut all = vec![0.0; nx * ny * nz];
        parallel::for_each_chunk(&mut all, layer, |layer, samples| {
            let zs = layer * SIDE..((layer + 1) * SIDE).min(nz);
            for y in (0..ny).step_by(SIDE) {
                for x in (0..nx).step_by(SIDE) {
                    let hi = [(x + SIDE).min(size[0]), (y + SIDE).min(size[1])];
                    let ranges = [x..hi[0], y..hi[1], zs.clone()];
                    self.with_box(&ranges, |part| {
                        for (k, plane) in samples.chunks_exact_mut(nx * ny).enumerate() {
                            for j in y..hi[1] {
                                plane[j * nx..][x..hi[0]].copy_from_slice(part.row(j - y, k));
                            }
                        }
                    });
                }
            }
        });
        all
    }

    /// Smallest and largest sample of the level.
    pub fn range(&self) -> [f32; 2] {
        let is_volume = self.level == 0 && self.weights.iter().all(|w| *w == 1.0);
        if is_volume { self.volume.range(|| self.find_range()) } else { self.find_range() }
    }

    fn find_range(&self) -> [f32; 2] {
        let [nx, ny, nz] = core::Decoder::size(self);
        let ranges = parallel::map(nz.div_ceil(SIDE), |layer| {
            let zs = layer * SIDE..((layer + 1) * SIDE).min(nz);
            let mut range = [f32::INFINITY, f32::NEG_INFINITY];
            for y in (0..ny).step_by(SIDE) {
                for x in (0..nx).step_by(SIDE) {
                    let ranges = [x..(x + SIDE).min(nx), y..(y + SIDE).min(ny), zs.clone()];
                    self.with_box(&ranges, |part| {
                        let rows = (0..part.n[2]).flat_map(|k| (0..part.n[1]).map(move |j| part.row(j, k)));
                        range = rows.map(extent::of).fold(range, extent::union);
                    });
                }
            }
            range
        });
        ranges.into_iter().fold([f32::INFINITY, f32::NEG_INFINITY], extent::union)
    }

    /// Calls `use_it` with the samples of a box.
    fn with_box<T>(&self, ranges: &[Range<usize>; 3], use_it: impl FnOnce(&Part) -> T) -> T {
        thread_local!(static SCRATCH: RefCell<Vec<Scratch>> = const { RefCell::new(Vec::new()) });
        SCRATCH.with_borrow_mut(|scratch| {
            scratch.resize_with(LEVELS_ABOVE + 2, Scratch::default);
            self.run(self.level, ranges, scratch);
            use_it(&scratch[0].part)
        })
    }

    /// Makes the box of a level in the first scratch; the coarser ones use those after it.
    fn run(&self, level: usize, ranges: &[Range<usize>; 3], scratch: &mut [Scratch]) {
        let Some((own, above)) = scratch.split_first_mut() else { return };
        if level == self.held_level {
            let size = self.volume.plan().low_size(level);
            return own.part.copy(&self.held, size, ranges);
        }
        let plan = self.volume.plan();
        for a in 0..3 {
            own.axes[a].build(plan.step(level, a), ranges[a].clone());
        }
        let low = [0, 1, 2].map(|a| own.axes[a].low.clone());
        self.run(level + 1, &low, above);
        let Some(Scratch { part: low, .. }) = above.first() else { return };
        Level::best().run(
            #[inline(always)]
            || {
                own.along_x(low);
                let weight = self.weights[level];
                if weight != 0.0 {
                    own.add_details(&self.volume, level, weight);
                }
                own.along_y();
                own.along_z();
            },
        );
    }
}

impl core::Decoder for Decoder {
    fn size(&self) -> [usize; 3] {
        self.volume.plan().low_size(self.level)
    }

    fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]) {
        let [nx, ny, _] = [0, 1, 2].map(|a| hi[a] - lo[a]);
        // Large boxes in pieces, so that the work space stays in the cache.
        for z in (lo[2]..hi[2]).step_by(2 * SIDE) {
            for y in (lo[1]..hi[1]).step_by(2 * SIDE) {
                for x in (lo[0]..hi[0]).step_by(2 * SIDE) {
                    let first = [x, y, z];
                    let ranges = [0, 1, 2].map(|a| first[a]..(first[a] + 2 * SIDE).min(hi[a]));
                    self.with_box(&ranges, |part| {
                        for k in 0..ranges[2].len() {
                            for j in 0..ranges[1].len() {
                                let at = ((z - lo[2] + k) * ny + (y - lo[1] + j)) * nx + x - lo[0];
                                let row = part.row(j, k);
                                out[at..][..row.len()].copy_from_slice(row);
                            }
                        }
                    });
                }
            }
        }
    }
}

/// A box of samples, rows padded to whole vectors.
#[derive(Default)]
struct Part {
    n: [usize; 3],
    stride: usize,
    samples: Vec<f32>,
}

impl Part {
    fn resize(&mut self, n: [usize; 3]) {
        self.n = n;
        self.stride = n[0].next_multiple_of(LANES);
        let wanted = self.stride * n[1] * n[2];
        if self.samples.len() < wanted {
            self.samples.resize(wanted, 0.0);
        }
    }

    fn row(&self, y: usize, z: usize) -> &[f32] {
        &self.samples[(z * self.n[1] + y) * self.stride..][..self.n[0]]
    }

    /// The ranges of all samples of a size.
    fn copy(&mut self, all: &[f32], [nx, ny, _]: [usize; 3], ranges: &[Range<usize>; 3]) {
        self.resize([0, 1, 2].map(|a| ranges[a].len()));
        for (k, z) in ranges[2].clone().enumerate() {
            for (j, y) in ranges[1].clone().enumerate() {
                let row = &all[(z * ny + y) * nx..][ranges[0].clone()];
                self.samples[(k * self.n[1] + j) * self.stride..][..row.len()].copy_from_slice(row);
            }
        }
    }
}

/// What one axis of a box needs of its step. Coefficients are counted from the first that is reached: low ones, then
/// details.
#[derive(Default)]
struct Axis {
    /// Positions of the samples.
    out: Range<usize>,
    /// Low coefficients that are reached, and details, counted from the first of each.
    low: Range<usize>,
    high: Range<usize>,
    /// For each sample the end of its taps.
    ends: Vec<usize>,
    /// Coefficient and weight.
    taps: Vec<(usize, f32)>,
}

impl Axis {
    fn build(&mut self, step: &Step, out: Range<usize>) {
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

    /// Coefficients that are reached.
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
struct Scratch {
    axes: [Axis; 3],
    columns: Columns,
    /// Rows after x: `[coefficient z][coefficient y]`, and which of them hold anything.
    rows: Vec<f32>,
    has_row: Vec<bool>,
    /// Rows after y: `[coefficient z][y]`, and which planes hold anything.
    planes: Vec<f32>,
    has_plane: Vec<bool>,
    part: Part,
}

/// The functions of the coefficients along x: vectors of weights from an output on.
#[derive(Default)]
struct Columns {
    /// For each vector of outputs and each low coefficient that reaches it.
    low: Vec<[f32; LANES]>,
    /// For each vector of outputs its low coefficients.
    reached: Vec<Range<usize>>,
    /// For each coefficient the first output of its function, and the function.
    own: Vec<(usize, [f32; LANES])>,
}

impl Columns {
    fn build(&mut self, axis: &Axis, stride: usize) {
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

impl Scratch {
    /// Rows of low coefficients along y and z, from the low samples of the box.
    #[inline(always)]
    fn along_x(&mut self, low: &Part) {
        let [x, y, z] = &self.axes;
        let n = [x.out.len(), y.out.len(), z.out.len()];
        self.part.resize(n);
        let stride = self.part.stride;
        self.columns.build(x, stride);
        let n_rows = y.n() * z.n();
        if self.rows.len() < n_rows * stride {
            self.rows.resize(n_rows * stride, 0.0);
        }
        self.has_row.clear();
        self.has_row.resize(n_rows, false);
        for k in 0..z.low.len() {
            for j in 0..y.low.len() {
                let place = k * y.n() + j;
                self.has_row[place] = true;
                let coefficients = low.row(j, k);
                let row = &mut self.rows[place * stride..][..stride];
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

    /// Adds the functions along x of all kept details.
    #[inline(always)]
    fn add_details(&mut self, volume: &WaveletVolume, level: usize, weight: f32) {
        let stride = self.part.stride;
        let [x, y, z] = &self.axes;
        for band in 1..8 {
            let part = |axis: &Axis, bit: usize| {
                if band >> bit & 1 == 0 { (axis.low.clone(), 0) } else { (axis.high.clone(), axis.low.len()) }
            };
            let [(xs, x0), (ys, y0), (zs, z0)] = [part(x, 0), part(y, 1), part(z, 2)];
            let (rows, has_row, own) = (&mut self.rows, &mut self.has_row, &self.columns.own);
            volume.for_each_kept(level, band, &[xs, ys, zs], |[i, j, k], value| {
                let place = (z0 + k) * y.n() + y0 + j;
                let row = &mut rows[place * stride..][..stride];
                if !has_row[place] {
                    has_row[place] = true;
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

    #[inline(always)]
    fn along_y(&mut self) {
        let [_, y, z] = &self.axes;
        let (stride, n_y) = (self.part.stride, y.out.len());
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

    #[inline(always)]
    fn along_z(&mut self) {
        let [_, y, z] = &self.axes;
        let plane = self.part.stride * y.out.len();
        for k in 0..z.out.len() {
            let out = &mut self.part.samples[k * plane..][..plane];
            for (c, out) in out.chunks_exact_mut(self.part.stride).enumerate() {
                sum_rows(&self.planes, plane, c * self.part.stride, z.taps(k), &self.has_plane, out);
            }
        }
    }
}

/// `out = Σ weight · rows[index]`, over the rows that hold anything; rows begin `pitch` apart, from `first` on.
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
