//! Reconstruction kernels, their footprint tables, and the B-spline prefilter.

pub mod footprint;
pub mod prefilter;
pub mod slice_taps;
pub mod weights;
