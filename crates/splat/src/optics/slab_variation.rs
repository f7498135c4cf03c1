//! Need of a transfer function for pre-integration: whether opacity or colour can change by a visible amount from sheet
//! to sheet, or sheets can miss a visible amount of the matter between them.

use wavesplat_core::{Grid, TransferFunction};

use crate::optics::classify::Classifier;

/// Total variation of a slab's opacity or colour, over all densities, from which slabs are pre-integrated.
const STEEP: f32 = 0.35;

/// Opacity that sheets may miss or exaggerate: two and a half of 255 grey levels; on a coarser level, which has lost
/// more than that itself, five.
const MISSED: f64 = 0.01;
const MISSED_ON_LEVELS: f64 = 0.02;

/// Numbers of slices over which rays are assumed to cross all densities, evenly; and the fewest that are assumed for a
/// single slab: what changes faster is an edge, which few texels see.
const SLICES_ACROSS: [usize; 8] = [8, 12, 16, 24, 32, 48, 64, 96];
const MIN_SLICES_OF_SLAB: f64 = 24.0;

/// Numbers of sheet places that are tried: even ones, over all densities for a single slab and within a slice for all
/// slabs, and the first tops and gaps of the function.
const N_EVEN_DENSITIES: usize = 512;
const N_EVEN_PLACES: usize = 32;
const N_TURNS: usize = 64;

/// Whether a transfer function needs pre-integration.
///
/// It does if opacity or colour can change by a visible amount within a voxel, or if it has peaks and gaps that sheets
/// can miss. On a coarser level, a voxel of the finest counts: pictures of the level are smaller, and a smooth function
/// is as smooth on it.
pub fn needs_preintegration(grid: &Grid, tf: &TransferFunction) -> bool {
    let thickness = slab_of_the_finest(grid, tf);
    let classifier = Classifier::new(tf, grid.density_from_sample(), grid.density_range(), thickness);
    varies(&classifier, thickness) || has_thin_parts(&classifier, grid, tf)
}

/// Whether the opacity or colour of slabs of a thickness, in `opacity_unit`s, varies visibly with the density.
pub(super) fn varies(classifier: &Classifier, slab_thickness: f64) -> bool {
    classifier.variation(slab_thickness) >= STEEP
}

/// Whether sheets can miss, or exaggerate, a visible amount of the matter between them. One sheet per slice is assumed,
/// as at quality draft, so that the answer, and the way a picture is drawn, is the same at every quality.
pub(super) fn has_thin_parts(classifier: &Classifier, grid: &Grid, tf: &TransferFunction) -> bool {
    let of_one_slice = 2.0 * slab_of_the_finest(grid, tf);
    // The function of a coarser level is noisy: its little tops mean nothing.
    if grid.coarseness() > 1.0 {
        return missed(classifier, of_one_slice, false) >= MISSED_ON_LEVELS;
    }
    missed(classifier, of_one_slice, true) >= MISSED
}

/// Thickness of a slab at two sheets per slice of the finest level, in `opacity_unit`s.
pub(super) fn slab_of_the_finest(grid: &Grid, tf: &TransferFunction) -> f64 {
    0.5 * grid.default_opacity_unit() / tf.opacity_unit().unwrap_or(grid.default_opacity_unit())
}

/// Largest opacity that is missed, or is too much, where a slab gets the mean of the opacities on the sheets before
/// and behind it in place of the matter between them: of one slab, or of all slabs from the least density to the
/// greatest.
/// `slab_thickness`: in `opacity_unit`s. `with_combs`: also where a sheet lies on every top.
fn missed(classifier: &Classifier, slab_thickness: f64, with_combs: bool) -> f64 {
    let [min, max] = classifier.range.map(f64::from);
    if max <= min {
        return 0.0;
    }
    let table = &classifier.segments;
    let n = table.len() - 2;
    let (lo, per_density) = (f64::from(classifier.lo), f64::from(classifier.per_density));
    let density = |i: usize| lo + i as f64 / per_density;
    // Integral and optical depth of a density.
    let at = |density: f64| {
        let position = (density - lo) * per_density;
        let inside = position.clamp(0.0, n as f64);
        let (k, t) = (inside as usize, inside.fract());
        let between = |c: usize| f64::from(table[k][c]) + (f64::from(table[k + 1][c]) - f64::from(table[k][c])) * t;
        let depth = between(3);
        // Constant beyond the table.
        [between(0) + (position - inside) / per_density * depth, depth]
    };
    let opacity = |depth: f64| -(-depth * slab_thickness).exp_m1();
    // Mean optical depth by both sheets, and of the matter between them.
    let depths = |from: f64, step: f64| {
        let ([before, near], [after, far]) = (at(from), at(from + step));
        [0.5 * (near + far), (after - before) / step]
    };
    let of_slab = |from: f64, step: f64| {
        let [sampled, whole] = depths(from, step);
        (opacity(sampled) - opacity(whole)).abs()
    };
    let of_all = |place: f64, n_slices: usize| {
        let step = (max - min) / n_slices as f64;
        let begins = (0..n_slices).map(|k| min + (k as f64 + place) * step);
        let slabs = begins.filter(|from| from + step <= max + 1e-6 * step).map(|from| depths(from, step));
        let [sampled, whole] = slabs.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
        (opacity(sampled) - opacity(whole)).abs()
    };
    let is_within = |d: &f64| (min..=max).contains(d);
    let step = (max - min) / MIN_SLICES_OF_SLAB;
    // Where the function turns from rising to falling, or back: tops and gaps, however thin.
    let mut turns = Vec::new();
    let mut rises = None;
    for i in 1..=n {
        let change = table[i][3] - table[i - 1][3];
        if change != 0.0 && rises.replace(change > 0.0) == Some(change < 0.0) {
            turns.push(density(i - 1));
        }
    }
    turns.retain(is_within);
    turns.truncate(N_TURNS);
    let even = (0..=N_EVEN_DENSITIES).map(|k| min + (max - min) * k as f64 / N_EVEN_DENSITIES as f64);
    let beside = |d: f64| of_slab(d, step).max(of_slab(d - step, step));
    // A sheet on a top counts in the slab before it and in the one behind it.
    let of_combs = if with_combs { turns.iter().map(|d| 2.0 * beside(*d)).sum() } else { 0.0 };
    let of_slabs = even.chain(turns.iter().copied()).map(beside);
    let of_all = SLICES_ACROSS.iter().flat_map(|&n_slices| {
        let even = (0..N_EVEN_PLACES).map(|k| k as f64 / N_EVEN_PLACES as f64);
        let at_turns = turns.iter().map(move |d| ((d - min) / (max - min) * n_slices as f64).fract());
        even.chain(at_turns).map(move |place| of_all(place, n_slices))
    });
    of_slabs.chain(of_all).fold(of_combs, f64::max)
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
            assert!(!needs_preintegration(grid, &soft) && needs_preintegration(grid, &hard));
        }
        // A peak that is thin beside the range of the data, however faint.
        let thin = [(0.49, 0.0), (0.5, 0.1), (0.51, 0.0)].map(|(value, opacity)| OpacityNode { value, opacity });
        let thin = TransferFunction::new(thin.to_vec(), vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], None).unwrap();
        assert!(needs_preintegration(&finest, &thin) && needs_preintegration(&level, &thin));
        // The same samples as a volume of their own have voxels four times as thick.
        assert!(needs_preintegration(&grid(4.0), &curve([(0.0, 0.0), (1.0, 0.3)], Some(1.0))));
    }

    #[test]
    fn sheets_miss_thin_peaks_gaps_and_steps_and_no_ramps() {
        let missed_by = |nodes: &[(f64, f64)]| {
            let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
            let tf = TransferFunction::new(opacity, vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], None).unwrap();
            missed(&Classifier::new(&tf, (0.0, 1.0), [0.0, 100.0], 0.5), 1.0, true)
        };
        let comb = |top: f64| {
            let peak = |k: usize| [-0.1, 0.0, 0.1].map(|x| (10.0 * k as f64 + x, if x == 0.0 { top } else { 0.0 }));
            (1..10).flat_map(peak).collect::<Vec<_>>()
        };
        for thin in [
            &[(49.0, 0.0), (50.0, 0.1), (51.0, 0.0)][..],
            &[(49.99, 0.0), (50.0, 0.1), (50.01, 0.0)],
            &[(0.0, 0.1), (49.0, 0.1), (50.0, 0.0), (51.0, 0.1), (100.0, 0.1)],
            &[(50.0, 0.0), (50.0, 0.1), (100.0, 0.1)],
            &comb(0.005),
        ] {
            assert!(missed_by(thin) > 0.02, "{thin:?}: {}", missed_by(thin));
        }
        for wide in [&[(0.0, 0.0), (100.0, 0.2)][..], &[(30.0, 0.0), (60.0, 0.05), (100.0, 0.2)], &[(0.0, 0.9)]] {
            assert!(missed_by(wide) < 0.008, "{wide:?}: {}", missed_by(wide));
        }
        // No more is missed than there is.
        assert!(missed_by(&[(49.0, 0.0), (50.0, 0.002), (51.0, 0.0)]) < 0.006);
    }
}
