//! Cameras: named views, orbits around a volume, fits, turns, and places of points in the picture.
//!
//! An [`InView`] names a volume or points to be in view, and the lens; it places a [`Pose`]: position, focal point, up
//! and lens, with angles in degrees, as documents have them. [`Pose::camera`] makes the camera that the renderer takes.
//! All numbers are double precision. Products are summed with fused multiplications in a fixed order, so that results differ
//! between machines only where the sine, cosine, tangent and arc tangent of their standard libraries do.
//!
//! ```
//! use glam::DVec3;
//! use wavesplat_view::{Fit, InView, box_corners};
//!
//! # fn main() -> wavesplat_core::Result<()> {
//! let corners = box_corners([DVec3::ZERO, DVec3::new(100.0, 80.0, 60.0)]);
//! // From 30 degrees beside the front and 20 degrees above it, in a picture of 4 by 3.
//! let pose = InView::around(&corners).perspective(30.0).aspect(4.0 / 3.0).orbit(30.0, 20.0, Fit::View)?;
//! let (pixels, _) = pose.project(&corners, [640, 480]);
//! assert!(pixels.iter().all(|[x, y]| (-0.51..639.51).contains(x) && (-0.51..479.51).contains(y)));
//! let camera = pose.camera()?;
//! assert_eq!(camera.position(), pose.position);
//! # Ok(())
//! # }
//! ```

mod eyes;
mod fit;
mod lens;
mod named;
mod panorama;
mod path;
mod pose;
mod rotation;
mod shown;
mod stack;
mod turn;

pub use eyes::{Eye, TwoEyes, VIEW_ANGLE_DEG};
pub use fit::{Fit, InView, box_corners, grid_corners};
pub use lens::{FARTHEST, Lens};
pub use named::{VIEWS, view_angles};
pub use panorama::{Face, N_TURNS, Place};
pub use path::CameraPath;
pub use pose::Pose;
pub use rotation::{Axes, about, orbit_axes, sin_cos_deg};
pub use shown::{FILLED, SomeSamples};
pub use stack::Stack;
pub use turn::Turn;
