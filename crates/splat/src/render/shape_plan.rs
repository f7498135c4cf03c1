//! Plan of shapes: their lights, what cuts them, and their surfaces on the rays of a base plane.

use std::sync::Arc;

use glam::DVec3;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Grid, Projection, RenderOptions, Shading, Shapes};

use crate::optics::occlusion::LightFields;
use crate::render::layer::Layer;
use crate::shapes::fragments::Fragments;
use crate::shapes::light::ShapeLight;
use crate::shapes::placement::PlaneView;
use crate::shapes::raster::fragments_of;
use crate::source::field::Field;
use crate::view::base_plane::BasePlane;
use crate::view::common_grid::IndexMap;
use crate::view::region::{Region, box_bounds};

/// Shapes, and the light and the cuts that their fragments are made with.
#[derive(Clone)]
pub struct ShapePlan {
    /// The shapes.
    pub shapes: Arc<Shapes>,
    /// Lights of the first layer that is lit, or a headlight.
    pub shading: Shading,
    /// The part of space that crop and clip planes leave, whatever the volume's box.
    pub cuts: Region,
}

impl ShapePlan {
    /// Shapes of a picture; `None` where there are none. `region`: what is drawn of the volumes.
    pub(super) fn new(layers: &[Layer], options: &RenderOptions, region: &Region) -> Option<Self> {
        let shapes = options.shapes.clone();
        if shapes.is_empty() {
            return None;
        }
        // The headlight makes no colour brighter than 1, so pictures without light need no shoulder for it.
        let lit = layers.iter().filter(|_| !options.composite.is_projection()).find_map(|layer| layer.shading);
        let shading = lit.cloned().unwrap_or_else(Shading::headlight);
        Some(Self { shapes, shading, cuts: region.without_box() })
    }

    /// Surfaces of the shapes on the rays of a base plane, in the index space of a grid. `fields`: fields of the plan,
    /// and `occlusion`: those among them that hold light, with the map from the grid to the first layer.
    pub(super) fn fragments(
        &self,
        simd: Level,
        (plane, grid, camera): (&BasePlane, &Grid, &Camera),
        fields: &[Field<'static>],
        occlusion: Option<(LightFields, IndexMap)>,
    ) -> Fragments {
        let view = PlaneView::new(plane, grid.world_from_index());
        let light = ShapeLight::new(&self.shading, camera, fields, occlusion);
        fragments_of(simd, &view, &self.shapes, &self.cuts, &light)
    }
}

/// Bounds of what is drawn in index space: of the volumes, and of shapes.
pub(super) fn bounds_with(grid: &Grid, [lo, hi]: [DVec3; 2], camera: &Camera, options: &RenderOptions) -> [DVec3; 2] {
    let Some(shapes) = options.shapes.bounds().filter(|_| !options.shapes.is_empty()) else { return [lo, hi] };
    // The height of the picture in the world, at the furthest of the shapes.
    let height = match camera.projection() {
        Projection::Orthographic { parallel_scale } => 2.0 * parallel_scale,
        Projection::Perspective { view_angle_rad } => {
            let furthest = shapes.map(|corner| (corner - camera.position()).abs());
            2.0 * (0.5 * view_angle_rad).tan() * furthest[0].max(furthest[1]).length()
        }
    };
    let around = options.shapes.max_half_px() * height / options.height_px as f64;
    let [first, last] = box_bounds(grid.index_from_world(), shapes[0] - around, shapes[1] + around);
    [lo.min(first), hi.max(last)]
}
