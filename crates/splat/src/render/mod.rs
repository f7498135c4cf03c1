//! Stages of a frame: the one place that knows their order.

pub mod empty_space;
pub mod frame;
pub mod layer;
pub mod part_plan;
pub mod piece;
pub mod plan;
pub mod plan_arrays;
pub mod progress;
pub mod report;
pub mod segments;
pub mod shape_plan;
mod sources;
pub mod stream;
pub mod tile;
pub mod tile_parts;
