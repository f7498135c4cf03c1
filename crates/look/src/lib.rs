//! Looks: colours, colour maps, presets, and what kind of data a volume holds.
//!
//! Plain numbers and texts in, plain numbers and texts out: no files, threads, Python or GPU.
//!
//! ```
//! use wavesplat_look::channel_colors::{ChannelFacts, usual_color};
//!
//! // Far red, which the eye hardly sees, is shown as magenta.
//! let far_red = ChannelFacts { name: "Alexa 647", ..ChannelFacts::default() };
//! assert_eq!(usual_color(&far_red), Some([1.0, 0.0, 1.0]));
//! ```

pub mod channel_colors;
pub mod colormaps;
pub mod colors;
mod map_tables;
mod numbers;
