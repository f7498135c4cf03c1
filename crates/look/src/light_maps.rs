//! Curves of maps that are read as numbers: doses, shares, calculated maps, p-values; and of masks.
//!
//! They give light from the value on that counts, and nothing has a skin.

use crate::colormaps::shades;
use crate::colors::Rgb;
use crate::fields::FIELD_MAP;
use crate::measured_maps::SIGNIFICANT;
use crate::numbers::linspace;
use crate::scans::{CurveNodes, increasing};
use crate::statistics::{percentiles, those};
use crate::voxels::{opacity_of_voxel, rising};

/// Nodes of a map over a range.
const N_NODES: usize = 17;
/// The map that doses are shown in, blue to red as in programs for radiotherapy, its first place, and the least share of
/// the largest dose that shows.
const DOSE_MAP: &str = "turbo";
const DOSE_START: f64 = 0.1;
const MIN_DOSE: f64 = 0.1;
/// The map that shares are shown in, and the first place of all maps of light. Fractional anisotropy that is clear and
/// that is opaque: grey matter and fluid have less than the first, and single fibre bundles reach the second.
const SHARE_MAP: &str = "hot";
const LIGHT_START: f64 = 0.3;
const FA_ENDS: (f64, f64) = (0.2, 0.9);
/// Percentiles of the values above 0 of a calculated map that are clear and opaque: fits leave a few far off.
const MAP_ENDS: [f64; 2] = [0.1, 99.5];
const MASK: Rgb = [0.98, 0.80, 0.56];

impl CurveNodes {
    /// A dose map: clear below a tenth of the largest dose, then from blue to red, the hottest solid.
    ///
    /// `n_voxels`: voxels of the largest values that are opaque together.
    pub fn of_dose(highest: f64, n_voxels: f64) -> Self {
        let shares = linspace(MIN_DOSE, 1.0, N_NODES);
        let doses: Vec<f64> = shares.iter().map(|share| share * highest).collect();
        let nodes = increasing(doses, if highest > 0.0 { highest } else { 1.0 });
        let alphas = shares.iter().map(|share| opacity_of_voxel(0.9999 * share.powf(2.5), n_voxels));
        let opacity = std::iter::once((nodes[0], 0.0)).chain(nodes.iter().copied().zip(alphas));
        Self::new(opacity, nodes.iter().copied().zip(shades(DOSE_MAP, DOSE_START, N_NODES)))
    }

    /// Fractional anisotropy up to a value: white matter gives light, and nothing has a skin.
    pub fn of_anisotropy(highest: f64, n_voxels: f64) -> Self {
        let (low, high) = FA_ENDS;
        Self::of_light(SHARE_MAP, low, high.min(highest).max(low + 0.1), n_voxels)
    }

    /// Probabilities: clear at 0, opaque at the largest.
    pub fn of_probability(highest: f64, n_voxels: f64) -> Self {
        // Without a value above 0, such as fits may have below it, nothing is probable, and nothing shows.
        Self::of_light(SHARE_MAP, 0.0, if highest > 0.0 { highest } else { 1.0 }, n_voxels)
    }

    /// A calculated map: light from the least value of the matter on.
    pub fn of_map(values: &[f64], n_voxels: f64) -> Self {
        let positive = those(values, |value| value > 0.0);
        let [low, high] = if positive.is_empty() { [0.0, 1.0] } else { percentiles(&positive, MAP_ENDS) };
        // The least value of a statistic above its threshold; of a map without one, nearly 0.
        let least = f64::max(1e-6 * low.abs(), f64::from(f32::MIN_POSITIVE));
        Self::of_light(FIELD_MAP, low, high.max(low + least), n_voxels)
    }

    /// p-values: clear from the significant ones on, opaque at 0.
    pub fn of_p_values(n_voxels: f64) -> Self {
        let mut found = Self::of_light(SHARE_MAP, 0.0, SIGNIFICANT, n_voxels);
        for node in &mut found.opacity {
            node.value = SIGNIFICANT - node.value;
        }
        for node in &mut found.color {
            node.value = SIGNIFICANT - node.value;
        }
        found.opacity.reverse();
        found.color.reverse();
        found
    }

    /// Matter that is opaque from halfway between two values on.
    pub fn of_mask(low: f64, high: f64) -> Self {
        let middle = 0.5 * (low + high);
        Self::new([(middle, 0.0), (middle, 1.0)], [(middle, MASK)])
    }

    /// A colour map from a clear value to one that `n_voxels` together make opaque.
    fn of_light(map: &str, low: f64, high: f64, n_voxels: f64) -> Self {
        let places = linspace(0.0, 1.0, N_NODES);
        let even: Vec<f64> = places.iter().map(|place| low + (high - low) * place).collect();
        let nodes = increasing(even, high - low);
        let opacity = nodes.iter().copied().zip(places.iter().map(|&place| rising(place, n_voxels)));
        Self::new(opacity, nodes.iter().copied().zip(shades(map, LIGHT_START, N_NODES)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_rises_from_the_value_that_counts() {
        let found = CurveNodes::of_anisotropy(0.7, 3.0);
        assert_eq!([found.opacity[0].value, found.opacity[16].value], [0.2, 0.7]);
        assert_eq!((found.opacity[0].opacity, found.color[16].rgb), (0.0, [1.0; 3]));
        let p = CurveNodes::of_p_values(3.0);
        assert_eq!((p.opacity[0].value, p.opacity[16].value, p.opacity[16].opacity), (0.0, SIGNIFICANT, 0.0));
        assert!(p.opacity[0].opacity > 0.8);
        let map = CurveNodes::of_map(&[0.0, -1.0], 3.0);
        assert_eq!((map.color[0].value, map.color[16].value), (0.0, 1.0));
    }

    #[test]
    fn small_doses_are_clear_and_masks_are_solid() {
        let found = CurveNodes::of_dose(60.0, 3.0);
        assert_eq!((found.opacity[0].value, found.opacity[0].opacity, found.opacity.len()), (6.0, 0.0, 18));
        assert!(found.opacity[17].opacity > 0.9);
        assert_eq!(CurveNodes::of_mask(0.0, 7.0).opacity[1].value, 3.5);
    }
}
