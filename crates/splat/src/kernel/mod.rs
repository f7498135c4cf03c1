//! Reconstruction kernels, their footprint tables, and the B-spline prefilter.

pub mod footprint;
pub mod footprint_table;
pub mod prefilter;
pub mod slice_taps;
pub mod smoothed;
pub mod weights;
