//! A level of a wavelet volume as a volume of its own: where its low samples lie, and one more at the ends.
//!
//! A low sample of a family by lifting lies on every second sample, one of [`Family::Haar`] between two. Where the last
//! (or first) one lies short of the volume's end, one more repeats it, as the mirrored boundary has it, so that every
//! level fills the same box.

use wavesplat_core as core;

use crate::decode::Decoder;
use crate::family::Family;
use crate::plan::Plan;

/// Where the low samples of a level lie along x, y, z, in indices of the finest grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelGrid {
    /// The first one.
    pub origin: [f64; 3],
    /// Distance of neighbours.
    pub spacing: [f64; 3],
    /// Low samples and those that repeat the ends.
    pub size: [usize; 3],
    /// Whether the first one is a repeated one, 1 or 0.
    n_before: [usize; 3],
}

impl LevelGrid {
    /// Level 0 is the finest grid itself. `None` where low coefficients are not samples: at further levels of the
    /// semi-orthogonal families, where they are not evenly spaced either, and of [`Family::Spline4`], where they are those
    /// of a cubic spline.
    pub fn new(plan: &Plan, level: usize) -> Option<Self> {
        if level > 0 && (plan.family().semi_orthogonal_order().is_some() || plan.family() == Family::Spline4) {
            return None;
        }
        let size = plan.low_size(level);
        let mut grid = Self::finest(size);
        for a in 0..3 {
            for _ in (0..level).map(|k| plan.step(k, a)).filter(|step| step.n_low < step.n) {
                if plan.family() == Family::Haar {
                    grid.origin[a] += 0.5 * grid.spacing[a];
                }
                grid.spacing[a] *= 2.0;
            }
            let last = grid.origin[a] + grid.spacing[a] * (size[a] - 1) as f64;
            let n_after = usize::from(last < (plan.size()[a] - 1) as f64);
            grid.n_before[a] = usize::from(grid.origin[a] > 0.0);
            grid.origin[a] -= grid.spacing[a] * grid.n_before[a] as f64;
            grid.size[a] += grid.n_before[a] + n_after;
        }
        Some(grid)
    }

    /// The finest grid itself.
    pub fn finest(size: [usize; 3]) -> Self {
        Self { origin: [0.0; 3], spacing: [1.0; 3], size, n_before: [0; 3] }
    }

    /// An index position of the finest grid as one of the level.
    pub fn level_from_finest(&self, index: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|a| (index[a] - self.origin[a]) / self.spacing[a])
    }
}

/// Decodes the low samples of a level, and those that repeat the ends.
pub struct Coarse {
    decoder: Decoder,
    grid: LevelGrid,
}

impl Coarse {
    /// `grid`: that of the decoder's level.
    pub fn new(decoder: Decoder, grid: LevelGrid) -> Self {
        Self { decoder, grid }
    }
}

impl core::Decoder for Coarse {
    fn size(&self) -> [usize; 3] {
        self.grid.size
    }

    fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]) {
        let inner = core::Decoder::size(&self.decoder);
        let place = |a: usize, i: usize| i.saturating_sub(self.grid.n_before[a]).min(inner[a] - 1);
        let from = [0, 1, 2].map(|a| place(a, lo[a]));
        let to = [0, 1, 2].map(|a| place(a, hi[a] - 1) + 1);
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
                let first = ((place(2, z) - from[2]) * n[1] + place(1, y) - from[1]) * n[0];
                for (x, out) in (lo[0]..hi[0]).zip(row) {
                    *out = samples[first + place(0, x) - from[0]];
                }
            }
        }
    }
}
