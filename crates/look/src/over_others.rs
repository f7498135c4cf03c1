//! Looks of volumes that lie over another one, as PET over CT: clear where their values are least, so that it shows.
//!
//! Opacities of a colour map rise from the low end of its window, or from the value that counts as the volume's smallest.
//! Diverging maps are clear at their centre and rise to both ends. A look that is made for a projection says nothing of
//! matter that a ray passes through: its opacities rise in the same way.

use wavesplat_core::{OpacityNode, TransferFunction};

use crate::colormaps::{MapRange, Rise};
use crate::colors::Rgb;
use crate::numbers::{interpolated, linspace};
use crate::projections::RayOperator;
use crate::scans::CurveNodes;

/// Opacity by place in the values, 0..1, of a layer without a window. The lowest tenth is background, of which a ray
/// passes through much; tuned on PET over CT, in space and on slices.
const PLACES: [f64; 5] = [0.0, 0.08, 0.2, 0.45, 1.0];
const ALPHAS: [f64; 5] = [0.0, 0.0, 0.08, 0.45, 1.0];
/// Thickness of a slab with these opacities, as a share of the longest side of the volume's box.
const UNIT_SHARE: f64 = 0.02;
/// Part of the range of values over which a preset's opacity rises from a clear lowest value, and marks of that rise.
const RISE: f64 = 0.15;
const N_MARKS: usize = 9;
/// Largest channel of a colour that adds no light to a projection.
const DARK: f64 = 0.02;

/// The values that a map is spread over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OverValues {
    /// Values that count as the volume's smallest and largest.
    OfVolume(f64, f64),
    /// A window: values that are clear and that are opaque.
    Window(f64, f64),
}

/// The colours of a map, at places 0..1.
#[derive(Clone, Copy, Debug)]
pub struct MapColors<'a> {
    /// Growing places.
    pub places: &'a [f64],
    /// The colour at each.
    pub colors: &'a [Rgb],
    /// Whether the map has a middle that its colours part from.
    pub is_diverging: bool,
}

/// Curves for a volume over another one, and the thickness that opacities are for; `None` is a voxel.
pub type OverCurves = (CurveNodes, Option<f64>);

impl MapColors<'_> {
    /// The map for a volume over another one. `longest_side`: of the volume's box.
    ///
    /// `None` of a diverging map over a window of negative values alone, which says nothing of the other sign.
    pub fn over(&self, values: OverValues, longest_side: f64) -> Option<OverCurves> {
        if self.is_diverging {
            return self.diverging(values, longest_side);
        }
        let (OverValues::OfVolume(low, high) | OverValues::Window(low, high)) = values;
        let range = MapRange { low, high, is_log: false, gamma: 1.0 };
        let color = range.color_nodes(self.places, self.colors);
        let is_window = matches!(values, OverValues::Window(..));
        let rise = || PLACES.iter().zip(ALPHAS).map(|(place, opacity)| (low + place * (high - low), opacity));
        let opacity = if is_window { Rise::Linear.over(|place| range.value_at(place)) } else { opacities(rise()) };
        Some((CurveNodes { opacity, color }, (!is_window).then_some(UNIT_SHARE * longest_side)))
    }

    /// A diverging map, clear about its centre: 0, or the value of the volume that is nearest to it.
    ///
    /// A window of two signs has the ends of the map; of one from a positive value on, less is clear on both sides of 0.
    fn diverging(&self, values: OverValues, longest_side: f64) -> Option<OverCurves> {
        let (centre, dead, low, high) = match values {
            OverValues::OfVolume(low, high) => {
                let centre = f64::min(f64::max(0.0, low), high);
                let reach = f64::max(high - centre, centre - low);
                (centre, 0.0, centre - reach, centre + reach)
            }
            OverValues::Window(low, high) if low < 0.0 && 0.0 < high => (0.0, 0.0, low, high),
            OverValues::Window(dead, high) if dead >= 0.0 => (0.0, dead, -high, high),
            OverValues::Window(..) => return None,
        };
        let value = |place: &f64| {
            let half = 2.0 * place - 1.0;
            if half < 0.0 {
                centre - dead + half * (centre - dead - low)
            } else {
                centre + dead + half * (high - centre - dead)
            }
        };
        let color = self.places.iter().map(value).zip(self.colors.iter().copied());
        if dead > 0.0 {
            return Some((CurveNodes::new([(low, 1.0), (-dead, 0.0), (dead, 0.0), (high, 1.0)], color), None));
        }
        let rising = || PLACES.into_iter().zip(ALPHAS);
        let below = rising().rev().map(|(place, alpha)| (centre - place * (centre - low), alpha));
        let above = rising().skip(1).map(|(place, alpha)| (centre + place * (high - centre), alpha));
        Some((CurveNodes::new(below.chain(above), color), Some(UNIT_SHARE * longest_side)))
    }
}

/// A look that was made for an operator, for a volume over another one.
#[derive(Clone, Copy, Debug)]
pub struct OverLook<'a> {
    /// Its curves.
    pub function: &'a TransferFunction,
    /// The operator that it was made for.
    pub made_for: RayOperator,
    /// Whether it has a name; looks of one's own mean what they say.
    pub has_name: bool,
}

impl OverLook<'_> {
    /// Opacities that are clear where the values are least, and their thickness; `None` where the look is so already.
    ///
    /// `operator`: the one that it is drawn with. `range`, `longest_side`: of the volume.
    pub fn cleared(
        &self,
        operator: RayOperator,
        range: (f64, f64),
        longest_side: f64,
    ) -> Option<(Vec<OpacityNode>, Option<f64>)> {
        let (function, color) = (self.function, self.function.color_nodes());
        let (low, high) = (color[0].value, color[color.len() - 1].value);
        let place = |value: f64| (value - low) / (high - low);
        let own_unit = function.opacity_unit();
        if operator.is_projection() {
            // Light that the lowest value adds, as the white of `pet` does, would cover all other layers.
            let is_dark = color[0].rgb.iter().all(|&part| part <= DARK) || function.opacity(low) == 0.0;
            let is_changed = self.made_for.is_projection() && !is_dark;
            return is_changed.then(|| (times(function, place, &[]), own_unit));
        }
        if self.made_for.is_projection() {
            let marks = PLACES.map(|place| low + place * (high - low));
            let rising = |value: f64| interpolated(place(value), &PLACES, &ALPHAS);
            return Some((times(function, rising, &marks), own_unit.or(Some(UNIT_SHARE * longest_side))));
        }
        let (least, most) = range;
        let alphas: Vec<f64> = function.opacity_nodes().iter().map(|node| node.opacity).collect();
        let shows_low = alphas.windows(2).any(|pair| pair[0] > pair[1]) && alphas[alphas.len() - 1] < alphas[0];
        // Those that show low values, such as air, would be lost.
        let is_kept = !self.has_name || shows_low || is_of_two_signs(function);
        if is_kept || least >= most || function.opacity(least) == 0.0 {
            return None;
        }
        let rise = RISE * (most - least);
        let marks: Vec<f64> = linspace(0.0, 1.0, N_MARKS).iter().map(|place| least + place * rise).collect();
        let smooth = |value: f64| {
            let part = ((value - least) / rise).clamp(0.0, 1.0);
            part * part
        };
        Some((times(function, smooth, &marks), own_unit))
    }
}

/// Whether values below 0 and above it show, and 0 does not: the lowest ones are no background.
pub fn is_of_two_signs(function: &TransferFunction) -> bool {
    let shows = |sign: f64| function.opacity_nodes().iter().any(|node| node.opacity > 0.0 && node.value * sign > 0.0);
    shows(-1.0) && shows(1.0) && function.opacity(0.0) == 0.0
}

/// Opacities times a factor of the value. `marks`: values that the product bends at.
fn times(function: &TransferFunction, factor: impl Fn(f64) -> f64, marks: &[f64]) -> Vec<OpacityNode> {
    let own = function.opacity_nodes().iter().map(|node| node.value);
    let mut values: Vec<f64> = own.chain(function.color_nodes().iter().map(|node| node.value)).collect();
    values.extend(marks);
    values.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    values.dedup();
    let alpha = |&value: &f64| (value, (function.opacity(value) * factor(value).clamp(0.0, 1.0)).clamp(0.0, 1.0));
    opacities(values.iter().map(alpha))
}

fn opacities(nodes: impl IntoIterator<Item = (f64, f64)>) -> Vec<OpacityNode> {
    nodes.into_iter().map(|(value, opacity)| OpacityNode { value, opacity }).collect()
}

#[cfg(test)]
mod tests {
    use wavesplat_core::ColorNode;

    use super::*;

    const GREYS: MapColors<'_> =
        MapColors { places: &[0.0, 0.5, 1.0], colors: &[[0.0; 3], [0.5; 3], [1.0; 3]], is_diverging: false };

    fn function(opacity: &[(f64, f64)], color: &[(f64, f64)]) -> TransferFunction {
        let color = color.iter().map(|&(value, grey)| ColorNode { value, rgb: [grey; 3] }).collect();
        TransferFunction::new(opacities(opacity.iter().copied()), color, None).unwrap()
    }

    #[test]
    fn the_lowest_values_of_a_map_are_clear() {
        let (curves, unit) = GREYS.over(OverValues::OfVolume(10.0, 110.0), 50.0).unwrap();
        assert_eq!((curves.opacity[1], unit), (OpacityNode { value: 18.0, opacity: 0.0 }, Some(1.0)));
        let (curves, unit) = GREYS.over(OverValues::Window(10.0, 110.0), 50.0).unwrap();
        assert_eq!((curves.opacity[0].opacity, curves.opacity.len(), unit), (0.0, 256, None));
    }

    #[test]
    fn diverging_maps_are_clear_at_their_centre() {
        let map = MapColors { is_diverging: true, ..GREYS };
        let (curves, _) = map.over(OverValues::OfVolume(-2.0, 10.0), 50.0).unwrap();
        assert_eq!([curves.color[0].value, curves.color[1].value, curves.color[2].value], [-10.0, 0.0, 10.0]);
        assert_eq!(curves.opacity[4], OpacityNode { value: 0.0, opacity: 0.0 });
        let (beyond, unit) = map.over(OverValues::Window(3.0, 9.0), 50.0).unwrap();
        assert_eq!((beyond.opacity[1].value, beyond.opacity[2].value, unit), (-3.0, 3.0, None));
        assert!(map.over(OverValues::Window(-9.0, -3.0), 50.0).is_none());
    }

    #[test]
    fn looks_become_clear_where_values_are_least() {
        let of = |function: &TransferFunction, made_for, operator| {
            OverLook { function, made_for, has_name: true }.cleared(operator, (0.0, 100.0), 50.0)
        };
        let solid = function(&[(0.0, 0.5)], &[(0.0, 1.0), (100.0, 0.0)]);
        let (opacity, unit) = of(&solid, RayOperator::Maximum, RayOperator::Over).unwrap();
        assert_eq!((opacity[0].opacity, opacity[4].opacity, unit), (0.0, 0.5, Some(1.0)));
        let (opacity, _) = of(&solid, RayOperator::Maximum, RayOperator::Maximum).unwrap();
        assert_eq!(opacity.iter().map(|node| node.opacity).collect::<Vec<_>>(), [0.0, 0.5]);
        let (opacity, _) = of(&solid, RayOperator::Over, RayOperator::Over).unwrap();
        assert_eq!((opacity[0].opacity, opacity[9].value, opacity[9].opacity), (0.0, 100.0, 0.5));
        // Of one colour all values up to it are clear.
        let flat = function(&[(0.0, 0.5)], &[(40.0, 1.0)]);
        let (opacity, _) = of(&flat, RayOperator::Maximum, RayOperator::Over).unwrap();
        assert!(opacity.iter().all(|node| node.opacity == 0.0), "{opacity:?}");
        let signed = function(&[(-9.0, 1.0), (-1.0, 0.0), (1.0, 0.0), (9.0, 1.0)], &[(0.0, 1.0)]);
        assert!(is_of_two_signs(&signed) && of(&signed, RayOperator::Over, RayOperator::Over).is_none());
    }
}
