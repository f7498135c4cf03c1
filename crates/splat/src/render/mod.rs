//! A frame: the one place that knows the order of the stages.

pub mod frame;
pub mod layer;
pub mod progress;
pub mod report;
pub mod scene;
pub mod tile;
