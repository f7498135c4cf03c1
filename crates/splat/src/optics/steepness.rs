//! Whether a transfer function needs pre-integration: whether opacity or colour can change by a visible amount from sheet
//! to sheet, or sheets can miss a visible amount of what is between them.

use wavesplat_core::{Grid, TransferFunction};

use crate::optics::classify::Classifier;

/// Change of a slab's opacity or colour, over all densities, from which slabs are pre-integrated.
const STEEP: f32 = 0.35;

/// Opacity of a slab that sheets may miss or exaggerate: two and a half of 255 grey levels.
const MISSED: f32 = 0.01;

/// Whether slabs of a thickness, in `opacity_unit`s, need pre-integration.
pub(super) fn is_steep_at(classifier: &Classifier, slab_thickness: f64) -> bool {
    classifier.variation(slab_thickness) >= STEEP || classifier.missed(slab_thickness) >= MISSED
}

/// Whether a transfer function can change opacity or colour by a visible amount within a voxel, or has peaks and gaps that
/// sheets can miss; of a coarser level, within one of the finest: its pictures are smaller, and a smooth function is as
/// smooth on it.
pub fn is_steep(grid: &Grid, tf: &TransferFunction) -> bool {
    let thickness = slab_of_the_finest(grid, tf);
    is_steep_at(&Classifier::new(tf, grid.density_from_sample(), grid.density_range(), thickness), thickness)
}

/// Thickness of a slab of two sheets a slice, of a coarser level one of the finest, in `opacity_unit`s.
pub(super) fn slab_of_the_finest(grid: &Grid, tf: &TransferFunction) -> f64 {
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
        // A peak that is thin beside the range of the data, however faint.
        let thin = [(0.49, 0.0), (0.5, 0.1), (0.51, 0.0)].map(|(value, opacity)| OpacityNode { value, opacity });
        let thin = TransferFunction::new(thin.to_vec(), vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], None).unwrap();
        assert!(is_steep(&finest, &thin) && is_steep(&level, &thin));
        // The same samples as a volume of their own have voxels four times as thick.
        assert!(is_steep(&grid(4.0), &curve([(0.0, 0.0), (1.0, 0.3)], Some(1.0))));
    }
}
