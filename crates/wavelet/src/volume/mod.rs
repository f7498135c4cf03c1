//! Volumes kept as their wavelet coefficients of large amplitude, and decoded box by box.

pub(crate) mod centered;
pub(crate) mod coarse;
pub(crate) mod coefficient_arrays;
pub(crate) mod decode;
mod retained_band;
mod sparse_synthesis;
mod threshold;
pub(crate) mod wavelet_volume;
