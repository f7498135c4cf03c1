//! What a frame took: counts of texels, sheets, base planes, and how it was drawn.

/// What a picture took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Texels that were reconstructed, all sheets.
    pub n_texels: u64,
    /// Sheets of tiles left out because nothing in them is visible.
    pub n_skipped_sheets: u64,
    /// Base planes drawn: one for parallel rays, up to six for perspective.
    pub n_base_planes: usize,
    /// Texels of the base planes.
    pub n_base_texels: u64,
    /// Sheets of each base plane.
    pub n_sheets: Vec<usize>,
    /// Samples drawn as empty because they are NaN or infinite.
    pub n_nonfinite_samples: usize,
    /// Threads that worked.
    pub n_threads: usize,
    /// Vectors that were used.
    pub simd: &'static str,
}

impl Report {
    /// With the work of a finer picture of the same; base planes and sheets are those of that.
    #[must_use]
    pub(crate) fn and(self, finer: Self) -> Self {
        let n_texels = self.n_texels + finer.n_texels;
        Self { n_texels, n_skipped_sheets: self.n_skipped_sheets + finer.n_skipped_sheets, ..finer }
    }
}
