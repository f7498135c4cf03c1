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
