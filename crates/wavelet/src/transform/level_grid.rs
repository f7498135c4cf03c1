//! Sample grid of a coarser level: positions of its low-pass coefficients among the samples.
//!
//! The low-pass coefficients of a family by lifting lie on every second sample, coefficients of
//! [`WaveletFamily::Haar`] between two samples. Where the first or last coefficient lies short of the volume's end, one
//! more sample repeats it, as the mirrored boundary does, so that every level fills the same box.

use wavesplat_core::LevelGrid;

use super::plan::TransformPlan;
use crate::family::WaveletFamily;

impl TransformPlan {
    /// Sample grid of a level; level 0 is the finest grid itself. `None` where low-pass coefficients are not samples:
    /// above level 0 of the semi-orthogonal families, where they are not evenly spaced either, and of
    /// [`WaveletFamily::Spline4`], where they are the coefficients of a cubic spline.
    ///
    /// # Panics
    /// Where `level` exceeds [`TransformPlan::n_levels`].
    pub fn level_grid(&self, level: usize) -> Option<LevelGrid> {
        let family = self.family();
        if level > 0 && (family.semi_orthogonal_order().is_some() || family == WaveletFamily::Spline4) {
            return None;
        }
        let size = self.low_size(level);
        let mut grid = LevelGrid::finest(size);
        for a in 0..3 {
            for _ in (0..level).map(|k| self.step(k, a)).filter(|step| step.n_low < step.n) {
                if family == WaveletFamily::Haar {
                    grid.origin[a] += 0.5 * grid.spacing[a];
                }
                grid.spacing[a] *= 2.0;
            }
            let last = grid.origin[a] + grid.spacing[a] * (size[a] - 1) as f64;
            let n_after = usize::from(last < (self.size()[a] - 1) as f64);
            let n_before = usize::from(grid.origin[a] > 0.0);
            grid.origin[a] -= grid.spacing[a] * n_before as f64;
            grid.size[a] += n_before + n_after;
        }
        Some(grid)
    }
}
