//! Samples that are NaN or infinite, filled from their neighbours.

use wavesplat_compute::parallel;

/// Replaces what is not finite by the nearest finite density of its row; then, for rows without any, of its column;
/// then of its line through the slices.
pub fn fill_holes(grid: &mut [f32], [nx, ny, nz]: [usize; 3]) {
    parallel::for_each_chunk(grid, nx * ny, |_, slice| {
        for y in 0..ny {
            fill_line(slice, y * nx, 1, nx);
        }
        for x in 0..nx {
            fill_line(slice, x, nx, ny);
        }
    });
    for i in 0..nx * ny {
        fill_line(grid, i, nx * ny, nz);
    }
}

fn fill_line(grid: &mut [f32], start: usize, stride: usize, n: usize) {
    let mut before: Option<usize> = None;
    let mut i = 0;
    while i < n {
        if grid[start + i * stride].is_finite() {
            before = Some(i);
            i += 1;
            continue;
        }
        let after = (i..n).find(|&k| grid[start + k * stride].is_finite());
        let end = after.unwrap_or(n);
        for k in i..end {
            let source = match (before, after) {
                (Some(b), Some(a)) => Some(if k - b <= a - k { b } else { a }),
                (b, a) => b.or(a),
            };
            if let Some(source) = source {
                grid[start + k * stride] = grid[start + source * stride];
            }
        }
        i = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_take_their_nearest_neighbour() {
        let nan = f32::NAN;
        let mut grid = vec![1.0, nan, nan, 4.0, nan, nan, nan, nan, 5.0, 6.0, 7.0, f32::INFINITY];
        fill_holes(&mut grid, [4, 1, 3]);
        assert_eq!(grid, [1.0, 1.0, 4.0, 4.0, 1.0, 1.0, 4.0, 4.0, 5.0, 6.0, 7.0, 7.0]);
    }
}
