//! NaN and infinity: samples that are not finite are filled from their neighbours, and drawn as empty.
//!
//! Where nothing is known nothing is drawn: what a masked sample reaches has no opacity. The fill only keeps gradients
//! and spline coefficients of the surroundings honest, so it need not go further than the widest kernel and gradient reach:
//! it is a function of a bounded neighbourhood ([`REACH`]), and a box of a volume gives the bits of the whole.

use wavesplat_compute::parallel;

/// Samples along each axis beyond which no fill is looked for.
pub const REACH: usize = 16;

/// Replaces what is not finite by the nearest finite density of its row within [`REACH`]; then, where there is none, of
/// its column; then of its line through the slices; then by `otherwise`.
pub fn fill_holes(grid: &mut [f32], [nx, ny, nz]: [usize; 3], otherwise: f32) {
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
    parallel::for_each_chunk(grid, nx * ny, |_, slice| {
        slice.iter_mut().filter(|density| !density.is_finite()).for_each(|density| *density = otherwise);
    });
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
            if let Some(source) = source.filter(|source| source.abs_diff(k) <= REACH) {
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
        fill_holes(&mut grid, [4, 1, 3], 9.0);
        assert_eq!(grid, [1.0, 1.0, 4.0, 4.0, 1.0, 1.0, 4.0, 4.0, 5.0, 6.0, 7.0, 7.0]);
    }

    #[test]
    fn far_from_everything_there_is_no_neighbour() {
        let mut line = vec![f32::NAN; 60];
        line[0] = 2.0;
        fill_holes(&mut line, [60, 1, 1], 0.5);
        assert!(line[..=REACH].iter().all(|d| *d == 2.0) && line[REACH + 1..].iter().all(|d| *d == 0.5));
    }
}
