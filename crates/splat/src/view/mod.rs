//! Camera to texels: viewing rays in index space, slice families, base planes (shear-warp), clipping.

pub mod base_plane;
pub mod common_grid;
pub mod depth_cue;
pub mod family;
pub mod index_frame;
pub mod part;
pub mod pixel_spacing;
pub mod ray_model;
pub mod region;
pub mod scattered;
pub mod silhouette;
