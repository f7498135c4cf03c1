//! A volume whose samples are not in memory: the caller reads boxes of them while it is drawn ([`crate::Stream`]).

use glam::{DAffine3, DVec3};
use wavesplat_core::{Error, Grid, Kernel, LevelGrid, Result, Shading, Statistics, TransferFunction};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::render::stream::Storage;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::source::survey::Survey;

use crate::level_look::LevelBrightness;
use crate::volume_cache::VolumeCache;

/// A lazy volume for one kernel: grid, survey of its samples, and layout of their storage.
pub struct LazyVolume {
    grid: Grid,
    storage: Storage,
    slices: Slices<'static>,
    cache: VolumeCache,
    /// Looks and grid within the finest level; `None` where the volume is no coarser level.
    level: Option<LevelBrightness>,
}

impl LazyVolume {
    /// A volume from a survey of all samples, which lie on `grid`. `prepared`: survey of the coefficients, or of the
    /// samples with filled holes; needed where [`LazyVolume::needs_prepared`] says so.
    ///
    /// # Errors
    ///
    /// Where `prepared` is needed and not given.
    pub fn new(
        grid: Grid,
        storage: Storage,
        kernel: Kernel,
        survey: &Survey,
        prepared: Option<&Survey>,
        light: usize,
        level: Option<LevelBrightness>,
    ) -> Result<Self> {
        if prepared.is_none() && Self::needs_prepared(&grid, kernel) {
            let mend = "look through the coefficients first";
            return Err(Error::out_of_range("survey of a volume", "of its samples alone", "complete", mend));
        }
        let slices = survey.slices(&grid, prepared.filter(|_| Self::needs_prepared(&grid, kernel)), light);
        Ok(Self { grid, storage, slices, cache: VolumeCache::default(), level })
    }

    /// Grid of a level of a pyramid, from its own grid and the size and affine of the finest level: it keeps the units
    /// of the finest level and is drawn within its bounds.
    ///
    /// # Errors
    ///
    /// The errors of [`Grid::new`].
    pub fn level_grid(own: Grid, finest_size: [usize; 3], finest: DAffine3) -> Result<(Grid, LevelGrid)> {
        let narrow = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        let finest = Grid::new("finest level", finest_size, finest, narrow, true)?;
        let level = Self::level_in(&own, finest.world_from_index());
        let bounds = [DVec3::ZERO, finest.last_index()]
            .map(|corner| DVec3::from_array(level.level_from_finest(corner.to_array())));
        Ok((own.as_level_of(finest.default_opacity_unit(), bounds), level))
    }

    /// Position of a grid in a finer one with the same axes.
    pub fn level_in(own: &Grid, finer: DAffine3) -> LevelGrid {
        let from_level = finer.inverse() * own.world_from_index();
        let spacing = [0, 1, 2].map(|a| from_level.matrix3.col(a)[a]);
        LevelGrid { origin: from_level.translation.to_array(), spacing, size: own.size() }
    }

    /// Whether the renderer works on other numbers than the samples: coefficients, or samples with filled holes.
    pub fn needs_prepared(grid: &Grid, kernel: Kernel) -> bool {
        matches!(kernel, Kernel::Bspline2 | Kernel::Bspline3) || grid.statistics().n_nonfinite > 0
    }

    /// Grid and range of the samples.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Layout of the stored samples.
    pub fn storage(&self) -> Storage {
        self.storage
    }

    /// Index position of this level at an index position of the finest level.
    pub fn level_from_finest(&self, index: DVec3) -> DVec3 {
        self.level.as_ref().map_or(index, |level| level.level_from_finest(index))
    }

    pub(crate) fn slices(&self) -> Slices<'static> {
        self.slices.clone()
    }

    pub(crate) fn visibility(&self) -> &VisibilityCache {
        &self.cache.visibility
    }

    /// Transfer function of this level, as in [`LevelBrightness::look`]; at the finest level the function itself.
    pub(crate) fn look(&self, tf: &TransferFunction, shading: Option<&Shading>) -> Result<(TransferFunction, bool)> {
        match &self.level {
            Some(level) => level.look(&self.grid, tf, shading),
            None => Ok((tf.clone(), self.cache.needs_preintegration(&self.grid, tf))),
        }
    }
}
