//! Depth shading (depth cueing): a factor that falls along the view, so that near parts look brighter.
//!
//! `1 − strength · (z − near) / (far − near)`, where z is the distance along the view direction; near and far are the
//! distances of the nearest and the farthest corner of the drawn region. Along every ray it is linear in the slice
//! coordinate.

use glam::DVec3;
use wavesplat_compute::simd::{LANES, Lanes};
use wavesplat_core::{Camera, Grid, Projection};

use crate::view::base_plane::BasePlane;

/// Distances from the camera's position along a unit vector, of the first and the last corner of a box of index
/// positions; along the view of a perspective camera of what is in front of the eye.
pub fn extent(direction: DVec3, camera: &Camera, grid: &Grid, [lo, hi]: [DVec3; 2]) -> [f64; 2] {
    let corners = (0..8).map(|c| {
        let pick = |bit: usize| if c >> bit & 1 == 0 { lo } else { hi };
        let world = grid.world_from_index().transform_point3(DVec3::new(pick(0).x, pick(1).y, pick(2).z));
        direction.dot(world - camera.position())
    });
    let (near, far) = corners.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), z| (a.min(z), b.max(z)));
    let sees_front = matches!(camera.projection(), Projection::Perspective { .. }) && direction == camera.forward();
    [if sees_front { near.max(0.0) } else { near }, far]
}

/// A factor that is affine in the index position.
#[derive(Clone, Copy, Debug)]
pub struct DepthCue {
    at_origin: f64,
    per_index: DVec3,
}

impl DepthCue {
    /// Shading that takes away the fraction `strength` at the farthest corner of the box `[lo, hi]`, index positions.
    pub fn new(strength: f64, camera: &Camera, grid: &Grid, corners: [DVec3; 2]) -> Self {
        let world_from_index = grid.world_from_index();
        let per_index = world_from_index.matrix3.transpose() * camera.forward();
        let at_origin = camera.forward().dot(world_from_index.translation - camera.position());
        let [near, far] = extent(camera.forward(), camera, grid, corners);
        let per_length = if far > near { strength / (far - near) } else { 0.0 };
        Self { at_origin: 1.0 - per_length * (at_origin - near), per_index: -per_length * per_index }
    }

    /// The factor at an index position.
    pub fn at(&self, index: DVec3) -> f64 {
        self.at_origin + self.per_index.dot(index)
    }

    /// The coefficients of [`DepthCue::along`] as affine functions of the texel: at texel (0, 0), and the changes per
    /// texel along u and along v.
    pub fn forms(&self, plane: &BasePlane) -> [[f64; 3]; 2] {
        let [per_u, per_v, per_w] = plane.family.uvw(self.per_index);
        let sign = if plane.family.ascending { 1.0 } else { -1.0 };
        let at = |i: f64, j: f64| {
            let ray = plane.ray(i, j);
            let at_zero = self.at_origin + per_u * ray.at_zero[0] + per_v * ray.at_zero[1];
            [at_zero, sign * (per_u * ray.slope[0] + per_v * ray.slope[1] + per_w)]
        };
        let [first, along_u, along_v] = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
        [0, 1].map(|k| [first[k], along_u[k] - first[k], along_v[k] - first[k]])
    }

    /// The factor on the rays of a run of texels that begins at `(i, j)`: at `s = 0`, and its change per s, the slice
    /// coordinate with the sign that makes it grow along the ray.
    pub fn along(&self, plane: &BasePlane, i: usize, j: usize) -> [Lanes; 2] {
        let [per_u, per_v, per_w] = plane.family.uvw(self.per_index);
        let sign = if plane.family.ascending { 1.0 } else { -1.0 };
        let mut lanes = [Lanes::splat(0.0); 2];
        for k in 0..LANES {
            let ray = plane.ray((i + k) as f64, j as f64);
            lanes[0].0[k] = (self.at_origin + per_u * ray.at_zero[0] + per_v * ray.at_zero[1]) as f32;
            lanes[1].0[k] = (sign * (per_u * ray.slope[0] + per_v * ray.slope[1] + per_w)) as f32;
        }
        lanes
    }
}
