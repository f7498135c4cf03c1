//! Distance and scale at which points are just in view.
//!
//! For one view, by the points projected into the picture; for a whole turn, by the sphere around them: a sphere of
//! radius r fills the view where half the height is r, and in perspective from r / sin(half the angle).

use glam::DVec3;
use wavesplat_core::{Error, Grid, Result};

use crate::lens::{Lens, check_ratio, distance_that_fits, half_height, largest, narrowed, slope};
use crate::named::view_angles;
use crate::pose::Pose;
use crate::rotation::{Axes, dot, dot_of_row, orbit_axes};

/// The rule by which a camera is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// In view from everywhere on a sphere around it, at one scale, so that frames of a turn can be compared.
    Turn,
    /// As near as one view allows.
    View,
}

/// A volume or points to be in view, and the lens that they are seen through.
#[derive(Clone, Copy, Debug)]
pub struct InView<'a> {
    corners: &'a [DVec3],
    points: Option<&'a [DVec3]>,
    zoom: f64,
    view_angle_deg: Option<f64>,
    aspect: f64,
}

impl<'a> InView<'a> {
    /// A box to be in view, by its corners, world positions, at least one: orthographic, square, at zoom 1.
    pub fn around(corners: &'a [DVec3]) -> Self {
        Self { corners, points: None, zoom: 1.0, view_angle_deg: None, aspect: 1.0 }
    }

    /// With world positions, at least one, that must be in view instead of the corners.
    #[must_use]
    pub fn points(self, points: &'a [DVec3]) -> Self {
        Self { points: Some(points), ..self }
    }

    /// With a magnification, 1e-9 to 1e9; in perspective it narrows the angle of view, and the eye stays.
    #[must_use]
    pub fn zoom(self, zoom: f64) -> Self {
        Self { zoom, ..self }
    }

    /// In perspective, with an angle of view from bottom to top at zoom 1, degrees between 0 and 180.
    #[must_use]
    pub fn perspective(self, view_angle_deg: f64) -> Self {
        Self { view_angle_deg: Some(view_angle_deg), ..self }
    }

    /// For a picture of this ratio of width to height, 1e-9 to 1e9.
    #[must_use]
    pub fn aspect(self, aspect: f64) -> Self {
        Self { aspect, ..self }
    }

    /// The pose on the orbit, at an azimuth and an elevation in degrees; see [`orbit_axes`].
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] if a number is not finite, or zoom, aspect or view angle is out of range.
    pub fn orbit(&self, azimuth_deg: f64, elevation_deg: f64, fit: Fit) -> Result<Pose> {
        for (what, angle) in [("azimuth", azimuth_deg), ("elevation", elevation_deg)] {
            if !angle.is_finite() {
                return Err(Error::out_of_range(what, angle, "a finite number of degrees", "pass one, such as 30"));
            }
        }
        self.place(&orbit_axes(azimuth_deg, elevation_deg), fit)
    }

    /// The pose of a named view, such as "front", with everything just in view; see [`view_angles`].
    ///
    /// # Errors
    ///
    /// [`Error::UnknownName`] if there is no view of that name, and the errors of [`InView::orbit`].
    pub fn view(&self, name: &str, is_anatomical: bool) -> Result<Pose> {
        let (azimuth, elevation) = view_angles(name, is_anatomical)?;
        self.orbit(azimuth, elevation, Fit::View)
    }

    /// The pose with these axes.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] if zoom, aspect or view angle is out of range.
    pub fn place(&self, axes: &Axes, fit: Fit) -> Result<Pose> {
        self.check()?;
        let shown = self.shown();
        let center = match (self.points, fit) {
            (Some(points), Fit::View) => {
                // The middle of what is seen from there.
                let seen: Vec<DVec3> = points.iter().map(|&p| axes.coordinates(p)).collect();
                axes.vector(middle(&seen))
            }
            _ => middle(shown),
        };
        let in_view = || shown.iter().map(|&p| axes.coordinates(p - center)).collect::<Vec<_>>();
        let (distance, lens) = match (fit, self.view_angle_deg) {
            (Fit::Turn, None) => {
                let scale = radius(shown, center) * (1.0 / self.aspect).max(1.0) / self.zoom;
                // Clear of the box.
                (2.0 * radius(self.corners, center), Lens::ParallelScale(scale))
            }
            (Fit::Turn, Some(angle)) => {
                let half_angle = (slope(angle) * self.aspect.min(1.0)).atan();
                (radius(shown, center) / half_angle.sin(), self.lens_in_perspective(angle))
            }
            (Fit::View, None) => {
                // Clear of the box, so that depths are positive.
                let along = self.corners.iter().map(|&p| dot_of_row(p - center, axes.back));
                let (near, far) = along.fold((f64::NEG_INFINITY, f64::INFINITY), |(a, b), w| (a.max(w), b.min(w)));
                (near - far, Lens::ParallelScale(half_height(&in_view(), self.aspect) / self.zoom))
            }
            (Fit::View, Some(angle)) => {
                (distance_that_fits(&in_view(), angle, self.aspect), self.lens_in_perspective(angle))
            }
        };
        Ok(Pose { position: center + distance * axes.back, focal_point: center, view_up: axes.up, lens })
    }

    /// The pose of the first of several views, at least one, at a scale and a distance at which each of them shows
    /// everything. All look at the middle of the box around the corners, or around the points.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] if zoom, aspect or view angle is out of range.
    ///
    /// # Panics
    ///
    /// If there is no view.
    pub fn place_for_all(&self, views: &[Axes]) -> Result<Pose> {
        self.check()?;
        let shown = self.shown();
        let center = middle(shown);
        let from_center: Vec<DVec3> = shown.iter().map(|&p| p - center).collect();
        let (distance, lens) = match self.view_angle_deg {
            None => {
                let half = |axes: &Axes| {
                    let right = axes.right / self.aspect;
                    largest(from_center.iter().map(|&p| dot(p, right).abs().max(dot(p, axes.up).abs())))
                };
                let scale = largest(views.iter().map(half)) / self.zoom;
                (2.0 * radius(self.corners, center), Lens::ParallelScale(scale))
            }
            Some(angle) => {
                let distance = |axes: &Axes| {
                    let in_view: Vec<DVec3> = from_center.iter().map(|&p| axes.coordinates(p)).collect();
                    distance_that_fits(&in_view, angle, self.aspect)
                };
                (largest(views.iter().map(distance)), self.lens_in_perspective(angle))
            }
        };
        let axes = &views[0];
        Ok(Pose { position: center + distance * axes.back, focal_point: center, view_up: axes.up, lens })
    }

    fn shown(&self) -> &'a [DVec3] {
        self.points.unwrap_or(self.corners)
    }

    fn lens_in_perspective(&self, view_angle_deg: f64) -> Lens {
        Lens::ViewAngleDeg(narrowed(view_angle_deg, self.zoom))
    }

    fn check(&self) -> Result<()> {
        check_ratio("zoom", self.zoom)?;
        check_ratio("aspect", self.aspect)?;
        match self.view_angle_deg {
            Some(angle) if !(angle > 0.0 && angle < 180.0) => {
                let mend = "pass the vertical view angle in degrees, 30 for example";
                Err(Error::out_of_range("view angle", angle, "between 0 and 180 degrees", mend))
            }
            _ => Ok(()),
        }
    }
}

/// World positions of the corners of a box between two corners of the world.
pub fn box_corners([lower, upper]: [DVec3; 2]) -> [DVec3; 8] {
    std::array::from_fn(|k| {
        let side = |axis: usize| if k >> (2 - axis) & 1 == 1 { upper[axis] } else { lower[axis] };
        DVec3::new(side(0), side(1), side(2))
    })
}

/// World positions of the eight outermost sample centres of a grid.
pub fn grid_corners(grid: &Grid) -> [DVec3; 8] {
    let world_from_index = grid.world_from_index();
    box_corners([DVec3::ZERO, grid.last_index()]).map(|index| world_from_index.transform_point3(index))
}

/// Middle of the box around points.
fn middle(points: &[DVec3]) -> DVec3 {
    let first = points.first().copied().unwrap_or(DVec3::NAN);
    let (low, high) = points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
    (low + high) / 2.0
}

/// Largest distance of points from a centre.
fn radius(points: &[DVec3], center: DVec3) -> f64 {
    largest(points.iter().map(|&p| (p - center).length()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [300, 200];
    const ASPECT: f64 = 1.5;

    /// A sheared and turned box.
    fn corners() -> [DVec3; 8] {
        let map = glam::DMat3::from_cols_array(&[50.0, 3.0, -9.0, 12.0, 30.0, 2.0, 1.0, -7.0, 90.0]);
        box_corners([DVec3::ZERO, DVec3::ONE]).map(|p| map * p + DVec3::new(100.0, -20.0, 7.0))
    }

    /// Smallest distance of the points from the edges of the picture, pixels; below 0 if one is outside.
    fn margin(pose: &Pose, points: &[DVec3]) -> f64 {
        let inside = |[x, y]: [f64; 2]| (x + 0.5).min(299.5 - x).min(y + 0.5).min(199.5 - y);
        pose.project(points, SIZE).0.into_iter().map(inside).fold(f64::INFINITY, f64::min)
    }

    fn framings(corners: &[DVec3]) -> [InView<'_>; 2] {
        let framing = InView::around(corners).aspect(ASPECT);
        [framing, framing.perspective(50.0)]
    }

    #[test]
    fn a_view_shows_everything_and_one_corner_touches_its_edge() {
        let corners = corners();
        for framing in framings(&corners) {
            for k in 0..40 {
                let pose = framing.orbit(f64::from(k) * 41.0, f64::from(k) * 17.0, Fit::View).unwrap();
                let margin = margin(&pose, &corners);
                assert!(margin.abs() < 1e-9, "{margin} pixels at {k}");
            }
        }
    }

    #[test]
    fn a_turn_shows_everything_from_everywhere_at_one_scale_and_distance() {
        let corners = corners();
        for framing in framings(&corners) {
            let first = framing.orbit(0.0, 0.0, Fit::Turn).unwrap();
            let mut least = f64::INFINITY;
            for k in 0..400 {
                let pose = framing.orbit(f64::from(k) * 41.0, f64::from(k) * 17.0, Fit::Turn).unwrap();
                assert_eq!((pose.lens, pose.focal_point), (first.lens, first.focal_point));
                least = least.min(margin(&pose, &corners));
            }
            assert!((0.0..2.0).contains(&least), "{least} pixels");
        }
    }

    #[test]
    fn several_views_are_as_near_as_the_one_that_needs_most() {
        let corners = corners();
        for framing in framings(&corners) {
            let views: Vec<Axes> = (0..9).map(|k| orbit_axes(f64::from(k) * 40.0, 10.0)).collect();
            let first = framing.place_for_all(&views).unwrap();
            let margins = views.iter().map(|axes| {
                let position = first.focal_point + first.distance() * axes.back;
                margin(&Pose { position, view_up: axes.up, ..first }, &corners)
            });
            let least = margins.fold(f64::INFINITY, f64::min);
            assert!(least.abs() < 1e-9, "{least} pixels");
        }
    }

    #[test]
    fn points_are_in_view_instead_of_the_corners() {
        let corners = corners();
        let points = [DVec3::new(120.0, -10.0, 20.0), DVec3::new(130.0, 0.0, 60.0), DVec3::new(110.0, 5.0, 30.0)];
        for framing in framings(&corners).map(|framing| framing.points(&points)) {
            let pose = framing.orbit(20.0, 30.0, Fit::View).unwrap();
            assert!(margin(&pose, &points).abs() < 1e-9);
            let half_as_large = framing.zoom(0.5).orbit(20.0, 30.0, Fit::View).unwrap();
            // A quarter of the height, or of the width, is free on either side of what filled it.
            assert!((50.0 - 1e-9..75.0 + 1e-9).contains(&margin(&half_as_large, &points)));
        }
    }

    #[test]
    fn impossible_numbers_are_refused() {
        let corners = corners();
        let framing = InView::around(&corners);
        for wrong in [framing.zoom(0.0), framing.zoom(f64::NAN), framing.aspect(-1.0), framing.perspective(180.0)] {
            assert!(matches!(wrong.orbit(0.0, 0.0, Fit::Turn), Err(Error::OutOfRange { .. })), "{wrong:?}");
        }
        assert!(framing.orbit(f64::INFINITY, 0.0, Fit::Turn).is_err());
        assert!(framing.view("behind", false).is_err());
    }
}
