//! Windows of slices, read from wherever the samples are: several slices combined into one, or slices transposed.
//!
//! Indices beyond the border are folded back as the kernel requires. Samples keep their own type until they are summed.

use wavesplat_compute::simd::{LANES, Lanes, Simd, VectorKernel, prefetch};
use wavesplat_core::Kernel;

use crate::kernel::slice_taps::SliceTap;
use crate::kernel::weights::mirror_index;

/// A rectangle of sample positions in a slice, `u` and `v` inclusive, before folding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First and last index along u.
    pub u: [i64; 2],
    /// First and last index along v.
    pub v: [i64; 2],
}

impl Window {
    /// Samples per row.
    pub fn n_u(&self) -> usize {
        (self.u[1] - self.u[0] + 1) as usize
    }

    /// Rows.
    pub fn n_v(&self) -> usize {
        (self.v[1] - self.v[0] + 1) as usize
    }
}

/// A window of a strided grid with its border folded back.
pub struct SliceRectangle {
    kernel: Kernel,
    stride: [usize; 3],
    n: [usize; 3],
    /// Position of the grid's first sample, along u, v, w.
    origin: [usize; 3],
    /// One past the last slice along w that the grid holds.
    end_w: usize,
    window: Window,
    out_stride: usize,
}

impl SliceRectangle {
    /// Window of a whole grid of `size`. `axes`: the index axes called u, v, w. `out_stride`: elements from an output
    /// row to the next.
    pub fn new(kernel: Kernel, size: [usize; 3], axes: [usize; 3], window: Window, out_stride: usize) -> Self {
        let all = [1, size[0], size[0] * size[1]];
        let (stride, n) = (axes.map(|a| all[a]), axes.map(|a| size[a]));
        Self { kernel, stride, n, origin: [0; 3], end_w: n[2], window, out_stride }
    }

    /// The same window, read from a box of the grid that begins at `lo`.
    #[must_use]
    pub fn inside(self, axes: [usize; 3], lo: [usize; 3], size: [usize; 3]) -> Self {
        let all = [1, size[0], size[0] * size[1]];
        let end_w = lo[axes[2]] + size[axes[2]];
        Self { stride: axes.map(|a| all[a]), origin: axes.map(|a| lo[a]), end_w, ..self }
    }

    /// Offset of a sample along one axis (0, 1: u, v), folded back.
    #[inline(always)]
    fn place(&self, axis: usize, i: i64) -> usize {
        (mirror_index(self.kernel, i, self.n[axis]) - self.origin[axis]) * self.stride[axis]
    }

    /// Writes `out[v · stride + u] = Σ weight · density` over the slices of `taps`. `soon`: a slice that is combined
    /// soon; each of its rows is prefetched while the same row of the taps is summed.
    #[inline(always)]
    pub fn combine<T: Copy>(
        &self,
        grid: &[T],
        taps: &[SliceTap],
        soon: Option<usize>,
        out: &mut [f32],
        density: impl Fn(T) -> f32,
    ) {
        let Window { u: [u_lo, u_hi], v: [v_lo, _] } = self.window;
        let [su, sv, sw] = self.stride;
        let [first_u, first_v, first_w] = self.origin;
        let last = self.n[0] as i64 - 1;
        // Columns that need no folding.
        let inner_lo = u_lo.clamp(0, last);
        let inner_hi = u_hi.clamp(0, last);
        let n_left = (inner_lo - u_lo) as usize;
        let n_inner = (inner_hi - inner_lo + 1) as usize;
        let n_u = self.window.n_u();
        let n_v = self.window.n_v();
        // Rows that need no folding lie evenly, and are found without a remainder.
        let n_above = (v_lo.clamp(0, self.n[1] as i64) - v_lo) as usize;
        let n_even = self.n[1] - (v_lo.clamp(0, self.n[1] as i64)) as usize;
        let even = (v_lo + n_above as i64) as usize;
        let lines = |r: usize| {
            let place = r.wrapping_sub(n_above);
            if place < n_even { (even + place - first_v) * sv } else { self.place(1, v_lo + r as i64) }
        };
        let starts = |slice: usize| (slice - first_w) * sw + (inner_lo as usize - first_u) * su;
        if su == 1 {
            let room = self.out_stride - n_left;
            let out = SumRows { out: &mut out[n_left..], stride: self.out_stride, room, n: n_inner, n_rows: n_v };
            sum_slices(grid, taps, soon, starts, lines, out, &density);
        }
        if su == 1 && n_inner == n_u {
            return;
        }
        for r in 0..n_v {
            let line = lines(r);
            let row = &mut out[r * self.out_stride..];
            if su != 1 {
                let inner = &mut row[n_left..n_left + n_inner];
                inner.fill(0.0);
                for &(slice, weight) in taps {
                    for (o, s) in inner.iter_mut().zip(grid[starts(slice) + line..].iter().step_by(su)) {
                        *o += weight * density(*s);
                    }
                }
            }
            let sum = |i: i64| {
                let place = line + self.place(0, i);
                let at = |slice: usize| density(grid[(slice - first_w) * sw + place]);
                taps.iter().fold(0.0, |sum, &(slice, weight)| sum + weight * at(slice))
            };
            for c in (0..n_left).chain(n_left + n_inner..n_u) {
                row[c] = sum(u_lo + c as i64);
            }
        }
    }
}

/// Rows that sums of slices are written to.
pub struct SumRows<'a> {
    /// Numbers, the first row's from the beginning on.
    pub out: &'a mut [f32],
    /// Numbers from a row to the next.
    pub stride: usize,
    /// Numbers of a row that may be overwritten, so that whole vectors can be written.
    pub room: usize,
    /// Sums per row.
    pub n: usize,
    /// Rows.
    pub n_rows: usize,
}

/// Writes `out = Σ weight · density` over slices whose samples are contiguous along a row. `starts` returns where the
/// samples of a slice begin, `lines` the offset of a row. `soon`: a slice that is combined soon; each of its rows is
/// prefetched while the same row of the taps is summed.
#[inline(always)]
pub fn sum_slices<T: Copy>(
    grid: &[T],
    taps: &[SliceTap],
    soon: Option<usize>,
    starts: impl Fn(usize) -> usize,
    lines: impl Fn(usize) -> usize,
    out: SumRows,
    density: &impl Fn(T) -> f32,
) {
    // The usual numbers of taps, unrolled.
    match taps.len() {
        1 => sum_rows::<1, _>(grid, taps, soon, starts, lines, out, density),
        2 => sum_rows::<2, _>(grid, taps, soon, starts, lines, out, density),
        3 => sum_rows::<3, _>(grid, taps, soon, starts, lines, out, density),
        4 => sum_rows::<4, _>(grid, taps, soon, starts, lines, out, density),
        // Slopes of the usual smoothed gradient.
        5 => sum_rows::<5, _>(grid, taps, soon, starts, lines, out, density),
        6 => sum_rows::<6, _>(grid, taps, soon, starts, lines, out, density),
        _ => {
            for r in 0..out.n_rows {
                let row = &mut out.out[r * out.stride..][..out.n];
                row.fill(0.0);
                for &(slice, weight) in taps {
                    for (o, s) in row.iter_mut().zip(&grid[starts(slice) + lines(r)..]) {
                        *o += weight * density(*s);
                    }
                }
            }
        }
    }
}

/// [`sum_slices`] over `N` slices, in one pass, a vector at a time. Rows of a tile are short, so whole vectors are read
/// and written beyond the end of a row where there is room.
#[inline(always)]
fn sum_rows<const N: usize, T: Copy>(
    grid: &[T],
    taps: &[SliceTap],
    soon: Option<usize>,
    starts: impl Fn(usize) -> usize,
    lines: impl Fn(usize) -> usize,
    SumRows { out, stride, room, n, n_rows }: SumRows,
    density: &impl Fn(T) -> f32,
) {
    let Some(taps) = taps.first_chunk::<N>() else { return };
    let soon = soon.map(&starts);
    let (mut firsts, mut weights) = ([0; N], [0.0; N]);
    for k in 0..N {
        firsts[k] = starts(taps[k].0);
        weights[k] = taps[k].1;
    }
    for r in 0..n_rows {
        let line = lines(r);
        if let Some(soon) = soon {
            prefetch(&grid[soon + line..][..n]);
        }
        let row = &mut out[r * stride..];
        let mut n_room = room.min(row.len());
        let mut rows: [&[T]; N] = [&[]; N];
        for k in 0..N {
            rows[k] = &grid[firsts[k] + line..];
            n_room = n_room.min(rows[k].len());
        }
        // All bounds are checked before the first sample is read: compilers vectorise only loops that no branch
        // interrupts.
        let n_whole = if n.next_multiple_of(LANES) <= n_room { n.next_multiple_of(LANES) } else { n / LANES * LANES };
        let rows = rows.map(|row| &row[..n_room]);
        for i in (0..n_whole).step_by(LANES) {
            let mut sums = [0.0; LANES];
            for k in 0..N {
                let samples = &rows[k][i..i + LANES];
                for j in 0..LANES {
                    sums[j] += weights[k] * density(samples[j]);
                }
            }
            row[i..i + LANES].copy_from_slice(&sums);
        }
        // At the very end of the grid, or where rows lie side by side.
        for i in n_whole..n {
            row[i] = (0..N).fold(0.0, |sum, k| sum + weights[k] * density(rows[k][i]));
        }
    }
}

/// Transposes [`LANES`] slices that lie across the rows of samples, `LANES` x `LANES` samples at a time.
pub struct Transpose<'a, T, F> {
    /// Window to read; its w runs along the rows of samples.
    pub region: SliceRectangle,
    /// Samples to read.
    pub grid: &'a [T],
    /// First of the slices.
    pub first: usize,
    /// Output, laid out as in [`crate::source::slices::Slices::write_transposed`].
    pub out: &'a mut [f32],
    /// Density of a sample.
    pub density: F,
}

impl<T: Copy, F: Fn(T) -> f32> VectorKernel for Transpose<'_, T, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let SliceRectangle { end_w, origin: [_, _, first_w], window, out_stride, .. } = self.region;
        let plane = out_stride * window.n_v();
        let n_here = LANES.min(end_w - self.first);
        let mut block = [Lanes::splat(0.0); LANES];
        for (r, v) in (window.v[0]..=window.v[1]).enumerate() {
            let start = self.region.place(1, v) + self.first - first_w;
            for c in (0..window.n_u()).step_by(LANES) {
                for k in 0..LANES {
                    let u = (window.u[0] + (c + k) as i64).min(window.u[1]);
                    let row = &self.grid[start + self.region.place(0, u)..];
                    if let Some(row) = row.first_chunk::<LANES>() {
                        for i in 0..LANES {
                            block[k].0[i] = (self.density)(row[i]);
                        }
                    } else {
                        for i in 0..LANES {
                            block[k].0[i] = (self.density)(row[i.min(n_here - 1)]);
                        }
                    }
                }
                s.transpose(&mut block);
                for k in 0..n_here {
                    self.out[k * plane + r * out_stride + c..][..LANES].copy_from_slice(&block[k].0);
                }
            }
        }
    }
}
