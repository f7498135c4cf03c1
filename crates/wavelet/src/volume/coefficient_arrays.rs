//! Serialisation: a wavelet volume as plain arrays, and back with checks, since a file may be damaged.

use std::sync::OnceLock;

use super::retained_band::{BLOCK, EMPTY, RetainedBand, RetainedBlock, blocks_of, subbands};
use super::wavelet_volume::WaveletVolume;
use crate::error::WaveletError;
use crate::family::WaveletFamily;
use crate::transform::plan::{TransformPlan, max_levels, n_samples_of};

/// A wavelet volume as plain arrays, to be stored: subbands 1 to 7 of each level, the finest first, then the low-pass
/// box of the last level.
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientArrays {
    /// Wavelet family.
    pub family: WaveletFamily,
    /// Samples along x, y, z.
    pub size: [usize; 3],
    /// Number of levels of details.
    pub n_levels: usize,
    /// Amplitude below which coefficients were dropped.
    pub threshold: f64,
    /// Offset that is added to the synthesised samples.
    pub offset: f32,
    /// Per block of 8 x 8 x 8 coefficients: 1 where it keeps any, else 0.
    pub has_block: Vec<u8>,
    /// Significance map: eight words per non-empty block, one per slice, with a bit per coefficient, x first.
    pub masks: Vec<u64>,
    /// Coefficients in the order of the bits.
    pub values: Vec<f32>,
    /// Smallest and largest decoded sample, if known; otherwise the first query decodes the volume.
    pub range: Option<[f32; 2]>,
}

impl WaveletVolume {
    /// The volume as plain arrays.
    pub fn to_arrays(&self) -> CoefficientArrays {
        let all = || self.bands.iter();
        CoefficientArrays {
            family: self.plan.family(),
            size: self.plan.size(),
            n_levels: self.plan.n_levels(),
            threshold: self.threshold,
            offset: self.offset,
            has_block: all().flat_map(|band| &band.blocks).map(|kept_idx| u8::from(*kept_idx != EMPTY)).collect(),
            masks: all().flat_map(|band| &band.kept).flat_map(|block| block.masks).collect(),
            values: all().flat_map(|band| &band.values).copied().collect(),
            range: self.range.get().copied(),
        }
    }

    /// A volume from plain arrays; the error names arrays that do not fit together.
    pub fn from_arrays(arrays: CoefficientArrays) -> Result<Self, WaveletError> {
        arrays.check_numbers()?;
        let CoefficientArrays { family, size, n_levels, threshold, offset, has_block, masks, values, range } = arrays;
        let plan = TransformPlan::new(family, size, Some(n_levels))?;
        let subbands = subbands(&plan);
        check_len("has_block", has_block.len(), subbands.iter().map(|s| blocks_of(&s.ranges).count()).sum())?;
        let n_kept_blocks = has_block.iter().filter(|has| **has != 0).count();
        check_len("masks", masks.len(), BLOCK * n_kept_blocks)?;
        let n_values = masks.iter().map(|mask| mask.count_ones() as usize).sum();

        let mut has_block = has_block.into_iter().enumerate();
        let mut masks = masks.as_chunks::<BLOCK>().0.iter();
        let mut bands = Vec::with_capacity(subbands.len());
        for subband in subbands {
            let mut band = RetainedBand { subband, blocks: Vec::new(), kept: Vec::new(), values: Vec::new() };
            let mut start = 0;
            // Checked above: there is one entry per block, and masks for each block that is not empty.
            for ([xs, ys, zs], (block, has)) in blocks_of(&band.subband.ranges).zip(has_block.by_ref()) {
                if has == 0 {
                    band.blocks.push(EMPTY);
                    continue;
                }
                let Some(&masks) = masks.next() else { break };
                let is_inside = |bit: usize| bit % BLOCK < xs.len() && bit / BLOCK < ys.len();
                let inside = (0..64).filter(|bit| is_inside(*bit)).fold(0, |all, bit| all | 1_u64 << bit);
                if masks.iter().enumerate().any(|(k, mask)| mask & !if k < zs.len() { inside } else { 0 } != 0) {
                    let (level, band) = (band.subband.level, band.subband.number);
                    return Err(WaveletError::MaskOutsideSubband { block, level, band });
                }
                band.blocks.push(band.kept.len() as u32);
                band.kept.push(RetainedBlock { masks, start });
                start += masks.iter().map(|mask| mask.count_ones() as usize).sum::<usize>();
            }
            bands.push((band, start));
        }

        check_len("values", values.len(), n_values)?;
        let mut values = values.as_slice();
        let with_values = |(mut band, n): (RetainedBand, usize)| {
            let (own, others) = values.split_at(n);
            band.values = own.to_vec();
            values = others;
            band
        };
        let bands = bands.into_iter().map(with_values).collect();
        Ok(Self {
            plan,
            threshold,
            offset,
            psnr_db: None,
            bands,
            range: range.map_or_else(OnceLock::new, OnceLock::from),
        })
    }
}

impl CoefficientArrays {
    /// Checks the numbers before anything of the volume's size is allocated, since the size may be damaged.
    fn check_numbers(&self) -> Result<(), WaveletError> {
        let Self { family, size, n_levels, offset, ref has_block, ref values, range, .. } = *self;
        let least = n_samples_of(size)?.div_ceil(BLOCK * BLOCK * BLOCK);
        if least > has_block.len() {
            return Err(WaveletError::TooFewBlocks { size, least, actual: has_block.len() });
        }
        let max = max_levels(family, size);
        if n_levels > max {
            return Err(WaveletError::TooManyLevels { family, size, n_levels, max });
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(WaveletError::NonFiniteCoefficient { index, value });
        }
        if !offset.is_finite() {
            return Err(WaveletError::NonFiniteOffset { offset });
        }
        match range {
            Some([lo, hi]) if !(lo.is_finite() && lo <= hi && hi.is_finite()) => {
                Err(WaveletError::SampleRange { lo, hi })
            }
            _ => Ok(()),
        }
    }
}

fn check_len(array: &'static str, actual: usize, expected: usize) -> Result<(), WaveletError> {
    if actual == expected { Ok(()) } else { Err(WaveletError::ArrayLength { array, expected, actual }) }
}
