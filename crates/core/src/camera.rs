//! Camera: position, focal point, view up, orthographic or perspective; the names that VTK and `PyVista` use.
//!
//! Pixel centres lie at half-integers and image row 0 is the top, so pixel `(x, y)` of a `width × height` picture
//! looks through the view-plane position `((x + ½) / height − width / (2 height), ½ − (y + ½) / height)`, in
//! units of the view's full height.

use glam::DVec3;

use crate::error::{Error, Result};

/// Orthographic or perspective projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Parallel rays; `parallel_scale` is half the view's height, world units.
    Orthographic {
        /// Half the view's height, world units.
        parallel_scale: f64,
    },
    /// Rays from the camera's position; the angle is vertical.
    Perspective {
        /// Vertical view angle, radians, `0..π`.
        view_angle_rad: f64,
    },
}

/// A validated camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    position: DVec3,
    projection: Projection,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
}

/// A viewing ray in world space. `direction` is not normalised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start of the ray: the eye, or a point of the camera's plane for parallel rays.
    pub origin: DVec3,
    /// Direction of the ray.
    pub direction: DVec3,
}

impl Camera {
    /// Checks that position, focal point and up vector span a frame.
    pub fn new(position: DVec3, focal_point: DVec3, view_up: DVec3, projection: Projection) -> Result<Self> {
        for (what, v) in [("position", position), ("focal_point", focal_point), ("view_up", view_up)] {
            if !v.is_finite() {
                let mend = "pass three finite numbers (x, y, z) in world units";
                return Err(Error::out_of_range(
                    format!("camera {what}"),
                    format!("{:?}", v.to_array()),
                    "finite",
                    mend,
                ));
            }
        }
        match projection {
            Projection::Orthographic { parallel_scale: s } if !(s.is_finite() && s > 0.0) => {
                let mend = "pass half the view's height in world units";
                return Err(Error::out_of_range("camera parallel_scale", s, "a positive number", mend));
            }
            Projection::Perspective { view_angle_rad: a } if !(a > 0.0 && a < std::f64::consts::PI) => {
                let mend = "pass the vertical view angle in degrees, 30 for example";
                return Err(Error::out_of_range(
                    "camera view_angle",
                    a.to_degrees(),
                    "between 0 and 180 degrees",
                    mend,
                ));
            }
            _ => {}
        }
        let view = focal_point - position;
        let Some(forward) = view.try_normalize() else {
            return Err(Error::CameraOnFocalPoint { position: position.to_array() });
        };
        let right = forward.cross(view_up.normalize_or_zero());
        // Below this sine the frame's roll is rounding noise.
        if right.length() < 1e-9 {
            return Err(Error::UpParallelToView { view_up: view_up.to_array(), direction: forward.to_array() });
        }
        let right = right.normalize();
        Ok(Self { position, projection, forward, right, up: right.cross(forward) })
    }

    /// Eye position, world units.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Projection of the camera.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Unit view direction.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Unit vector towards the right of the picture.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// Unit vector towards the top of the picture.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// Side of a pixel at a point, world units; 0 at the eye and behind it.
    pub fn pixel_size(&self, point: DVec3, height_px: usize) -> f64 {
        let half_height = match self.projection {
            Projection::Orthographic { parallel_scale } => parallel_scale,
            Projection::Perspective { view_angle_rad } => {
                (view_angle_rad / 2.0).tan() * self.forward.dot(point - self.position).max(0.0)
            }
        };
        2.0 * half_height / height_px.max(1) as f64
    }

    /// The ray through pixel position `(x, y)`; pixel centres are at half-integers, `y` counts from the top.
    /// Origin and direction are affine in `(x, y)`.
    pub fn ray(&self, x_px: f64, y_px: f64, width_px: usize, height_px: usize) -> Ray {
        let height = height_px as f64;
        let right = (2.0 * x_px - width_px as f64) / height;
        let up = (height - 2.0 * y_px) / height;
        match self.projection {
            Projection::Orthographic { parallel_scale: s } => {
                Ray { origin: self.position + s * (right * self.right + up * self.up), direction: self.forward }
            }
            Projection::Perspective { view_angle_rad } => {
                let s = (view_angle_rad / 2.0).tan();
                Ray { origin: self.position, direction: self.forward + s * (right * self.right + up * self.up) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORTHOGRAPHIC: Projection = Projection::Orthographic { parallel_scale: 2.0 };

    #[test]
    fn pixel_corners_land_on_the_view_rectangle() {
        let camera = Camera::new(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, ORTHOGRAPHIC).unwrap();
        let top_left = camera.ray(0.0, 0.0, 300, 100).origin;
        assert!((top_left - DVec3::new(-6.0, -5.0, 2.0)).length() < 1e-12, "{top_left}");
        let centre = camera.ray(150.0, 50.0, 300, 100).origin;
        assert!((centre - camera.position()).length() < 1e-12, "{centre}");
    }

    #[test]
    fn perspective_angle_is_vertical() {
        let projection = Projection::Perspective { view_angle_rad: 1.0 };
        let camera = Camera::new(DVec3::ZERO, DVec3::X, DVec3::Z, projection).unwrap();
        let top = camera.ray(200.0, 0.0, 400, 100).direction.normalize();
        assert!((top.angle_between(DVec3::X) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let new = |p: DVec3, f: DVec3, up: DVec3, projection| Camera::new(p, f, up, projection).unwrap_err();
        assert!(matches!(new(DVec3::X, DVec3::X, DVec3::Z, ORTHOGRAPHIC), Error::CameraOnFocalPoint { .. }));
        assert!(matches!(new(DVec3::X, DVec3::ZERO, DVec3::NEG_X, ORTHOGRAPHIC), Error::UpParallelToView { .. }));
        assert!(matches!(new(DVec3::X, DVec3::ZERO, DVec3::ZERO, ORTHOGRAPHIC), Error::UpParallelToView { .. }));
        for parallel_scale in [0.0, -1.0, f64::NAN] {
            let projection = Projection::Orthographic { parallel_scale };
            assert!(matches!(new(DVec3::X, DVec3::ZERO, DVec3::Z, projection), Error::OutOfRange { .. }));
        }
        let projection = Projection::Perspective { view_angle_rad: 3.2 };
        assert!(matches!(new(DVec3::X, DVec3::ZERO, DVec3::Z, projection), Error::OutOfRange { .. }));
    }
}
