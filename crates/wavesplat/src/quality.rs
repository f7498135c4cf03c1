//! Named qualities: sheets per slice and texels per pixel, by volume, transfer function and view.

use wavesplat_core::{Camera, Grid, LADDER, Result, TransferFunction, oversampling_of_level, quality_settings};
use wavesplat_splat::quality::ladder::{Ladder, Sampling};
use wavesplat_splat::quality::target_psnr::PsnrTarget;

/// Effort for a picture: a quality, a sampling, or a PSNR.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is one per frame")]
pub enum Effort {
    /// A named quality.
    Named(Quality),
    /// A number of sheets per slice and of texels per pixel.
    Fixed(Sampling),
    /// The cheapest sampling that is expected to reach a PSNR.
    Psnr(PsnrTarget),
}

/// Named qualities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Fast, for interaction.
    Draft,
    /// Normal, for viewing.
    #[default]
    Normal,
    /// Fine, for looking closely: about 8 dB better than normal.
    Fine,
    /// High, for publishing.
    High,
}

/// Factor of sheets per slice for steep functions of two dimensions: they cannot be integrated along a slab, so only
/// more sheets find thin features.
const SHEETS_OF_TWO_DIMENSIONS: f64 = 3.0;

impl Quality {
    /// Public name of the quality.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Normal => "normal",
            Self::Fine => "fine",
            Self::High => "high",
        }
    }

    /// Sampling of a named quality for a volume on a grid. `needs_preintegration`: whether the transfer function needs
    /// pre-integration.
    pub(crate) fn sampling(
        name: &str,
        grid: &Grid,
        tf: &TransferFunction,
        needs_preintegration: bool,
        camera: &Camera,
        height_px: usize,
    ) -> Result<Sampling> {
        let samples_per_pixel = samples_per_pixel(grid, camera, height_px);
        let (sheets, oversampling) =
            quality_settings(name, needs_preintegration, grid.coarseness(), samples_per_pixel)?;
        Ok(Sampling { sheets_per_slice: sheets * sheet_factor(tf, needs_preintegration), oversampling })
    }
}

/// Samplings from which a picture of a wanted PSNR is chosen, for a volume on a grid: finer where named qualities are.
pub(crate) fn ladder(
    grid: &Grid,
    tf: &TransferFunction,
    needs_preintegration: bool,
    camera: &Camera,
    height_px: usize,
) -> Ladder {
    let samples_per_pixel = samples_per_pixel(grid, camera, height_px);
    LADDER.map(|(sheets, oversampling)| Sampling {
        sheets_per_slice: sheets * sheet_factor(tf, needs_preintegration),
        oversampling: oversampling_of_level(oversampling, grid.coarseness(), samples_per_pixel),
    })
}

fn samples_per_pixel(grid: &Grid, camera: &Camera, height_px: usize) -> f64 {
    camera.pixel_size(grid.middle(), height_px) / grid.mean_spacing()
}

fn sheet_factor(tf: &TransferFunction, needs_preintegration: bool) -> f64 {
    if needs_preintegration && tf.function_2d().is_some() { SHEETS_OF_TWO_DIMENSIONS } else { 1.0 }
}
