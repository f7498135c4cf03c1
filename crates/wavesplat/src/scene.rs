//! A scene: volumes, or levels of them, and their looks. It owns the caches between frames.

use std::sync::Arc;

use wavesplat_core::{ClipPlane, Composite, Crop, Grid, Kernel, Result, Shading, Shapes, TransferFunction, Volume};
use wavesplat_look::Look;
use wavesplat_splat::optics::labels::Labels;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::source::slices::Slices;

use crate::lazy_volume::LazyVolume;
use crate::level_volume::LevelVolume;
use crate::volume_cache::VolumeCache;

/// Volumes and their looks, in one picture.
///
/// Draw with [`Scene::render`]. Data prepared for the first frame is kept for the next ones.
#[derive(Clone)]
pub struct Scene<'a> {
    /// One to eight layers; several only with [`Composite::Over`]. At a point of space their extinctions add and their
    /// colours mix by extinction, so their order matters little: sheets lie along the axes of the first one, and labels
    /// lie on its samples.
    pub layers: Vec<SceneLayer<'a>>,
    /// A segmentation beside the first volume; for [`Composite::Over`].
    pub labels: Option<Arc<Labels>>,
    /// Box that is drawn, in the world or in index positions of the first volume's finest level.
    pub crop: Option<Crop>,
    /// Clip planes; all of them apply.
    pub clip_planes: Vec<ClipPlane>,
    /// Straight colour and opacity behind the volumes; `None` is transparent.
    pub background: Option<[f32; 4]>,
    /// Surfaces, lines and points among the volumes, at their depth.
    pub shapes: Arc<Shapes>,
}

/// A volume and its look.
#[derive(Clone)]
pub struct SceneLayer<'a> {
    /// Volume to draw. Its axes are parallel to the axes of the scene's first volume.
    pub volume: SceneVolume<'a>,
    /// Colour and opacity by sample value.
    pub transfer_function: TransferFunction,
    /// Lights and Phong coefficients; `None` draws the colours as given.
    pub shading: Option<Shading>,
    /// A field that gives the layer its colours, with [`Composite::Over`] and [`Composite::FirstHit`]; `None` for its own.
    pub color: Option<SceneColor<'a>>,
}

/// A field whose values are coloured, where a layer's own samples say how opaque it is.
#[derive(Clone)]
pub struct SceneColor<'a> {
    /// Samples that cover the layer, lazy or in memory as the layer's are. Their axes are parallel to the axes of the
    /// scene's first volume.
    pub volume: SceneVolume<'a>,
    /// Transfer function of the field's values; its colours count.
    pub transfer_function: TransferFunction,
}

/// Volume of a layer.
#[derive(Clone)]
#[expect(clippy::large_enum_variant, reason = "there are few of them in a scene")]
pub enum SceneVolume<'a> {
    /// Samples in memory, and their cache.
    Samples(Volume<'a>, Arc<VolumeCache>),
    /// A level of wavelet coefficients.
    Level(Arc<LevelVolume>),
    /// Samples that are read while they are drawn, only by [`Scene::stream`].
    Lazy(Arc<LazyVolume>),
}

impl<'a> Scene<'a> {
    /// Scene of samples with the default shading.
    pub fn new(volume: Volume<'a>, transfer_function: TransferFunction) -> Self {
        Self::of(vec![SceneLayer::new(SceneVolume::Samples(volume, Arc::default()), transfer_function)])
    }

    /// Scene of samples with a look: its transfer function, light and background. Its operator is for
    /// [`FrameOptions::composite`](crate::FrameOptions).
    pub fn with_look(volume: Volume<'a>, look: &Look) -> Self {
        let mut scene = Self::new(volume, look.transfer_function.clone());
        scene.layers[0].shading.clone_from(&look.shading);
        Self { background: look.background, ..scene }
    }

    /// Sources of samples: the layers' volumes, and after them the fields that colour layers, in the order of these.
    pub(crate) fn sources(&self) -> impl Iterator<Item = &SceneVolume<'a>> {
        let colors = self.layers.iter().filter_map(|layer| layer.color.as_ref());
        self.layers.iter().map(|layer| &layer.volume).chain(colors.map(|color| &color.volume))
    }

    /// Scene of layers, without labels, cuts and background.
    pub fn of(layers: Vec<SceneLayer<'a>>) -> Self {
        Self { layers, labels: None, crop: None, clip_planes: Vec::new(), background: None, shapes: Arc::default() }
    }
}

impl<'a> SceneLayer<'a> {
    /// Layer of a volume with the default shading.
    pub fn new(volume: SceneVolume<'a>, transfer_function: TransferFunction) -> Self {
        Self { volume, transfer_function, shading: Some(Shading::default()), color: None }
    }
}

impl<'a> SceneVolume<'a> {
    /// Grid and range of the samples.
    pub fn grid(&self) -> &Grid {
        match self {
            Self::Samples(volume, _) => volume.grid(),
            Self::Level(level) => level.grid(),
            Self::Lazy(volume) => volume.grid(),
        }
    }

    /// Transfer function to draw with: for a coarser level and [`Composite::Over`], one that keeps the brightness.
    pub fn look(
        &self,
        tf: &TransferFunction,
        composite: Composite,
        shading: Option<&Shading>,
    ) -> Result<TransferFunction> {
        match self {
            Self::Level(level) if composite == Composite::Over => Ok(level.look(tf, shading)?.0),
            Self::Lazy(volume) if composite == Composite::Over => Ok(volume.look(tf, shading)?.0),
            _ => Ok(tf.clone()),
        }
    }

    /// Whether a transfer function needs pre-integration, and so the sampling of a steep one.
    pub(crate) fn needs_preintegration(&self, tf: &TransferFunction, shading: Option<&Shading>) -> Result<bool> {
        match self {
            Self::Samples(volume, cache) => Ok(cache.needs_preintegration(volume.grid(), tf)),
            Self::Level(level) => Ok(level.look(tf, shading)?.1),
            Self::Lazy(volume) => Ok(volume.look(tf, shading)?.1),
        }
    }

    /// Crop box in index positions of this volume, from index positions of the finest level.
    pub fn crop_on_level(&self, crop: Crop) -> Crop {
        match (self, crop) {
            (Self::Level(level), Crop::Index { lo, hi }) => {
                Crop::Index { lo: level.level_from_finest(lo), hi: level.level_from_finest(hi) }
            }
            (Self::Lazy(volume), Crop::Index { lo, hi }) => {
                Crop::Index { lo: volume.level_from_finest(lo), hi: volume.level_from_finest(hi) }
            }
            _ => crop,
        }
    }

    /// Slices for a kernel.
    pub fn slices(&self, kernel: Kernel) -> Slices<'a> {
        match self {
            Self::Samples(volume, cache) => cache.slices(volume, kernel),
            Self::Level(level) => level.slices(kernel),
            Self::Lazy(volume) => volume.slices(),
        }
    }

    pub(crate) fn visibility(&self) -> &VisibilityCache {
        match self {
            Self::Samples(_, cache) => &cache.visibility,
            Self::Level(level) => &level.visibility,
            Self::Lazy(volume) => volume.visibility(),
        }
    }
}
