//! Lenses: orthographic or perspective, and how much of the world they show.

use glam::DVec3;
use wavesplat_core::{Error, Result};

/// Largest ratio of lengths in a picture, such as of view and volume: beyond it numbers do not resolve pixels.
pub const FARTHEST: f64 = 1e9;

/// Lens of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Orthographic: half the height of the view, world units.
    ParallelScale(f64),
    /// Perspective: the angle of view from bottom to top, degrees.
    ViewAngleDeg(f64),
}

impl Lens {
    /// Half the height of the view, or the tangent of half its angle.
    pub(crate) fn scale(self) -> f64 {
        match self {
            Self::ParallelScale(scale) => scale,
            Self::ViewAngleDeg(angle) => slope(angle),
        }
    }

    /// The lens of the same kind with another scale.
    pub(crate) fn with_scale(self, scale: f64) -> Self {
        match self {
            Self::ParallelScale(_) => Self::ParallelScale(scale),
            Self::ViewAngleDeg(_) => Self::ViewAngleDeg(angle_of(scale)),
        }
    }
}

/// The angle of view, degrees, in which things look `zoom` times as large.
pub(crate) fn narrowed(view_angle_deg: f64, zoom: f64) -> f64 {
    angle_of(slope(view_angle_deg) / zoom)
}

/// The angle of view, degrees, by the tangent of its half.
fn angle_of(slope: f64) -> f64 {
    (2.0 * slope.atan()).to_degrees()
}

/// Tangent of half an angle of view, degrees.
pub(crate) fn slope(view_angle_deg: f64) -> f64 {
    (view_angle_deg.to_radians() / 2.0).tan()
}

/// Half the height of an orthographic view in which points, in coordinates of its axes from its middle, are.
pub(crate) fn half_height(in_view: &[DVec3], aspect: f64) -> f64 {
    largest(in_view.iter().map(|p| p.y.abs().max(p.x.abs() / aspect)))
}

/// Smallest distance of the eye from the middle at which every point is inside the view. A point (u, v, w) is seen
/// from distance d at v / (d - w), which must not exceed the tangent of half the angle.
pub(crate) fn distance_that_fits(in_view: &[DVec3], view_angle_deg: f64, aspect: f64) -> f64 {
    let slope = slope(view_angle_deg);
    largest(in_view.iter().map(|p| p.z + p.y.abs().max(p.x.abs() / aspect) / slope))
}

/// Refuses a factor outside of 1 / [`FARTHEST`] to [`FARTHEST`].
pub(crate) fn check_ratio(what: &str, ratio: f64) -> Result<()> {
    if (1.0 / FARTHEST..=FARTHEST).contains(&ratio) {
        return Ok(());
    }
    Err(Error::out_of_range(what, ratio, "a number from 1e-9 to 1e9", "pass one in that range, 1 is neutral"))
}

/// The largest of some numbers.
pub(crate) fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(f64::NEG_INFINITY, f64::max)
}
