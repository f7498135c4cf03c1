//! Wavelet volume: a volume kept as its wavelet coefficients of large amplitude, and no others.
//!
//! What is dropped: coefficients whose amplitude ([`Norm`]) is below a threshold. With [`Norm::L2`] that leaves, for an
//! orthogonal family, the least mean square error of all choices of as many; the others come near.

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

/// Rule of thresholding: which coefficients are kept. Zeros are never stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Keep {
    /// Those whose amplitude is at least this, in the units of the samples; 0: all.
    Amplitude(f64),
    /// The largest amplitudes, this share of all coefficients, `0..=1`; equal ones stay together.
    Fraction(f64),
    /// As few as give the samples back with this PSNR, dB; its peak is the range of the samples.
    Psnr(f64),
}

/// A volume as retained wavelet coefficients.
#[derive(Clone, Debug)]
pub struct WaveletVolume {
    pub(super) plan: TransformPlan,
    pub(super) threshold: f64,
    /// Added to the samples that the coefficients stand for.
    pub(super) offset: f32,
    /// The PSNR of the samples that the coefficients stand for, dB, where it was found: by [`Keep::Psnr`].
    pub(super) psnr_db: Option<f64>,
    /// In the order of [`subbands`].
    pub(super) bands: Vec<RetainedBand>,
    /// Smallest and largest sample, once they are known.
    pub(super) range: OnceLock<[f32; 2]>,
}

impl WaveletVolume {
    /// Analyses samples `[z][y][x]`, in place, and keeps what is asked for. `n_levels`: as many as there are where
    /// `None`. Takes no more memory than the samples in f32 and what is kept, but for [`Keep::Psnr`], which takes three
    /// times the samples.
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
                // A constant has no range to measure errors by; it comes back to rounding.
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

    /// The transform: family, size, levels.
    pub fn plan(&self) -> &TransformPlan {
        &self.plan
    }

    /// The amplitude below which coefficients were dropped.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// Offset, added to the samples that the coefficients stand for, times the weight of the coarsest low-pass box.
    pub fn offset(&self) -> f32 {
        self.offset
    }

    /// The PSNR that [`Keep::Psnr`] found, dB; infinite where the samples come back exactly. `None` for other rules, and
    /// of volumes made [from arrays](WaveletVolume::from_arrays).
    pub fn psnr_db(&self) -> Option<f64> {
        self.psnr_db
    }

    /// Smallest and largest sample that the coefficients stand for, found by `find` once.
    pub(crate) fn range(&self, find: impl FnOnce() -> [f32; 2]) -> [f32; 2] {
        *self.range.get_or_init(find)
    }

    /// Coefficients that are kept.
    pub fn n_kept(&self) -> usize {
        self.bands.iter().map(|band| band.values.len()).sum()
    }

    /// Bytes held.
    pub fn n_bytes(&self) -> usize {
        self.bands.iter().map(RetainedBand::n_bytes).sum()
    }

    /// Coefficients that are kept of each level's details, the finest first, and of the coarsest low-pass box.
    pub fn n_kept_by_level(&self) -> Vec<usize> {
        let mut n = vec![0; self.plan.n_levels() + 1];
        for band in &self.bands {
            n[band.subband.level] += band.values.len();
        }
        n
    }

    /// All coefficients in the layout of the plan, zeros where nothing is kept. `weights`: a factor for each level's
    /// details, the finest first, and for the coarsest low-pass box; those beyond the slice are 1. They stand for the
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

    /// Calls `found` with position and value of every kept coefficient of a subband of a level that lies in `ranges`.
    /// Both count from the first coefficient there: `ranges` from the subband's, the position from that of `ranges`.
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

    /// The samples, `[z][y][x]`, that the coefficients stand for, weighted as in [`WaveletVolume::coefficients`].
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
