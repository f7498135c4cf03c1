//! Errors of wavelet transforms and wavelet volumes.

use crate::family::WaveletFamily;

/// Error of this crate: its message says what happened, where, and how to mend it. All of them are about arguments.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each variant is its documentation")]
pub enum WaveletError {
    #[error(
        "size {size:?} (x, y, z) is not the size of a volume; \
         pass at least 1 sample along each axis, and no more than {max} in all",
        max = usize::MAX
    )]
    VolumeSize { size: [usize; 3] },
    #[error(
        "size {size:?} (x, y, z) needs {expected} samples, the buffer has {actual}; \
         check the axis order (x first) or pass {expected} samples"
    )]
    SampleCount { size: [usize; 3], expected: usize, actual: usize },
    #[error(
        "level {level} does not exist; the transform has levels 0 (finest) to {coarsest} (coarsest), pass one of them"
    )]
    NoSuchLevel { level: usize, coarsest: usize },
    #[error(
        "level {level} of family {:?} has no sample grid: its low-pass coefficients are no samples; \
         use level 0, or one of the families haar, cdf53, cdf97",
        family.name()
    )]
    NoSampleGrid { family: WaveletFamily, level: usize },
    #[error(
        "coefficient arrays: {n_levels} levels are more than the {max} that {} has at size {size:?} (x, y, z); \
         check family, size and levels, the arrays may be of another volume",
        family.name()
    )]
    TooManyLevels { family: WaveletFamily, size: [usize; 3], n_levels: usize, max: usize },
    #[error(
        "coefficient arrays: {array} has {actual} entries, the others need {expected}; \
         pass the arrays of one volume, whole and in their order"
    )]
    ArrayLength { array: &'static str, expected: usize, actual: usize },
    #[error(
        "coefficient arrays: has_block has {actual} entries, size {size:?} (x, y, z) needs at least {least}; \
         check the size, or pass one entry for each block of 8 x 8 x 8 coefficients"
    )]
    TooFewBlocks { size: [usize; 3], least: usize, actual: usize },
    #[error(
        "coefficient arrays: block {block} has a mask bit outside subband {band} of level {level}; \
         check size and family, the masks may be damaged or of another volume"
    )]
    MaskOutsideSubband { block: usize, level: usize, band: usize },
    #[error("coefficient arrays: value {index} is {value}, which is not a finite number; the values may be damaged")]
    NonFiniteCoefficient { index: usize, value: f32 },
    #[error(
        "coefficient arrays: the sample range from {lo} to {hi} is no range; \
         pass two finite numbers, the smaller first, or none where it is not known"
    )]
    SampleRange { lo: f32, hi: f32 },
    #[error("coefficient arrays: the offset is {offset}, which is not a finite number; pass 0 where there is none")]
    NonFiniteOffset { offset: f32 },
    #[error(
        "a PSNR of {psnr_db} dB is more than the {reached_db:.1} dB that samples from {lo} to {hi} have in float32; \
         ask for less, or subtract what all samples have in common first"
    )]
    PsnrOutOfReach { psnr_db: f64, reached_db: f64, lo: f64, hi: f64 },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_message_has_the_numbers_and_the_cure() {
        let family = WaveletFamily::Spline4;
        let size = [3, 4, 5];
        let cases = [
            (
                WaveletError::VolumeSize { size },
                "size [3, 4, 5] (x, y, z) is not the size of a volume; pass at least 1",
            ),
            (
                WaveletError::SampleCount { size, expected: 60, actual: 59 },
                "needs 60 samples, the buffer has 59; check",
            ),
            (WaveletError::NoSuchLevel { level: 4, coarsest: 3 }, "level 4 does not exist; the transform has levels 0"),
            (WaveletError::NoSampleGrid { family, level: 1 }, "level 1 of family \"spline4\" has no sample grid"),
            (
                WaveletError::TooManyLevels { family, size, n_levels: 9, max: 3 },
                "9 levels are more than the 3 that spline4",
            ),
            (
                WaveletError::ArrayLength { array: "masks", expected: 16, actual: 8 },
                "masks has 8 entries, the others need 16",
            ),
            (
                WaveletError::TooFewBlocks { size, least: 2, actual: 1 },
                "has_block has 1 entries, size [3, 4, 5] (x, y, z)",
            ),
            (
                WaveletError::MaskOutsideSubband { block: 7, level: 2, band: 5 },
                "block 7 has a mask bit outside subband 5 of level 2",
            ),
            (WaveletError::NonFiniteCoefficient { index: 3, value: f32::NAN }, "value 3 is NaN, which is not a finite"),
            (
                WaveletError::SampleRange { lo: 2.0, hi: 1.0 },
                "the sample range from 2 to 1 is no range; pass two finite",
            ),
            (
                WaveletError::NonFiniteOffset { offset: f32::INFINITY },
                "the offset is inf, which is not a finite number; pass 0",
            ),
            (
                WaveletError::PsnrOutOfReach { psnr_db: 60.0, reached_db: 45.82, lo: 1e6, hi: 1_000_003.5 },
                "60 dB is more than the 45.8 dB that samples from 1000000 to 1000003.5 have in float32; ask for less",
            ),
        ];
        for (error, start) in cases {
            assert!(error.to_string().contains(start), "{error}");
        }
    }
}
