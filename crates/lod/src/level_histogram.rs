//! Level of detail: joint histogram of the finest samples and the values of a coarser level.
//!
//! Every bin of coarse values `d` has the distribution `P(v | d)` of the samples `v` at the positions where the
//! interpolated coarse volume has that value. It is computed from a part of the samples, in boxes all over the volume.

use wavesplat_compute::parallel;
use wavesplat_core::{Decoder, LevelGrid};

use crate::probe_rays::ProbeRays;

/// Number of bins of the range of values.
pub(crate) const N_BINS: usize = 512;

/// Side of the boxes from which the histogram is computed, and their largest number.
const SIDE: usize = 16;
const N_BOXES: usize = 512;

/// Prior: weight, in samples, with which every coarse value stands for itself.
const SELF_COUNT: f32 = 4.0;

/// Share of all samples above which a coarse value is frequent.
const FREQUENT_SHARE: f32 = 0.02;

/// Joint histogram of the samples of the finest level and the values of a coarser one, and rays that probe the
/// brightness of both. Independent of transfer functions; computed once per level.
pub struct LevelHistogram {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    /// `P(v | d)`, one row per bin of coarse values `d`.
    pub(crate) shares: Vec<f32>,
    pub(crate) rays: ProbeRays,
}

impl LevelHistogram {
    /// Histogram of the finest level and a coarser one that lies on `grid`. `spacing`: distance of the finest samples
    /// along each axis, in any unit. `range`: smallest and largest sample. `budget_bytes`: memory for decoded samples;
    /// where the volume does not fit, rays cross narrow parts of it that are decoded one by one.
    ///
    /// # Panics
    /// Where a level has no samples.
    pub fn new(
        fine: &dyn Decoder,
        coarse: &dyn Decoder,
        grid: &LevelGrid,
        spacing: [f64; 3],
        range: [f64; 2],
        budget_bytes: usize,
    ) -> Self {
        let [lo, hi] = range;
        let size = fine.size();
        let n = size.map(|n| n.div_ceil(SIDE));
        let n_all: usize = n.iter().product();
        let n_boxes = n_all.min(N_BOXES);
        // Distinct boxes without a pattern: multiples of a prime.
        let box_idx = |i: usize| (i as u64 * 2_654_435_761 % n_all as u64) as usize;
        let parts = parallel::map(n_boxes, |i| {
            let b = box_idx(i);
            let first = [b % n[0], b / n[0] % n[1], b / (n[0] * n[1])].map(|k| k * SIDE);
            let end = [0, 1, 2].map(|a| (first[a] + SIDE).min(size[a]));
            pairs(fine, coarse, grid, first, end)
        });
        let per_value = if hi > lo { N_BINS as f64 / (hi - lo) } else { 0.0 };
        let bin = |v: f32| (((f64::from(v) - lo) * per_value).max(0.0) as usize).min(N_BINS - 1);
        let mut shares = vec![0.0_f32; N_BINS * N_BINS];
        for (v, d) in parts.into_iter().flatten() {
            shares[bin(d) * N_BINS + bin(v)] += 1.0;
        }
        let mut shares = smooth(&shares);
        for (d, row) in shares.chunks_exact_mut(N_BINS).enumerate() {
            row[d] += SELF_COUNT;
            let n: f32 = row.iter().sum();
            for share in row {
                *share /= n;
            }
        }
        Self { lo, hi, shares, rays: ProbeRays::new([fine, coarse], grid, spacing, budget_bytes, bin) }
    }

    /// Value in the middle of every bin.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> + Clone {
        (0..N_BINS).map(|bin| self.lo + (bin as f64 + 0.5) * self.step())
    }

    /// Width of a bin.
    pub(crate) fn step(&self) -> f64 {
        (self.hi - self.lo) / N_BINS as f64
    }
}

/// Smooths the counts over neighbouring coarse values, none of which counts more than the value itself: random steps
/// from bin to bin would make a smooth function one that has to be pre-integrated. Frequent values are left as they
/// are, so that opaque ones stay opaque and transparent ones transparent.
fn smooth(counts: &[f32]) -> Vec<f32> {
    let n: Vec<f32> = counts.chunks_exact(N_BINS).map(|row| row.iter().sum()).collect();
    let frequent = FREQUENT_SHARE * n.iter().sum::<f32>();
    let mut smooth = vec![0.0; counts.len()];
    for (d, row) in smooth.chunks_exact_mut(N_BINS).enumerate() {
        if n[d] > frequent {
            row.copy_from_slice(&counts[d * N_BINS..][..N_BINS]);
            continue;
        }
        for (k, weight) in [1.0, 2.0, 3.0, 2.0, 1.0].into_iter().enumerate() {
            let Some(from) = (d + k).checked_sub(2).filter(|from| *from < N_BINS) else { continue };
            let weight = weight / 9.0 * (n[d].max(SELF_COUNT) / n[from].max(SELF_COUNT)).min(1.0);
            for (sum, count) in row.iter_mut().zip(&counts[from * N_BINS..]) {
                *sum += weight * count;
            }
        }
    }
    smooth
}

/// Sample and interpolated coarse value at every position of a box of the finest grid.
fn pairs(
    fine: &dyn Decoder,
    coarse: &dyn Decoder,
    grid: &LevelGrid,
    first: [usize; 3],
    end: [usize; 3],
) -> Vec<(f32, f32)> {
    let n @ [nx, ny, nz] = [0, 1, 2].map(|a| end[a] - first[a]);
    let mut values = vec![0.0; nx * ny * nz];
    fine.decode(first, end, &mut values);
    let last = coarse.size().map(|n| n - 1);
    // Lower coarse sample at each position, and weight of the upper one.
    let between = |a: usize| -> Vec<(usize, f32)> {
        let at = |i: usize| {
            let mut index = [0.0; 3];
            index[a] = (first[a] + i) as f64;
            let x = grid.level_from_finest(index)[a].clamp(0.0, last[a] as f64);
            let below = (x as usize).min(last[a].saturating_sub(1));
            (below, (x - below as f64) as f32)
        };
        (0..n[a]).map(at).collect()
    };
    let axes = [0, 1, 2].map(between);
    let lo = [0, 1, 2].map(|a| axes[a][0].0);
    let hi = [0, 1, 2].map(|a| (axes[a][n[a] - 1].0 + 2).min(last[a] + 1));
    let [cx, cy, cz] = [0, 1, 2].map(|a| hi[a] - lo[a]);
    let mut low = vec![0.0; cx * cy * cz];
    coarse.decode(lo, hi, &mut low);
    let mut pairs = Vec::with_capacity(values.len());
    for (k, &(z, tz)) in axes[2].iter().enumerate() {
        for (j, &(y, ty)) in axes[1].iter().enumerate() {
            let row = |dy: usize, dz: usize| {
                let (y, z) = ((y - lo[1] + dy).min(cy - 1), (z - lo[2] + dz).min(cz - 1));
                &low[(z * cy + y) * cx..][..cx]
            };
            let rows = [row(0, 0), row(1, 0), row(0, 1), row(1, 1)];
            let weights = [(1.0 - ty) * (1.0 - tz), ty * (1.0 - tz), (1.0 - ty) * tz, ty * tz];
            for (i, &(x, tx)) in axes[0].iter().enumerate() {
                let (x0, x1) = (x - lo[0], (x - lo[0] + 1).min(cx - 1));
                let d: f32 = rows.iter().zip(weights).map(|(row, w)| w * (row[x0] * (1.0 - tx) + row[x1] * tx)).sum();
                pairs.push((values[(k * ny + j) * nx + i], d));
            }
        }
    }
    pairs
}
