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

pub mod channel_colors;
pub mod colormaps;
pub mod colors;
mod look;
mod map_tables;
mod numbers;
pub mod presets;
pub mod scale;
pub mod texts;
pub mod windows;

pub use look::Look;
