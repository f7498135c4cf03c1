//! Rays that meet shapes: in the world, and as pixel positions of a picture.

use glam::{DAffine3, DVec2, DVec3};
use wavesplat_core::{Camera, Projection};
use wavesplat_splat::view::family::Family;

/// The projection of a picture.
#[derive(Clone, Copy)]
pub struct PixelView<'a> {
    pub camera: &'a Camera,
    pub size_px: [usize; 2],
    pub index_from_world: DAffine3,
}

impl PixelView<'_> {
    /// Distance from the eye along the view.
    pub fn depth(&self, point: DVec3) -> f64 {
        (point - self.camera.position()).dot(self.camera.forward())
    }

    /// Whether points are seen only in front of the eye.
    pub fn has_eye(&self) -> bool {
        matches!(self.camera.projection(), Projection::Perspective { .. })
    }

    /// Pixel position of a point, which lies in front of the eye of a perspective.
    pub fn project(&self, point: DVec3) -> DVec2 {
        let half_height = match self.camera.projection() {
            Projection::Orthographic { parallel_scale } => parallel_scale,
            Projection::Perspective { view_angle_rad } => (view_angle_rad / 2.0).tan() * self.depth(point),
        };
        let from_eye = point - self.camera.position();
        let [right, up] = [self.camera.right(), self.camera.up()].map(|axis| axis.dot(from_eye) / half_height);
        let [width, height] = self.size_px.map(|n| n as f64);
        0.5 * DVec2::new(width + right * height, height - up * height)
    }
}

/// A surface on the way of a ray, before light and style.
pub struct Met {
    /// Ray parameter.
    pub t: f64,
    /// Normal of length 1, towards either side; `None`: colours are shown as they are.
    pub normal: Option<DVec3>,
    /// Straight colour and opacity.
    pub rgba: [f64; 4],
}

/// A ray through a pixel position, in the world.
pub struct ShapeRay {
    pub origin: DVec3,
    pub direction: DVec3,
    pub pixel: DVec2,
    /// Ray parameter from which on it sees.
    pub start: f64,
    /// World vector whose product with a position is, but for a constant, the number of its slice, along the index axis
    /// that the ray runs most along.
    pub slice: DVec3,
}

impl ShapeRay {
    /// The ray of a view through a pixel position.
    pub fn new(view: PixelView, pixel: [f64; 2]) -> Self {
        let [width_px, height_px] = view.size_px;
        let ray = view.camera.ray(pixel[0], pixel[1], width_px, height_px);
        let [_, _, w] = Family::of(view.index_from_world.transform_vector3(ray.direction)).axes;
        Self {
            origin: ray.origin,
            direction: ray.direction,
            pixel: DVec2::from_array(pixel),
            start: match view.camera.projection() {
                Projection::Orthographic { .. } => f64::NEG_INFINITY,
                Projection::Perspective { .. } => 0.0,
            },
            slice: view.index_from_world.matrix3.row(w),
        }
    }

    /// Position at a ray parameter.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// Ray parameter at which the ray passes the slice of a point.
    pub fn at_slice_of(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.slice) / self.direction.dot(self.slice)
    }
}
