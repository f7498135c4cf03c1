//! High-resolution splatting on the CPU.
//!
//! The volume is reconstructed one *sheet* at a time, a plane parallel to its slices at much higher resolution than
//! the samples. Densities are splatted into the sheet first; colour and opacity are looked up after, at every texel;
//! then the sheet is composited. The modules follow the data:
//!
//! slices ([`slices`]) -> footprints ([`footprint`]) -> sheet ([`sheet`]) -> classify ([`classify`]) -> shade
//! ([`shade`]) -> composite ([`composite`]) -> warp ([`warp`]) -> picture.
//!
//! [`render`] is the one place that knows the order. [`mod@reference`] holds the literal double-precision twins.
//! Source of the method: "High Resolution Image Splatting", IJACEN 2(7), 2014.

pub mod base_picture;
pub mod base_plane;
pub mod blocks;
pub mod bricks;
pub mod by_gradient;
pub mod classify;
pub mod composite;
mod enlarge;
pub mod estimate;
mod experience;
pub mod extras;
pub mod fade;
pub mod family;
pub mod fields;
pub mod first_hit;
pub mod footprint;
mod holes;
pub mod interval;
pub mod kernel;
pub mod labels;
pub mod light;
pub mod local_maximum;
mod needs;
pub mod noise;
pub mod panel;
mod parts;
pub mod plane;
pub mod prefilter;
mod probe;
pub mod project;
mod quincunx;
pub mod rays;
pub mod reads;
pub mod reference;
mod refine;
mod render;
mod resample;
mod scene;
mod seen;
pub mod shade;
pub mod sheet;
pub mod slices;
pub mod standard;
mod tile;
pub mod warp;
pub mod weights;
pub mod window;

pub use render::{Monitor, Report, render, render_base_planes, render_base_planes_at, render_labelled};
pub use scene::is_steep;
pub use wavesplat_compute::parallel::with_threads;
