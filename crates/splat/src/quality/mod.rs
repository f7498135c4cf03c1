//! Pictures of a target PSNR: an a-posteriori error estimate from pilot tiles, and an error model to choose by.

pub mod error_model;
pub mod framing;
mod probe;
mod sampled;
pub mod target_psnr;
