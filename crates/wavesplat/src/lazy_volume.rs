//! A volume whose samples are not in memory: boxes of them are read elsewhere while it is drawn ([`crate::Stream`]).

use glam::{DAffine3, DVec3};
use wavesplat_core::{Error, Grid, Kernel, LevelGrid, Result, Shading, Statistics, TransferFunction};
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::render::stream::Storage;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::source::survey::Survey;

use crate::level_look::LevelLooks;
use crate::volume_cache::VolumeCache;

/// What is known of such a volume, for one kernel, and how its samples are stored.
pub struct LazyVolume {
    grid: Grid,
    storage: Storage,
    slices: Slices<'static>,
    cache: VolumeCache,
    /// Of a coarser level of another volume: how it keeps the brightness of that, and where it lies in it.
    level: Option<LevelLooks>,
}

impl LazyVolume {
    /// From a survey of all samples, which lie on `grid`. `prepared`: the survey of coefficients, or of samples whose holes were
    /// filled; needed where `kernel` has coefficients or there are samples that are not finite.
    ///
    /// # Errors
    ///
    /// Where that is needed and not given.
    pub fn new(
        grid: Grid,
        storage: Storage,
        kernel: Kernel,
        survey: &Survey,
        prepared: Option<&Survey>,
        light: usize,
        level: Option<LevelLooks>,
    ) -> Result<Self> {
        if prepared.is_none() && Self::needs_prepared(&grid, kernel) {
            let mend = "look through the coefficients first";
            return Err(Error::out_of_range("survey of a volume", "of its samples alone", "complete", mend));
        }
        let slices = survey.slices(&grid, prepared.filter(|_| Self::needs_prepared(&grid, kernel)), light);
        Ok(Self { grid, storage, slices, cache: VolumeCache::default(), level })
    }

    /// The grid of a level of a pyramid, from the place of its samples and that of the finest level's: it keeps the units of
    /// the finest and is drawn within its bounds.
    ///
    /// # Errors
    ///
    /// As of [`Grid::new`].
    pub fn level_grid(own: Grid, finest_size: [usize; 3], finest: DAffine3) -> Result<(Grid, LevelGrid)> {
        let narrow = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        let finest = Grid::new("finest level", finest_size, finest, narrow, true)?;
        let level = Self::level_in(&own, finest.world_from_index());
        let bounds = [DVec3::ZERO, finest.last_index()]
            .map(|corner| DVec3::from_array(level.level_from_finest(corner.to_array())));
        Ok((own.as_level_of(finest.default_opacity_unit(), bounds), level))
    }

    /// Where a grid lies in a finer one with the same axes.
    pub fn level_in(own: &Grid, finer: DAffine3) -> LevelGrid {
        let from_level = finer.inverse() * own.world_from_index();
        let spacing = [0, 1, 2].map(|a| from_level.matrix3.col(a)[a]);
        LevelGrid { origin: from_level.translation.to_array(), spacing, size: own.size() }
    }

    /// Whether the renderer works on other numbers than the samples: coefficients, or samples with filled holes.
    pub fn needs_prepared(grid: &Grid, kernel: Kernel) -> bool {
        matches!(kernel, Kernel::Bspline2 | Kernel::Bspline3) || grid.statistics().n_nonfinite > 0
    }

    /// Where the samples lie, and their range.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// How they are stored.
    pub fn storage(&self) -> Storage {
        self.storage
    }

    /// An index position of the finest level as one of this one.
    pub fn level_from_finest(&self, index: DVec3) -> DVec3 {
        self.level.as_ref().map_or(index, |level| level.level_from_finest(index))
    }

    pub(crate) fn slices(&self) -> Slices<'static> {
        self.slices.clone()
    }

    pub(crate) fn visibility(&self) -> &VisibilityCache {
        &self.cache.visibility
    }

    /// As of a level of detail ([`crate::LevelVolume`]); of the finest level the function itself.
    pub(crate) fn look(&self, tf: &TransferFunction, shading: Option<&Shading>) -> Result<(TransferFunction, bool)> {
        match &self.level {
            Some(level) => level.look(&self.grid, tf, shading),
            None => Ok((tf.clone(), self.cache.needs_preintegration(&self.grid, tf))),
        }
    }
}
