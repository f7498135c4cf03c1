//! Pictures of a target PSNR: a ladder of samplings, whose errors pilot tiles measure.

pub mod framing;
pub mod ladder;
mod pilot;
mod sampled;
pub mod target_psnr;
