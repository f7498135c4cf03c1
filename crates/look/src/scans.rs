//! Curves of automatic looks of scans: CT, tissue, ultrasound, scans of no fixed scale, and greys.
//!
//! Homogeneous matter, and noise, must not cover what lies behind. Where nothing is known but the values, opacities
//! follow Kindlmann and Durkin (1998): high at the values that boundaries between two materials pass through, where
//! gradients are largest, and low at the values of the materials themselves.

use wavesplat_core::{ColorNode, OpacityNode};

use crate::colors::Rgb;
use crate::facts::DataKind;
use crate::histogram::{otsu, otsu_of_scan, robust_range};
use crate::numbers::linspace;
use crate::statistics::{percentiles, those};

/// Values in Hounsfield units, opacity of a millimetre: soft tissue is a veil, vessels with contrast agent and bone are
/// solid.
const CT_OPACITY: [(f64, f64); 8] = [
    (-160.0, 0.0),
    (-90.0, 0.001),
    (20.0, 0.004),
    (80.0, 0.008),
    (130.0, 0.03),
    (180.0, 0.2),
    (280.0, 0.6),
    (900.0, 0.95),
];
const CT_COLOR: [(f64, Rgb); 7] = [
    (-160.0, [1.0, 0.9, 0.74]),
    (-20.0, [1.0, 0.82, 0.66]),
    (60.0, [1.0, 0.62, 0.5]),
    (130.0, [0.98, 0.55, 0.42]),
    (200.0, [1.0, 0.84, 0.68]),
    (320.0, [1.0, 0.95, 0.85]),
    (900.0, [1.0, 1.0, 0.97]),
];
/// Hounsfield units in black and in white: level 40, width 400, the usual window of soft tissue.
const CT_WINDOW: [f64; 2] = [-160.0, 240.0];
/// Colours from faint to bright: tissue is warm, as is expected; other scans go from blue to ivory.
const TISSUE: [Rgb; 4] = [[0.62, 0.30, 0.24], [0.90, 0.58, 0.44], [1.00, 0.84, 0.68], [1.00, 0.99, 0.95]];
const MATTER: [Rgb; 4] = [[0.20, 0.42, 0.68], [0.36, 0.68, 0.74], [0.93, 0.83, 0.58], [1.00, 0.96, 0.88]];
/// Nodes of the opacity of scans of no fixed scale.
const N_NODES: usize = 65;

/// Nodes of a transfer function.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveNodes {
    /// Values and opacities.
    pub opacity: Vec<OpacityNode>,
    /// Values and colours.
    pub color: Vec<ColorNode>,
}

impl CurveNodes {
    pub(crate) fn new(
        opacity: impl IntoIterator<Item = (f64, f64)>,
        color: impl IntoIterator<Item = (f64, Rgb)>,
    ) -> Self {
        Self {
            opacity: opacity.into_iter().map(|(value, opacity)| OpacityNode { value, opacity }).collect(),
            color: color.into_iter().map(|(value, rgb)| ColorNode { value, rgb }).collect(),
        }
    }

    /// Of CT in Hounsfield units with an offset; opacities are those of a millimetre.
    pub fn of_ct(offset: f64) -> Self {
        let moved = |value: f64| value + offset;
        Self::new(CT_OPACITY.map(|(v, opacity)| (moved(v), opacity)), CT_COLOR.map(|(v, rgb)| (moved(v), rgb)))
    }

    /// Skin and organs as surfaces: opaque soon above the background.
    ///
    /// White is left to the largest thousandth: fat, and skin with it, is among the brightest seventh of a head, which in
    /// scans of thick slices was a white plaster.
    pub fn of_tissue(values: &[f64]) -> Self {
        let (low, high) = robust_range(values);
        let threshold = otsu(values, low, high);
        let [middle, upper] = percentiles(&those(values, |value| value > threshold), [40.0, 85.0]);
        let nodes = increasing([threshold - 0.4 * (threshold - low), threshold, middle, upper], high - low);
        let places = increasing([nodes[0], nodes[1], nodes[3], high], high - low);
        Self::new(nodes.into_iter().zip([0.0, 0.05, 0.25, 0.5]), places.into_iter().zip(TISSUE))
    }

    /// Echoes above the background.
    pub fn of_ultrasound(values: &[f64]) -> Self {
        let (low, high) = robust_range(values);
        let threshold = otsu(values, low, high);
        let nodes = increasing([threshold, threshold + 0.3 * (high - threshold), high], high - low);
        let places = linspace(threshold, high, TISSUE.len());
        Self::new(nodes.into_iter().zip([0.0, 0.12, 0.5]), places.into_iter().zip(TISSUE))
    }

    /// Boundaries: opacity follows the mean gradient at a value, relative to that of other values.
    ///
    /// `gradients`: magnitudes of the differences of neighbours at `samples`.
    pub fn of_scan(samples: &[f64], gradients: &[f64], is_anatomical: bool) -> Self {
        let (low, high) = robust_range(samples);
        let scan = otsu_of_scan(samples, low, high);
        let (low, threshold, high) = (scan.background, scan.threshold, scan.high);
        let values = linspace(low, high, N_NODES);
        let strength = boundary_strength(samples, gradients, &values);
        let alpha = |(&value, strength): (&f64, f64)| {
            let rise = ((value - threshold) / f64::max(high - threshold, 1e-12)).clamp(0.0, 1.0);
            let is_seen = value > threshold - 0.25 * (threshold - low);
            if is_seen { (0.3 + 0.7 * strength) * (0.02 + 0.6 * rise.powf(1.2)) } else { 0.0 }
        };
        let mut opacity: Vec<f64> = values.iter().zip(strength).map(alpha).collect();
        opacity[N_NODES - 1] = opacity[N_NODES - 1].max(0.5);
        let colors = if is_anatomical { TISSUE } else { MATTER };
        let nodes = values.into_iter().zip(opacity.into_iter().map(|alpha| alpha.clamp(0.0, 1.0)));
        Self::new(nodes, linspace(threshold, high, colors.len()).into_iter().zip(colors))
    }

    /// Opaque greys, as slices are shown. `is_clear_below`: what would be black is clear, such as air.
    pub fn of_greys(values: &[f64], kind: DataKind, is_clear_below: bool) -> Self {
        let [low, high] = if kind == DataKind::Ct { CT_WINDOW } else { percentiles(values, [0.5, 99.5]) };
        let high = if high > low { high } else { low + 1.0 };
        let clear = is_clear_below.then_some((low, 0.0));
        Self::new(clear.into_iter().chain([(low, 1.0)]), [(low, [0.0; 3]), (high, [1.0; 3])])
    }
}

/// The nodes, kept a small distance apart: equal percentiles would make steps.
pub(crate) fn increasing<T: AsMut<[f64]>>(mut nodes: T, extent: f64) -> T {
    let all = nodes.as_mut();
    for i in 1..all.len() {
        all[i] = all[i].max(all[i - 1] + 1e-3 * extent);
    }
    nodes
}

/// Mean gradient of the samples near each value, as a share of the largest such mean, 0..1.
fn boundary_strength(samples: &[f64], gradients: &[f64], values: &[f64]) -> Vec<f64> {
    let (first, step, last) = (values[0], values[1] - values[0], values.len() - 1);
    let (mut counts, mut sums) = (vec![0.0_f64; values.len()], vec![0.0_f64; values.len()]);
    for (value, gradient) in samples.iter().zip(gradients) {
        let place = (((value - first) / step).round_ties_even().max(0.0) as usize).min(last);
        counts[place] += 1.0;
        sums[place] += gradient;
    }
    let around = |of: &[f64], i: usize| 0.25 * of[i.saturating_sub(1)] + 0.5 * of[i] + 0.25 * of[(i + 1).min(last)];
    let counts_around: Vec<f64> = (0..=last).map(|i| around(&counts, i)).collect();
    let mean = |i: usize| if counts_around[i] > 0.0 { around(&sums, i) / counts_around[i].max(1e-9) } else { 0.0 };
    let means: Vec<f64> = (0..=last).map(mean).collect();
    let is_enough = |i: &usize| counts_around[*i] > 1e-5 * samples.len() as f64;
    let largest = (0..=last).filter(is_enough).map(|i| means[i]).fold(0.0, f64::max).max(1e-12);
    means.into_iter().map(|mean| (mean / largest).clamp(0.0, 1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opacity_is_highest_where_gradients_are() {
        // Two materials, at 0 and 100, and the values between them, whose gradients are largest.
        let values: Vec<f64> = (0..=100).flat_map(|v| vec![f64::from(v); if v % 100 == 0 { 500 } else { 5 }]).collect();
        let gradients: Vec<f64> = values.iter().map(|v| v * (100.0 - v)).collect();
        let found = CurveNodes::of_scan(&values, &gradients, false);
        let strength = |place: usize| found.opacity[place].opacity;
        assert!(strength(40) > strength(63) && strength(0) == 0.0 && found.color[3].rgb == MATTER[3]);
    }

    #[test]
    fn nodes_of_equal_percentiles_are_apart_and_greys_have_a_range() {
        let values: Vec<f64> = (0..100).map(|i| if i < 60 { 0.0 } else { 7.0 }).collect();
        let found = CurveNodes::of_tissue(&values);
        assert!(found.opacity.windows(2).all(|pair| pair[0].value < pair[1].value), "{found:?}");
        let greys = CurveNodes::of_greys(&[3.0; 9], DataKind::Mr, true);
        assert_eq!((greys.opacity.len(), greys.color[1].value), (2, 4.0));
        assert_eq!(CurveNodes::of_ct(1024.0).opacity[2].value, 1044.0);
    }
}
