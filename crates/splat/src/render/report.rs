//! Report of a frame: counts of texels, sheets and base planes, and how it was drawn.

use wavesplat_compute::parallel;

use crate::render::plan::{FamilyPlan, Plan};
use crate::shapes::fragments::Fragments;

/// Counts of the work that a picture took, and how it was drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Texels that were reconstructed, summed over all sheets.
    pub n_texels: u64,
    /// Slabs of tiles, or of parts of tiles on 16 threads or more, that show nothing.
    pub n_skipped_slabs: u64,
    /// Base planes drawn: one for parallel rays, up to six for perspective.
    pub n_base_planes: usize,
    /// Texels of all base planes.
    pub n_base_texels: u64,
    /// Sheets of each base plane.
    pub n_sheets: Vec<usize>,
    /// Samples drawn as empty because they are NaN or infinite.
    pub n_nonfinite_samples: usize,
    /// Places of the first and the last depth colour along the view, from the camera, or along their axis.
    pub depth_colors: Option<[f64; 2]>,
    /// Surfaces of shapes on all rays, and rays whose deepest ones were joined for their number.
    pub n_fragments: [usize; 2],
    /// Threads that were used.
    pub n_threads: usize,
    /// Name of the SIMD level that was used.
    pub simd: &'static str,
}

impl Report {
    /// Report of a planned frame, before anything is drawn.
    pub fn of(plan: &Plan) -> Self {
        let n_base_texels = |family: &FamilyPlan| family.plane.size.iter().product::<usize>() as u64;
        Self {
            n_nonfinite_samples: plan.layers.iter().map(|layer| layer.grid.statistics().n_nonfinite).sum(),
            n_base_planes: plan.families.len(),
            n_base_texels: plan.families.iter().map(n_base_texels).sum(),
            n_sheets: plan.families.iter().map(|family| family.spacing.n_slabs + 1).collect(),
            depth_colors: plan.depth_colors.as_ref().map(|colors| colors.range),
            n_fragments: [0, 1].map(|k| {
                let counts = |all: &Fragments| [all.len(), all.n_joined()][k];
                plan.families.iter().filter_map(|own| own.fragments.as_deref()).map(counts).sum()
            }),
            n_threads: parallel::n_threads(),
            simd: plan.simd.name(),
            ..Self::default()
        }
    }
}
