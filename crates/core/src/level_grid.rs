//! Level of detail: the sample grid of a coarser level of a volume.

/// Where the samples of a level lie along x, y, z, in index positions of the finest grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelGrid {
    /// The first one.
    pub origin: [f64; 3],
    /// Distance of neighbours.
    pub spacing: [f64; 3],
    /// Samples along each axis.
    pub size: [usize; 3],
}

impl LevelGrid {
    /// The finest grid itself.
    pub fn finest(size: [usize; 3]) -> Self {
        Self { origin: [0.0; 3], spacing: [1.0; 3], size }
    }

    /// An index position of the finest grid as one of the level.
    pub fn level_from_finest(&self, index: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|a| (index[a] - self.origin[a]) / self.spacing[a])
    }
}
