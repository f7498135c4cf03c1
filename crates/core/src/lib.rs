//! The terms that all parts of Wavesplat share: volume, camera, transfer function, picture, options, errors.
//!
//! Grid: samples sit at integer index positions `(i, j, k)`, `i` fastest in memory; the volume fills the box
//! `[0, n−1]` in each axis, from the first to the last sample centre. This crate knows no files, threads, GPU or
//! Python. Every type here is validated when it is made, so that the inside of the renderer cannot fail.

mod camera;
mod composite;
mod decoder;
mod depth_colors;
mod error;
mod facts;
mod grid;
mod label;
mod level_grid;
mod normals;
mod options;
mod picture;
mod samples;
mod shapes;
mod transfer_function;
mod transfer_function_2d;
mod volume;

pub use camera::{Camera, Projection, Ray};
pub use composite::Composite;
pub use decoder::Decoder;
pub use depth_colors::DepthColors;
pub use error::{Error, ErrorKind, Result};
pub use facts::Facts;
pub use grid::Grid;
pub use label::LabelLook;
pub use level_grid::LevelGrid;
pub use normals::normals_of_faces;
pub use options::{
    ClipPlane, Crop, Gradient, Kernel, LADDER, Light, LightFrame, MAX_GRADIENT_OFFSET, MAX_SIDE_PX, RenderOptions,
    Shading, oversampling_of_level, quality_settings,
};
pub use picture::Picture;
pub use samples::{Sample, SampleBuffer, Samples, Statistics};
pub use shapes::{Card, Mesh, Paint, Paths, Points, ShapeStyle, Shapes, Sizes, Thickness};
pub use transfer_function::{ColorNode, GradientNode, OpacityNode, TransferFunction};
pub use transfer_function_2d::TransferFunction2D;
pub use volume::Volume;
