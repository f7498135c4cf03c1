//! What a transform of one size needs, made once: the steps along each axis, and where the subbands lie.
//!
//! Each level splits the low box along x, y and z (Mallat's non-standard decomposition). The result has the size of the
//! data: the low box of a level lies in the first corner of that of the level before, details beside it. Level 0 is the
//! finest; its low box is all the data, and level `k`'s is what `k` steps leave.

use std::ops::Range;

use crate::family::Family;
use crate::lifting::Lifting;
use crate::norm::Factors;
use crate::semi_orthogonal::split;
use crate::step::Step;

/// A family at a size and a number of levels. Axes in the order x, y, z; data in the order `[z][y][x]`.
#[derive(Clone, Debug)]
pub struct Plan {
    family: Family,
    size: [usize; 3],
    axes: [Axis; 3],
}

/// All steps along one axis, and the norms of the functions that they end in.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub steps: Vec<Step>,
    pub factors: Factors,
}

impl Plan {
    /// The plan for a volume of `size` samples along x, y, z. `n_levels`: all that the longest axis has where `None`;
    /// more than that are left out. Axes that are split up before the others stay as they are.
    ///
    /// # Panics
    /// Where a size is 0.
    pub fn new(family: Family, size: [usize; 3], n_levels: Option<usize>) -> Self {
        assert!(size.iter().all(|&n| n > 0), "a volume of {size:?} samples has nothing to transform");
        let most = max_levels(family, size);
        let n_levels = n_levels.map_or(most, |n| n.min(most));
        let [nx, ny, nz] = size;
        let x = Axis::new(family, nx, n_levels);
        let y = if ny == nx { x.clone() } else { Axis::new(family, ny, n_levels) };
        let z = match nz {
            n if n == nx => x.clone(),
            n if n == ny => y.clone(),
            n => Axis::new(family, n, n_levels),
        };
        Self { family, size, axes: [x, y, z] }
    }

    /// The plan for lines of `n` samples.
    pub fn line(family: Family, n: usize, n_levels: Option<usize>) -> Self {
        Self::new(family, [n, 1, 1], n_levels)
    }

    /// The family.
    pub fn family(&self) -> Family {
        self.family
    }

    /// Samples along x, y, z.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Samples in all.
    pub fn n_samples(&self) -> usize {
        self.size.iter().product()
    }

    /// Levels of details.
    pub fn n_levels(&self) -> usize {
        self.axes[0].steps.len()
    }

    /// Size of the low box of a level, `0..=n_levels`; at 0 that of the data.
    pub fn low_size(&self, level: usize) -> [usize; 3] {
        std::array::from_fn(|axis| match level {
            0 => self.size[axis],
            _ => self.axes[axis].steps[level - 1].n_low,
        })
    }

    /// Where a subband of a level, `0..n_levels`, lies, along x, y, z. Bit 0, 1, 2 of `band`: details along x, y, z;
    /// band 0 is the low box of the next level. Bands of axes that were not split are empty.
    pub fn subband(&self, level: usize, band: usize) -> [Range<usize>; 3] {
        std::array::from_fn(|axis| {
            let Step { n, n_low, .. } = self.axes[axis].steps[level];
            if band >> axis & 1 == 0 { 0..n_low } else { n_low..n }
        })
    }

    /// The step from the low box of a level to that of the next along an axis (0, 1, 2 for x, y, z).
    pub fn step(&self, level: usize, axis: usize) -> &Step {
        &self.axes[axis].steps[level]
    }

    pub(crate) fn axes(&self) -> &[Axis; 3] {
        &self.axes
    }
}

/// Levels after which no axis can be split any more.
pub fn max_levels(family: Family, size: [usize; 3]) -> usize {
    size.into_iter().map(|n| family.max_levels(n)).max().unwrap_or(0)
}

impl Axis {
    fn new(family: Family, n: usize, n_levels: usize) -> Self {
        // Break points of the splines; only the semi-orthogonal families have them.
        let order = family.semi_orthogonal_order();
        let mut breaks: Vec<f64> = (0..(n + 2).saturating_sub(order.unwrap_or(0))).map(|i| i as f64).collect();
        let mut steps: Vec<Step> = Vec::with_capacity(n_levels);
        for _ in 0..n_levels {
            let n = steps.last().map_or(n, |step| step.n_low);
            steps.push(match (order, Lifting::of(family)) {
                _ if family.n_low(n) == n => Step::copy(n),
                (Some(order), _) => {
                    let split = split(&breaks, order);
                    let step = Step::semi_orthogonal(&split);
                    breaks = split.breaks;
                    step
                }
                (None, Some(lifting)) => Step::lifting(family, lifting, n),
                (None, None) => unreachable!("a family is made by lifting or by splines"),
            });
        }
        let factors = Factors::new(family, n, &steps);
        Self { steps, factors }
    }
}
