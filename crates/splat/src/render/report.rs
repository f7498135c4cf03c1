//! What a frame took: counts of texels, sheets, base planes, and how it was drawn.

use wavesplat_compute::parallel;

use crate::render::plan::{FamilyPlan, Plan};

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
    /// What a plan tells before anything is drawn.
    pub fn of(plan: &Plan) -> Self {
        let n_base_texels = |family: &FamilyPlan| family.plane.size.iter().product::<usize>() as u64;
        Self {
            n_nonfinite_samples: plan.layers.iter().map(|layer| layer.grid.statistics().n_nonfinite).sum(),
            n_base_planes: plan.families.len(),
            n_base_texels: plan.families.iter().map(n_base_texels).sum(),
            n_sheets: plan.families.iter().map(|family| family.spacing.n_slabs + 1).collect(),
            n_threads: parallel::n_threads(),
            simd: plan.simd.name(),
            ..Self::default()
        }
    }
}
