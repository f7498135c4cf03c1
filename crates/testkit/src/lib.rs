//! Phantoms with known answers and picture comparison, for the tests of Wavesplat.

#![expect(clippy::missing_panics_doc, reason = "tests are meant to panic")]

mod by_day;
mod compare;
mod phantom;
pub mod shapes;

pub use by_day::by_day;
pub use compare::{max_difference, mean_brightness, psnr_db};
pub use phantom::{PROJECTIONS, Phantom, camera_towards, opacity_ramp, ripples_signal};
