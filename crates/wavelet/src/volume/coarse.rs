//! Level of detail: a level of a wavelet volume as a volume of its own.
//!
//! Its samples are the low-pass coefficients, on [`level_grid`](crate::TransformPlan::level_grid); at an end that these
//! do not reach, one more sample repeats the last.

use wavesplat_core::{Decoder, LevelGrid};

use super::decode::CoefficientDecoder;
use crate::error::WaveletError;

/// Decoder of the samples of a level.
pub struct CoarseLevel {
    decoder: CoefficientDecoder,
    grid: LevelGrid,
    /// Number of samples along each axis that repeat the first coefficient, 1 or 0.
    n_before: [usize; 3],
}

impl CoarseLevel {
    /// Makes a volume of the decoder's level. Fails where its low-pass coefficients are not samples, see
    /// [`TransformPlan::level_grid`].
    ///
    /// [`TransformPlan::level_grid`]: crate::TransformPlan::level_grid
    pub fn new(decoder: CoefficientDecoder) -> Result<Self, WaveletError> {
        let (plan, level) = (decoder.plan(), decoder.level());
        let grid = plan.level_grid(level).ok_or(WaveletError::NoSampleGrid { family: plan.family(), level })?;
        // Low-pass coefficients start at 0 or beyond: a sample before 0 repeats the first of them.
        let n_before = grid.origin.map(|first| usize::from(first < 0.0));
        Ok(Self { decoder, grid, n_before })
    }

    /// Sample grid of the level.
    pub fn grid(&self) -> LevelGrid {
        self.grid
    }
}

impl Decoder for CoarseLevel {
    fn size(&self) -> [usize; 3] {
        self.grid.size
    }

    fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]) {
        let inner = self.decoder.size();
        let inner_idx = |a: usize, i: usize| i.saturating_sub(self.n_before[a]).min(inner[a] - 1);
        let from = [0, 1, 2].map(|a| inner_idx(a, lo[a]));
        let to = [0, 1, 2].map(|a| inner_idx(a, hi[a] - 1) + 1);
        let n = [0, 1, 2].map(|a| to[a] - from[a]);
        if (0..3).all(|a| n[a] == hi[a] - lo[a]) {
            return self.decoder.decode(from, to, out);
        }
        let mut samples = vec![0.0; n.iter().product()];
        self.decoder.decode(from, to, &mut samples);
        let mut rows = out.chunks_exact_mut(hi[0] - lo[0]);
        for z in lo[2]..hi[2] {
            for y in lo[1]..hi[1] {
                let Some(row) = rows.next() else { return };
                let first = ((inner_idx(2, z) - from[2]) * n[1] + inner_idx(1, y) - from[1]) * n[0];
                for (x, out) in (lo[0]..hi[0]).zip(row) {
                    *out = samples[first + inner_idx(0, x) - from[0]];
                }
            }
        }
    }
}
