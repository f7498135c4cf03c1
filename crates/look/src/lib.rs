//! Looks: colours, colour maps, presets, and what kind of data a volume holds.
//!
//! Plain numbers and texts in, plain numbers and texts out: no files, threads, Python or GPU.
//!
//! ```
//! use wavesplat_look::Look;
//! use wavesplat_look::channel_colors::{ChannelFacts, usual_color};
//!
//! # fn main() -> wavesplat_core::Result<()> {
//! let look = Look::preset("ct-bone")?;
//! assert_eq!(look.transfer_function.opacity_unit(), Some(1.0));
//!
//! // Far red, which the eye hardly sees, is shown as magenta.
//! let far_red = ChannelFacts { name: "Alexa 647", ..ChannelFacts::default() };
//! assert_eq!(usual_color(&far_red), Some([1.0, 0.0, 1.0]));
//! # Ok(())
//! # }
//! ```
//!
//! [`kind`] says what the samples of a volume are, and why it is thought so, from [`Evidence`]: what its file says, and
//! samples spread over it with their neighbours.

mod automatic;
pub mod changes;
pub mod channel_colors;
mod channel_light;
pub mod channel_ramp;
mod channel_windows;
pub mod colormaps;
pub mod colors;
pub mod ct_windows;
mod evidence;
mod facts;
mod fields;
mod histogram;
mod hounsfield;
mod kinds;
mod light_maps;
mod look;
mod map_tables;
mod measured_maps;
mod numbers;
mod over_others;
pub mod presets;
mod projections;
pub mod quantities;
pub mod scale;
mod scans;
mod segmentation;
mod shares;
pub mod statistics;
pub mod texts;
pub mod voxels;
mod words;

pub use automatic::{AutomaticLook, Refusal, SOLID_LIGHT, SliceFacts, Subject, is_block};
pub use channel_light::ChannelLight;
pub use channel_windows::{ChannelWindow, VolumeChannel, is_whole_range, window_of_values};
pub use evidence::{
    Evidence, HISTOGRAM_SAMPLES, KIND_SAMPLES, MIN_FINITE, Neighbourhood, SeenSamples, SidePair, Source, UNIT_SAMPLES,
    step_for,
};
pub use facts::{DataKind, KindFacts, MODALITIES, NumberType};
pub use fields::FilledPart;
pub use histogram::{N_BINS, ROBUST, Scan, otsu, otsu_of_scan, robust_range, without_padding};
pub use hounsfield::{looks_like_hounsfield, stored_offset};
pub use kinds::{FAR, FoundKind, kind};
pub use look::{LightSettings, Look};
pub use over_others::{MapColors, OverCurves, OverLook, OverValues, is_of_two_signs};
pub use projections::{HOUNSFIELD_ATTENUATION, RayOperator, SpreadSamples};
pub use scans::CurveNodes;
pub use words::in_digits;
