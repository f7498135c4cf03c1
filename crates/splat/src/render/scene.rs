//! What a picture shows and how, apart from the base planes that it is drawn on.

use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_compute::simd::{LANES, Level};
use wavesplat_core::{Camera, Composite, Error, Grid, RenderOptions, Result, Shading, TransferFunction};

use crate::kernel::noise::keeps_bounds;
use crate::optics::classify::Classifier;
use crate::optics::gradient_opacity::GradientOpacity;
use crate::optics::labels::Labels;
use crate::optics::modifiers::Modifiers;
use crate::optics::occlusion::{ExtinctionGrid, LightTerms};
use crate::optics::shade::Shader;
use crate::optics::visibility_cache::{Visibility, VisibilityCache};
use crate::picture::base_picture::BasePicture;
use crate::ray::compositor::Compositor;
use crate::ray::first_hit::FirstHit;
use crate::ray::local_maximum::LocalMaximum;
use crate::ray::over::Over;
use crate::ray::project::Project;
use crate::render::layer::Layer;
use crate::render::progress::Progress;
use crate::render::tile::{Piece, TileJob, Work};
use crate::sheet::spacing::SheetSpacing;
use crate::sheet::tile_layout::{Chunk, N_STRIPS, TILE_U, TILE_V};
use crate::sheet::tile_rays::RayGeometry;
use crate::source::field::Field;
use crate::source::geometry::SheetGeometry;
use crate::source::occupancy::OccupancyGrid;
use crate::source::slices::Slices;
use crate::view::base_plane::BasePlane;
use crate::view::depth_cue::DepthCue;
use crate::view::family::{Family, IndexRays};
use crate::view::index_frame::light_direction;
use crate::view::region::Region;

/// Has everything ready that does not depend on the base plane.
pub(crate) fn with_scene<T>(
    level: Level,
    layer: &Layer,
    camera: &Camera,
    options: &RenderOptions,
    draw: impl FnOnce(&Scene) -> Result<T>,
) -> Result<T> {
    options.validate()?;
    let region = Region::new(layer.slices.grid(), options)?;
    let mut scene = Scene::new(level, layer, camera, options, region);
    let light = scene.light(layer.labels)?;
    scene.set_fields(layer.labels, light.as_ref())?;
    draw(&scene)
}

/// Change of a slab's opacity or colour, over all densities, from which slabs are pre-integrated.
const STEEP: f32 = 0.35;

/// A ray stops when less than this share of light comes through: a tenth of a grey level of 1024.
const OPAQUE_ENOUGH: f32 = 1.0 - 1e-4;

/// The same where the picture is to be that of the method's plain sheets: an eighth of a 16-bit grey level.
const OPAQUE: f32 = 1.0 - 2e-6;

/// Whether a transfer function can change opacity or colour by a visible amount within a voxel; of a coarser level,
/// within one of the finest: its pictures are smaller, and a smooth function is as smooth on it.
pub fn is_steep(grid: &Grid, tf: &TransferFunction) -> bool {
    let thickness = slab_of_the_finest(grid, tf);
    let classifier = Classifier::new(tf, grid.density_from_sample(), grid.density_range(), thickness);
    classifier.variation(thickness) >= STEEP
}

/// Thickness of a slab of two sheets a slice, of a coarser level one of the finest, in `opacity_unit`s.
fn slab_of_the_finest(grid: &Grid, tf: &TransferFunction) -> f64 {
    0.5 * grid.default_opacity_unit() / tf.opacity_unit().unwrap_or(grid.default_opacity_unit())
}

/// How a picture frames a volume: its rays beside the samples, in the middle of the volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing {
    /// How far apart rays of neighbouring pixels are, in samples: 0.01 to 100.
    pub pixel_in_samples: f64,
    /// How many samples a ray runs from slice to slice: 1 to 1.9.
    pub slice_in_samples: f64,
    /// The share of the pixels that a ball as long as the volume would cover, `0..=1`: how much is seen, from any side.
    pub covered: f64,
}

impl Framing {
    pub(crate) fn new(grid: &Grid, camera: &Camera, options: &RenderOptions) -> Self {
        let size_px = [options.width_px, options.height_px];
        let [first, last] = grid.bounds();
        let rays = IndexRays::new(camera, grid.index_from_world(), size_px[0], size_px[1]);
        let middle = size_px.map(|n| 0.5 * n as f64);
        let pixel_in_samples = rays.distance_at(0.5 * (first + last), middle).clamp(0.01, 100.0);
        let direction = rays.direction(middle[0], middle[1]);
        let [_, _, across] = Family::of(direction).uvw(direction);
        let n_covered = ((last - first).length() / pixel_in_samples).powi(2);
        let covered = (n_covered / (size_px[0] * size_px[1]) as f64).min(1.0);
        Self { pixel_in_samples, slice_in_samples: direction.length() / across.abs(), covered }
    }
}

/// Everything that does not depend on the base plane.
pub(crate) struct Scene<'a> {
    pub level: Level,
    pub grid: &'a Grid,
    slices: &'a Slices<'a>,
    cache: &'a VisibilityCache,
    pub camera: &'a Camera,
    pub options: &'a RenderOptions,
    pub tf: &'a TransferFunction,
    /// What is drawn of the volume.
    pub region: Region,
    classifier: Arc<Visibility>,
    opacity_unit: f64,
    /// Of a typical slab, in `opacity_unit`s.
    slab_thickness: f64,
    labels: Option<&'a Labels>,
    fields: Arc<Vec<Field<'a>>>,
    light: Option<LightTerms>,
}

/// Shares of light that get to the cells of a coarse volume.
struct Light {
    dimness: ExtinctionGrid,
    openness: Option<Vec<f32>>,
    shadow: Option<Vec<f32>>,
}

impl<'a> Scene<'a> {
    fn new(level: Level, layer: &Layer<'a>, camera: &'a Camera, options: &'a RenderOptions, region: Region) -> Self {
        let Layer { slices, transfer_function: tf, cache, .. } = *layer;
        let grid = slices.grid();
        let opacity_unit = tf.opacity_unit().unwrap_or(grid.default_opacity_unit());
        let slab_thickness = grid.mean_spacing() / options.sheets_per_slice / opacity_unit;
        let classifier = cache.get(slices, tf, slab_thickness);
        let (labels, fields, light) = (None, Arc::default(), None);
        Self {
            level,
            grid,
            slices,
            cache,
            camera,
            options,
            tf,
            region,
            classifier,
            opacity_unit,
            slab_thickness,
            labels,
            fields,
            light,
        }
    }

    /// The same with other options, be they of sheets, texels or the size of the picture; in the same light.
    pub fn with_options<'b>(&'b self, options: &'b RenderOptions) -> Scene<'b>
    where
        'a: 'b,
    {
        let slab_thickness = self.grid.mean_spacing() / options.sheets_per_slice / self.opacity_unit;
        Scene {
            options,
            classifier: self.cache.get(self.slices, self.tf, slab_thickness),
            slab_thickness,
            region: self.region.clone(),
            fields: self.fields.clone(),
            ..*self
        }
    }

    /// What is held off of the light, where that is wanted.
    fn light(&self, labels: Option<&Labels>) -> Result<Option<Light>> {
        let shading = self.options.shading.as_ref().filter(|_| self.options.composite == Composite::Over);
        let Some(shading) = shading.filter(|s| s.ambient_occlusion > 0.0 || s.shadow > 0.0) else { return Ok(None) };
        let dimness = ExtinctionGrid::new(self.slices, &self.classifier, self.opacity_unit, labels)?;
        let size = self.grid.size();
        let sides = self.grid.spacing() * DVec3::from_array(size.map(|n| n as f64));
        let radius = shading.occlusion_radius.unwrap_or(0.1 * sides.max_element());
        let openness = (shading.ambient_occlusion > 0.0).then(|| dimness.openness(radius));
        let first = shading.lights.first().filter(|_| shading.shadow > 0.0);
        let shadow = first.map(|light| dimness.shadow(light_direction(self.camera, light)));
        Ok(Some(Light { dimness, openness, shadow }))
    }

    /// Lists the fields of light and labels.
    fn set_fields(&mut self, labels: Option<&'a Labels>, light: Option<&'a Light>) -> Result<()> {
        self.labels = labels.filter(|_| self.options.composite == Composite::Over);
        if let (Some(light), Some(shading)) = (light, &self.options.shading) {
            let mut terms = LightTerms::default();
            let mut fields = Vec::new();
            if let Some(openness) = &light.openness {
                terms.openness = Some((fields.len(), shading.ambient_occlusion));
                fields.push(light.dimness.field(openness)?);
            }
            if let Some(shadow) = &light.shadow {
                terms.shadow = Some((fields.len(), shading.shadow));
                fields.push(light.dimness.field(shadow)?);
            }
            self.fields = Arc::new(fields);
            self.light = Some(terms);
        }
        Ok(())
    }

    /// Whether opacity or colour can change by a visible amount from sheet to sheet.
    pub fn is_steep(&self) -> bool {
        let varies = |thickness| self.classifier.variation(thickness) >= STEEP;
        varies(self.slab_thickness) && (self.grid.coarseness() <= 1.0 || varies(slab_of_the_finest(self.grid, self.tf)))
    }

    /// Where the sheets of a base plane lie.
    pub fn spacing(&self, plane: &BasePlane, sheets_per_slice: f64) -> SheetSpacing {
        SheetSpacing::new(self.grid.size()[plane.family.axes[2]], sheets_per_slice)
    }

    /// Draws pieces of a base plane, with so many sheets per slice: what it shows, the work, and the number of sheets.
    pub fn draw_plane(
        &self,
        plane: &BasePlane,
        sheets_per_slice: f64,
        pieces: &[Piece],
        progress: &Progress,
    ) -> Result<(BasePicture, Work, usize)> {
        let world_from_index = self.grid.world_from_index();
        let shaded = !self.options.composite.is_projection();
        let shading = self.options.shading.as_ref().filter(|_| shaded);
        let shader_for =
            |range| shading.map(|s| Shader::new(s, self.camera, world_from_index.matrix3, &plane.family, range));
        let shader = shader_for(self.slices.range());
        let mut extras = Modifiers::default();
        let mut label_fields = Vec::new();
        if self.options.composite == Composite::Over {
            let map = self.grid.density_from_sample();
            extras.by_gradient = GradientOpacity::new(self.tf, world_from_index.matrix3, &plane.family, map);
            extras.light = self.light;
            if let Some(labels) = self.labels {
                extras.labels = Some(labels.terms().after(self.fields.len()));
                extras.label_shader = shader_for([0.0, 1.0]);
                label_fields = labels.fields();
            }
        }
        let gradient_offset = shading.map(|s| s.gradient_offset);
        let gradient_offset =
            gradient_offset.or(extras.by_gradient.as_ref().map(|_| Shading::default().gradient_offset));
        let size = self.grid.size();
        let spacing = self.spacing(plane, sheets_per_slice);
        let axes = plane.family.axes;
        let bricks = self.slices.bricks();
        let variant = &self.options.variant;
        let fade = match self.options.composite {
            Composite::DepthShadedMaximum { strength, .. } => {
                Some(DepthCue::new(strength, self.camera, self.grid, self.region.bounds))
            }
            _ => None,
        };
        let density = |value: f64| {
            let (offset, scale) = self.grid.density_from_sample();
            ((value - offset) * scale) as f32
        };
        let job = |opacity_unit: f64, occupied: Option<Arc<OccupancyGrid>>| TileJob {
            geometry: SheetGeometry::new(self.level, plane, self.slices, size, gradient_offset, variant, spacing.step),
            rays: RayGeometry {
                plane,
                region: &self.region,
                world_from_index,
                opacity_unit,
                view_angle_correction: variant.view_angle_correction,
                fade,
            },
            spacing,
            occupied: occupied.filter(|_| keeps_bounds(variant, self.slices.kernel())),
            fields: self
                .fields
                .iter()
                .chain(&label_fields)
                .map(|f| SheetGeometry::of_field(self.level, plane, f))
                .collect(),
        };
        let with_depth = self.options.with_depth;
        let (picture, work) = match self.options.composite {
            Composite::Over => {
                let plain = !(self.options.refined && variant.may_pre_integrate());
                // A function of two dimensions has no integral along a slab.
                let has_integral = !extras.by_gradient.as_ref().is_some_and(GradientOpacity::decides_color);
                let is_steep = !plain && has_integral && self.is_steep();
                let opaque = if plain { OPAQUE } else { OPAQUE_ENOUGH };
                let mut occupied = Some(bricks.occupied(axes, self.classifier.visible_ranges(bricks)));
                if let Some(field) = extras.matter_field() {
                    let matter = label_fields[field - self.fields.len()].slices.bricks();
                    let covered = matter.occupied(axes, &matter.visible_ranges(|[_, hi]| hi > 0.0));
                    occupied = occupied.and_then(|occupied| occupied.or(&covered)).map(Arc::new);
                }
                let (classifier, shader): (&Classifier, _) = (&self.classifier, shader.as_ref());
                let job = job(self.opacity_unit, occupied);
                if extras.any() {
                    let over = || Over::<true>::new(classifier, shader, &extras, is_steep, opaque, with_depth);
                    draw_tiles(&job, pieces, progress, with_depth, over)
                } else {
                    let over = || Over::<false>::new(classifier, shader, &extras, is_steep, opaque, with_depth);
                    draw_tiles(&job, pieces, progress, with_depth, over)
                }
            }
            Composite::FirstHit { iso_value } => {
                let iso = density(iso_value);
                // A surface needs densities on both sides.
                let occupied = bricks.occupied(axes, &bricks.visible_ranges(|[lo, hi]| lo < iso && hi >= iso));
                let first_hit = || FirstHit::new(iso, &self.classifier, shader.as_ref());
                draw_tiles(&job(self.opacity_unit, Some(occupied)), pieces, progress, with_depth, first_hit)
            }
            Composite::LocalMaximum { threshold } => {
                draw_tiles(&job(1.0, None), pieces, progress, with_depth, || LocalMaximum::new(density(threshold)))
            }
            projection @ (Composite::Maximum
            | Composite::DepthShadedMaximum { .. }
            | Composite::Minimum
            | Composite::Mean
            | Composite::Sum
            | Composite::XRay { .. }) => {
                // Lengths of projections are world lengths.
                draw_tiles(&job(1.0, None), pieces, progress, with_depth, || Project::new(projection, density))
            }
        }?;
        Ok((picture, work, spacing.n_slabs + 1))
    }
}

/// Runs pieces of a base plane, each on its own, and puts them together.
fn draw_tiles<C: Compositor>(
    job: &TileJob,
    pieces: &[Piece],
    progress: &Progress,
    with_depth: bool,
    compositor: impl Fn() -> C + Sync + Send,
) -> Result<(BasePicture, Work)> {
    let plane = job.geometry.plane;
    // Positions along rays and along w differ by this sign.
    let sign = if plane.family.ascending { 1.0 } else { -1.0 };
    let all = Mutex::new((BasePicture::new(plane.clone(), with_depth), Work::default()));
    parallel::for_each(pieces.len(), |k| {
        if progress.is_stopped() {
            return;
        }
        let mut tile_work = Work::default();
        let [tile_u, tile_v] = pieces[k].tile;
        let drawn = job.run(&pieces[k], &compositor, &mut tile_work);
        let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
        let (picture, work) = &mut *all;
        work.n_texels += tile_work.n_texels;
        work.n_skipped += tile_work.n_skipped;
        if let Some(compositor) = drawn {
            for strip in 0..N_STRIPS {
                for row in 0..TILE_V {
                    let (i, j) = (tile_u * TILE_U + strip * LANES, tile_v * TILE_V + row);
                    if i < plane.size[0] && j < plane.size[1] {
                        let texels = compositor.finish(Chunk { strip, row });
                        let w_half = texels.s_half.map(|s| s.map(|s| s * sign));
                        picture.put(i, j, &texels.rgba, w_half.as_ref());
                    }
                }
            }
        }
        drop(all);
        progress.tile_done();
    });
    if progress.is_stopped() {
        return Err(Error::Cancelled);
    }
    Ok(all.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Largest colour that shading makes of white.
pub(crate) fn brightest(shading: &Shading) -> f32 {
    let channel = |c: usize| shading.lights.iter().map(|l| l.rgb[c]).sum::<f32>();
    let light = (0..3).map(channel).fold(0.0, f32::max);
    (shading.ambient + (shading.diffuse + shading.specular) * light).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;
    use wavesplat_core::{ColorNode, OpacityNode, Statistics};

    #[test]
    fn a_smooth_function_is_smooth_on_every_level() {
        let statistics = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        let grid = |spacing: f64| {
            Grid::new("", [9; 3], DAffine3::from_scale(DVec3::splat(spacing)), statistics, false).unwrap()
        };
        let finest = grid(1.0);
        let level = grid(4.0).as_level_of(finest.default_opacity_unit(), finest.bounds());
        let curve = |nodes: [(f64, f64); 2], unit: Option<f64>| {
            let opacity = nodes.map(|(value, opacity)| OpacityNode { value, opacity }).to_vec();
            TransferFunction::new(opacity, vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], unit).unwrap()
        };
        let (soft, hard) = (curve([(0.0, 0.0), (1.0, 0.3)], None), curve([(0.5, 0.0), (0.51, 1.0)], None));
        for grid in [&finest, &level] {
            assert!(!is_steep(grid, &soft) && is_steep(grid, &hard));
        }
        // The same samples as a volume of their own have voxels four times as thick.
        assert!(is_steep(&grid(4.0), &curve([(0.0, 0.0), (1.0, 0.3)], Some(1.0))));
    }
}
