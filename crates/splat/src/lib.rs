//! High-resolution splatting on the CPU.
//!
//! The volume is reconstructed one *sheet* at a time, a plane parallel to its slices at much higher resolution than the
//! samples. Densities are splatted into the sheet first; colour and opacity are looked up after, at every texel; then
//! the sheet is composited. The folders follow the data; each imports only from those before it:
//!
//! `view` (camera, base planes) -> `kernel` (footprints) -> `source` (slices) -> `sheet` -> `optics` (classify, shade)
//! -> `shapes` (surfaces, lines, points) -> `ray` (composite) -> `picture` (warp) -> `render` (the one place that knows the order) -> `quality`.
//!
//! Beside them stands [`slice_plane`]. The literal twins and the older technique that pictures are compared with are the
//! crate `wavesplat-study`. Source of the method: "High Resolution Image Splatting", IJACEN 2(7), 2014.
//!
//! This crate is the engine; its modules are public for tests and for the crates built on it, but are no stable
//! interface. To draw, use the crate `wavesplat`.

#[doc(hidden)]
pub mod kernel;
#[doc(hidden)]
pub mod optics;
#[doc(hidden)]
pub mod picture;
#[doc(hidden)]
pub mod quality;
#[doc(hidden)]
pub mod ray;
#[doc(hidden)]
pub mod render;
#[doc(hidden)]
pub mod shapes;
#[doc(hidden)]
pub mod sheet;
pub mod slice_plane;
#[doc(hidden)]
pub mod source;
#[doc(hidden)]
pub mod view;

pub use optics::slab_variation::needs_preintegration;
pub use render::frame::{render, render_base_planes, render_base_planes_at, render_layers};
pub use render::layer::{ColorField, Layer};
pub use render::progress::{ProgressCallback, ProgressPart};
pub use render::report::Report;
pub use wavesplat_compute::parallel::with_threads;
