//! Wavelet transforms: the plan of a transform, analysis and synthesis in place.

mod level_grid;
mod lifting;
mod lines;
pub(crate) mod norm;
pub(crate) mod plan;
pub(crate) mod real;
pub(crate) mod reversible;
mod semi_orthogonal;
pub(crate) mod separable;
mod solve;
mod spline;
pub(crate) mod step;
pub(crate) mod taps;
