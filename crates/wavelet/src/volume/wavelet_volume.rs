//! Wavelet volume: a volume of which only the wavelet coefficients of large amplitude are kept.
//!
//! Coefficients whose amplitude ([`Norm`]) is below a threshold are dropped. With [`Norm::L2`] and an orthogonal family
//! the mean square error is the least for the number of coefficients; the other families come near.

use std::ops::Range;
use std::sync::OnceLock;

use wavesplat_compute::parallel;

use super::centered::CenteredSamples;
use super::retained_band::{RetainedBand, subbands};
use super::threshold::{drop_below, threshold_of_fraction, threshold_of_psnr};
use crate::error::WaveletError;
use crate::family::WaveletFamily;
use crate::transform::norm::Norm;
use crate::transform::plan::{TransformPlan, n_samples_of};
use crate::transform::separable::{analyse, synthesise};

/// Rule by which coefficients are kept. Zeros are never stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Keep {
    /// Coefficients of at least this amplitude, in the units of the samples; 0: all.
    Amplitude(f64),
    /// This share of all coefficients, `0..=1`, with the largest amplitudes; equal ones are kept or dropped together.
    Fraction(f64),
    /// The fewest coefficients that reproduce the samples with this PSNR, dB; its peak is the range of the samples.
    Psnr(f64),
}

/// A volume as retained wavelet coefficients.
#[derive(Clone, Debug)]
pub struct WaveletVolume {
    pub(super) plan: TransformPlan,
    pub(super) threshold: f64,
    /// Offset that is added to the synthesised samples.
    pub(super) offset: f32,
    /// PSNR of the decoded samples, dB, where [`Keep::Psnr`] has computed it.
    pub(super) psnr_db: Option<f64>,
    /// Bands in the order of [`subbands`].
    pub(super) bands: Vec<RetainedBand>,
    /// Smallest and largest decoded sample, once known.
    pub(super) range: OnceLock<[f32; 2]>,
}

impl WaveletVolume {
    /// Analyses samples `[z][y][x]`, in place, and keeps coefficients by a rule. `n_levels`: `None` for all levels.
    /// Takes no more memory than the samples in f32 and the kept coefficients; [`Keep::Psnr`] takes three times the
    /// samples.
    ///
    /// Fails where a PSNR is asked for that samples in f32 cannot have.
    pub fn new(
        family: WaveletFamily,
        size: [usize; 3],
        samples: impl Into<CenteredSamples>,
        n_levels: Option<usize>,
        norm: Norm,
        keep: Keep,
    ) -> Result<Self, WaveletError> {
        let CenteredSamples { values: samples, offset, range } = samples.into();
        let (expected, actual) = (n_samples_of(size)?, samples.len());
        if actual != expected {
            return Err(WaveletError::SampleCount { size, expected, actual });
        }
        let plan = TransformPlan::new(family, size, n_levels)?;
        let wanted = if let Keep::Psnr(_) = keep { samples.clone() } else { Vec::new() };
        let mut coefficients = samples;
        analyse(&plan, &mut coefficients);
        let (threshold, psnr_db) = match keep {
            Keep::Amplitude(threshold) => (threshold, None),
            Keep::Fraction(fraction) => (threshold_of_fraction(&plan, norm, &coefficients, fraction), None),
            Keep::Psnr(psnr_db) => {
                let found = threshold_of_psnr(&plan, norm, &coefficients, &wanted, offset, psnr_db);
                // A constant has no range to measure errors by; it is reproduced up to rounding.
                if found.psnr_db < psnr_db && range[0] < range[1] {
                    let [lo, hi] = range;
                    return Err(WaveletError::PsnrOutOfReach { psnr_db, reached_db: found.psnr_db, lo, hi });
                }
                // A constant has no range to measure errors by.
                (found.threshold, (range[0] < range[1]).then_some(found.psnr_db))
            }
        };
        drop(wanted);
        drop_below(&plan, norm, threshold, &mut coefficients);
        let subbands = subbands(&plan);
        let bands = parallel::map(subbands.len(), |b| RetainedBand::new(subbands[b].clone(), &coefficients, size));
        Ok(Self { plan, threshold, offset, psnr_db, bands, range: OnceLock::new() })
    }

    /// Transform plan: family, size, levels.
    pub fn plan(&self) -> &TransformPlan {
        &self.plan
    }

    /// Amplitude below which coefficients were dropped.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// Offset that is added to the synthesised samples, times the weight of the coarsest low-pass box.
    pub fn offset(&self) -> f32 {
        self.offset
    }

    /// PSNR that [`Keep::Psnr`] reached, dB; infinite where the samples are reproduced exactly. `None` for other rules,
    /// and for volumes made [from arrays](WaveletVolume::from_arrays).
    pub fn psnr_db(&self) -> Option<f64> {
        self.psnr_db
    }

    /// Smallest and largest decoded sample, computed by `find` once.
    pub(crate) fn range(&self, find: impl FnOnce() -> [f32; 2]) -> [f32; 2] {
        *self.range.get_or_init(find)
    }

    /// Number of kept coefficients.
    pub fn n_kept(&self) -> usize {
        self.bands.iter().map(|band| band.values.len()).sum()
    }

    /// Bytes of memory.
    pub fn n_bytes(&self) -> usize {
        self.bands.iter().map(RetainedBand::n_bytes).sum()
    }

    /// Number of kept coefficients of each level's details, the finest first, and of the coarsest low-pass box.
    pub fn n_kept_by_level(&self) -> Vec<usize> {
        let mut n = vec![0; self.plan.n_levels() + 1];
        for band in &self.bands {
            n[band.subband.level] += band.values.len();
        }
        n
    }

    /// All coefficients in the layout of the plan, 0 where dropped. `weights`: a factor for each level's details, the
    /// finest first, and for the coarsest low-pass box; weights beyond the end of the slice are 1. Synthesis gives the
    /// samples less the [offset](WaveletVolume::offset).
    pub fn coefficients(&self, weights: &[f32]) -> Vec<f32> {
        let mut coefficients = vec![0.0; self.plan.n_samples()];
        for band in &self.bands {
            let weight = weights.get(band.subband.level).copied().unwrap_or(1.0);
            if weight != 0.0 {
                band.unpack(weight, &mut coefficients, self.plan.size());
            }
        }
        coefficients
    }

    /// Calls `found` with position and value of every kept coefficient of a subband that lies in `ranges`. The ranges
    /// count from the subband's first coefficient, positions from the first of the ranges.
    #[inline(always)]
    pub(crate) fn for_each_kept(
        &self,
        level: usize,
        band: usize,
        ranges: &[Range<usize>; 3],
        found: impl FnMut([usize; 3], f32),
    ) {
        if let Some(band) = self.bands.iter().find(|b| b.subband.level == level && b.subband.number == band)
            && ranges.iter().all(|range| !range.is_empty())
        {
            band.for_each(ranges, found);
        }
    }

    /// Offset of the samples of any level with these weights: low-pass coefficients of a constant are that constant.
    pub(crate) fn weighted_offset(&self, weights: &[f32]) -> f32 {
        self.offset * weights.get(self.plan.n_levels()).copied().unwrap_or(1.0)
    }

    /// Writes the coarsest low-pass box, times `weight`, `[z][y][x]`, at its own size.
    pub(crate) fn unpack_low(&self, weight: f32, low: &mut [f32]) {
        let coarsest = self.plan.n_levels();
        let [nx, ny, nz] = self.plan.low_size(coarsest);
        self.for_each_kept(coarsest, 0, &[0..nx, 0..ny, 0..nz], |[x, y, z], value| {
            low[(z * ny + y) * nx + x] = weight * value;
        });
    }

    /// Synthesises all samples, `[z][y][x]`, with weights as in [`WaveletVolume::coefficients`].
    pub fn to_samples(&self, weights: &[f32]) -> Vec<f32> {
        let mut samples = self.coefficients(weights);
        synthesise(&self.plan, &mut samples);
        let offset = self.weighted_offset(weights);
        if offset != 0.0 {
            for sample in &mut samples {
                *sample += offset;
            }
        }
        samples
    }
}
