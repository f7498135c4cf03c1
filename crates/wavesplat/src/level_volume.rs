//! A level of detail, or a band, of a volume of wavelet coefficients, decoded while it is drawn.

use std::sync::{Arc, Mutex};

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_core::{Decoder, Grid, Kernel, LevelGrid, Result, Shading, Statistics, TransferFunction};
use wavesplat_lod::LevelHistogram;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::source::block_cache::{bytes_of_all, samples_every};
use wavesplat_splat::source::slices::Slices;
use wavesplat_wavelet::{CoarseLevel, CoefficientDecoder, WaveletError, WaveletVolume};

use crate::error::LevelError;
use crate::level_look::LevelBrightness;
use wavesplat_compute::locks::lock;

/// A level of a volume, with its caches between frames.
pub struct LevelVolume {
    grid: Grid,
    /// Transfer functions of the level.
    looks: LevelBrightness,
    decoder: Arc<dyn Decoder>,
    cache_bytes: usize,
    /// Slices for the latest kernel.
    slices: Mutex<Option<Slices<'static>>>,
    pub(crate) visibility: VisibilityCache,
}

impl LevelVolume {
    /// Opens a level: 0 is the finest. `weights`: a factor for each level's details, the finest first, and for the
    /// coarsest low-pass box. `world_from_index`: affine of the finest grid. About `cache_bytes` of decoded samples are
    /// kept at most.
    ///
    /// The level has its own resolution where its samples are evenly spaced; else it has the finest grid, without the
    /// details of the finer levels.
    pub fn open(
        coefficients: &Arc<WaveletVolume>,
        level: usize,
        weights: &[f32],
        world_from_index: DAffine3,
        name: &str,
        cache_bytes: usize,
    ) -> std::result::Result<Self, LevelError> {
        let plan = coefficients.plan();
        let coarsest = plan.n_levels();
        if level > coarsest {
            return Err(WaveletError::NoSuchLevel { level, coarsest }.into());
        }
        let mut level_weights = weights.to_vec();
        let own_level = if plan.level_grid(level).is_some() {
            level
        } else {
            level_weights.iter_mut().take(level).for_each(|weight| *weight = 0.0);
            0
        };
        let decoder = CoefficientDecoder::new(coefficients.clone(), own_level, &level_weights)?;
        let [min, max] = decoder.range().map(f64::from);
        let decoder = CoarseLevel::new(decoder)?;
        let level_grid = decoder.grid();
        let histogram = if level > 0 {
            let finest = CoefficientDecoder::new(coefficients.clone(), 0, weights)?;
            let range = finest.range().map(f64::from);
            let spacing = [0, 1, 2].map(|a| world_from_index.matrix3.col(a).length());
            Some(LevelHistogram::new(&finest, &decoder, &level_grid, spacing, range, cache_bytes))
        } else {
            None
        };
        let statistics = Statistics { min, max, n_nonfinite: 0 };
        let finest = Grid::new(name, plan.size(), world_from_index, statistics, false)?;
        let LevelGrid { origin, spacing, .. } = level_grid;
        let matrix3 = DMat3::from_diagonal(DVec3::from_array(spacing));
        let finest_from_level = DAffine3 { matrix3, translation: DVec3::from_array(origin) };
        let bounds = [DVec3::ZERO, finest.last_index()]
            .map(|corner| DVec3::from_array(level_grid.level_from_finest(corner.to_array())));
        let grid = Grid::new(name, decoder.size(), world_from_index * finest_from_level, statistics, false)?;
        let grid = grid.as_level_of(finest.default_opacity_unit(), bounds);
        let brightness = histogram.map(|histogram| (histogram, grid.spacing() / DVec3::from_array(spacing)));
        let cache_bytes = cache_bytes.min(bytes_of_all(grid.size()));
        Ok(Self {
            grid,
            looks: LevelBrightness::new(level_grid, brightness),
            decoder: Arc::new(decoder),
            cache_bytes,
            slices: Mutex::default(),
            visibility: VisibilityCache::default(),
        })
    }

    /// Grid and range of the level's samples.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Most bytes of decoded samples that are kept.
    pub fn cache_bytes(&self) -> usize {
        self.cache_bytes
    }

    /// Every `step`-th sample along each axis: their number along x, y, z, and the samples, `[z][y][x]`.
    pub fn samples_every(&self, step: usize) -> ([usize; 3], Vec<f32>) {
        samples_every(&*self.decoder, step.max(1))
    }

    /// Index position of the level at an index position of the finest grid.
    pub fn level_from_finest(&self, index: DVec3) -> DVec3 {
        self.looks.level_from_finest(index)
    }

    /// Transfer function of the level, see [`LevelBrightness::look`].
    pub(crate) fn look(&self, tf: &TransferFunction, shading: Option<&Shading>) -> Result<(TransferFunction, bool)> {
        self.looks.look(&self.grid, tf, shading)
    }

    /// Slices for a kernel, kept until another kernel is asked for.
    pub fn slices(&self, kernel: Kernel) -> Slices<'static> {
        let mut kept = lock(&self.slices);
        if let Some(slices) = kept.as_ref().filter(|slices| slices.kernel() == kernel) {
            return slices.clone();
        }
        // Freed first, so that there are never two.
        *kept = None;
        let slices = Slices::of_decoder(self.decoder.clone(), &self.grid, kernel, self.cache_bytes);
        *kept = Some(slices.clone());
        slices
    }
}
