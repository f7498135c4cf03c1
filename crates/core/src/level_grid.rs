//! Level of detail: the sample grid of a coarser level of a volume.

/// Sample positions of a level along x, y, z, in index positions of the finest grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelGrid {
    /// Position of the first sample.
    pub origin: [f64; 3],
    /// Distance between neighbouring samples.
    pub spacing: [f64; 3],
    /// Number of samples along each axis.
    pub size: [usize; 3],
}

impl LevelGrid {
    /// The finest grid itself.
    pub fn finest(size: [usize; 3]) -> Self {
        Self { origin: [0.0; 3], spacing: [1.0; 3], size }
    }

    /// Index position of the level at an index position of the finest grid.
    pub fn level_from_finest(&self, index: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|a| (index[a] - self.origin[a]) / self.spacing[a])
    }
}
