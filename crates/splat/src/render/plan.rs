//! The plan of a frame: all that is decided once, in f64, before samples are read.
//!
//! Slice families and their base planes, sheet positions, footprints, tables of the transfer function, what is occupied,
//! intervals of rays, lights, and how pixels are read. A plan owns its numbers, mostly as plain arrays, and knows neither
//! the samples nor threads: the CPU draws by it piece by piece ([`crate::render::piece`]), and so can a GPU, a stream of
//! boxes, or many machines. No decision is taken twice, so they cannot drift.

use std::sync::Arc;

use glam::DVec3;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Composite, Error, Gradient, Grid, RenderOptions, Result, Shading, TransferFunction};

use crate::optics::gradient_opacity::GradientOpacity;
use crate::optics::labels::LabelTerms;
use crate::optics::modifiers::Modifiers;
use crate::optics::occlusion::{ExtinctionGrid, LightTerms};
use crate::optics::shade::Shader;
use crate::optics::steepness::is_steep_in_slabs;
use crate::optics::visibility_cache::Visibility;
use crate::picture::supersampling::reads_per_axis;
use crate::ray::project::Project;
use crate::render::layer::Layer;
use crate::sheet::spacing::SheetSpacing;
use crate::sheet::tile_rays::RayGeometry;
use crate::source::field::Field;
use crate::source::min_max_bricks::Bricks;
use crate::source::occupancy::OccupancyGrid;
use crate::view::base_plane::{BasePlane, base_planes};
use crate::view::depth_cue::DepthCue;
use crate::view::family::IndexRays;
use crate::view::index_frame::light_direction;
use crate::view::region::Region;

/// Early ray termination: a ray stops when less than this share of light comes through, a tenth of a grey level of 1024.
const OPAQUE_ENOUGH: f32 = 1.0 - 1e-4;

/// The same where rays are to go on until nothing can be seen: an eighth of a 16-bit grey level.
const OPAQUE_TO_THE_END: f32 = 1.0 - 2e-6;

/// All that is decided of a frame.
pub struct Plan {
    /// Vectors that the CPU uses.
    pub simd: Level,
    /// Where the samples lie, and the range of their densities.
    pub grid: Grid,
    /// The view.
    pub camera: Camera,
    /// Width and height.
    pub size_px: [usize; 2],
    /// The viewing ray of every pixel, in index space.
    pub rays: IndexRays,
    /// What is drawn of the volume: half spaces.
    pub region: Region,
    /// How the sheets become one value per ray.
    pub operator: Operator,
    /// World length that opacities, or the lengths of projections, belong to.
    pub opacity_unit: f64,
    /// Tables of the transfer function: colour and optical depth by density, integrals, visible ranges.
    pub tables: Arc<Visibility>,
    /// For the colours of projections, after the warp.
    pub transfer_function: TransferFunction,
    /// Depth shading, where it is wanted.
    pub depth_cue: Option<DepthCue>,
    /// Light and labels, as fields on grids of their own; and which of them holds what.
    pub fields: Arc<FieldPlan>,
    /// Lights and coefficients, in the frame that they are given in; `None` of projections, and without shading.
    pub shading: Option<Shading>,
    /// Bounds of the densities, or spline coefficients.
    pub density_range: [f32; 2],
    /// Sheets per slice distance, about.
    pub sheets_per_slice: f64,
    /// Base planes: one for parallel rays, up to six in perspective.
    pub families: Vec<FamilyPlan>,
    /// Reads of a pixel along x and along y; it is their mean.
    pub reads_per_axis: usize,
    /// Largest unassociated colour.
    pub peak: f32,
    /// Whether the position of opacity 1/2 is wanted.
    pub with_depth: bool,
    /// Unassociated colour and opacity behind the volume.
    pub background: Option<[f32; 4]>,
}

/// How the sheets become one value per ray.
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
        /// The density.
        iso: f32,
    },
    /// The first maximum that reaches a density.
    LocalMaximum {
        /// The density.
        threshold: f32,
    },
    /// All other projections.
    Project {
        /// Which.
        composite: Composite,
        /// As of [`Project::level`].
        level: f32,
    },
}

impl Operator {
    /// The projection that it is, whose values are coloured after the warp.
    pub fn projection(self) -> Option<Composite> {
        match self {
            Self::Over { .. } | Self::FirstHit { .. } => None,
            Self::LocalMaximum { threshold } => Some(Composite::LocalMaximum { threshold: f64::from(threshold) }),
            Self::Project { composite, .. } => Some(composite),
        }
    }
}

/// Scalar quantities beside the density that a picture needs.
#[derive(Default)]
pub struct FieldPlan {
    /// Their samples: of light, then of labels.
    pub fields: Vec<Field<'static>>,
    /// Which hold ambient occlusion and shadow.
    pub light: Option<LightTerms>,
    /// Which hold the labels.
    pub labels: Option<LabelTerms>,
}

/// What is decided of a base plane.
#[derive(Clone)]
pub struct FamilyPlan {
    /// Where the texels of every sheet lie.
    pub plane: BasePlane,
    /// Where the sheets lie.
    pub spacing: SheetSpacing,
    /// How gradients are estimated, voxels; `None` where none is wanted.
    pub gradient: Option<Gradient>,
    /// Bricks that change anything, for empty-space skipping; `None`: all do.
    pub occupancy: Option<Arc<OccupancyGrid>>,
    /// Lights and coefficients; `None` without shading.
    pub shader: Option<Shader>,
    /// Gradient opacity, light that is held off, labels.
    pub modifiers: Modifiers,
}

impl Plan {
    /// Plans a frame. Reads the samples for ambient occlusion and shadows alone.
    pub fn new(simd: Level, layer: &Layer, camera: &Camera, options: &RenderOptions) -> Result<Self> {
        Self::with_fields(simd, layer, camera, options, None)
    }

    /// The same frame in another size or sampling; light and labels are kept.
    pub(crate) fn resampled(&self, layer: &Layer, options: &RenderOptions) -> Result<Self> {
        Self::with_fields(self.simd, layer, &self.camera, options, Some(self.fields.clone()))
    }

    fn with_fields(
        simd: Level,
        layer: &Layer,
        camera: &Camera,
        options: &RenderOptions,
        fields: Option<Arc<FieldPlan>>,
    ) -> Result<Self> {
        options.validate()?;
        let slices = layer.slices;
        let grid = slices.grid();
        let Some(bricks) = slices.bricks() else {
            let mend = "plan with the slices of the whole volume, then draw pieces from boxes";
            return Err(Error::out_of_range("slices of a plan", "a box of a volume", "the whole volume", mend));
        };
        let tf = layer.transfer_function;
        let composite = options.composite;
        let region = Region::new(grid, options)?;
        let size_px = [options.width_px, options.height_px];
        let rays = IndexRays::new(camera, grid.index_from_world(), size_px[0], size_px[1]);
        let planes = base_planes(camera, &rays, size_px, options.oversampling, region.bounds)?;
        let opacity_unit = tf.opacity_unit().unwrap_or(grid.default_opacity_unit());
        let slab_thickness = grid.mean_spacing() / options.sheets_per_slice / opacity_unit;
        let tables = layer.cache.get(slices, tf, slab_thickness);
        let fields = match fields {
            Some(fields) => fields,
            None if composite == Composite::Over => {
                Arc::new(FieldPlan::new(layer, camera, options, &tables, opacity_unit)?)
            }
            None => Arc::default(),
        };
        let steep = || is_steep_in_slabs(&tables, grid, tf, slab_thickness);
        let is_projection = composite.is_projection();
        let mut plan = Self {
            simd,
            grid: grid.clone(),
            camera: camera.clone(),
            size_px,
            rays,
            operator: operator(options, tf, grid, steep),
            opacity_unit: if is_projection { 1.0 } else { opacity_unit },
            tables: tables.clone(),
            transfer_function: tf.clone(),
            depth_cue: match composite {
                Composite::DepthShadedMaximum { strength, .. } => {
                    Some(DepthCue::new(strength, camera, grid, region.bounds))
                }
                _ => None,
            },
            region,
            fields,
            shading: options.shading.clone().filter(|_| !is_projection),
            density_range: slices.range(),
            sheets_per_slice: options.sheets_per_slice,
            families: Vec::new(),
            reads_per_axis: reads_per_axis(composite, options.oversampling),
            peak: if is_projection { f32::MAX } else { options.shading.as_ref().map_or(1.0, brightest) },
            with_depth: options.with_depth,
            background: options.background,
        };
        plan.families = planes.into_iter().map(|plane| plan.family(plane, Some(bricks))).collect();
        Ok(plan)
    }

    /// What is decided of a base plane, be it one of another size.
    pub(crate) fn family(&self, plane: BasePlane, bricks: Option<&Bricks>) -> FamilyPlan {
        let world_from_index = self.grid.world_from_index().matrix3;
        let shader_for = |range| {
            let shading = self.shading.as_ref();
            shading.map(|s| Shader::new(s, &self.camera, world_from_index, &plane.family, range))
        };
        let mut modifiers = Modifiers::default();
        if matches!(self.operator, Operator::Over { .. }) {
            let map = self.grid.density_from_sample();
            modifiers.by_gradient = GradientOpacity::new(&self.transfer_function, world_from_index, &plane.family, map);
            modifiers.light = self.fields.light;
            modifiers.labels = self.fields.labels;
            modifiers.label_shader = self.fields.labels.and_then(|_| shader_for([0.0, 1.0]));
        }
        let of_light = self.shading.as_ref().map(|s| s.gradient);
        let gradient = of_light.or(modifiers.by_gradient.as_ref().map(|_| Shading::default().gradient));
        FamilyPlan {
            spacing: SheetSpacing::new(self.grid.size()[plane.family.axes[2]], self.sheets_per_slice),
            gradient,
            occupancy: bricks.and_then(|bricks| self.occupancy(bricks, plane.family.axes, &modifiers)),
            shader: shader_for(self.density_range),
            modifiers,
            plane,
        }
    }

    /// Bricks in which something may be visible; `None`: all count.
    fn occupancy(&self, bricks: &Bricks, axes: [usize; 3], modifiers: &Modifiers) -> Option<Arc<OccupancyGrid>> {
        match self.operator {
            Operator::Over { .. } => {
                let occupied = bricks.occupied(axes, self.tables.visible_ranges(bricks));
                let Some(field) = modifiers.matter_field() else { return Some(occupied) };
                let matter = self.fields.fields[field].slices.bricks()?;
                let covered = matter.occupied(axes, &matter.visible_ranges(|[_, hi]| hi > 0.0));
                occupied.or(&covered).map(Arc::new)
            }
            // A surface needs densities on both sides.
            Operator::FirstHit { iso } => {
                Some(bricks.occupied(axes, &bricks.visible_ranges(|[lo, hi]| lo < iso && hi >= iso)))
            }
            Operator::LocalMaximum { .. } | Operator::Project { .. } => None,
        }
    }

    /// Whether colours along a ray change smoothly from sheet to sheet.
    pub fn is_smooth(&self) -> bool {
        matches!(self.operator, Operator::Over { pre_integrated: false, .. }) && !self.transfer_function.has_gradient()
    }
}

impl FamilyPlan {
    /// What the rays of all its tiles share.
    pub(super) fn ray_geometry<'a>(&'a self, plan: &'a Plan) -> RayGeometry<'a> {
        RayGeometry {
            plane: &self.plane,
            region: &plan.region,
            world_from_index: plan.grid.world_from_index(),
            opacity_unit: plan.opacity_unit,
            depth_cue: plan.depth_cue,
        }
    }

    /// Positions along rays grow with w, or fall: 1 or -1.
    pub fn sign(&self) -> f32 {
        if self.plane.family.ascending { 1.0 } else { -1.0 }
    }
}

fn operator(options: &RenderOptions, tf: &TransferFunction, grid: &Grid, is_steep: impl Fn() -> bool) -> Operator {
    let (offset, scale) = grid.density_from_sample();
    let density = |value: f64| ((value - offset) * scale) as f32;
    match options.composite {
        Composite::Over => Operator::Over {
            // A function of two dimensions has no integral along a slab.
            pre_integrated: options.pre_integration && tf.function_2d().is_none() && is_steep(),
            opaque: if options.early_ray_termination { OPAQUE_ENOUGH } else { OPAQUE_TO_THE_END },
        },
        Composite::FirstHit { iso_value } => Operator::FirstHit { iso: density(iso_value) },
        Composite::LocalMaximum { threshold } => Operator::LocalMaximum { threshold: density(threshold) },
        composite @ (Composite::Maximum
        | Composite::DepthShadedMaximum { .. }
        | Composite::Minimum
        | Composite::Mean
        | Composite::Sum
        | Composite::XRay { .. }) => Operator::Project { composite, level: Project::level(composite, density) },
    }
}

impl FieldPlan {
    /// Ambient occlusion and the shadow of the first light, where they are wanted, and labels.
    fn new(
        layer: &Layer,
        camera: &Camera,
        options: &RenderOptions,
        tables: &Visibility,
        opacity_unit: f64,
    ) -> Result<Self> {
        let mut plan = Self::default();
        let shading = options.shading.as_ref().filter(|s| s.ambient_occlusion > 0.0 || s.shadow > 0.0);
        if let Some(shading) = shading {
            let grid = layer.slices.grid();
            let extinction = || ExtinctionGrid::new(layer.slices, tables, opacity_unit, layer.labels);
            let mut terms = LightTerms::default();
            if shading.ambient_occlusion > 0.0 {
                let sides = grid.spacing() * DVec3::from_array(grid.size().map(|n| n as f64));
                let radius = shading.occlusion_radius.unwrap_or(0.1 * sides.max_element());
                terms.openness = Some((plan.fields.len(), shading.ambient_occlusion));
                let openness = || extinction().and_then(|grid| grid.field(grid.openness(radius)));
                // Labels are not among what the tables are kept by.
                let kept = layer.labels.is_none();
                plan.fields.push(if kept { tables.openness(radius, openness)? } else { openness()? });
            }
            if let Some(light) = shading.lights.first().filter(|_| shading.shadow > 0.0) {
                terms.shadow = Some((plan.fields.len(), shading.shadow));
                let extinction = extinction()?;
                plan.fields.push(extinction.field(extinction.shadow(light_direction(camera, light)))?);
            }
            plan.light = Some(terms);
        }
        if let Some(labels) = layer.labels {
            plan.labels = Some(labels.terms().after(plan.fields.len()));
            plan.fields.extend(labels.fields());
        }
        Ok(plan)
    }
}

/// Largest colour that shading makes of white.
pub(crate) fn brightest(shading: &Shading) -> f32 {
    let channel = |c: usize| shading.lights.iter().map(|l| l.rgb[c]).sum::<f32>();
    let light = (0..3).map(channel).fold(0.0, f32::max);
    (shading.ambient + (shading.diffuse + shading.specular) * light).max(1.0)
}
