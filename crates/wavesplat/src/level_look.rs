//! Transfer function of a coarser level, which makes it as bright as the finest.

use std::sync::Mutex;

use glam::DVec3;
use wavesplat_compute::locks::lock;
use wavesplat_core::{Decoder, Grid, LevelGrid, Result, Shading, TransferFunction};
use wavesplat_lod::LevelHistogram;
use wavesplat_splat::needs_preintegration;

/// Brightness matching of a level to the finest one, and its latest result.
pub struct LevelBrightness {
    level: LevelGrid,
    /// Histogram of the level and a finer one, and sample spacing of the finer one, world units.
    brightness: Option<(LevelHistogram, DVec3)>,
    /// Latest function that was drawn, and its counterpart for this level.
    latest: Mutex<Option<LevelLook>>,
}

/// Samples of a box of a level, `[z][y][x]`.
pub struct LevelPart {
    /// First sample of the box.
    pub lo: [usize; 3],
    /// Samples along x, y, z.
    pub size: [usize; 3],
    /// The samples.
    pub samples: Vec<f32>,
}

impl Decoder for LevelPart {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]) {
        let [nx, ny, _] = self.size;
        let rows = (lo[2]..hi[2]).flat_map(|z| (lo[1]..hi[1]).map(move |y| (z * ny + y) * nx));
        for (out, row) in out.chunks_exact_mut(hi[0] - lo[0]).zip(rows) {
            out.copy_from_slice(&self.samples[row + lo[0]..row + hi[0]]);
        }
    }
}

/// A transfer function, and the function that a level is drawn with in its place.
struct LevelLook {
    of: TransferFunction,
    shading: Option<Shading>,
    tf: TransferFunction,
    needs_preintegration: bool,
}

impl LevelBrightness {
    /// Looks of a level that lies on `level` in the finest one. `brightness`: histogram of the level and a finer one,
    /// and sample spacing of the finer one, world units; without it functions stay as they are.
    pub fn new(level: LevelGrid, brightness: Option<(LevelHistogram, DVec3)>) -> Self {
        Self { level, brightness, latest: Mutex::default() }
    }

    /// Looks of a level from a box of its samples and a box of a finer level, which stand for the rest. `in_finer`:
    /// position of the level in the finer one, whose samples are `spacing` apart, world units; `range`: smallest and
    /// largest sample.
    pub fn of_parts(
        level: LevelGrid,
        in_finer: LevelGrid,
        [fine, coarse]: [LevelPart; 2],
        spacing: DVec3,
        range: [f64; 2],
    ) -> Self {
        let first = |a: usize| in_finer.origin[a] + in_finer.spacing[a] * coarse.lo[a] as f64 - fine.lo[a] as f64;
        let own = LevelGrid { origin: [0, 1, 2].map(first), spacing: in_finer.spacing, size: coarse.size };
        let histogram = LevelHistogram::new(&fine, &coarse, &own, spacing.to_array(), range, usize::MAX);
        Self::new(level, Some((histogram, spacing)))
    }

    /// Position of the level in the finest one.
    pub fn grid(&self) -> LevelGrid {
        self.level
    }

    /// Index position of the level at an index position of the finest grid.
    pub fn level_from_finest(&self, index: DVec3) -> DVec3 {
        DVec3::from_array(self.level.level_from_finest(index.to_array()))
    }

    /// Transfer function for which the level is as bright as the finest one for `tf`, and whether it or `tf` needs
    /// pre-integration; kept until another function is asked for. `grid`: the level's.
    pub(crate) fn look(
        &self,
        grid: &Grid,
        tf: &TransferFunction,
        shading: Option<&Shading>,
    ) -> Result<(TransferFunction, bool)> {
        let mut latest = lock(&self.latest);
        if let Some(known) = &*latest
            && (&known.of, known.shading.as_ref()) == (tf, shading)
        {
            return Ok((known.tf.clone(), known.needs_preintegration));
        }
        let given_needs_preintegration = needs_preintegration(grid, tf);
        let own = if let Some((histogram, spacing)) = &self.brightness {
            let unit = tf.opacity_unit().unwrap_or(grid.default_opacity_unit());
            histogram.filter(tf, (*spacing / unit).to_array(), shading, given_needs_preintegration)?
        } else {
            tf.clone()
        };
        // A smooth function may need so much extinction on the level that it becomes steep there.
        let needs_preintegration = given_needs_preintegration || needs_preintegration(grid, &own);
        *latest = Some(LevelLook { of: tf.clone(), shading: shading.cloned(), tf: own.clone(), needs_preintegration });
        Ok((own, needs_preintegration))
    }
}
