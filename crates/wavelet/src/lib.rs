//! Wavelet transforms of volumes, and volumes kept as a few wavelet coefficients: arrays in, arrays out.
//!
//! A [`TransformPlan`] is made once for a [`WaveletFamily`], a size and a number of levels; [`analyse`] turns samples
//! into the same number of coefficients, [`synthesise`] turns them back, in place, exact to rounding at any size from 1
//! up. Level 0 is the finest grid, and higher levels are coarser. [`to_amplitudes`] makes coefficients comparable, for
//! thresholds.
//!
//! A [`WaveletVolume`] keeps the coefficients above a threshold. A [`CoefficientDecoder`] decodes the samples of any
//! box at any level, and a [`CoarseLevel`] is one level as a volume of its own; both are a [`wavesplat_core::Decoder`].
//!
//! ```
//! use std::sync::Arc;
//! use wavesplat_core::Decoder as _;
//! use wavesplat_wavelet::{CoarseLevel, CoefficientDecoder, Keep, Norm, WaveletFamily, WaveletVolume};
//!
//! // A ramp along x of 16 x 8 x 8 samples, `[z][y][x]`.
//! let samples: Vec<f32> = (0..16 * 8 * 8).map(|i| (i % 16) as f32).collect();
//! let keep = Keep::Amplitude(0.5);
//! let volume = WaveletVolume::new(WaveletFamily::Cdf53, [16, 8, 8], samples, None, Norm::L2, keep)?;
//! let volume = Arc::new(volume);
//! println!("{} of {} coefficients", volume.n_kept(), volume.plan().n_samples());
//!
//! let mut row = [0.0; 4];
//! CoefficientDecoder::new(volume.clone(), 0, &[])?.decode([4, 2, 2], [8, 3, 3], &mut row);
//! assert!((row[0] - 4.0).abs() < 0.5 && (row[3] - 7.0).abs() < 0.5);
//!
//! let half = CoarseLevel::new(CoefficientDecoder::new(volume, 1, &[])?)?;
//! assert_eq!(half.grid().spacing, [2.0; 3]);
//! # Ok::<(), wavesplat_wavelet::WaveletError>(())
//! ```
//!
//! # Families
//!
//! | family | φ | φ, ψ taps | smoothness of φ | moments¹ | boundary rule | cost² |
//! | --- | --- | --- | --- | --- | --- | --- |
//! | haar | constant | 2, 2 | jumps | 1 | last odd sample kept | 1, 1 |
//! | cdf53 | linear B-spline | 3, 5 | C⁰ | 2 | mirrored | 1, 1 |
//! | cdf97 | no closed form | 7, 9 | C¹ | 4 | mirrored | 3, 3 |
//! | spline4 | cubic B-spline | 5, 11 | C² | 4 | mirrored | 3, 3 |
//! | bspline2 | linear B-spline | 3, 5 | C⁰ | 2 | interval | 4, 4 |
//! | bspline3 | quadratic B-spline | 4, 8 | C¹ | 3 | interval | 6, 6 |
//! | bspline4 | cubic B-spline | 5, 11 | C² | 4 | interval | 9, 8 |
//!
//! ¹ Polynomials of lower degree have no details; in mirrored families they have some at the ends, unless constant.
//! ² Multiplications per sample and axis in analysis (semi-orthogonal: a banded solve) and in synthesis.
//!
//! Normalisation: low-pass coefficients of a constant are that constant, at every level, so the low-pass box of a level
//! is the volume at that resolution in its own units. Details have gain 2 at the highest frequency for cdf53, cdf97 and
//! spline4, are the plain difference for haar, and coefficients of functions whose largest tap is 1 for the splines on
//! the interval.
//!
//! Semi-orthogonal wavelets are orthogonal to all coarser functions, so levels can be dropped with the least loss of
//! energy; within a level they overlap, and at the same number of kept coefficients the families by lifting give the
//! smaller error.
//!
//! # Features
//!
//! `threads` (on by default): slices and blocks in parallel. Results are the same to the bit without it.

mod error;
mod family;
mod transform;
mod volume;

pub use error::WaveletError;
pub use family::WaveletFamily;
pub use transform::norm::{Norm, from_amplitudes, to_amplitudes};
pub use transform::plan::{TransformPlan, max_levels};
pub use transform::real::Real;
pub use transform::reversible::{analyse_integers, synthesise_integers};
pub use transform::separable::{analyse, analyse_level, synthesise, synthesise_level, synthesise_to};
pub use transform::step::LevelStep;
pub use transform::taps::Tap;
pub use volume::centered::CenteredSamples;
pub use volume::coarse::CoarseLevel;
pub use volume::coefficient_arrays::CoefficientArrays;
pub use volume::decode::CoefficientDecoder;
pub use volume::wavelet_volume::{Keep, WaveletVolume};
