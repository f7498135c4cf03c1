//! Two eyes that look in parallel, and views that are in perspective or from within.
//!
//! An eye at +-e/2 sees the plane at the distance c in the same window as the middle does if its frustum is sheared by
//! e / (2 c). The renderer draws symmetric frusta, so a picture that is wider by k pixels is drawn, and k of them are
//! cut off at one side: the frustum of the rest is sheared by k / 2 pixels, exactly. With f = height / (2 tan(angle /
//! 2)), the pixels to the unit tangent, k is f e / c, rounded, so that the plane without parallax lies at f e / k. See
//! P. Bourke, "Calculating stereo pairs" (1999).

use glam::DVec3;

use crate::lens::{Lens, slope};
use crate::pose::Pose;
use crate::rotation::{Axes, dot};

/// Vertical angle of view, degrees, of cameras of VTK, for views that are orthographic by themselves.
pub const VIEW_ANGLE_DEG: f64 = 30.0;
/// Least share of a view's up along the world's z, in views that have a horizon.
const MIN_UPRIGHT: f64 = 0.5;
/// Angle between the eyes, seen from where they converge, degrees: the default of cameras of VTK.
const EYE_ANGLE_DEG: f64 = 2.0;
/// Angle of view of the eye of a panorama, degrees: the angle of a cube's sides.
const WITHIN_ANGLE_DEG: f64 = 90.0;

/// One of two eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eye {
    /// The left eye.
    Left,
    /// The right eye.
    Right,
}

impl Eye {
    /// Half of a distance of the eyes, towards this one.
    pub(crate) fn half(self, distance: f64) -> f64 {
        if self == Self::Right { distance / 2.0 } else { -distance / 2.0 }
    }
}

/// Two eyes beside each other that look in parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoEyes {
    /// Distance of the eyes, world units.
    pub distance: f64,
    /// Distance from the eyes to the plane that both see at the same place, world units.
    pub convergence: f64,
}

impl TwoEyes {
    /// The eyes of a view: by default they converge at its focal point, and are 2 degrees of what lies there apart.
    pub fn of(pose: &Pose, distance: Option<f64>, convergence: Option<f64>) -> Self {
        let convergence = convergence.unwrap_or_else(|| pose.distance());
        let distance = distance.unwrap_or_else(|| 2.0 * convergence * slope(EYE_ANGLE_DEG));
        Self { distance, convergence }
    }

    /// Columns that are cut off each eye's picture, which is drawn wider by them: on the left of the left eye's, on the
    /// right of the right one's. The view is in perspective, and the picture `height` pixels high.
    pub fn columns_cut(&self, pose: &Pose, height: usize) -> usize {
        (pixels_to_tangent(pose, height) * self.distance / self.convergence).round_ties_even() as usize
    }

    /// Distance to the plane without parallax, as whole pixels give it; `None` is infinity.
    pub fn convergence_seen(&self, pose: &Pose, height: usize) -> Option<f64> {
        let cut = self.columns_cut(pose, height);
        (cut > 0).then(|| pixels_to_tangent(pose, height) * self.distance / cut as f64)
    }

    /// The pose of an eye.
    pub fn eye(&self, side: Eye, pose: &Pose) -> Pose {
        let shift = side.half(self.distance) * pose.axes().right;
        Pose { position: pose.position + shift, focal_point: pose.focal_point + shift, ..*pose }
    }
}

fn pixels_to_tangent(pose: &Pose, height: usize) -> f64 {
    height as f64 / (2.0 * pose.lens.scale())
}

impl Pose {
    /// A pose in perspective that shows as much in the focal plane as an orthographic one, from where 30 degrees do.
    #[must_use]
    pub fn in_perspective(&self) -> Self {
        let Lens::ParallelScale(scale) = self.lens else { return *self };
        let position = self.focal_point + scale / slope(VIEW_ANGLE_DEG) * self.axes().back;
        Self { position, lens: Lens::ViewAngleDeg(VIEW_ANGLE_DEG), ..*self }
    }

    /// The pose of an eye of a panorama, which stands where it is.
    #[must_use]
    pub fn all_around(&self) -> Self {
        Self { lens: Lens::ViewAngleDeg(WITHIN_ANGLE_DEG), ..*self }
    }

    /// The pose moved to its focal point: the eye of a panorama from the middle of what the pose shows.
    ///
    /// It looks the same way or, where it `is_level`, along the horizon below or above that, with the world's z upright;
    /// views along z have none. The focal point is as far ahead as the pose shows to each side, as what is around the
    /// eye is.
    #[must_use]
    pub fn within(&self, is_level: bool) -> Self {
        let Axes { mut up, mut back, .. } = self.axes();
        let far = match self.lens {
            Lens::ParallelScale(scale) => scale,
            Lens::ViewAngleDeg(angle) => self.distance() * slope(angle),
        };
        if is_level && up.z.abs() > MIN_UPRIGHT {
            (up, back) = (up.z.signum() * DVec3::Z, back.with_z(0.0));
        }
        let focal_point = self.focal_point - far / dot(back, back).sqrt() * back;
        Self { position: self.focal_point, focal_point, view_up: up, lens: self.lens }.all_around()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A view along -y in perspective, whose eye is 60 before its focal point.
    fn pose() -> Pose {
        let focal_point = DVec3::new(10.0, 20.0, 30.0);
        let lens = Lens::ViewAngleDeg(30.0);
        Pose { position: focal_point + 60.0 * DVec3::Y, focal_point, view_up: DVec3::Z, lens }
    }

    #[test]
    fn eyes_are_two_degrees_apart_by_default_and_converge_at_the_focal_point() {
        let eyes = TwoEyes::of(&pose(), None, None);
        assert_eq!(eyes.convergence, 60.0);
        assert!((eyes.distance - 2.0 * 60.0 * 1_f64.to_radians().tan()).abs() < 1e-15);
        assert_eq!(TwoEyes::of(&pose(), Some(3.0), Some(9.0)), TwoEyes { distance: 3.0, convergence: 9.0 });
    }

    #[test]
    fn both_eyes_see_the_plane_of_convergence_at_the_same_place() {
        let (size, pose) = ([300, 200], pose());
        let eyes = TwoEyes::of(&pose, Some(4.0), Some(50.0));
        let cut = eyes.columns_cut(&pose, size[1]);
        let seen = eyes.convergence_seen(&pose, size[1]).unwrap();
        assert!((seen - 50.0).abs() < 50.0 * 0.5 / cut as f64);
        let point = pose.position + seen * DVec3::NEG_Y + DVec3::new(4.0, 0.0, -3.0);
        let wide = [size[0] + cut, size[1]];
        let column = |side| eyes.eye(side, &pose).project(&[point], wide).0[0][0];
        // The left eye's first columns are cut off.
        assert!((column(Eye::Left) - cut as f64 - column(Eye::Right)).abs() < 1e-9);
        let parallel = TwoEyes { distance: 1e-9, convergence: 50.0 };
        assert_eq!((parallel.columns_cut(&pose, 200), parallel.convergence_seen(&pose, 200)), (0, None));
    }

    #[test]
    fn a_view_in_perspective_shows_the_same_of_its_focal_plane() {
        let flat = Pose { lens: Lens::ParallelScale(25.0), ..pose() };
        let deep = flat.in_perspective();
        let edge = flat.focal_point + DVec3::new(11.0, 0.0, 25.0);
        let [one, other] = [flat, deep].map(|pose| pose.project(&[edge], [320, 200]).0[0]);
        assert!((one[0] - other[0]).abs() < 1e-9 && (one[1] - other[1]).abs() < 1e-9);
        assert_eq!(deep.in_perspective(), deep);
    }

    #[test]
    fn the_eye_within_is_level_unless_it_looks_along_z() {
        let above = pose().turned(20.0, 40.0, 0.0);
        let level = above.within(true);
        assert_eq!((level.position, level.view_up), (above.focal_point, DVec3::Z));
        assert_eq!(level.focal_point.z, level.position.z);
        assert!((level.distance() - 60.0 * 15_f64.to_radians().tan()).abs() < 1e-12);
        assert!((above.within(false).axes().back - above.axes().back).length() < 1e-12);
        let down = pose().turned(0.0, 90.0, 0.0).within(true);
        assert!((down.axes().back - DVec3::Z).length() < 1e-12);
    }
}
