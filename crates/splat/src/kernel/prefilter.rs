//! B-spline prefilter: samples -> coefficients whose spline interpolates the samples.
//!
//! One causal and one anticausal first-order recursion per axis with pole `z` (degree 2: `√8 − 3`, degree 3: `√3 − 2`)
//! and whole-sample mirror boundaries. Source: Unser, Aldroubi, Eden, "B-spline signal processing", 1993.

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
    for k in 0..horizon(z) {
        let m = k % period;
        first += power * line[if m < n { m } else { period - m }];
        power *= z;
    }
    line[0] = first;
    for i in 1..n {
        line[i] += z * line[i - 1];
    }
    line[n - 1] = z / (z * z - 1.0) * (line[n - 1] + z * line[n - 2]);
    for i in (0..n - 1).rev() {
        line[i] = z * (line[i + 1] - line[i]);
    }
    for c in line {
        *c *= gain;
    }
}

/// Samples that the first causal value takes: the mirrored signal's whole history, summed until it is below rounding.
fn horizon(z: f64) -> usize {
    ((1e-17_f64.ln() / z.abs().ln()).ceil() as usize).max(2)
}

/// Prefilters a whole `[nx, ny, nz]` grid along its three axes, in place. Recursions run in f64.
pub fn prefilter_volume(grid: &mut [f32], size: [usize; 3], z: f64) {
    let [nx, ny, _] = size;
    // x and y: each slice is independent.
    parallel::for_each_chunk(grid, nx * ny, |_, slice| prefilter_slice(slice, nx, z));
    prefilter_z(grid, size, z);
}

/// Along x and y.
fn prefilter_slice(slice: &mut [f32], nx: usize, z: f64) {
    let mut line = vec![0.0; nx];
    for row in slice.chunks_exact_mut(nx) {
        filter_row(row, z, &mut line);
    }
    let mut rows = vec![0.0; slice.len()];
    Level::best().run(
        #[inline(always)]
        || filter_across(slice, nx, nx, slice.len() / nx, z, &mut rows),
    );
}

/// The same on one thread, for a small grid, to the bit.
pub fn prefilter_box(grid: &mut [f32], [nx, ny, nz]: [usize; 3], z: f64) {
    for slice in grid.chunks_exact_mut(nx * ny) {
        prefilter_slice(slice, nx, z);
    }
    let mut rows = vec![0.0; nx * nz];
    Level::best().run(
        #[inline(always)]
        || {
            for y in 0..ny {
                filter_across(&mut grid[y * nx..], nx * ny, nx, nz, z, &mut rows);
            }
        },
    );
}

/// Filters across `n` rows of `row_len` that begin `stride` apart, all lines side by side.
#[inline(always)]
fn filter_across(grid: &mut [f32], stride: usize, row_len: usize, n: usize, z: f64, rows: &mut [f64]) {
    let rows = &mut rows[..n * row_len];
    for (i, row) in rows.chunks_exact_mut(row_len).enumerate() {
        for (r, s) in row.iter_mut().zip(&grid[i * stride..]) {
            *r = f64::from(*s);
        }
    }
    prefilter_rows(rows, row_len, z);
    for (i, row) in rows.chunks_exact(row_len).enumerate() {
        for (s, r) in grid[i * stride..].iter_mut().zip(row) {
            *s = *r as f32;
        }
    }
}

/// [`prefilter_line`] of as many lines as a row is long, all at a time.
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

/// Rows of each slice that are filtered along z before they are put back: what they take is small beside the volume.
const N_ROWS_ALONG_Z: usize = 16;

/// The same along z. Rows of all slices that lie behind each other are independent of others.
fn prefilter_z(grid: &mut [f32], [nx, ny, nz]: [usize; 3], z: f64) {
    for first in (0..ny).step_by(N_ROWS_ALONG_Z) {
        let n = N_ROWS_ALONG_Z.min(ny - first);
        let filtered = parallel::map(n, |r| {
            let rows = (0..nz).flat_map(|k| &grid[(k * ny + first + r) * nx..][..nx]);
            let mut rows: Vec<f64> = rows.map(|s| f64::from(*s)).collect();
            Level::best().run(
                #[inline(always)]
                || prefilter_rows(&mut rows, nx, z),
            );
            rows
        });
        parallel::for_each_chunk(grid, nx * ny, |k, slice| {
            for (row, rows) in slice[first * nx..].chunks_exact_mut(nx).zip(&filtered) {
                row.iter_mut().zip(&rows[k * nx..]).for_each(|(s, r)| *s = *r as f32);
            }
        });
    }
}

fn filter_row(row: &mut [f32], z: f64, line: &mut [f64]) {
    line.iter_mut().zip(row.iter()).for_each(|(l, s)| *l = f64::from(*s));
    prefilter_line(line, z);
    row.iter_mut().zip(line).for_each(|(s, l)| *s = *l as f32);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::weights::{fold, taps};

    #[test]
    fn the_spline_goes_through_the_samples() {
        for kernel in [Kernel::Bspline2, Kernel::Bspline3] {
            for n in [2, 3, 4, 7, 30] {
                let samples: Vec<f64> = (0..n).map(|i| f64::from((i * 37 + 11) % 17)).collect();
                let mut c = samples.clone();
                prefilter_line(&mut c, pole(kernel).unwrap());
                for (i, sample) in samples.iter().enumerate() {
                    let (first, weights) = taps(kernel, i as f64);
                    let at = |t: usize| c[fold(kernel, first + t as i64, samples.len())];
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

    /// Line by line.
    fn plain(grid: &mut [f32], size: [usize; 3], z: f64) {
        let strides = [1, size[0], size[0] * size[1]];
        for axis in 0..3 {
            for start in (0..grid.len()).filter(|i| (i / strides[axis]).is_multiple_of(size[axis])) {
                let places = (0..size[axis]).map(|k| start + k * strides[axis]);
                let mut line: Vec<f64> = places.clone().map(|i| f64::from(grid[i])).collect();
                prefilter_line(&mut line, z);
                places.zip(line).for_each(|(i, s)| grid[i] = s as f32);
            }
        }
    }

    #[test]
    fn volumes_and_boxes_are_filtered_as_their_lines_are() {
        for size in [[2, 2, 2], [5, 2, 9], [60, 33, 17], [1, 7, 3]] {
            let samples: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 251) as f32).collect();
            for kernel in [Kernel::Bspline2, Kernel::Bspline3] {
                let z = pole(kernel).unwrap();
                let (mut want, mut volume, mut small) = (samples.clone(), samples.clone(), samples.clone());
                plain(&mut want, size, z);
                prefilter_volume(&mut volume, size, z);
                prefilter_box(&mut small, size, z);
                assert_eq!(volume, want, "{kernel:?} {size:?}");
                assert_eq!(small, want, "{kernel:?} {size:?}");
            }
        }
    }
}
