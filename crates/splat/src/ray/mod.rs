//! Compositing along rays: over, projections (MIP and others), first hit of an isosurface, local maximum.

pub mod accumulator;
pub mod compositor;
pub mod cut_faces;
pub mod first_hit;
pub mod local_maximum;
pub mod media;
pub mod over;
pub mod over_layers;
pub mod project;
pub mod state;
pub mod surfaces;
