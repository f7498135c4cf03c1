//! Whether a transfer function needs pre-integration: whether opacity or colour can change by a visible amount from sheet
//! to sheet.

use wavesplat_core::{Grid, TransferFunction};

use crate::optics::classify::Classifier;
use crate::optics::visibility_cache::Visibility;

/// Change of a slab's opacity or colour, over all densities, from which slabs are pre-integrated.
const STEEP: f32 = 0.35;

/// Whether a transfer function can change opacity or colour by a visible amount within a voxel; of a coarser level,
/// within one of the finest: its pictures are smaller, and a smooth function is as smooth on it.
pub fn is_steep(grid: &Grid, tf: &TransferFunction) -> bool {
    let thickness = slab_of_the_finest(grid, tf);
    let classifier = Classifier::new(tf, grid.density_from_sample(), grid.density_range(), thickness);
    classifier.variation(thickness) >= STEEP
}

/// Whether opacity or colour can change by a visible amount from sheet to sheet. `slab_thickness`: in `opacity_unit`s.
pub fn is_steep_in_slabs(visibility: &Visibility, grid: &Grid, tf: &TransferFunction, slab_thickness: f64) -> bool {
    let varies = |thickness| visibility.variation(thickness) >= STEEP;
    varies(slab_thickness) && (grid.coarseness() <= 1.0 || varies(slab_of_the_finest(grid, tf)))
}

/// Thickness of a slab of two sheets a slice, of a coarser level one of the finest, in `opacity_unit`s.
fn slab_of_the_finest(grid: &Grid, tf: &TransferFunction) -> f64 {
    0.5 * grid.default_opacity_unit() / tf.opacity_unit().unwrap_or(grid.default_opacity_unit())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DAffine3, DVec3};
    use wavesplat_core::{ColorNode, OpacityNode, Statistics};

    #[test]
    fn a_smooth_function_is_smooth_on_every_level() {
        let statistics = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        let grid = |spacing: f64| {
            Grid::new("", [9; 3], DAffine3::from_scale(DVec3::splat(spacing)), statistics, false).unwrap()
        };
        let finest = grid(1.0);
        let level = grid(4.0).as_level_of(finest.default_opacity_unit(), finest.bounds());
        let curve = |nodes: [(f64, f64); 2], unit: Option<f64>| {
            let opacity = nodes.map(|(value, opacity)| OpacityNode { value, opacity }).to_vec();
            TransferFunction::new(opacity, vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], unit).unwrap()
        };
        let (soft, hard) = (curve([(0.0, 0.0), (1.0, 0.3)], None), curve([(0.5, 0.0), (0.51, 1.0)], None));
        for grid in [&finest, &level] {
            assert!(!is_steep(grid, &soft) && is_steep(grid, &hard));
        }
        // The same samples as a volume of their own have voxels four times as thick.
        assert!(is_steep(&grid(4.0), &curve([(0.0, 0.0), (1.0, 0.3)], Some(1.0))));
    }
}
