//! B-spline prefilter: samples -> coefficients whose spline interpolates the samples.
//!
//! One causal and one anticausal first-order recursion per axis with pole `z` (degree 2: `√8 − 3`, degree 3: `√3 − 2`)
//! and whole-sample mirror boundaries. Source: Unser, Aldroubi, Eden, "B-spline signal processing", 1993.

use wavesplat_compute::parallel;
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
    // First causal value: the mirrored signal's whole history, summed until it is below rounding.
    let horizon = ((1e-17_f64.ln() / z.abs().ln()).ceil() as usize).max(2);
    let period = 2 * (n - 1);
    let mut power = 1.0;
    let mut first = 0.0;
    for k in 0..horizon {
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

/// Prefilters a whole `[nx, ny, nz]` grid along its three axes, in place. Recursions run in f64.
pub fn prefilter_volume(grid: &mut [f32], size: [usize; 3], z: f64) {
    let [nx, ny, _] = size;
    // x and y: each slice is independent.
    parallel::for_each_chunk(grid, nx * ny, |_, slice| {
        let mut line = vec![0.0; nx.max(ny)];
        for row in slice.chunks_exact_mut(nx) {
            filter_strided(row, 0, 1, nx, z, &mut line);
        }
        for x in 0..nx {
            filter_strided(slice, x, nx, ny, z, &mut line);
        }
    });
    prefilter_z(grid, size, z);
}

/// The same on one thread, for a small grid.
pub fn prefilter_box(grid: &mut [f32], [nx, ny, nz]: [usize; 3], z: f64) {
    let mut line = vec![0.0; nx.max(ny).max(nz)];
    for row in grid.chunks_exact_mut(nx) {
        filter_strided(row, 0, 1, nx, z, &mut line);
    }
    for slice in grid.chunks_exact_mut(nx * ny) {
        for x in 0..nx {
            filter_strided(slice, x, nx, ny, z, &mut line);
        }
    }
    for i in 0..nx * ny {
        filter_strided(grid, i, nx * ny, nz, z, &mut line);
    }
}

/// The same recursion along z, all columns of a slice at a time, so that memory is read in order.
fn prefilter_z(grid: &mut [f32], [nx, ny, nz]: [usize; 3], z: f64) {
    let slice_len = nx * ny;
    // Lines along z are gathered in blocks of whole rows; blocks are independent.
    let rows = parallel::map(ny, |y| {
        let mut block = vec![0.0_f64; nx * nz];
        for k in 0..nz {
            let row = &grid[k * slice_len + y * nx..][..nx];
            for (x, s) in row.iter().enumerate() {
                block[x * nz + k] = f64::from(*s);
            }
        }
        block.chunks_exact_mut(nz).for_each(|line| prefilter_line(line, z));
        block
    });
    for (y, block) in rows.into_iter().enumerate() {
        for k in 0..nz {
            let row = &mut grid[k * slice_len + y * nx..][..nx];
            for (x, s) in row.iter_mut().enumerate() {
                *s = block[x * nz + k] as f32;
            }
        }
    }
}

fn filter_strided(grid: &mut [f32], start: usize, stride: usize, n: usize, z: f64, line: &mut [f64]) {
    let line = &mut line[..n];
    for (i, l) in line.iter_mut().enumerate() {
        *l = f64::from(grid[start + i * stride]);
    }
    prefilter_line(line, z);
    for (i, l) in line.iter().enumerate() {
        grid[start + i * stride] = *l as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{fold, taps};

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
}
