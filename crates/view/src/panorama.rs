//! Panoramas of 360 degrees, of perspective pictures in all directions.
//!
//! The middle of an equirectangular picture is what the camera looks at, columns are longitudes, rows latitudes, its
//! upper edge is the camera's up. One eye takes the six sides of a cube. For two eyes each direction has eyes of its
//! own, beside each other on a circle (omnidirectional stereo: Peleg, Ben-Ezra and Pritch, "Omnistereo", 2001): some
//! turns of three pictures. Within one of these the eye stands still, so that a ray d degrees from its middle passes
//! the axis at cos(d) of half the eyes' distance, and the same from both sides of a seam on the horizon.
//!
//! Pictures overlap, and pixels in an overlap are mixed from the pictures that show them, by weights that fall evenly
//! to nothing at their edges.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::eyes::Eye;
use crate::lens::{Lens, largest};
use crate::pose::Pose;
use crate::rotation::{Axes, sin_cos_deg};

/// Pixels of the pictures for each pixel of the panorama, along the horizon: resampling blurs less.
const OVERSAMPLED: f64 = 1.25;
/// Turns of the eyes about the axis, for two eyes: a ray passes it at 0.4 % less of their distance, at most, and where
/// one looks up or down, rays of both sides of a seam are at most 2 sin(5 deg) = 0.17 of that distance apart.
pub const N_TURNS: usize = 36;
/// Edge of a cube's sides with their overlap, as a tangent.
const EDGE: f64 = 1.05;
/// Overlap of turns, degrees.
const OVERLAP_DEG: f64 = 1.5;
/// Latitude at which the pictures of a turn meet, degrees.
const MEETING_DEG: f64 = 45.0;
/// Least share of a direction that lies ahead, in what a picture shows.
const AHEAD: f64 = 1e-6;

/// A perspective picture of a panorama.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Axes of the picture in axes of the camera.
    axes: Axes,
    half_width: f64,
    half_height: f64,
    part: Scope,
}

/// The part of a panorama that a picture shows.
#[derive(Clone, Copy, Debug)]
enum Scope {
    /// A side of a cube.
    Side,
    /// A band of longitudes, radians from its `middle` to its sides, whose eyes stand in its own direction: on the
    /// horizon, or beyond it `upwards` (1) or downwards (-1).
    Band { middle: f64, half: f64, upwards: Option<f64> },
}

/// A pixel of a panorama in one of its pictures.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Number of the pixel, row by row.
    pub pixel: usize,
    /// Column and row in the picture, not rounded; (0, 0) is the centre of the first pixel.
    pub at: [f64; 2],
    /// Weight of the picture in the pixel.
    pub weight: f64,
}

impl Face {
    /// The six sides of a cube around the eye.
    pub fn of_cube() -> [Self; 6] {
        [(0.0, 0.0), (90.0, 0.0), (180.0, 0.0), (-90.0, 0.0), (0.0, 90.0), (0.0, -90.0)].map(|(turn, pitch)| Self {
            axes: turned(turn, pitch),
            half_width: EDGE,
            half_height: EDGE,
            part: Scope::Side,
        })
    }

    /// Pictures of `n` turns about the camera's up: ahead, above and below.
    pub fn of_turns(n: usize) -> Vec<Self> {
        let half = 180.0 / n as f64;
        (0..n).flat_map(|k| Self::of_turn(360.0 * k as f64 / n as f64, half)).collect()
    }

    /// The three pictures in a direction, `half` degrees to both sides, and somewhat more.
    fn of_turn(turn: f64, half: f64) -> [Self; 3] {
        let wide = (half + OVERLAP_DEG).to_radians();
        let (meeting, overlap) = (MEETING_DEG.to_radians(), OVERLAP_DEG.to_radians());
        let part = |upwards| Scope::Band { middle: turn.to_radians(), half: half.to_radians(), upwards };
        let half_height = (meeting + overlap).tan() / wide.cos();
        let ahead = Self { axes: turned(turn, 0.0), half_width: wide.tan(), half_height, part: part(None) };
        // The corner that is farthest to the side, and the one that is farthest down.
        let pitch = f64::midpoint(90.0, MEETING_DEG);
        let (axes, low) = (turned(0.0, pitch), meeting - overlap);
        let ends: Vec<DVec3> = (0..=64)
            .map(|k| direction(-wide + 2.0 * wide * f64::from(k) / 64.0, low))
            .map(|end| axes.coordinates(end))
            .collect();
        let half_width = largest(ends.iter().map(|end| (end.x / end.z).abs()));
        let down = largest(ends.iter().map(|end| (end.y / end.z).abs()));
        let half_height = down.max(((90.0 - pitch).to_radians() + overlap).tan());
        let polar = |up: f64| Self { axes: turned(turn, up * pitch), half_width, half_height, part: part(Some(up)) };
        [ahead, polar(1.0), polar(-1.0)]
    }

    /// Width and height of the picture, pixels, in a panorama of that size.
    pub fn size(&self, panorama: [usize; 2]) -> [usize; 2] {
        let scale = pixels_to_tangent(panorama);
        [self.half_width, self.half_height].map(|half| (2.0 * half * scale).ceil() as usize + 2)
    }

    /// The pose of the picture, in a panorama of that size: of one eye where the camera is, or of one of two at a
    /// distance from each other. Its focal point is as far ahead as the camera's.
    pub fn pose(&self, camera: &Pose, panorama: [usize; 2], eye: Option<(Eye, f64)>) -> Pose {
        let around = camera.axes();
        let mut position = camera.position;
        if let (Some((side, distance)), Scope::Band { middle, .. }) = (eye, self.part) {
            position += side.half(distance) * around.vector(DVec3::new(middle.cos(), 0.0, middle.sin()));
        }
        let tangent = self.size(panorama)[1] as f64 / 2.0 / pixels_to_tangent(panorama);
        Pose {
            position,
            focal_point: position - camera.distance() * around.vector(self.axes.back),
            view_up: around.vector(self.axes.up),
            lens: Lens::ViewAngleDeg(0.0).with_scale(tangent),
        }
    }

    /// The pixels of a panorama of that size that the picture shows, row by row.
    pub fn places(&self, panorama: [usize; 2]) -> Vec<Place> {
        let [width, height] = panorama;
        let scale = pixels_to_tangent(panorama);
        let middle = self.size(panorama).map(|side| side as f64 / 2.0 - 0.5);
        let longitudes: Vec<f64> = (0..width).map(|k| (k as f64 + 0.5) / width as f64 * 2.0 * PI - PI).collect();
        let mut places = Vec::new();
        for row in 0..height {
            let latitude = PI / 2.0 - (row as f64 + 0.5) / height as f64 * PI;
            for (column, &longitude) in longitudes.iter().enumerate() {
                let DVec3 { x, y, z } = self.axes.coordinates(direction(longitude, latitude));
                if z < -AHEAD {
                    let tangents = [x / -z, y / -z];
                    let weight = self.part.weight(longitude, latitude, tangents);
                    if weight > 0.0 {
                        let at = [middle[0] + scale * tangents[0], middle[1] - scale * tangents[1]];
                        places.push(Place { pixel: row * width + column, at, weight });
                    }
                }
            }
        }
        places
    }
}

impl Scope {
    /// Weight of a picture in a direction, which it shows at these tangents to the right and up; 0 beyond its edges.
    fn weight(self, longitude: f64, latitude: f64, tangents: [f64; 2]) -> f64 {
        match self {
            Self::Side => {
                // Half at the cube's edge, on both sides of it: there a tangent is one over its value in the next side.
                let falling = |tangent: f64| ((1.0 - tangent.abs().max(1e-9).ln() / EDGE.ln()) / 2.0).clamp(0.0, 1.0);
                falling(tangents[0]) * falling(tangents[1])
            }
            Self::Band { middle, half, upwards } => {
                let overlap = OVERLAP_DEG.to_radians();
                let falling = |inside: f64| ((inside + overlap) / (2.0 * overlap)).clamp(0.0, 1.0);
                let away = ((longitude - middle + PI).rem_euclid(TAU) - PI).abs();
                let above = |latitude: f64| falling(latitude - MEETING_DEG.to_radians());
                falling(half - away) * upwards.map_or_else(|| 1.0 - above(latitude.abs()), |up| above(up * latitude))
            }
        }
    }
}

/// Pixels of the pictures of a panorama to the unit tangent.
fn pixels_to_tangent([width, height]: [usize; 2]) -> f64 {
    OVERSAMPLED * (width as f64 / TAU).max(height as f64 / PI)
}

/// A direction in axes of the camera.
fn direction(longitude: f64, latitude: f64) -> DVec3 {
    let (sin, cos) = longitude.sin_cos();
    DVec3::new(latitude.cos() * sin, latitude.sin(), -latitude.cos() * cos)
}

/// Axes of an eye that turns to the right and lifts its view, degrees, in axes of the camera.
fn turned(turn_deg: f64, pitch_deg: f64) -> Axes {
    let (sin_t, cos_t) = sin_cos_deg(turn_deg);
    let (sin_p, cos_p) = sin_cos_deg(pitch_deg);
    let right = DVec3::new(cos_t, 0.0, sin_t);
    let back = DVec3::new(-sin_t * cos_p, -sin_p, cos_t * cos_p);
    Axes { right, up: back.cross(right), back }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [72, 36];

    fn camera() -> Pose {
        let (position, focal_point) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 12.0, 3.0));
        Pose { position, focal_point, view_up: DVec3::Z, lens: Lens::ViewAngleDeg(90.0) }
    }

    #[test]
    fn weights_of_all_pictures_add_up_to_one_in_every_direction() {
        for faces in [Face::of_cube().to_vec(), Face::of_turns(8), Face::of_turns(36)] {
            let mut sums = vec![0.0; SIZE[0] * SIZE[1]];
            for place in faces.iter().flat_map(|face| face.places(SIZE)) {
                sums[place.pixel] += place.weight;
            }
            // Turns share out each pixel; at a corner of the cube three sides meet.
            let most = if faces.len() == 6 { 0.3 } else { 1e-9 };
            assert!(sums.iter().all(|sum| (sum - 1.0).abs() < most), "{} faces", faces.len());
        }
    }

    #[test]
    fn pictures_show_their_pixels_where_their_cameras_see_the_direction() {
        let camera = camera();
        for face in Face::of_cube().into_iter().chain(Face::of_turns(8)) {
            let (size, pose) = (face.size(SIZE), face.pose(&camera, SIZE, None));
            assert!((pose.distance() - 10.0).abs() < 1e-12 && pose.camera().is_ok());
            for Place { pixel, at, .. } in face.places(SIZE) {
                let longitude = ((pixel % SIZE[0]) as f64 + 0.5) / 72.0 * TAU - PI;
                let latitude = PI / 2.0 - ((pixel / SIZE[0]) as f64 + 0.5) / 36.0 * PI;
                let seen = camera.position + camera.axes().vector(direction(longitude, latitude));
                let place = pose.project(&[seen], size).0[0];
                assert!((place[0] - at[0]).abs() < 1e-9 && (place[1] - at[1]).abs() < 1e-9);
                assert!((-0.5..size[0] as f64 - 0.5).contains(&at[0]) && (-0.5..size[1] as f64 - 0.5).contains(&at[1]));
            }
        }
    }

    #[test]
    fn eyes_of_turns_are_beside_each_other_in_their_direction() {
        for face in Face::of_turns(8) {
            let [left, right] = [Eye::Left, Eye::Right].map(|side| face.pose(&camera(), SIZE, Some((side, 2.0))));
            let apart = right.position - left.position;
            assert!((apart - 2.0 * left.axes().right).length() < 1e-12);
        }
        let side = Face::of_cube()[0].pose(&camera(), SIZE, Some((Eye::Left, 2.0)));
        assert_eq!(side.position, camera().position);
    }
}
