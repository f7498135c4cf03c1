//! The literal, slow, double-precision twins of the renderer: the oracle of its tests and of the quality study.
//!
//! [`raycast`] is the converged picture; [`splat`] is high-resolution splatting by the method's pseudo-code, also with
//! single parts left out or changed ([`ablation`]; [`sampled_footprint`] has the tables for one of them), and
//! [`original`] is its published form; [`project`] has projections by their definitions; [`standard`] is standard
//! splatting, sample by sample. None is on the fast path.

pub mod ablation;
mod active_blocks;
pub mod color_field;
mod lights;
mod medium;
mod mixture;
pub mod original;
pub mod project;
pub mod raycast;
mod reached_samples;
pub mod sampled_footprint;
pub mod sampler;
mod shapes;
pub mod splat;
pub mod standard;
