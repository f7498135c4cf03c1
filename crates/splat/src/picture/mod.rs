//! Base planes to picture: the warp of shear-warp, supersampling, colours of projections.

pub mod base_picture;
pub mod color_projection;
pub mod depth_colors;
mod edge_texels;
pub mod edges;
pub mod resample;
pub mod supersampling;
pub mod warp;
