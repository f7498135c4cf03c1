//! Volume rendering of CT, MRI, microscopy and simulations, on the CPU and, with the feature `gpu`, on GPUs.
//!
//! A [`Scene`] is one or more volumes and their looks; [`Scene::render`] draws it. The method is high-resolution
//! splatting: it gives the picture of a converged ray caster in a fraction of the time, and needs no GPU.
//!
//! ```
//! use wavesplat::glam::{DAffine3, DVec3};
//! use wavesplat::view::{Fit, InView, grid_corners};
//! use wavesplat::{ColorNode, FrameOptions, OpacityNode, Samples, Scene, TransferFunction, Volume};
//!
//! # fn main() -> wavesplat::Result<()> {
//! // Samples of any type, x fastest, and the affine that takes their indices into the world.
//! let n = 32;
//! let ball = |i: usize| {
//!     let p = DVec3::new((i % n) as f64, (i / n % n) as f64, (i / (n * n)) as f64);
//!     (255.0 - 20.0 * p.distance(DVec3::splat(15.5))).max(0.0) as u8
//! };
//! let samples: Vec<u8> = (0..n * n * n).map(ball).collect();
//! let volume = Volume::new("ball", Samples::U8(&samples), [n, n, n], DAffine3::IDENTITY)?;
//!
//! // Opacity and colour by sample value, with straight lines between the nodes.
//! let opacity = [(80.0, 0.0), (120.0, 0.8)].map(|(value, opacity)| OpacityNode { value, opacity });
//! let color = [ColorNode { value: 0.0, rgb: [1.0, 0.8, 0.6] }];
//! let look = TransferFunction::new(opacity.to_vec(), color.to_vec(), None)?;
//!
//! // In perspective, 30 degrees beside the front and 20 above it, as near as all of the volume is in view.
//! let corners = grid_corners(volume.grid());
//! let framing = InView::around(&corners).perspective(35.0).aspect(160.0 / 120.0);
//! let camera = framing.orbit(30.0, 20.0, Fit::View)?.camera()?;
//!
//! let scene = Scene::new(volume, look);
//! let frame = scene.render(&camera, [160, 120], &FrameOptions::default())?;
//! assert_eq!(frame.picture.rgba.len(), 160 * 120);
//! let png: Vec<u8> = wavesplat::encode_png(&frame.picture, wavesplat::PngBits::Eight)?;
//! # assert!(png.len() > 500);
//! # Ok(())
//! # }
//! ```
//!
//! A look by name takes the place of curves and light:
//!
//! ```
//! # use wavesplat::glam::DAffine3;
//! # use wavesplat::view::{Fit, InView, grid_corners};
//! use wavesplat::{FrameOptions, Look, Samples, Scene, Volume};
//!
//! # fn main() -> wavesplat::Result<()> {
//! // A bone of 700 Hounsfield units in air.
//! let value = |i: usize| if (i % 16).abs_diff(8) < 3 { 700 } else { -1000 };
//! let samples: Vec<i16> = (0..16 * 16 * 16).map(value).collect();
//! let volume = Volume::new("bone", Samples::I16(&samples), [16, 16, 16], DAffine3::IDENTITY)?;
//! # let corners = grid_corners(volume.grid());
//! # let camera = InView::around(&corners).orbit(30.0, 20.0, Fit::View)?.camera()?;
//!
//! let look = Look::preset("ct-bone")?;
//! let options = FrameOptions { composite: look.composite, ..FrameOptions::default() };
//! let frame = Scene::with_look(volume, &look).render(&camera, [64, 64], &options)?;
//! assert!(frame.picture.rgba.iter().any(|pixel| pixel[3] > 0.9));
//! # Ok(())
//! # }
//! ```
//!
//! # More types
//!
//! - [`AutoLook`]: `Look::auto(&volume, &facts)`, the look that suits a volume; [`cut_open`]: blocks, without a corner.
//! - [`Look::preset`]: looks by name, ours and 3D Slicer's; [`look`]: colour maps, windows of CT, colours of channels.
//! - [`Scene::from_document`]: scenes that Python or the viewer saved as JSON, with camera and picture; [`document`];
//!   [`look_document`]: the JSON of a look.
//! - [`files::read`]: volumes in NIfTI and NRRD files, with the [`Facts`] of their headers; [`kind_of`]: what they hold.
//! - [`PlacedCamera`]: `Camera::orbit(&volume, ..)`, and `Camera::fit(&scene, ..)` around what looks show.
//! - [`view::InView`]: cameras on an orbit, or of a named view, that show all of a volume; [`view::Pose`]: their turns.
//! - [`Composite`]: *over*, first hit of an isosurface, and projections (MIP and others).
//! - [`Shading`]: Phong, lights, ambient occlusion, shadows. [`Labels`]: a segmentation beside the scan.
//! - [`Crop`] boxes and [`ClipPlane`]s; [`Kernel`]s between samples, from trilinear to cubic B-splines.
//! - [`SceneVolume::slice`]: values on a plane, or of a slab of planes.
//! - [`Effort`]: a named quality, a sampling, or a wanted PSNR.
//! - [`LevelVolume`]: a level of detail, or a band, of a volume of wavelet coefficients.
//! - [`SampleReader`]: volumes larger than memory, read while they are drawn ([`Scene::stream`]).
//!
//! The examples of this crate (`cargo run -p wavesplat --example head`) draw a head, a projection, labels, a coarse
//! level, and a raw file that is larger than the memory it may take; `first` draws a NIfTI or NRRD file by
//! the look that suits it, or by a preset.
//!
//! # What it does not do
//!
//! It opens no file, reads no environment variable, and starts no thread except by the feature `threads`,
//! [`FrameOptions::n_threads`], or a [`Device`] other than the CPU: drivers have threads of their own. Without the
//! feature everything runs on the caller's thread, as in wasm.
//!
//! Stability: this crate's items are public; items of the crates that it depends on are not, unless re-exported here.

mod automatic;
mod block_state;
mod bytes;
mod device;
mod document_labels;
mod document_values;
mod error;
mod frame;
mod kind;
mod lazy_volume;
mod level_look;
mod level_volume;
mod placed;
mod png;
mod quality;
mod sample_reader;
mod scene;
mod scene_document;
mod slice;
mod stream;
mod volume_cache;

pub use automatic::{AutoLook, cut_open};
pub use block_state::BlockState;
pub use bytes::{rgb_bytes, straight_bytes};
pub use device::{Device, DrawnBy};
pub use document_values::{DocumentError, look_document};
pub use error::LevelError;
pub use frame::{Frame, FrameOptions, StageTimes};
pub use kind::kind_of;
pub use lazy_volume::LazyVolume;
pub use level_look::{LevelBrightness, LevelPart};
pub use level_volume::LevelVolume;
pub use placed::PlacedCamera;
pub use png::{PngBits, encode_png, png_of_rgba};
pub use quality::{Effort, Quality};
pub use sample_reader::{SampleReader, StreamError};
pub use scene::{Scene, SceneColor, SceneLayer, SceneVolume};
pub use scene_document::FramedScene;
pub use stream::{Stream, StreamOptions};
pub use volume_cache::VolumeCache;
pub use wavesplat_splat::view::part::Part;

/// Chooses the SIMD level by name (`plain`, `sse2`, `avx2`, `avx512`, `neon`, `simd128`) for all pictures from now on; all
/// levels give the same bits. By default the widest level of the machine is used. WebAssembly has vectors if it is compiled
/// with `-C target-feature=+simd128`.
///
/// # Errors
///
/// A message with the names that this machine has, if there is no such level, or with the level in use, if that is
/// another.
pub fn use_simd(name: &str) -> std::result::Result<(), String> {
    wavesplat_compute::simd::Level::choose(name).map(|_| ())
}

/// The SIMD level that pictures are drawn with.
pub fn simd_in_use() -> &'static str {
    wavesplat_compute::simd::Level::best().name()
}

/// Vectors and matrices of this crate's interface.
pub use glam;
pub use wavesplat_compute::parallel::after_fork;
pub use wavesplat_core::{
    Camera, Card, ClipPlane, ColorNode, Composite, Crop, DepthColors, Error, ErrorKind, Facts, Gradient, GradientNode,
    Grid, Kernel, LabelLook, LevelGrid, Light, LightFrame, Mesh, OpacityNode, Paint, Paths, Picture, Points,
    Projection, Result, SampleBuffer, Samples, Shading, ShapeStyle, Shapes, Sizes, Statistics, Thickness,
    TransferFunction, TransferFunction2D, Volume, normals_of_faces,
};
pub use wavesplat_document as document;
pub use wavesplat_files as files;
#[cfg(feature = "gpu")]
pub use wavesplat_gpu as gpu;
pub use wavesplat_look::{self as look, Look};
pub use wavesplat_splat::optics::labels::{Codes, Labels};
pub use wavesplat_splat::quality::target_psnr::{Estimate, Framing, Measured, PsnrTarget, RungError, Sampling};
pub use wavesplat_splat::render::frame::SHOWS_THROUGH;
pub use wavesplat_splat::render::stream::{IndexBox, Storage};
pub use wavesplat_splat::slice_plane::{Plane, Reduction, ThickSlab};
pub use wavesplat_splat::source::survey::Survey;
pub use wavesplat_splat::{ProgressCallback, ProgressPart, Report, with_threads};
pub use wavesplat_view as view;
pub use wavesplat_wavelet::{
    CoefficientArrays, CoefficientDecoder, Keep, Norm, WaveletError, WaveletFamily, WaveletVolume,
};

/// Boxes of volumes that are too large for memory, for surveys and light beside [`Stream`], which reads its own.
pub mod boxes {
    pub use wavesplat_splat::source::slices::{Slices, VolumeBox, needed_samples};
    pub use wavesplat_splat::source::strided::{StridedSamples, light_steps};
}
