//! Turns of the eye about an axis, at one scale and one distance.

use glam::{DMat3, DVec3};
use wavesplat_core::{Error, Result};

use crate::fit::InView;
use crate::pose::Pose;
use crate::rotation::{Axes, about, orbit_axes, turned};

/// Number of directions of a whole turn that decide its scale.
const N_DIRECTIONS: f64 = 48.0;

/// A turn of the eye, frame by frame.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    axis: DVec3,
    degrees: f64,
    frames: usize,
}

impl Turn {
    /// A turn about a direction of the world, by degrees, less than 0 the other way round, in a number of frames. Of a
    /// whole turn the last frame is the one before the first, so that it repeats.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] if the axis has no direction, the angle is not finite, or there is no frame.
    pub fn new(axis: DVec3, degrees: f64, frames: usize) -> Result<Self> {
        let length = axis.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(Error::out_of_range("axis of the turn", axis, "a direction", "pass one, such as (0, 0, 1)"));
        }
        if !degrees.is_finite() {
            return Err(Error::out_of_range("angle of the turn", degrees, "finite", "pass degrees, such as 360"));
        }
        if frames == 0 {
            return Err(Error::out_of_range("frames of the turn", frames, "1 or more", "pass their number"));
        }
        Ok(Self { axis, degrees, frames })
    }

    /// Angle of each frame, degrees.
    pub fn angles(&self) -> Vec<f64> {
        let is_whole = self.degrees.abs() >= 360.0;
        let steps = if is_whole { self.frames } else { (self.frames - 1).max(1) };
        (0..self.frames).map(|k| self.degrees * k as f64 / steps as f64).collect()
    }

    /// Poses that turn about the focal point of the first one.
    pub fn around(&self, first: &Pose) -> Vec<Pose> {
        let offset = first.position - first.focal_point;
        let further = |matrix: DMat3| {
            let position = first.focal_point + turned(&matrix, offset);
            Pose { position, view_up: turned(&matrix, first.view_up), ..*first }
        };
        std::iter::once(*first).chain(self.rotations().skip(1).map(further)).collect()
    }

    /// Poses that turn where the eye is.
    pub fn in_place(&self, pose: &Pose) -> Vec<Pose> {
        let ahead = pose.focal_point - pose.position;
        let further = |matrix: DMat3| {
            let focal_point = pose.position + turned(&matrix, ahead);
            Pose { focal_point, view_up: turned(&matrix, pose.view_up), ..*pose }
        };
        self.rotations().map(further).collect()
    }

    fn rotations(&self) -> impl Iterator<Item = DMat3> {
        self.angles().into_iter().map(|angle| about(self.axis, angle))
    }

    /// Directions of the turn that decide its scale: between two of them hardly anything comes nearer.
    fn directions(&self, first: &Axes) -> Vec<Axes> {
        let covered = self.degrees.clamp(-360.0, 360.0);
        let last = ((N_DIRECTIONS * covered.abs() / 360.0).round_ties_even()).max(1.0);
        (0..=last as usize).map(|k| first.rotated(&about(self.axis, covered * k as f64 / last))).collect()
    }
}

impl InView<'_> {
    /// The poses of a turn that begins at an azimuth and an elevation in degrees, at a scale and a distance at which
    /// everything is in view all the way.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] if zoom, aspect or view angle is out of range.
    pub fn turn(&self, azimuth_deg: f64, elevation_deg: f64, turn: &Turn) -> Result<Vec<Pose>> {
        let first = orbit_axes(azimuth_deg, elevation_deg);
        Ok(turn.around(&self.place_for_all(&turn.directions(&first))?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::box_corners;

    #[test]
    fn a_whole_turn_repeats_and_a_part_of_one_ends_at_its_angle() {
        let angles = |degrees, frames| Turn::new(DVec3::Z, degrees, frames).unwrap().angles();
        assert_eq!(angles(360.0, 4), [0.0, 90.0, 180.0, 270.0]);
        assert_eq!(angles(-90.0, 3), [0.0, -45.0, -90.0]);
        assert_eq!(angles(90.0, 1), [0.0]);
        for (axis, degrees, frames) in [(DVec3::ZERO, 1.0, 1), (DVec3::Z, f64::NAN, 1), (DVec3::Z, 1.0, 0)] {
            assert!(Turn::new(axis, degrees, frames).is_err());
        }
    }

    #[test]
    fn everything_stays_in_view_all_the_way_at_one_distance() {
        let corners = box_corners([DVec3::ZERO, DVec3::new(90.0, 40.0, 60.0)]);
        for in_view in [InView::around(&corners), InView::around(&corners).perspective(40.0)] {
            let turn = Turn::new(DVec3::new(0.2, 0.1, 1.0), 360.0, 96).unwrap();
            let mut margin = f64::INFINITY;
            for pose in in_view.turn(20.0, 10.0, &turn).unwrap() {
                let (places, _) = pose.project(&corners, [200, 200]);
                margin = places.iter().flatten().fold(margin, |least, &x| least.min(x + 0.5).min(199.5 - x));
            }
            assert!((-0.5..0.5).contains(&margin), "{margin} pixels");
        }
    }

    #[test]
    fn an_eye_turns_about_the_focal_point_or_where_it_is() {
        let corners = box_corners([DVec3::ZERO, DVec3::ONE]);
        let first = InView::around(&corners).view("front", false).unwrap();
        let turn = Turn::new(DVec3::Z, 360.0, 4).unwrap();
        let poses = turn.around(&first);
        assert_eq!(poses[0], first);
        let back = |angle| orbit_axes(angle, 0.0).back * first.distance();
        assert!((poses[1].position - (first.focal_point + back(90.0))).length() < 1e-12);
        let ahead = turn.in_place(&first)[1];
        assert_eq!(ahead.position, first.position);
        assert!((ahead.focal_point - (first.position - back(90.0))).length() < 1e-12);
    }
}
