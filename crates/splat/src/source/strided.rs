//! Strided samples: every n-th along each axis of a volume that is not in memory, for uses that need no more.

use std::sync::Arc;

use glam::DVec3;
use wavesplat_core::Grid;

/// Values of every n-th sample along each axis, or densities of a volume whose samples are prepared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StridedSamples {
    /// Step from one to the next, in samples of the volume, along x, y, z.
    pub step: [usize; 3],
    /// Number of strided samples along x, y, z.
    pub size: [usize; 3],
    /// The values, `[z][y][x]`: up to 150 MB for light, so that a survey and the slices made of it share them.
    pub values: Arc<Vec<f32>>,
}

impl StridedSamples {
    /// Strided samples of a volume of `size`, to be filled in.
    pub fn new(size: [usize; 3], step: [usize; 3]) -> Self {
        let own = [0, 1, 2].map(|a| size[a].div_ceil(step[a]));
        Self { step, size: own, values: Arc::new(vec![0.0; own.iter().product()]) }
    }

    /// Copies the strided samples that lie in a box of `n` values, `[z][y][x]`, that begins at `lo`.
    pub fn take(&mut self, values: impl Fn(usize) -> f32, lo: [usize; 3], n: [usize; 3]) {
        let range = |a: usize| lo[a].div_ceil(self.step[a])..(lo[a] + n[a]).div_ceil(self.step[a]).min(self.size[a]);
        let [xs, ys, zs] = [range(0), range(1), range(2)];
        let own = Arc::make_mut(&mut self.values);
        for z in zs {
            for y in ys.clone() {
                let from = n[0] * (y * self.step[1] - lo[1] + n[1] * (z * self.step[2] - lo[2]));
                let to = self.size[0] * (y + self.size[1] * z);
                for x in xs.clone() {
                    own[to + x] = values(from + x * self.step[0] - lo[0]);
                }
            }
        }
    }

    /// Value at an index position, linear between strided samples; the nearest beyond the last of them.
    pub fn linear(&self, index: DVec3) -> f64 {
        let index = index.to_array();
        let places = [0, 1, 2].map(|a| (index[a] / self.step[a] as f64).clamp(0.0, (self.size[a] - 1) as f64));
        let mut sum = 0.0;
        for corner in 0..8_usize {
            let (mut weight, mut at) = (1.0, [0; 3]);
            for (a, place) in places.into_iter().enumerate() {
                let (below, share) = (place as usize, place.fract());
                let is_above = corner >> a & 1 == 1;
                weight *= if is_above { share } else { 1.0 - share };
                at[a] = (below + usize::from(is_above)).min(self.size[a] - 1);
            }
            sum += weight * f64::from(self.values[at[0] + self.size[0] * (at[1] + self.size[1] * at[2])]);
        }
        sum
    }

    /// Row of values at `y` and `z`, which are indices of the volume.
    pub fn row(&self, y: usize, z: usize) -> &[f32] {
        &self.values[self.size[0] * (y / self.step[1] + self.size[1] * (z / self.step[2]))..][..self.size[0]]
    }
}

/// Maximum number of cells, along the longest side, of the coarse volume that light is swept through.
const MAX_CELLS: f64 = 96.0;

/// Samples per cell of the coarse volume that light is swept through, and the step between samples that are read: a
/// part of the samples is enough.
pub fn light_steps(grid: &Grid) -> ([usize; 3], [usize; 3]) {
    let (size, spacing) = (grid.size(), grid.spacing().to_array());
    let longest = (0..3).map(|a| spacing[a] * size[a] as f64).fold(0.0, f64::max);
    let per_cell = [0, 1, 2].map(|a| ((longest / MAX_CELLS / spacing[a]).round().max(1.0) as usize).min(size[a] / 2));
    (per_cell, per_cell.map(|n| n.div_ceil(3)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_between_strided_samples_are_linear() {
        let (size, step) = ([9, 8, 5], [2, 3, 1]);
        let value = |p: DVec3| 1.0 + p.x - 2.0 * p.y + 3.0 * p.z;
        let mut all = StridedSamples::new(size, step);
        let at = |i: usize| value(DVec3::new((i % 9) as f64, (i / 9 % 8) as f64, (i / 72) as f64)) as f32;
        all.take(at, [0; 3], size);
        for p in [DVec3::ZERO, DVec3::new(3.5, 2.25, 1.75), DVec3::new(8.0, 6.0, 4.0)] {
            assert!((all.linear(p) - value(p)).abs() < 1e-5, "{p}");
        }
        assert_eq!(all.linear(DVec3::new(-1.0, 7.0, 9.0)), value(DVec3::new(0.0, 6.0, 4.0)));
    }

    #[test]
    fn boxes_that_divide_nothing_give_every_nth_sample() {
        let size = [11, 7, 9];
        let number = |p: [usize; 3]| (p[0] + 100 * p[1] + 10_000 * p[2]) as f32;
        for step in [[1, 1, 1], [2, 3, 4], [5, 1, 9], [11, 7, 8]] {
            let mut all = StridedSamples::new(size, step);
            for lo in [[0, 0, 0], [4, 0, 0], [0, 3, 0], [4, 3, 0], [0, 0, 5], [4, 0, 5], [0, 3, 5], [4, 3, 5]] {
                let n = [0, 1, 2].map(|a| if lo[a] == 0 { [4, 3, 5][a] } else { size[a] - lo[a] });
                let at = |i: usize| number([lo[0] + i % n[0], lo[1] + i / n[0] % n[1], lo[2] + i / (n[0] * n[1])]);
                all.take(at, lo, n);
            }
            for (i, got) in all.values.iter().enumerate() {
                let [nx, ny, _] = all.size;
                let p = [i % nx * step[0], i / nx % ny * step[1], i / (nx * ny) * step[2]];
                assert_eq!(*got, number(p), "{step:?} {p:?}");
                assert_eq!(all.row(p[1], p[2])[p[0] / step[0]], *got);
            }
        }
    }
}
