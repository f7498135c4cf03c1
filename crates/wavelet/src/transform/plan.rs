//! Transform plan: the steps along each axis for one size, and the layout of the subbands.
//!
//! Each level splits the low-pass box (LLL) along x, y and z (Mallat's non-standard decomposition). The result has the
//! size of the data: the low-pass box of a level lies in the first corner of the box of the level before, details
//! beside it. Level 0 is the finest: its low-pass box is all the data, and level `k`'s is left after `k` steps.

use std::ops::Range;

use super::lifting::LiftingScheme;
use super::norm::AxisNorms;
use super::semi_orthogonal::split;
use super::step::LevelStep;
use crate::error::WaveletError;
use crate::family::WaveletFamily;

/// Transform of a family at a size and a number of levels. Axes in the order x, y, z; data in the order `[z][y][x]`.
#[derive(Clone, Debug)]
pub struct TransformPlan {
    family: WaveletFamily,
    size: [usize; 3],
    axes: [AxisPlan; 3],
}

/// All steps along one axis, and the norms of its basis functions.
#[derive(Clone, Debug)]
pub(crate) struct AxisPlan {
    pub steps: Vec<LevelStep>,
    pub norms: AxisNorms,
}

impl TransformPlan {
    /// Plan for a volume of `size` samples along x, y, z. `n_levels`: at most as the longest axis has; `None`: all of
    /// these. Axes that cannot be split any more stay as they are at further levels.
    pub fn new(family: WaveletFamily, size: [usize; 3], n_levels: Option<usize>) -> Result<Self, WaveletError> {
        n_samples_of(size)?;
        let most = max_levels(family, size);
        let n_levels = n_levels.map_or(most, |n| n.min(most));
        let [nx, ny, nz] = size;
        let x = AxisPlan::new(family, nx, n_levels);
        let y = if ny == nx { x.clone() } else { AxisPlan::new(family, ny, n_levels) };
        let z = match nz {
            n if n == nx => x.clone(),
            n if n == ny => y.clone(),
            n => AxisPlan::new(family, n, n_levels),
        };
        Ok(Self { family, size, axes: [x, y, z] })
    }

    /// Plan for lines of `n` samples.
    pub fn line(family: WaveletFamily, n: usize, n_levels: Option<usize>) -> Result<Self, WaveletError> {
        Self::new(family, [n, 1, 1], n_levels)
    }

    /// The family.
    pub fn family(&self) -> WaveletFamily {
        self.family
    }

    /// Samples along x, y, z.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Number of samples.
    pub fn n_samples(&self) -> usize {
        self.size.iter().product()
    }

    /// Number of levels of details.
    pub fn n_levels(&self) -> usize {
        self.axes[0].steps.len()
    }

    /// Size of the low-pass box of a level, `0..=n_levels`; level 0 has the size of the data.
    ///
    /// # Panics
    /// Where `level` exceeds [`TransformPlan::n_levels`].
    pub fn low_size(&self, level: usize) -> [usize; 3] {
        std::array::from_fn(|axis| match level {
            0 => self.size[axis],
            _ => self.axes[axis].steps[level - 1].n_low,
        })
    }

    /// Ranges of a subband of a level, `0..n_levels`, along x, y, z. Bit 0, 1, 2 of `band`: details along x, y, z; band
    /// 0 is the low-pass box of the next level. Bands of axes that were not split are empty.
    ///
    /// # Panics
    /// Where `level` is not below [`TransformPlan::n_levels`].
    pub fn subband(&self, level: usize, band: usize) -> [Range<usize>; 3] {
        std::array::from_fn(|axis| {
            let LevelStep { n, n_low, .. } = self.axes[axis].steps[level];
            if band >> axis & 1 == 0 { 0..n_low } else { n_low..n }
        })
    }

    /// Step from the low-pass box of a level to the next level's, along an axis (0, 1, 2 for x, y, z).
    ///
    /// # Panics
    /// Where `level` is not below [`TransformPlan::n_levels`].
    pub fn step(&self, level: usize, axis: usize) -> &LevelStep {
        &self.axes[axis].steps[level]
    }

    /// # Panics
    /// Where an array does not have the size of the data.
    pub(crate) fn check_len(&self, len: usize) {
        let n_samples = self.n_samples();
        assert_eq!(len, n_samples, "the array has {len} entries, the plan of size {:?} needs {n_samples}", self.size);
    }

    pub(crate) fn axes(&self) -> &[AxisPlan; 3] {
        &self.axes
    }
}

/// Number of samples of a volume.
pub(crate) fn n_samples_of(size: [usize; 3]) -> Result<usize, WaveletError> {
    let n = size.iter().try_fold(1_usize, |n, &m| n.checked_mul(m));
    n.filter(|n| *n > 0).ok_or(WaveletError::VolumeSize { size })
}

/// Number of levels after which no axis can be split any more.
pub fn max_levels(family: WaveletFamily, size: [usize; 3]) -> usize {
    size.into_iter().map(|n| family.max_levels(n)).max().unwrap_or(0)
}

impl AxisPlan {
    fn new(family: WaveletFamily, n: usize, n_levels: usize) -> Self {
        // Break points of the splines, for semi-orthogonal families.
        let order = family.semi_orthogonal_order();
        let mut breaks: Vec<f64> = (0..(n + 2).saturating_sub(order.unwrap_or(0))).map(|i| i as f64).collect();
        let mut steps: Vec<LevelStep> = Vec::with_capacity(n_levels);
        for _ in 0..n_levels {
            let n = steps.last().map_or(n, |step| step.n_low);
            steps.push(match (order, LiftingScheme::of(family)) {
                _ if family.n_low(n) == n => LevelStep::copy(n),
                (Some(order), _) => {
                    let split = split(&breaks, order);
                    let step = LevelStep::semi_orthogonal(&split);
                    breaks = split.breaks;
                    step
                }
                (None, Some(lifting)) => LevelStep::lifting(family, lifting, n),
                (None, None) => unreachable!("a family is made by lifting or by splines"),
            });
        }
        let norms = AxisNorms::new(family, n, &steps);
        Self { steps, norms }
    }
}
