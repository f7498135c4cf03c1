//! The sheet buffer of a tile: densities and gradients at every texel of a plane parallel to the slices.

pub mod buffer;
pub mod field_sheets;
pub mod layer_sheets;
mod missing;
pub mod spacing;
pub mod tile_layout;
pub mod tile_rays;
pub mod upsample;
