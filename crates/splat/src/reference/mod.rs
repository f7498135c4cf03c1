//! The literal, slow, double-precision twins of the renderer: the oracle of its tests and of the quality study.
//!
//! [`raycast`] is the converged picture; [`splat`] is high-resolution splatting sample by sample, as the method's
//! pseudo-code has it; [`project`] are projections by their definitions; [`standard`] is standard splatting, sample by
//! sample. None is on the fast path.

pub mod project;
pub mod raycast;
pub mod splat;
pub mod standard;
