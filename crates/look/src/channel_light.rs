//! The light of a fluorescence channel on slices, where it rises evenly over the window, as its look has it in space.
//!
//! In space a channel's colours are a ramp ([`ramp`](crate::channel_ramp::ramp)): dark, full, whiter beyond. Gamma moves
//! the nodes of that ramp, exposure multiplies their colours ([`changes`](crate::changes)). Both are read from the nodes,
//! so that a look that was changed, saved or edited has one set of colours. Up to the full colour c a ramp of exposure E
//! has at place t, 0..1, the colour
//!
//! c E (d + (1 - d) t / f), with d = [`DARKEST`] and f = [`FULL_COLOR`],
//!
//! so that the first node gives E, and any node that is not clipped at 1 gives the t whose colour is at its value.

use crate::changes::{ColorRow, bent, exposed};
use crate::channel_ramp::{DARKEST, FULL_COLOR};
use crate::channel_windows::ROUNDING;
use crate::colors::Rgb;

/// Digits of places that count: white has its full colour at many nodes, and the first one is meant.
const DIGITS: f64 = 1e9;
/// Least cosine of the first colour and the brightest one, into which white is mixed.
const SAME_HUE: f64 = 0.9;

/// The light of a channel: black up to one value, a colour from another one on, and the curve between.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelLight {
    /// The value up to which it is black.
    pub low: f64,
    /// The value from which on it has its colour.
    pub high: f64,
    /// The colour without the exposure above 1.
    pub color: Rgb,
    /// From black at `low` to the colour at `high`.
    pub curve: Vec<ColorRow>,
}

impl ChannelLight {
    /// The light of a channel's look with these colours, at least one. `is_projection`: the look is for a projection.
    pub fn of(nodes: &[ColorRow], is_projection: bool) -> Self {
        let (low, high) = (nodes[0][0], nodes[nodes.len() - 1][0]);
        let between = |color: Rgb| vec![[low, 0.0, 0.0, 0.0], [high, color[0], color[1], color[2]]];
        if is_projection || !is_ramp(nodes) {
            let color = rgb(nodes[brightest(nodes)]).map(|part| part.clamp(0.0, 1.0));
            return Self { low, high, color, curve: if is_projection { nodes.to_vec() } else { between(color) } };
        }
        let exposure = f64::max(1.0, most(nodes[0]) / DARKEST);
        let color = rgb(nodes[0]).map(|part| (part / DARKEST / exposure).clamp(0.0, 1.0));
        let mut curve = between(color);
        let gamma = gamma_of(nodes);
        if gamma != 1.0 {
            curve = bent(&curve, (low, high), gamma);
        }
        if exposure > 1.0 + ROUNDING {
            curve = exposed(&[], &curve, exposure, true, true).1;
        }
        Self { low, high, color, curve }
    }
}

fn rgb([_, red, green, blue]: ColorRow) -> Rgb {
    [red, green, blue]
}

fn most(node: ColorRow) -> f64 {
    rgb(node).into_iter().fold(f64::NEG_INFINITY, f64::max)
}

/// The first node whose colour has the largest channel.
fn brightest(nodes: &[ColorRow]) -> usize {
    largest(nodes.iter().map(|&node| most(node)))
}

fn largest(numbers: impl Iterator<Item = f64>) -> usize {
    let larger = |best: (usize, f64), one: (usize, f64)| if one.1 > best.1 { one } else { best };
    numbers.enumerate().fold((0, f64::NEG_INFINITY), larger).0
}

/// Whether colours rise from a dark one in one hue, as those of a ramp do after any change.
fn is_ramp(nodes: &[ColorRow]) -> bool {
    let [dark, bright] = [nodes[0], nodes[brightest(nodes)]].map(rgb);
    let dot = |a: Rgb, b: Rgb| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let lengths = dot(dark, dark).sqrt() * dot(bright, bright).sqrt();
    nodes[0][0] < nodes[nodes.len() - 1][0] && lengths > 0.0 && dot(dark, bright) >= SAME_HUE * lengths
}

/// The gamma of a ramp: by the last node up to the full colour that is not clipped.
fn gamma_of(nodes: &[ColorRow]) -> f64 {
    let (first, start) = (most(nodes[0]), nodes[0][0]);
    let end = nodes[nodes.len() - 1][0];
    let wanted = |node: &ColorRow| {
        // Beyond the full colour white is mixed in.
        let place = FULL_COLOR * (most(*node) / first - 1.0) * DARKEST / (1.0 - DARKEST);
        let place = (place * DIGITS).round_ties_even() / DIGITS;
        let is_whole = most(*node) < 1.0 - ROUNDING || first <= DARKEST + ROUNDING;
        if is_whole && place <= FULL_COLOR + ROUNDING { place } else { 0.0 }
    };
    let wanted: Vec<f64> = nodes[1..].iter().map(wanted).collect();
    let last = largest(wanted.iter().copied());
    let place = (nodes[1 + last][0] - start) / (end - start);
    if !(0.0 < wanted[last] && wanted[last] < 1.0 && 0.0 < place && place < 1.0) {
        return 1.0;
    }
    let gamma = wanted[last].ln() / place.ln();
    if (gamma - 1.0).abs() < ROUNDING { 1.0 } else { gamma }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channel_ramp::{WHITE, ramp};

    fn nodes(color: Rgb) -> Vec<ColorRow> {
        let (_, color) = ramp(color, 10.0, 110.0, 3.0, None, WHITE);
        color.iter().map(|node| [node.value, node.rgb[0], node.rgb[1], node.rgb[2]]).collect()
    }

    #[test]
    fn a_ramp_gives_its_colour_and_window() {
        let light = ChannelLight::of(&nodes([0.1, 1.0, 0.2]), false);
        assert!(light.color.iter().zip([0.1, 1.0, 0.2]).all(|(a, b)| (a - b).abs() < 1e-12));
        assert_eq!((light.low, light.high, light.curve.len()), (10.0, 110.0, 2));
    }

    #[test]
    fn gamma_and_exposure_are_read_from_the_nodes() {
        let changed = exposed(&[], &bent(&nodes([0.1, 1.0, 0.2]), (10.0, 110.0), 2.0), 0.5, true, false).1;
        assert!((gamma_of(&bent(&nodes([0.1, 1.0, 0.2]), (10.0, 110.0), 2.0)) - 2.0).abs() < 1e-6);
        let light = ChannelLight::of(&changed, false);
        assert!((light.color[1] - 0.5).abs() < 1e-9, "{light:?}");
        let flat = ChannelLight::of(&[[5.0, 0.3, 0.9, 0.3]], false);
        assert_eq!((flat.color, flat.curve.len()), ([0.3, 0.9, 0.3], 2));
    }
}
