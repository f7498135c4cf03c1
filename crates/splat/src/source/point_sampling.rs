//! Reconstruction at single points: weighted sums over the samples that a kernel reaches, in f64.

use crate::kernel::weights::MAX_TAPS;

/// Taps of one position: folded indices and weights along x, y and z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointTaps {
    /// Folded indices of samples or coefficients.
    pub index: [[usize; MAX_TAPS]; 3],
    /// Weights of the taps; 0 beyond those that the kernel has.
    pub weight: [[f64; MAX_TAPS]; 3],
    /// Samples at both ends of the cell, and the weights that the linear kernel gives them.
    pub cell: [[(usize, f64); 2]; 3],
}

/// Weighted sums over the taps of points, from a grid or a box of it.
pub(super) struct PointSums {
    pub(super) n_taps: usize,
    pub(super) lo: [usize; 3],
    pub(super) size: [usize; 3],
}

impl PointSums {
    /// First and one past the last index of any tap, along x, y, z.
    pub(super) fn reached(&self, points: &[PointTaps]) -> Option<([usize; 3], [usize; 3])> {
        let ends = |axis: usize| {
            let all = points.iter().flat_map(|point| &point.index[axis][..self.n_taps]);
            Some((*all.clone().min()?, *all.max()? + 1))
        };
        let [x, y, z] = [ends(0)?, ends(1)?, ends(2)?];
        Some(([x.0, y.0, z.0], [x.1, y.1, z.1]))
    }

    pub(super) fn write<T: Copy>(&self, grid: &[T], points: &[PointTaps], out: &mut [f64], sample: impl Fn(T) -> f64) {
        self.write_at(points, out, |i| sample(grid[i]));
    }

    /// Writes the sum of each point, like [`PointSums::write`]; `sample` takes a place in the grid.
    pub(super) fn write_at(&self, points: &[PointTaps], out: &mut [f64], sample: impl Fn(usize) -> f64) {
        for (point, out) in points.iter().zip(out) {
            let mut sum = 0.0;
            self.for_each_tap(point, |i, weight| sum += weight * sample(i));
            *out = sum;
        }
    }

    /// Calls `work` with the place in the grid and the linear weight of each corner of a cell whose weight is not 0.
    pub(super) fn for_each_cell_tap(&self, point: &PointTaps, mut work: impl FnMut(usize, f64)) {
        let [nx, ny, _] = self.size;
        let taps = |axis: usize| {
            let lo = self.lo[axis];
            point.cell[axis].iter().filter(|(_, weight)| *weight != 0.0).map(move |(i, weight)| (i - lo, *weight))
        };
        for (z, weight_z) in taps(2) {
            for (y, weight_y) in taps(1) {
                let row = (z * ny + y) * nx;
                taps(0).for_each(|(x, weight_x)| work(row + x, weight_x * weight_y * weight_z));
            }
        }
    }

    /// Calls `work` with the place in the grid and the weight of each tap, except weights of 0: their samples may be
    /// NaN.
    #[inline(always)]
    pub(super) fn for_each_tap(&self, point: &PointTaps, mut work: impl FnMut(usize, f64)) {
        let [nx, ny, _] = self.size;
        let taps = |axis: usize| {
            let (index, weight) = (&point.index[axis][..self.n_taps], &point.weight[axis]);
            let lo = self.lo[axis];
            index.iter().zip(weight).filter(|(_, weight)| **weight != 0.0).map(move |(i, weight)| (i - lo, *weight))
        };
        for (z, weight_z) in taps(2) {
            for (y, weight_y) in taps(1) {
                let row = (z * ny + y) * nx;
                taps(0).for_each(|(x, weight_x)| work(row + x, weight_x * weight_y * weight_z));
            }
        }
    }
}
