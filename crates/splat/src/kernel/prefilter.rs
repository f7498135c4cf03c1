//! B-spline prefilter: samples -> coefficients whose spline interpolates the samples.
//!
//! One causal and one anticausal first-order recursion per axis with pole `z` (degree 2: `√8 − 3`, degree 3: `√3 − 2`)
//! and whole-sample mirror boundaries. Source: Unser, Aldroubi, Eden, "B-spline signal processing", 1993.
//!
//! A recursion reaches from one end of a line to the other, but samples a few places away hardly count. Lines of
//! volumes are filtered in segments of [`SEGMENT`] samples, each from its own samples and [`MARGIN`] on either side
//! alone, so that a coefficient is a function of a bounded neighbourhood: any box of a volume gives the bits of the
//! whole.

use std::ops::Range;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::Kernel;

/// Pole of the recursion; `None` for kernels that need no prefilter.
pub fn pole(kernel: Kernel) -> Option<f64> {
    match kernel {
        Kernel::Bspline2 => Some(8.0_f64.sqrt() - 3.0),
        Kernel::Bspline3 => Some(3.0_f64.sqrt() - 2.0),
        _ => None,
    }
}

/// Turns one line of samples into coefficients, in place.
pub fn prefilter_line(line: &mut [f64], z: f64) {
    let n = line.len();
    if n < 2 {
        return;
    }
    let gain = (1.0 - z) * (1.0 - 1.0 / z);
    let period = 2 * (n - 1);
    let mut power = 1.0;
    let mut first = 0.0;
    // The causal recursion starts infinitely far out on the mirrored line, which repeats after `period`. Powers of the
    // pole beyond the horizon are below the precision, so a finite sum is as good.
    for k in 0..horizon(z) {
        let m = k % period;
        first += power * line[if m < n { m } else { period - m }];
        power *= z;
    }
    line[0] = first;
    for i in 1..n {
        line[i] += z * line[i - 1];
    }
    // About its end the mirrored line is even, which gives the infinite anticausal sum a closed form.
    line[n - 1] = z / (z * z - 1.0) * (line[n - 1] + z * line[n - 2]);
    for i in (0..n - 1).rev() {
        line[i] = z * (line[i + 1] - line[i]);
    }
    for c in line {
        *c *= gain;
    }
}

/// Length of the segments of a line, whose coefficients are computed together; they begin at multiples of this, counted
/// from the volume's first sample.
pub const SEGMENT: usize = 32;

/// Samples on either side of a segment that its coefficients depend on: the pole to this power is below f32.
pub const MARGIN: usize = 14;

/// The samples along an axis of `n` that the coefficients of `samples` depend on.
pub fn needed(samples: &Range<usize>, n: usize) -> Range<usize> {
    let first = samples.start / SEGMENT * SEGMENT;
    let end = samples.end.div_ceil(SEGMENT) * SEGMENT;
    first.saturating_sub(MARGIN)..(end + MARGIN).min(n)
}

/// The segments of `n` samples from `origin` on: the part of the run in each, and the part that it is computed from.
fn segments(origin: usize, n: usize) -> impl Iterator<Item = [Range<usize>; 2]> {
    (origin / SEGMENT..(origin + n).div_ceil(SEGMENT)).map(move |k| {
        let within = |position: usize| position.clamp(origin, origin + n) - origin;
        let (first, end) = (k * SEGMENT, (k + 1) * SEGMENT);
        [within(first)..within(end), within(first.saturating_sub(MARGIN))..within(end + MARGIN)]
    })
}

/// Number of samples in the first causal value: the mirrored signal's whole history, until it is below rounding.
fn horizon(z: f64) -> usize {
    ((1e-17_f64.ln() / z.abs().ln()).ceil() as usize).max(2)
}

/// Prefilters a whole `[nx, ny, nz]` grid along its three axes, in place. Recursions run in f64.
pub fn prefilter_volume(grid: &mut [f32], size: [usize; 3], z: f64) {
    let [nx, ny, _] = size;
    // x and y: each slice is independent.
    parallel::for_each_chunk(grid, nx * ny, |_, slice| prefilter_slice(slice, [0; 2], nx, z));
    prefilter_z(grid, size, z);
}

/// Prefilters a slice along x and y, in place.
fn prefilter_slice(slice: &mut [f32], origin: [usize; 2], nx: usize, z: f64) {
    let mut line = Vec::new();
    let mut filtered = vec![0.0; nx];
    for row in slice.chunks_exact_mut(nx) {
        filter_row(row, origin[0], z, &mut line, &mut filtered);
    }
    let mut rows = Vec::new();
    Level::best().run(
        #[inline(always)]
        || filter_across(slice, nx, nx, (origin[1], slice.len() / nx), z, &mut rows),
    );
}

/// Turns the samples of a box of a volume into B-spline coefficients, in place, on one thread. The box begins at
/// `origin`; `pole` is the kernel's ([`pole`]). Coefficients equal the whole volume's to the
/// bit where the box holds all samples that are [`needed`].
pub fn prefilter_box(grid: &mut [f32], origin: [usize; 3], [nx, ny, nz]: [usize; 3], pole: f64) {
    for slice in grid.chunks_exact_mut(nx * ny) {
        prefilter_slice(slice, [origin[0], origin[1]], nx, pole);
    }
    let mut rows = Vec::new();
    Level::best().run(
        #[inline(always)]
        || {
            for y in 0..ny {
                filter_across(&mut grid[y * nx..], nx * ny, nx, (origin[2], nz), pole, &mut rows);
            }
        },
    );
}

/// Filters across `n` rows of `row_len` that begin `stride` apart, all lines side by side; the first row is sample
/// `origin` of the lines.
#[inline(always)]
fn filter_across(
    grid: &mut [f32],
    stride: usize,
    row_len: usize,
    (origin, n): (usize, usize),
    z: f64,
    rows: &mut Vec<f64>,
) {
    let mut all = Vec::with_capacity(n * row_len);
    for i in 0..n {
        all.extend(grid[i * stride..][..row_len].iter().map(|s| f64::from(*s)));
    }
    for [own, from] in segments(origin, n) {
        rows.clear();
        rows.extend_from_slice(&all[from.start * row_len..from.end * row_len]);
        prefilter_rows(rows, row_len, z);
        for (i, row) in own.clone().zip(rows[(own.start - from.start) * row_len..].chunks_exact(row_len)) {
            for (s, r) in grid[i * stride..].iter_mut().zip(row) {
                *s = *r as f32;
            }
        }
    }
}

/// [`prefilter_line`] of `row_len` lines at a time, one per column of `rows`.
#[inline(always)]
fn prefilter_rows(rows: &mut [f64], row_len: usize, z: f64) {
    let n = rows.len() / row_len;
    if n < 2 {
        return;
    }
    let gain = (1.0 - z) * (1.0 - 1.0 / z);
    let period = 2 * (n - 1);
    let mut power = 1.0;
    let mut first = vec![0.0; row_len];
    for k in 0..horizon(z) {
        let m = k % period;
        let row = &rows[if m < n { m } else { period - m } * row_len..];
        for (f, r) in first.iter_mut().zip(row) {
            *f += power * r;
        }
        power *= z;
    }
    rows[..row_len].copy_from_slice(&first);
    for i in 1..n {
        let (before, own) = rows[(i - 1) * row_len..].split_at_mut(row_len);
        for (o, b) in own.iter_mut().zip(before) {
            *o += z * *b;
        }
    }
    let (before, last) = rows[(n - 2) * row_len..].split_at_mut(row_len);
    for (l, b) in last.iter_mut().zip(before) {
        *l = z / (z * z - 1.0) * (*l + z * *b);
    }
    for i in (0..n - 1).rev() {
        let (own, after) = rows[i * row_len..].split_at_mut(row_len);
        for (o, a) in own.iter_mut().zip(after) {
            *o = z * (*a - *o);
        }
    }
    for c in rows {
        *c *= gain;
    }
}

/// Rows of each slice that are filtered along z before they are put back: their copy is small beside the volume.
const N_ROWS_ALONG_Z: usize = 16;

/// Prefilters a volume along z, in place. Lines of one row are independent of other rows.
fn prefilter_z(grid: &mut [f32], [nx, ny, nz]: [usize; 3], z: f64) {
    for first in (0..ny).step_by(N_ROWS_ALONG_Z) {
        let n = N_ROWS_ALONG_Z.min(ny - first);
        let filtered = parallel::map(n, |r| {
            let rows = (0..nz).flat_map(|k| &grid[(k * ny + first + r) * nx..][..nx]);
            let mut rows: Vec<f32> = rows.copied().collect();
            let mut work = Vec::new();
            Level::best().run(
                #[inline(always)]
                || filter_across(&mut rows, nx, nx, (0, nz), z, &mut work),
            );
            rows
        });
        parallel::for_each_chunk(grid, nx * ny, |k, slice| {
            for (row, rows) in slice[first * nx..].chunks_exact_mut(nx).zip(&filtered) {
                row.copy_from_slice(&rows[k * nx..][..nx]);
            }
        });
    }
}

fn filter_row(row: &mut [f32], origin: usize, z: f64, line: &mut Vec<f64>, filtered: &mut [f64]) {
    for [own, from] in segments(origin, row.len()) {
        line.clear();
        line.extend(row[from.clone()].iter().map(|s| f64::from(*s)));
        prefilter_line(line, z);
        filtered[own.clone()].copy_from_slice(&line[own.start - from.start..][..own.len()]);
    }
    row.iter_mut().zip(filtered).for_each(|(s, l)| *s = *l as f32);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::weights::{mirror_index, taps};

    #[test]
    fn the_spline_goes_through_the_samples() {
        for kernel in [Kernel::Bspline2, Kernel::Bspline3] {
            for n in [2, 3, 4, 7, 30] {
                let samples: Vec<f64> = (0..n).map(|i| f64::from((i * 37 + 11) % 17)).collect();
                let mut c = samples.clone();
                prefilter_line(&mut c, pole(kernel).unwrap());
                for (i, sample) in samples.iter().enumerate() {
                    let (first, weights) = taps(kernel, i as f64);
                    let at = |t: usize| c[mirror_index(kernel, first + t as i64, samples.len())];
                    let value: f64 = weights.iter().enumerate().map(|(t, w)| w * at(t)).sum();
                    assert!((value - sample).abs() < 1e-10, "{kernel:?} n={n} i={i}: {value} for {sample}");
                }
            }
        }
    }

    #[test]
    fn a_volume_is_filtered_along_all_axes() {
        let size = [4, 3, 5];
        let z = pole(Kernel::Bspline3).unwrap();
        // A separable signal's coefficients are the product of its lines' coefficients.
        let lines = size.map(|n| (0..n).map(|i| ((i * 5 + 2) % 7) as f64 - 2.5).collect::<Vec<_>>());
        let mut grid = Vec::new();
        for c in &lines[2] {
            for b in &lines[1] {
                grid.extend(lines[0].iter().map(|a| (a * b * c) as f32));
            }
        }
        prefilter_volume(&mut grid, size, z);
        let filtered = lines.map(|mut l| {
            prefilter_line(&mut l, z);
            l
        });
        for (i, got) in grid.iter().enumerate() {
            let want = filtered[0][i % 4] * filtered[1][i / 4 % 3] * filtered[2][i / 12];
            assert!((f64::from(*got) - want).abs() < 1e-4, "{i}: {got} for {want}");
        }
    }

    /// Prefilters line by line, in segments or, if `is_whole`, as one recursion each.
    fn plain(grid: &mut [f32], size: [usize; 3], z: f64, is_whole: bool) {
        let strides = [1, size[0], size[0] * size[1]];
        for axis in 0..3 {
            for start in (0..grid.len()).filter(|i| (i / strides[axis]).is_multiple_of(size[axis])) {
                let places: Vec<usize> = (0..size[axis]).map(|k| start + k * strides[axis]).collect();
                let line: Vec<f64> = places.iter().map(|i| f64::from(grid[*i])).collect();
                for [own, from] in
                    if is_whole { vec![[0..line.len(), 0..line.len()]] } else { segments(0, line.len()).collect() }
                {
                    let mut part = line[from.clone()].to_vec();
                    prefilter_line(&mut part, z);
                    own.for_each(|k| grid[places[k]] = part[k - from.start] as f32);
                }
            }
        }
    }

    #[test]
    fn volumes_and_boxes_are_filtered_as_their_lines_are() {
        for size in [[2, 2, 2], [5, 2, 9], [90, 33, 17], [1, 7, 3], [9, 70, 40]] {
            let samples: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 251) as f32).collect();
            for kernel in [Kernel::Bspline2, Kernel::Bspline3] {
                let z = pole(kernel).unwrap();
                let [mut want, mut exact, mut volume, mut small] = [0; 4].map(|_| samples.clone());
                plain(&mut want, size, z, false);
                plain(&mut exact, size, z, true);
                prefilter_volume(&mut volume, size, z);
                prefilter_box(&mut small, [0; 3], size, z);
                assert_eq!(volume, want, "{kernel:?} {size:?}");
                assert_eq!(small, want, "{kernel:?} {size:?}");
                // Samples beyond the margins count less than rounding to f32 does: coefficients are up to 1000.
                let furthest = exact.iter().zip(&want).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(furthest < 2e-4, "{kernel:?} {size:?}: {furthest}");
            }
        }
    }

    #[test]
    fn a_box_has_the_coefficients_of_the_whole() {
        let (size, z) = ([100, 40, 70], pole(Kernel::Bspline3).unwrap());
        let samples: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 251) as f32).collect();
        let mut whole = samples.clone();
        prefilter_volume(&mut whole, size, z);
        let place = |p: [usize; 3]| p[0] + size[0] * (p[1] + size[1] * p[2]);
        for wanted in [[3..9, 0..40, 31..33], [40..41, 5..6, 69..70], [0..100, 33..40, 0..1], [63..65, 31..33, 10..60]]
        {
            let from = [0, 1, 2].map(|a| needed(&wanted[a], size[a]));
            let [nx, ny, nz] = [0, 1, 2].map(|a| from[a].len());
            let mut part = Vec::new();
            for z in from[2].clone() {
                for y in from[1].clone() {
                    part.extend_from_slice(&samples[place([from[0].start, y, z])..][..nx]);
                }
            }
            prefilter_box(&mut part, [0, 1, 2].map(|a| from[a].start), [nx, ny, nz], z);
            for z in wanted[2].clone() {
                for y in wanted[1].clone() {
                    for x in wanted[0].clone() {
                        let [i, j, k] = [x - from[0].start, y - from[1].start, z - from[2].start];
                        assert_eq!(part[i + nx * (j + ny * k)], whole[place([x, y, z])], "{x} {y} {z}");
                    }
                }
            }
        }
    }
}
