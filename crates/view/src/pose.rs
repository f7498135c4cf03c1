//! Poses: position, focal point, up and lens of a camera, with angles in degrees, as documents have them.

use glam::DVec3;
use wavesplat_core::{Camera, Projection, Result};

use crate::lens::{Lens, check_ratio, distance_that_fits, half_height, narrowed, slope};
use crate::rotation::{Axes, about, dot_of_row, sin_cos_deg, turned, unit};

/// Position, focal point, up and lens of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The eye, world units.
    pub position: DVec3,
    /// The point in the middle of the picture.
    pub focal_point: DVec3,
    /// Direction that points up in the picture; need not be perpendicular to the view.
    pub view_up: DVec3,
    /// Orthographic or perspective.
    pub lens: Lens,
}

impl Pose {
    /// The camera that the renderer takes.
    ///
    /// # Errors
    ///
    /// If the position is the focal point, the up direction is parallel to the view, or a number is out of range.
    pub fn camera(&self) -> Result<Camera> {
        let projection = match self.lens {
            Lens::ParallelScale(parallel_scale) => Projection::Orthographic { parallel_scale },
            Lens::ViewAngleDeg(angle) => Projection::Perspective { view_angle_rad: angle.to_radians() },
        };
        Camera::new(self.position, self.focal_point, self.view_up, projection)
    }

    /// Right, up and back of the camera.
    pub fn axes(&self) -> Axes {
        let back = unit(self.position - self.focal_point);
        let right = unit(self.view_up.cross(back));
        Axes { right, up: back.cross(right), back }
    }

    /// Distance from the eye to the focal point, world units.
    pub fn distance(&self) -> f64 {
        exact_length(self.position - self.focal_point)
    }

    /// The pose after a turn about its focal point, degrees; scale and distance stay. `azimuth_deg` turns about the
    /// world's +z, as an orbit does; `elevation_deg` lifts the eye towards the top of the picture; `roll_deg` turns the
    /// eye clockwise about the line of sight, and so the picture anticlockwise.
    #[must_use]
    pub fn turned(&self, azimuth_deg: f64, elevation_deg: f64, roll_deg: f64) -> Self {
        if azimuth_deg == 0.0 && elevation_deg == 0.0 && roll_deg == 0.0 {
            return *self;
        }
        let Axes { right, up, back } = self.axes();
        let (s, c) = sin_cos_deg(elevation_deg);
        let (up, back) = (c * up - s * back, s * up + c * back);
        let (s, c) = sin_cos_deg(roll_deg);
        let up = c * up + s * right;
        let about_z = about(DVec3::Z, azimuth_deg);
        let (up, back) = (turned(&about_z, up) + 0.0, turned(&about_z, back) + 0.0);
        Self { position: self.focal_point + self.distance() * back, view_up: up, ..*self }
    }

    /// The pose that shows everything `factor` times as large; in perspective by a narrower angle, the eye stays.
    ///
    /// # Errors
    ///
    /// If the factor is not a positive number within [`crate::FARTHEST`].
    pub fn zoomed(&self, factor: f64) -> Result<Self> {
        check_ratio("zoom", factor)?;
        Ok(Self { lens: self.lens.with_scale(self.lens.scale() / factor), ..*self })
    }

    /// The pose itself where it shows all `points`, world positions, else with a larger scale or moved back until it
    /// does. `aspect`: width over height of the picture; `zoom`: magnification beyond that fit, which is kept.
    #[must_use]
    pub fn widened(&self, points: &[DVec3], zoom: f64, aspect: f64) -> Self {
        let axes = self.axes();
        let in_view: Vec<DVec3> = points.iter().map(|&p| axes.coordinates(p - self.focal_point)).collect();
        match self.lens {
            Lens::ParallelScale(scale) => {
                let needed = half_height(&in_view, aspect) / zoom;
                if needed <= scale { *self } else { Self { lens: Lens::ParallelScale(needed), ..*self } }
            }
            Lens::ViewAngleDeg(angle) => {
                let distance = distance_that_fits(&in_view, narrowed(angle, 1.0 / zoom), aspect);
                if distance <= self.distance() {
                    return *self;
                }
                Self { position: self.focal_point + distance * axes.back, ..*self }
            }
        }
    }

    /// Places of world points in a picture of `size` (width, height) pixels, and their depths.
    ///
    /// A place is a column and a row, not rounded; (0, 0) is the centre of the upper left pixel. A depth is in world
    /// units along the point's ray, from the eye, or from the plane of an orthographic camera's position. Points that
    /// are not in front of a perspective camera are NaN.
    pub fn project(&self, points: &[DVec3], size: [usize; 2]) -> (Vec<[f64; 2]>, Vec<f64>) {
        let [width, height] = size.map(|n| n as f64);
        let Axes { right, up, back } = self.axes();
        let place = |&point: &DVec3| {
            let seen = point - self.position;
            let forward = -dot_of_row(seen, back);
            let (half_height, depth) = match self.lens {
                Lens::ParallelScale(scale) => (scale, forward),
                Lens::ViewAngleDeg(angle) if forward > 0.0 => (forward * slope(angle), seen.length()),
                Lens::ViewAngleDeg(_) => (f64::NAN, f64::NAN),
            };
            let column = width.midpoint(height * dot_of_row(seen, right) / half_height) - 0.5;
            let row = height * (1.0 - dot_of_row(seen, up) / half_height) / 2.0 - 0.5;
            ([column, row], depth)
        };
        points.iter().map(place).unzip()
    }

    /// World points at `places` in a picture of `size`, at `depths` along their rays, one for each or one for all: the
    /// inverse of [`Pose::project`]. Where a depth is NaN, so is the point.
    ///
    /// # Panics
    ///
    /// If there are neither as many depths as places nor one.
    pub fn unproject(&self, places: &[[f64; 2]], depths: &[f64], size: [usize; 2]) -> Vec<DVec3> {
        assert!(depths.len() == places.len() || depths.len() == 1, "{} depths", depths.len());
        let [width, height] = size.map(|n| n as f64);
        let Axes { right, up, back } = self.axes();
        let point = |([column, row], depth): (&[f64; 2], &f64)| {
            // Distances from the middle of the picture, in half its heights.
            let across = (2.0 * (column + 0.5) - width) / height;
            let upwards = 1.0 - 2.0 * (row + 0.5) / height;
            let beside = across * right + upwards * up;
            match self.lens {
                Lens::ParallelScale(scale) => self.position + scale * beside - *depth * back,
                Lens::ViewAngleDeg(angle) => {
                    let ray = slope(angle) * beside - back;
                    self.position + *depth * ray / ray.length()
                }
            }
        };
        let one_for_all = depths.len() == 1;
        places.iter().enumerate().map(|(k, place)| point((place, &depths[if one_for_all { 0 } else { k }]))).collect()
    }
}

/// Length of a vector, rounded once: the squares are summed with their rounding errors.
fn exact_length(v: DVec3) -> f64 {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest.is_finite()) {
        return largest;
    }
    // A power of two, so that nothing over- or underflows.
    let scale = 2.0_f64.powi(largest.log2().floor().clamp(-1000.0, 1000.0) as i32);
    let (mut sum, mut error) = (0.0_f64, 0.0);
    for part in (v / scale).to_array() {
        let square = part * part;
        let next = sum + square;
        let kept = next - sum;
        error += part.mul_add(part, -square) + ((sum - (next - kept)) + (square - kept));
        sum = next;
    }
    let root = (sum + error).sqrt();
    let missing = (sum - root * root) - root.mul_add(root, -(root * root)) + error;
    (root + missing / (2.0 * root)) * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(lens: Lens) -> Pose {
        let focal_point = DVec3::new(10.0, 20.0, 30.0);
        Pose { position: focal_point + DVec3::new(0.0, 500.0, 0.0), focal_point, view_up: DVec3::Z, lens }
    }

    #[test]
    fn places_are_those_whose_rays_hit_the_points() {
        for lens in [Lens::ParallelScale(80.0), Lens::ViewAngleDeg(40.0)] {
            let pose = pose(lens).turned(33.0, 12.0, 7.0);
            let points = [DVec3::ZERO, DVec3::new(40.0, -30.0, 55.0), pose.focal_point];
            let (places, depths) = pose.project(&points, [320, 200]);
            let camera = pose.camera().unwrap();
            for ((point, [x, y]), depth) in points.iter().zip(&places).zip(&depths) {
                let ray = camera.ray(x + 0.5, y + 0.5, 320, 200);
                let hit = ray.origin + *depth * ray.direction.normalize();
                assert!((hit - *point).length() < 1e-10, "{hit} is not {point}");
            }
            for (back, point) in pose.unproject(&places, &depths, [320, 200]).iter().zip(points) {
                assert!((*back - point).length() < 1e-10);
            }
            assert!((places[2][0] - 159.5).abs() < 1e-10 && (places[2][1] - 99.5).abs() < 1e-10);
        }
        let (places, depths) = pose(Lens::ViewAngleDeg(40.0)).project(&[DVec3::new(0.0, 600.0, 0.0)], [10, 10]);
        assert!(places[0][0].is_nan() && depths[0].is_nan(), "behind the eye");
    }

    #[test]
    fn turns_keep_the_distance_and_the_lens() {
        let start = pose(Lens::ParallelScale(5.0));
        let side = start.turned(90.0, 0.0, 0.0);
        assert_eq!(side.position, start.focal_point - DVec3::new(500.0, 0.0, 0.0));
        assert_eq!((side.view_up, side.lens), (DVec3::Z, start.lens));
        assert_eq!(start.turned(0.0, 90.0, 0.0).position, start.focal_point + DVec3::new(0.0, 0.0, 500.0));
        let around = start.turned(70.0, 20.0, 10.0);
        assert!((around.distance() - 500.0).abs() < 1e-12);
    }

    #[test]
    fn zooming_twice_halves_what_is_seen() {
        assert_eq!(pose(Lens::ParallelScale(8.0)).zoomed(2.0).unwrap().lens, Lens::ParallelScale(4.0));
        let Lens::ViewAngleDeg(angle) = pose(Lens::ViewAngleDeg(90.0)).zoomed(2.0).unwrap().lens else { panic!() };
        assert!((angle.to_radians() / 2.0 - 0.5_f64.atan()).abs() < 1e-15);
        assert!(pose(Lens::ParallelScale(8.0)).zoomed(0.0).is_err());
    }

    #[test]
    fn a_pose_is_widened_only_where_it_must_be() {
        for lens in [Lens::ParallelScale(80.0), Lens::ViewAngleDeg(40.0)] {
            let pose = pose(lens);
            let near = [pose.focal_point + DVec3::ONE];
            assert_eq!(pose.widened(&near, 1.0, 1.5), pose);
            let far = [pose.focal_point + DVec3::new(30.0, 20.0, -400.0)];
            let row = pose.project(&far, [300, 200]).0[0][1];
            assert!(row > 199.5, "out of view at {row}");
            let row = pose.widened(&far, 1.0, 1.5).project(&far, [300, 200]).0[0][1];
            assert!((row - 199.5).abs() < 1e-9, "at the lower edge, not at {row}");
        }
    }

    #[test]
    fn lengths_are_rounded_once() {
        assert_eq!(exact_length(DVec3::new(2.0, 3.0, 6.0)), 7.0);
        assert_eq!(exact_length(DVec3::new(2e-300, 3e-300, 6e-300)), 7e-300);
        assert_eq!(exact_length(DVec3::new(3e300, 4e300, 0.0)), 5e300);
        assert_eq!(exact_length(DVec3::ZERO), 0.0);
        // 1 + 2^-60: below half a unit in the last place, as often as it is added.
        let small = 2.0_f64.powi(-30);
        assert_eq!(exact_length(DVec3::new(1.0, small, small)), 1.0);
    }
}
