//! Transfer function, pre-integration, Phong shading, gradient opacity, ambient occlusion, labels: density to light.

pub mod classify;
mod depth_integral;
pub mod field_color;
pub mod gradient_opacity;
pub mod labels;
pub mod modifiers;
pub mod occlusion;
pub mod preintegrate;
pub mod shade;
pub mod slab_variation;
pub mod visibility_cache;
