//! Decoder of a wavelet volume: samples of any box of a level, straight from the retained coefficients.
//!
//! A sample at level `k` is a sum over the axes' synthesis taps of low-pass samples of level `k + 1` and details of
//! level `k`. So a box needs a box of low-pass samples half as large and a few samples wider, and so on recursively, up
//! to a level small enough to be held as a whole.
//!
//! Each sample is summed in the order of its taps, so it does not depend on the box. It equals the result of
//! [`crate::synthesise`], which works by lifting, up to rounding.

use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

use wavesplat_compute::simd::Level;
use wavesplat_compute::{extent, parallel};
use wavesplat_core::Decoder;

use super::sparse_synthesis::{DecodedBox, LevelScratch};
use super::wavelet_volume::WaveletVolume;
use crate::error::WaveletError;
use crate::transform::plan::TransformPlan;

/// Number of levels from the decoder's own to the low-pass samples held in memory, which are a 512th of its samples.
const LEVELS_ABOVE: usize = 3;

/// Side of the boxes in which a whole level is decoded.
const SIDE: usize = 32;

/// Decoder of one level of a wavelet volume, with a weight for each level's details.
pub struct CoefficientDecoder {
    volume: Arc<WaveletVolume>,
    weights: Vec<f32>,
    level: usize,
    /// Low-pass samples of `held_level`, a coarser level.
    held: Vec<f32>,
    held_level: usize,
    /// Offset that is added to every sample.
    offset: f32,
}

impl CoefficientDecoder {
    /// Decoder of a level: level 0 gives the samples, each further level the low-pass samples at half the resolution.
    /// `weights`: a factor for each level's details, the finest first, and for the coarsest low-pass box; weights
    /// beyond the end of the slice are 1.
    pub fn new(volume: Arc<WaveletVolume>, level: usize, weights: &[f32]) -> Result<Self, WaveletError> {
        let coarsest = volume.plan().n_levels();
        if level > coarsest {
            return Err(WaveletError::NoSuchLevel { level, coarsest });
        }
        let weight = |k: usize| weights.get(k).copied().unwrap_or(1.0);
        let weights: Vec<f32> = (0..=coarsest).map(weight).collect();
        let mut held = vec![0.0; volume.plan().low_size(coarsest).iter().product()];
        volume.unpack_low(weights[coarsest], &mut held);
        let mut decoder = Self { volume, weights, level: coarsest, held, held_level: coarsest, offset: 0.0 };
        while decoder.held_level > level + LEVELS_ABOVE {
            decoder.level = decoder.held_level - 1;
            decoder.held = decoder.all();
            decoder.held_level = decoder.level;
        }
        decoder.level = level;
        // Set last: the coarser levels are held without the offset.
        decoder.offset = decoder.volume.weighted_offset(&decoder.weights);
        Ok(decoder)
    }

    /// Transform plan of the volume.
    pub(super) fn plan(&self) -> &TransformPlan {
        self.volume.plan()
    }

    pub(super) fn level(&self) -> usize {
        self.level
    }

    /// All samples of the level, `[z][y][x]`.
    pub fn all(&self) -> Vec<f32> {
        let size @ [nx, ny, nz] = self.size();
        let layer = nx * ny * SIDE;
        let mut all = vec![0.0; nx * ny * nz];
        parallel::for_each_chunk(&mut all, layer, |layer, samples| {
            let zs = layer * SIDE..((layer + 1) * SIDE).min(nz);
            for y in (0..ny).step_by(SIDE) {
                for x in (0..nx).step_by(SIDE) {
                    let hi = [(x + SIDE).min(size[0]), (y + SIDE).min(size[1])];
                    let ranges = [x..hi[0], y..hi[1], zs.clone()];
                    self.with_box(&ranges, |decoded| {
                        for (k, plane) in samples.chunks_exact_mut(nx * ny).enumerate() {
                            for j in y..hi[1] {
                                plane[j * nx..][x..hi[0]].copy_from_slice(decoded.row(j - y, k));
                            }
                        }
                    });
                }
            }
        });
        all
    }

    /// Smallest and largest sample of the level.
    pub fn range(&self) -> [f32; 2] {
        let is_volume = self.level == 0 && self.weights.iter().all(|w| *w == 1.0);
        if is_volume { self.volume.range(|| self.find_range()) } else { self.find_range() }
    }

    fn find_range(&self) -> [f32; 2] {
        let [nx, ny, nz] = self.size();
        let ranges = parallel::map(nz.div_ceil(SIDE), |layer| {
            let zs = layer * SIDE..((layer + 1) * SIDE).min(nz);
            let mut range = [f32::INFINITY, f32::NEG_INFINITY];
            for y in (0..ny).step_by(SIDE) {
                for x in (0..nx).step_by(SIDE) {
                    let ranges = [x..(x + SIDE).min(nx), y..(y + SIDE).min(ny), zs.clone()];
                    self.with_box(&ranges, |decoded| {
                        let rows = (0..decoded.n[2]).flat_map(|k| (0..decoded.n[1]).map(move |j| decoded.row(j, k)));
                        range = rows.map(extent::of).fold(range, extent::union);
                    });
                }
            }
            range
        });
        ranges.into_iter().fold([f32::INFINITY, f32::NEG_INFINITY], extent::union)
    }

    /// Calls `use_it` with the samples of a box.
    fn with_box<T>(&self, ranges: &[Range<usize>; 3], use_it: impl FnOnce(&DecodedBox) -> T) -> T {
        thread_local!(static SCRATCH: RefCell<Vec<LevelScratch>> = const { RefCell::new(Vec::new()) });
        SCRATCH.with_borrow_mut(|scratch| {
            scratch.resize_with(LEVELS_ABOVE + 2, LevelScratch::default);
            self.run(self.level, ranges, scratch);
            if self.offset != 0.0 {
                scratch[0].samples.add(self.offset);
            }
            use_it(&scratch[0].samples)
        })
    }

    /// Decodes the box of a level into the first scratch; coarser levels use the following ones.
    fn run(&self, level: usize, ranges: &[Range<usize>; 3], scratch: &mut [LevelScratch]) {
        let Some((own, above)) = scratch.split_first_mut() else { return };
        if level == self.held_level {
            let size = self.volume.plan().low_size(level);
            return own.samples.copy(&self.held, size, ranges);
        }
        let plan = self.volume.plan();
        for a in 0..3 {
            own.axes[a].build(plan.step(level, a), ranges[a].clone());
        }
        let low = [0, 1, 2].map(|a| own.axes[a].low.clone());
        self.run(level + 1, &low, above);
        let Some(LevelScratch { samples: low, .. }) = above.first() else { return };
        Level::best().run(
            #[inline(always)]
            || {
                own.along_x(low);
                let weight = self.weights[level];
                if weight != 0.0 {
                    own.add_details(&self.volume, level, weight);
                }
                own.along_y();
                own.along_z();
            },
        );
    }
}

impl Decoder for CoefficientDecoder {
    fn size(&self) -> [usize; 3] {
        self.volume.plan().low_size(self.level)
    }

    fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]) {
        let [nx, ny, _] = [0, 1, 2].map(|a| hi[a] - lo[a]);
        // Large boxes are decoded in smaller ones, so that the work space stays in the cache.
        for z in (lo[2]..hi[2]).step_by(2 * SIDE) {
            for y in (lo[1]..hi[1]).step_by(2 * SIDE) {
                for x in (lo[0]..hi[0]).step_by(2 * SIDE) {
                    let first = [x, y, z];
                    let ranges = [0, 1, 2].map(|a| first[a]..(first[a] + 2 * SIDE).min(hi[a]));
                    self.with_box(&ranges, |decoded| {
                        for k in 0..ranges[2].len() {
                            for j in 0..ranges[1].len() {
                                let at = ((z - lo[2] + k) * ny + (y - lo[1] + j)) * nx + x - lo[0];
                                let row = decoded.row(j, k);
                                out[at..][..row.len()].copy_from_slice(row);
                            }
                        }
                    });
                }
            }
        }
    }
}
