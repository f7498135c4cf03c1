//! Plan of a frame: all decisions that are taken once, in f64, before samples are read.
//!
//! These are slice families and their base planes, sheet positions, footprints, tables of the transfer function,
//! occupancy, intervals of rays, lights, and how pixels are read. A plan owns its numbers, mostly as plain arrays, and
//! knows neither the samples nor threads: the CPU draws by it piece by piece ([`crate::render::piece`]), and so can a
//! GPU, a stream of boxes, or many machines. No decision is taken twice, so the backends cannot drift apart.

use std::sync::Arc;

use glam::DVec3;
use wavesplat_compute::simd::{LANES, Level};
use wavesplat_core::{
    Camera, Composite, Crop, Error, Gradient, Grid, RenderOptions, Result, Shading, TransferFunction,
};

use crate::optics::field_color::FieldColor;
use crate::optics::gradient_opacity::GradientOpacity;
use crate::optics::labels::LabelFields;
use crate::optics::modifiers::Modifiers;
use crate::optics::occlusion::{ExtinctionGrid, LightFields};
use crate::optics::shade::Shader;
use crate::optics::visibility_cache::TabulatedFunction;
use crate::picture::depth_colors::PlacedDepthColors;
use crate::picture::supersampling::reads_per_axis;
use crate::ray::project::Project;
use crate::ray::surfaces::TileSurfaces;
use crate::render::layer::{ColorField, Layer};
use crate::render::part_plan::PartPlan;
use crate::render::shape_plan::{ShapePlan, bounds_with};
use crate::shapes::fragments::Fragments;
use crate::sheet::spacing::SheetSpacing;
use crate::sheet::tile_rays::RayGeometry;
use crate::source::field::Field;
use crate::source::min_max_bricks::Bricks;
use crate::source::occupancy::OccupancyGrid;
use crate::view::base_plane::{BasePlane, base_planes};
use crate::view::common_grid::{CommonGrid, IndexMap, from_layer, map_of_color};
use crate::view::depth_cue::DepthCue;
use crate::view::family::IndexRays;
use crate::view::index_frame::light_direction;
use crate::view::region::Region;
use crate::view::silhouette::Silhouette;

/// Early ray termination: opacity from which a ray stops. The rest is a tenth of a grey level of 1024.
const OPAQUE_ENOUGH: f32 = 1.0 - 1e-4;

/// Opacity from which a ray stops without early termination. The rest is an eighth of a 16-bit grey level.
const OPAQUE_TO_THE_END: f32 = 1.0 - 2e-6;

/// Plan of a frame.
pub struct Plan {
    /// SIMD level that the CPU uses.
    pub simd: Level,
    /// Grid in whose index space rays, sheets and texels lie: the volume's own, or one that holds all layers.
    pub grid: Grid,
    /// The view.
    pub camera: Camera,
    /// Width and height of the picture.
    pub size_px: [usize; 2],
    /// The viewing ray of every pixel, in index space.
    pub rays: IndexRays,
    /// Part of space that is drawn: an intersection of half spaces.
    pub region: Region,
    /// Part of that region that this process draws; `None`: all.
    pub part: Option<PartPlan>,
    /// Silhouette of the regions of all layers.
    pub silhouette: Silhouette,
    /// Composite operator: how the sheets become one value per ray.
    pub operator: Operator,
    /// Plans of the layers; mostly one.
    pub layers: Vec<LayerPlan>,
    /// Depth shading, if it is wanted.
    pub depth_cue: Option<DepthCue>,
    /// Hues by the place of the extreme, of a projection.
    pub depth_colors: Option<PlacedDepthColors>,
    /// Light and labels as fields, on grids of their own beside the first layer's, and which field holds which.
    pub fields: Arc<FieldPlan>,
    /// Sheets per slice distance, approximately.
    pub sheets_per_slice: f64,
    /// Plans of the base planes: one for parallel rays, up to six in perspective.
    pub families: Vec<FamilyPlan>,
    /// Reads of the base planes per pixel, along x and along y each; the pixel is their mean.
    pub reads_per_axis: usize,
    /// Largest unassociated colour.
    pub peak: f32,
    /// Whether the position of opacity 1/2 is wanted.
    pub with_depth: bool,
    /// Unassociated colour and opacity behind the volume.
    pub background: Option<[f32; 4]>,
    /// Surfaces, lines and points in the picture; `None` without.
    pub shapes: Option<ShapePlan>,
}

/// Plan of a layer.
pub struct LayerPlan {
    /// Grid of the layer's samples, with the range of their densities.
    pub grid: Grid,
    /// Map from index positions of the frame to index positions of the layer.
    pub map: IndexMap,
    /// Part of the layer that is drawn, in the index space of the frame.
    pub region: Region,
    /// World length that opacities refer to, and the unit of the lengths of projections.
    pub opacity_unit: f64,
    /// Tables of the transfer function: colour and optical depth by density, integrals, visible ranges.
    pub tables: Arc<TabulatedFunction>,
    /// Transfer function: colours projections after the warp, and gives gradient opacity.
    pub transfer_function: TransferFunction,
    /// Lights and coefficients, in the frame that they are given in; `None` for projections, and without shading.
    pub shading: Option<Shading>,
    /// Least and largest density, or spline coefficient.
    pub density_range: [f32; 2],
    /// Field that gives the layer its colours.
    pub color: Option<ColorPlan>,
}

/// Plan of a field that gives a layer its colours.
pub struct ColorPlan {
    /// Map from index positions of the frame to index positions of the field.
    pub map: IndexMap,
    /// Tables of the transfer function of the field's densities; only its colours are used.
    pub tables: Arc<TabulatedFunction>,
    /// Whether samples of the field are missing.
    pub has_mask: bool,
    /// Number of its sheet among the sheets of all fields: light and labels come first.
    pub field: usize,
    /// Offset and scale from values of the field to its densities.
    pub density_from_sample: (f64, f64),
}

/// Composite operator: how the sheets become one value per ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operator {
    /// Emission and absorption.
    Over {
        /// Whether slabs are pre-integrated: their density is linear between two sheets.
        pre_integrated: bool,
        /// Opacity from which a ray is done.
        opaque: f32,
    },
    /// The first crossing of a density, shaded there.
    FirstHit {
        /// Density of the surface.
        iso: f32,
    },
    /// The first maximum that reaches a density.
    LocalMaximum {
        /// Density that a maximum must reach.
        threshold: f32,
    },
    /// All other projections.
    Project {
        /// The projection.
        composite: Composite,
        /// Densities at which the projection dims or absorbs ([`Project::levels`]).
        levels: [f32; 2],
    },
}

impl Operator {
    /// The projection, whose values are coloured after the warp; `None` for other operators.
    pub fn projection(self) -> Option<Composite> {
        match self {
            Self::Over { .. } | Self::FirstHit { .. } => None,
            Self::LocalMaximum { threshold } => Some(Composite::LocalMaximum { threshold: f64::from(threshold) }),
            Self::Project { composite, .. } => Some(composite),
        }
    }
}

/// Scalar fields beside the density that a picture needs.
#[derive(Default)]
pub struct FieldPlan {
    /// The fields: light first, then labels.
    pub fields: Vec<Field<'static>>,
    /// Numbers of the fields that hold ambient occlusion and shadow.
    pub light: Option<LightFields>,
    /// Numbers of the fields that hold the labels.
    pub labels: Option<LabelFields>,
}

/// Plan of a base plane.
#[derive(Clone)]
pub struct FamilyPlan {
    /// Base plane: where the texels of every sheet lie.
    pub plane: BasePlane,
    /// Positions of the sheets along w.
    pub spacing: SheetSpacing,
    /// Plans of the layers on this base plane.
    pub layers: Vec<FamilyLayer>,
    /// Surfaces of shapes on the rays of the texels; `None` without shapes.
    pub fragments: Option<Arc<Fragments>>,
}

/// Plan of a layer on a base plane.
#[derive(Clone)]
pub struct FamilyLayer {
    /// Gradient estimator, lengths in voxels; `None` where no gradient is needed.
    pub gradient: Option<Gradient>,
    /// Bricks in which something may be visible, for empty-space skipping; `None`: all count.
    pub occupancy: Option<Arc<OccupancyGrid>>,
    /// Lights and coefficients; `None` without shading.
    pub shader: Option<Shader>,
    /// Gradient opacity, occlusion of light, labels.
    pub modifiers: Modifiers,
}

impl Plan {
    /// Plans a frame of layers; only `Composite::Over` takes several. Reads samples only for ambient occlusion and
    /// shadows.
    pub fn new(simd: Level, layers: &[Layer], camera: &Camera, options: &RenderOptions) -> Result<Self> {
        Self::with_fields(simd, layers, camera, options, None)
    }

    /// Plans the same frame in another size or sampling; light and labels are kept.
    pub(crate) fn resampled(&self, layers: &[Layer], options: &RenderOptions) -> Result<Self> {
        Self::with_fields(self.simd, layers, &self.camera, options, Some(self.fields.clone()))
    }

    fn with_fields(
        simd: Level,
        layers: &[Layer],
        camera: &Camera,
        options: &RenderOptions,
        fields: Option<Arc<FieldPlan>>,
    ) -> Result<Self> {
        options.validate()?;
        let composite = options.composite;
        let is_projection = composite.is_projection();
        check_layers(layers, composite)?;
        let grids: Vec<&Grid> = layers.iter().map(|layer| layer.slices.grid()).collect();
        let common = CommonGrid::new(&grids)?;
        let grid = common.grid;
        let region =
            Region::new(&grid, &RenderOptions { crop: in_common(options, &common.layers[0]), ..options.clone() })?;
        let size_px = [options.width_px, options.height_px];
        let rays = IndexRays::new(camera, grid.index_from_world(), size_px[0], size_px[1]);
        let shapes = ShapePlan::new(layers, options, &region);
        let shown = bounds_with(&grid, region.bounds, camera, options);
        let mut planes = base_planes(camera, &rays, size_px, options.oversampling, shown)?;
        if shapes.is_some() {
            // Walls are not applied as the picture is made: shapes go on beyond them.
            for plane in &mut planes {
                plane.beyond = 0.0;
            }
        }
        let slab_length = grid.mean_spacing() / options.sheets_per_slice;
        let mut plans: Vec<LayerPlan> = layers
            .iter()
            .zip(common.layers)
            .map(|(layer, map)| LayerPlan::new(layer, map, &region, slab_length, is_projection, layers.len() == 1))
            .collect();
        let fields = match fields {
            Some(fields) => fields,
            None if composite == Composite::Over => Arc::new(FieldPlan::new(layers, &plans, camera)?),
            None => Arc::default(),
        };
        let mut n_fields = fields.fields.len();
        for (plan, layer) in plans.iter_mut().zip(layers) {
            if let Some(color) = &layer.color {
                let map = map_of_color(&grid, (&plan.grid, &plan.map), color.slices.grid())?;
                plan.color = Some(ColorPlan::new(color, map, slab_length / plan.opacity_unit, n_fields));
                n_fields += 1;
            }
        }
        let needs_preintegration = || {
            let mut pairs = plans.iter().zip(layers);
            pairs.any(|(plan, layer)| {
                let thickness = slab_length / plan.opacity_unit;
                // A function of two dimensions has no integral along a slab.
                layer.transfer_function.function_2d().is_none()
                    && plan.tables.needs_preintegration(&plan.grid, layer.transfer_function, thickness)
            })
        };
        let first = layers[0];
        let mut plan = Self {
            simd,
            camera: camera.clone(),
            size_px,
            rays,
            operator: operator(options, first.slices.grid(), needs_preintegration),
            depth_cue: match composite {
                Composite::DepthShadedMaximum { strength, .. } => {
                    Some(DepthCue::new(strength, camera, &grid, region.bounds))
                }
                _ => None,
            },
            depth_colors: options
                .depth_colors
                .as_ref()
                .map(|colors| PlacedDepthColors::new(colors, camera, &grid, region.bounds)),
            grid,
            silhouette: Silhouette::new(plans.iter().map(|layer| &layer.region)),
            region,
            part: None,
            fields,
            sheets_per_slice: options.sheets_per_slice,
            families: Vec::new(),
            reads_per_axis: reads_per_axis(composite, options.oversampling),
            peak: if is_projection {
                f32::MAX
            } else {
                let of_shapes = shapes.as_ref().map(|shapes| &shapes.shading);
                layers.iter().filter_map(|l| l.shading).chain(of_shapes).map(brightest).fold(1.0, f32::max)
            },
            with_depth: options.with_depth || options.depth_colors.is_some(),
            background: options.background,
            layers: plans,
            shapes,
        };
        plan.families = planes.into_iter().map(|plane| plan.family(plane, layers)).collect();
        Ok(plan)
    }

    /// Plans a base plane of the frame, or a part of one at another resolution.
    pub(crate) fn family(&self, plane: BasePlane, layers: &[Layer]) -> FamilyPlan {
        let spacing = SheetSpacing::new(self.grid.size()[plane.family.axes[2]], self.sheets_per_slice);
        let layers = (0..layers.len()).map(|k| self.family_layer(k, &plane, layers[k].slices.bricks())).collect();
        let fragments = self.fragments(&plane).map(Arc::new);
        FamilyPlan { plane, spacing, layers, fragments }
    }

    /// Surfaces of the shapes on the rays of a base plane; `None` without shapes.
    fn fragments(&self, plane: &BasePlane) -> Option<Fragments> {
        let occlusion = self.fields.light.map(|light| (light, self.layers[0].map));
        let of_plane = (plane, &self.grid, &self.camera);
        self.shapes.as_ref().map(|shapes| shapes.fragments(self.simd, of_plane, &self.fields.fields, occlusion))
    }

    fn family_layer(&self, k: usize, plane: &BasePlane, bricks: Option<&Bricks>) -> FamilyLayer {
        let layer = &self.layers[k];
        let steps = layer.grid.world_from_index().matrix3;
        let shader_for = |range| {
            let shading = layer.shading.as_ref();
            shading.map(|s| Shader::new(s, &self.camera, steps, &plane.family, range))
        };
        let of_color = layer.color.as_ref();
        let mut modifiers = Modifiers {
            color: of_color.map(|c| FieldColor { field: c.field, tables: c.tables.clone(), has_mask: c.has_mask }),
            ..Modifiers::default()
        };
        if matches!(self.operator, Operator::Over { .. }) {
            let map = layer.grid.density_from_sample();
            let second = of_color.map(|color| (color.field, color.density_from_sample));
            modifiers.by_gradient = GradientOpacity::new(&layer.transfer_function, steps, &plane.family, map, second);
            // A further layer without shading has no light that could be occluded.
            modifiers.light = self.fields.light.filter(|_| k == 0 || layer.shading.is_some());
            if k == 0 {
                modifiers.labels = self.fields.labels;
                modifiers.label_shader = self.fields.labels.and_then(|_| shader_for([0.0, 1.0]));
            }
        }
        let of_light = layer.shading.as_ref().map(|s| s.gradient);
        FamilyLayer {
            gradient: of_light.or(modifiers.by_gradient.as_ref().map(|_| Shading::default().gradient)),
            occupancy: bricks.and_then(|bricks| self.occupancy(layer, bricks, plane.family.axes, &modifiers)),
            shader: shader_for(layer.density_range),
            modifiers,
        }
    }

    /// Bricks in which something may be visible; `None`: all count.
    fn occupancy(
        &self,
        layer: &LayerPlan,
        bricks: &Bricks,
        axes: [usize; 3],
        modifiers: &Modifiers,
    ) -> Option<Arc<OccupancyGrid>> {
        match self.operator {
            Operator::Over { .. } => {
                let occupied = bricks.occupied(axes, layer.tables.visible_ranges(bricks));
                let Some(field) = modifiers.label_medium_field() else { return Some(occupied) };
                let medium = self.fields.fields[field].slices.bricks()?;
                let covered = medium.occupied(axes, &medium.visible_ranges(|[_, hi]| hi > 0.0));
                occupied.or(&covered).map(Arc::new)
            }
            // A surface needs densities on both sides.
            Operator::FirstHit { iso } => {
                Some(bricks.occupied(axes, &bricks.visible_ranges(|[lo, hi]| lo < iso && hi >= iso)))
            }
            Operator::LocalMaximum { .. } | Operator::Project { .. } => None,
        }
    }

    /// The plan with cut faces lit by their gradients: segments of rays, which are drawn on their own, do not know
    /// where their rays entered.
    #[must_use]
    pub fn without_even_cuts(mut self) -> Self {
        for layer in self.families.iter_mut().flat_map(|family| &mut family.layers) {
            let shaders = layer.shader.iter_mut().chain(&mut layer.modifiers.label_shader);
            shaders.for_each(Shader::light_cuts_by_gradients);
        }
        self
    }

    /// Shading of the first layer that has one: its shoulder compresses the highlights of the picture.
    pub fn shading(&self) -> Option<&Shading> {
        self.layers.iter().find_map(|layer| layer.shading.as_ref())
    }
}

impl LayerPlan {
    /// Plans a layer. `slab_length`: world length of a typical slab. `is_alone`: it is the only layer, so `region` is
    /// its region.
    fn new(
        layer: &Layer,
        map: IndexMap,
        region: &Region,
        slab_length: f64,
        is_projection: bool,
        is_alone: bool,
    ) -> Self {
        let grid = layer.slices.grid();
        let tf = layer.transfer_function;
        let opacity_unit = tf.opacity_unit().unwrap_or(grid.default_opacity_unit());
        let ends = grid.bounds().map(|end| from_layer(&map, end));
        let own_region = || region.within(ends[0].min(ends[1]), ends[0].max(ends[1]));
        Self {
            region: if is_alone { region.clone() } else { own_region() },
            opacity_unit: if is_projection { 1.0 } else { opacity_unit },
            tables: layer.cache.get(layer.slices, tf, slab_length / opacity_unit),
            transfer_function: tf.clone(),
            shading: layer.shading.filter(|_| !is_projection).cloned(),
            density_range: layer.slices.range(),
            grid: grid.clone(),
            map,
            color: None,
        }
    }
}

impl ColorPlan {
    /// Plans the field that colours a layer. `slab_thickness`: of a typical slab, in `opacity_unit`s.
    fn new(color: &ColorField, map: IndexMap, slab_thickness: f64, field: usize) -> Self {
        let tables = color.cache.get(color.slices, color.transfer_function, slab_thickness);
        let density_from_sample = color.slices.grid().density_from_sample();
        // Slices of a survey have no samples; the statistics of their grid count the missing ones.
        let has_mask = color.slices.grid().statistics().n_nonfinite > 0;
        Self { map, tables, has_mask, field, density_from_sample }
    }
}

impl FamilyPlan {
    /// Geometry that the rays of all tiles share, for a layer.
    pub(super) fn ray_geometry<'a>(&'a self, plan: &'a Plan, layer: &'a LayerPlan) -> RayGeometry<'a> {
        RayGeometry {
            plane: &self.plane,
            region: &layer.region,
            widened: layer.region.widened(&self.plane, self.plane.beyond),
            silhouette: &plan.silhouette,
            part: plan.part.as_ref().map(|own| own.part),
            world_from_index: plan.grid.world_from_index(),
            gradient_steps: layer.grid.world_from_index().matrix3,
            opacity_unit: layer.opacity_unit,
            depth_cue: plan.depth_cue,
        }
    }

    /// Surfaces of shapes on the rays of the tile whose first texel is `first`, after those that a state has passed;
    /// `None` without shapes.
    pub(super) fn surfaces(&self, first: [usize; 2], passed: Vec<[u8; LANES]>) -> Option<TileSurfaces<'_>> {
        let fragments = self.fragments.as_deref().filter(|fragments| !fragments.is_empty())?;
        Some(TileSurfaces::new(fragments, first, passed))
    }

    /// Sign of w along the rays: 1 where w grows away from the eye, -1 where it falls.
    pub fn sign(&self) -> f32 {
        if self.plane.family.ascending { 1.0 } else { -1.0 }
    }
}

/// Maximum number of layers of a picture.
pub const MAX_LAYERS: usize = 8;

// The layers that a ray hits are bits of a byte (`view::silhouette::RayHits`).
const _: () = assert!(MAX_LAYERS <= u8::BITS as usize);

fn check_layers(layers: &[Layer], composite: Composite) -> Result<()> {
    if layers.is_empty() || layers.len() > MAX_LAYERS {
        return Err(Error::out_of_range("number of layers", layers.len(), "1 to 8", "leave some out"));
    }
    if layers.len() > 1 && composite != Composite::Over {
        let mend = "draw each of them on its own, and add the pictures";
        return Err(Error::out_of_range("layers of a projection or surface", layers.len(), "1", mend));
    }
    if composite.is_projection() && layers.iter().any(|layer| layer.color.is_some()) {
        let mend = "draw it with Composite::Over or Composite::FirstHit, or without the field";
        return Err(Error::out_of_range("layer of a projection", "coloured by a field", "coloured by itself", mend));
    }
    for layer in layers {
        let Some(joint) = layer.transfer_function.function_2d() else { continue };
        let what = "two-dimensional transfer function of a layer";
        match (joint.is_of_fields(), layer.color.is_some()) {
            (true, false) => {
                let mend = "give the layer the field, or a function of value and gradient";
                return Err(Error::out_of_range(what, "of two fields", "of the layer's own samples", mend));
            }
            (false, true) => {
                let mend = "give a function of one dimension, or of two fields";
                return Err(Error::out_of_range(what, "of value and gradient", "for a layer of two fields", mend));
            }
            _ => {}
        }
    }
    if layers.iter().any(|layer| layer.slices.bricks().is_none()) {
        let mend = "plan with the slices of the whole volume, then draw pieces from boxes";
        return Err(Error::out_of_range("slices of a plan", "a box of a volume", "the whole volume", mend));
    }
    Ok(())
}

/// Crop box in the index space of the frame; the options give it in the first layer's.
fn in_common(options: &RenderOptions, map: &IndexMap) -> Option<Crop> {
    Some(match options.crop? {
        Crop::Index { lo, hi } => Crop::Index { lo: from_layer(map, lo), hi: from_layer(map, hi) },
        world @ Crop::World { .. } => world,
    })
}

fn operator(options: &RenderOptions, grid: &Grid, needs_preintegration: impl Fn() -> bool) -> Operator {
    let (offset, scale) = grid.density_from_sample();
    let density = |value: f64| ((value - offset) * scale) as f32;
    match options.composite {
        Composite::Over => Operator::Over {
            pre_integrated: options.pre_integration && needs_preintegration(),
            opaque: if options.early_ray_termination { OPAQUE_ENOUGH } else { OPAQUE_TO_THE_END },
        },
        Composite::FirstHit { iso_value } => Operator::FirstHit { iso: density(iso_value) },
        Composite::LocalMaximum { threshold } => Operator::LocalMaximum { threshold: density(threshold) },
        composite @ (Composite::Maximum
        | Composite::DepthShadedMaximum { .. }
        | Composite::AttenuatedMaximum { .. }
        | Composite::Minimum
        | Composite::Mean
        | Composite::Sum
        | Composite::XRay { .. }) => Operator::Project { composite, levels: Project::levels(composite, density) },
    }
}

impl FieldPlan {
    /// Computes ambient occlusion and the shadow of the first light, where the first layer's shading asks for them, and
    /// adds the fields of labels.
    fn new(layers: &[Layer], plans: &[LayerPlan], camera: &Camera) -> Result<Self> {
        let mut plan = Self::default();
        let first = &layers[0];
        let shading = first.shading.filter(|s| s.ambient_occlusion > 0.0 || s.shadow > 0.0);
        if let Some(shading) = shading {
            let grid = first.slices.grid();
            let extinction = || {
                let mut parts = layers.iter().zip(plans).enumerate().map(|(k, (layer, plan))| {
                    let labels = layer.labels.filter(|_| k == 0);
                    ExtinctionGrid::new(layer.slices, &plan.tables, plan.opacity_unit, labels)
                });
                let mut sum = parts.next().expect("a layer")?;
                parts.try_for_each(|part| part.map(|part| sum.add(&part)))?;
                Ok(sum)
            };
            let mut terms = LightFields::default();
            if shading.ambient_occlusion > 0.0 {
                let sides = grid.spacing() * DVec3::from_array(grid.size().map(|n| n as f64));
                let radius = shading.occlusion_radius.unwrap_or(0.1 * sides.max_element());
                terms.openness = Some((plan.fields.len(), shading.ambient_occlusion));
                let openness = || extinction().and_then(|grid: ExtinctionGrid| grid.field(grid.openness(radius)));
                // The cache's key does not contain labels.
                let kept = first.labels.is_none();
                let others = plans[1..].iter().map(|other| other.tables.id()).collect();
                let tables = &plans[0].tables;
                plan.fields.push(if kept { tables.openness(radius, others, openness)? } else { openness()? });
            }
            if let Some(light) = shading.lights.first().filter(|_| shading.shadow > 0.0) {
                terms.shadow = Some((plan.fields.len(), shading.shadow));
                let extinction = extinction()?;
                plan.fields.push(extinction.field(extinction.shadow(light_direction(camera, light)))?);
            }
            plan.light = Some(terms);
        }
        if let Some(labels) = first.labels {
            plan.labels = Some(labels.terms().after(plan.fields.len()));
            plan.fields.extend(labels.fields());
        }
        Ok(plan)
    }
}

/// Largest colour that shading makes of white, at least 1.
pub fn brightest(shading: &Shading) -> f32 {
    let channel = |c: usize| shading.lights.iter().map(|l| l.rgb[c]).sum::<f32>();
    let light = (0..3).map(channel).fold(0.0, f32::max);
    (shading.ambient + (shading.diffuse + shading.specular) * light).max(1.0)
}
