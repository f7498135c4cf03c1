//! World directions in the frame of a slice family: gradients are taken in index space and shaded in world space.
//!
//! The world gradient is the index-space difference times the inverse transpose of `world_from_index`.

use glam::{DMat3, DVec3};
use wavesplat_core::{Camera, Light, LightFrame};

use crate::view::family::Family;

/// World gradient from the index gradient along u, v, w; its transpose turns world vectors into forms on index
/// gradients.
pub fn world_gradient_from_index(world_from_index: DMat3, family: &Family) -> DMat3 {
    let gradient = world_from_index.inverse().transpose();
    let [u, v, w] = family.axes.map(|a| gradient.col(a));
    DMat3::from_cols(u, v, w)
}

/// World direction to a light, unit length.
pub fn light_direction(camera: &Camera, light: &Light) -> DVec3 {
    let to_light = light.to_light.normalize();
    match light.frame {
        LightFrame::World => to_light,
        LightFrame::Camera => to_light.x * camera.right() + to_light.y * camera.up() - to_light.z * camera.forward(),
    }
}
