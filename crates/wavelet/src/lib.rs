//! Wavelet transforms of volumes: arrays in, arrays out.
//!
//! A [`Plan`] is made once for a [`Family`], a size and a number of levels; [`analyse`] turns samples into as many
//! coefficients, [`synthesise`] turns them back, in place, exact to rounding at any size from 1 up. Level 0 is the finest
//! grid and counts up. [`to_amplitudes`] makes coefficients comparable, for thresholds.
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
//! ¹ Polynomials of lower degree leave no details; mirrored families leave some at the ends, unless it is a constant.
//! ² Multiplications per sample and axis in analysis (semi-orthogonal: a banded solve) and in synthesis.
//!
//! Normalisation: low coefficients of a constant are that constant, at every level, so the low box of a level is the
//! volume at that resolution in its own units. [`mod@lifting`] and [`mod@semi_orthogonal`] have the scale of the details.
//!
//! Semi-orthogonal wavelets are orthogonal to all coarser functions, so levels can be dropped with the least loss of
//! energy; within a level they overlap, and per coefficient kept the families by lifting give the smaller error.
//!
//! ```
//! use wavesplat_wavelet::{Family, Norm, Plan, analyse, from_amplitudes, synthesise, to_amplitudes};
//!
//! let plan = Plan::new(Family::Cdf53, [5, 4, 3], None);
//! let samples: Vec<f32> = (0..plan.n_samples()).map(|i| i as f32).collect();
//! let mut c = samples.clone();
//! analyse(&plan, &mut c);
//! to_amplitudes(&plan, Norm::L2, &mut c);
//! c.iter_mut().filter(|c| c.abs() < 1e-3).for_each(|c| *c = 0.0);
//! from_amplitudes(&plan, Norm::L2, &mut c);
//! synthesise(&plan, &mut c);
//! assert!(c.iter().zip(&samples).all(|(a, b)| (a - b).abs() < 1e-2));
//! ```

mod brightness;
mod coarse;
mod decode;
mod family;
pub mod lifting;
mod lines;
mod norm;
mod plan;
mod reversible;
mod sample;
pub mod semi_orthogonal;
mod solve;
mod spline;
mod spread;
mod step;
mod taps;
mod transform;
mod volume;

pub use coarse::{Coarse, LevelGrid};
pub use decode::Decoder;
pub use family::Family;
pub use norm::{Norm, from_amplitudes, to_amplitudes};
pub use plan::{Plan, max_levels};
pub use reversible::{analyse_integers, synthesise_integers};
pub use sample::Sample;
pub use spread::Spread;
pub use step::Step;
pub use taps::Tap;
pub use transform::{analyse, analyse_level, synthesise, synthesise_level, synthesise_to};
pub use volume::{Keep, Parts, WaveletVolume};
