//! The literal, slow, double-precision twins of the renderer: the oracle of its tests and of the quality study.
//!
//! [`raycast`] is the converged picture; [`splat`] is high-resolution splatting by the method's pseudo-code, also without
//! one of its parts ([`ablation`]), by [`sampled_footprint`] tables for one, and [`original`] its
//! published form; [`project`] are projections by their
//! definitions; `standard` is standard splatting, sample by sample. None is on the fast path.

pub mod ablation;
mod active_blocks;
mod medium;
pub mod original;
pub mod project;
pub mod raycast;
pub mod sampled_footprint;
pub mod splat;
#[cfg(feature = "standard")]
pub mod standard;
