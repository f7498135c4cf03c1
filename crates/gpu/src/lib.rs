//! The renderer's twin for GPUs: the plan of a frame, drawn by compute shaders (wgpu, WGSL).
//!
//! The CPU decides, the GPU sums. Base planes, sheets, positions, tables, occupancy, intervals of rays and lights are
//! the plan's (`wavesplat_splat::render::plan`), uploaded as plain numbers; the GPU reconstructs, classifies, shades
//! and composites, one thread per base-plane texel; the CPU warps. Samples are fetched exactly and weighed in f32,
//! never filtered by the hardware, whose fractions have 8 bits: so the picture is the CPU's within one grey level, on
//! any device.
//!
//! The stages, each a file here and, where it runs on the GPU, one of the same name in `shaders/`: `adapter` and
//! `device` (which GPU, opened) -> `self_test` (is it right?) -> `samples` (upload) -> `numbers` (the plan) ->
//! `permutation` and `pipeline` (the shader) -> `pages` (what does not fit) -> `draw` (ranges of slabs) -> base planes;
//! `gpus` keeps what is open.

mod adapter;
mod band;
mod buffers;
#[doc(hidden)]
pub mod capture;
mod device;
mod draw;
mod failure;
mod gpu;
mod gpus;
#[doc(hidden)]
pub mod layout;
#[doc(hidden)]
pub mod numbers;
mod pages;
#[doc(hidden)]
pub mod permutation;
mod pipeline;
mod report;
mod samples;
mod scene_kind;
mod self_test;
mod stage;
mod timer;
mod volumes;

pub use adapter::{Adapter, Choice, adapters};
pub use draw::Schedule;
pub use failure::{Failure, GpuResult};
pub use gpu::{DEFAULT_BUDGET_BYTES, Gpu};
pub use gpus::{DeviceChoice, DrawnOnGpu, Gpus};
pub use report::{GpuReport, WallSeconds};
