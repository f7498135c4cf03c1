//! Pictures of a wanted PSNR: an error model, and an estimate from tiles that are redrawn finer.

pub mod error_model;
pub mod parts;
pub mod probe;
pub mod refine;
pub mod target_psnr;
