//! Samples: slices of the volume in any sample type, decoded blocks, non-finite samples, min-max bricks for empty-space
//! skipping.

pub mod block_cache;
pub mod field;
pub mod geometry;
pub mod min_max_bricks;
pub mod nonfinite;
pub mod occupancy;
pub mod point_sampling;
pub mod slices;
pub mod stored;
pub mod strided;
pub mod survey;
pub mod transposed;
pub mod window;
