//! Changes of curves that keep their colours and operator: window, gamma, exposure.
//!
//! Place t of a value is (value - low) / (high - low) in the curves' window, which spans their nodes. A window moves the
//! nodes to the same places in another one; gamma gives a value of place t the colour that the curves have at t ** gamma.
//! Opacities stay, so that gamma shows nothing that was clear before.
//!
//! Exposure is a factor of the light that matter gives off: colours get the factor; what is beyond 1 makes them whiter,
//! so that their hue stays. Above 1 extinction gets it too, since a full colour has no room left; of a channel, which is
//! seen among others, only as far as the colour has none, so that the mixture of channels stays. A projection has no
//! extinction.

use crate::numbers::{interpolated, power};

/// Parts of a segment between two nodes where curves become bent.
const N_PARTS: usize = 8;
/// Share of white in what exposure makes of a channel's colour beyond 1: with all of it hues of mixtures turned by 9
/// degrees, with half by 5.
const CHANNEL_WHITE: f64 = 0.5;

/// Value and opacity, or magnitude and factor.
pub type OpacityRow = [f64; 2];
/// Value, red, green and blue.
pub type ColorRow = [f64; 4];

/// The least and the largest value of curves; `None` if they are the same, so that there is no window to change.
pub fn window_of(opacity: &[OpacityRow], color: &[ColorRow]) -> Option<(f64, f64)> {
    let values = opacity.iter().map(|node| node[0]).chain(color.iter().map(|node| node[0]));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    (low < high).then_some((low, high))
}

/// Nodes with values moved from one window into another one.
pub fn in_window<const N: usize>(
    nodes: &[[f64; N]],
    (first, last): (f64, f64),
    (low, high): (f64, f64),
) -> Vec<[f64; N]> {
    let scale = (high - low) / (last - first);
    let moved =
        |node: &[f64; N]| std::array::from_fn(|c| if c == 0 { low + scale * (node[0] - first) } else { node[c] });
    nodes.iter().map(moved).collect()
}

/// Magnitudes of gradients that go with values moved from one window into another one.
pub fn gradients_in_window(
    nodes: &[OpacityRow],
    (first, last): (f64, f64),
    (low, high): (f64, f64),
) -> Vec<OpacityRow> {
    let scale = (high - low) / (last - first);
    nodes.iter().map(|&[magnitude, factor]| [magnitude * scale, factor]).collect()
}

/// Colours moved in a window: the value at place t gets the colour of place t ** gamma.
pub fn bent(color: &[ColorRow], (low, high): (f64, f64), gamma: f64) -> Vec<ColorRow> {
    let mut nodes = divided(color);
    for node in &mut nodes {
        let place = ((node[0] - low) / (high - low)).clamp(0.0, 1.0);
        node[0] = low + (high - low) * power(place, 1.0 / gamma);
    }
    nodes
}

/// Opacities and colours of matter that gives off `exposure` times the light; above 1 it is denser too, but for
/// projections.
pub fn exposed(
    opacity: &[OpacityRow],
    color: &[ColorRow],
    exposure: f64,
    is_channel: bool,
    is_projection: bool,
) -> (Vec<OpacityRow>, Vec<ColorRow>) {
    let mut color = divided(color);
    let mut opacity = opacity.to_vec();
    if exposure > 1.0 && !is_projection {
        opacity = divided(&opacity);
        let values: Vec<f64> = color.iter().map(|node| node[0]).collect();
        let parts: [Vec<f64>; 3] = std::array::from_fn(|c| color.iter().map(|node| node[c + 1]).collect());
        for node in &mut opacity {
            let most = parts.iter().map(|part| interpolated(node[0], &values, part)).fold(f64::NEG_INFINITY, f64::max);
            let denser = if is_channel { (exposure * most).max(1.0) } else { exposure };
            node[1] = -(denser * (-node[1]).ln_1p()).exp_m1();
        }
    }
    let white = if is_channel { CHANNEL_WHITE } else { 1.0 };
    for [_, rgb @ ..] in &mut color {
        *rgb = brighter(*rgb, exposure, white);
    }
    (opacity, color)
}

/// A colour times the exposure; the share `white` of what is beyond 1 is white, in the same hue.
fn brighter(rgb: [f64; 3], exposure: f64, white: f64) -> [f64; 3] {
    let bright = rgb.map(|share| share * exposure);
    let most = bright.iter().fold(1.0, |most: f64, &share| most.max(share));
    let mixed = white * (1.0 - 1.0 / most);
    bright.map(|share| ((1.0 - mixed) * share / most + mixed).clamp(0.0, 1.0))
}

/// Nodes, with others between them so that each segment has [`N_PARTS`]; steps stay steps.
fn divided<const N: usize>(nodes: &[[f64; N]]) -> Vec<[f64; N]> {
    let mut found = Vec::with_capacity(nodes.len() * N_PARTS);
    for pair in nodes.windows(2) {
        let n_parts = if pair[0][0] == pair[1][0] { 1 } else { N_PARTS };
        found.extend((0..n_parts).map(|k| {
            let part = k as f64 / N_PARTS as f64;
            std::array::from_fn(|c| pair[0][c] + part * (pair[1][c] - pair[0][c]))
        }));
    }
    found.extend(nodes.last());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPACITY: [OpacityRow; 2] = [[0.0, 0.0], [10.0, 0.5]];
    const COLOR: [ColorRow; 2] = [[0.0, 0.0, 0.0, 0.0], [10.0, 0.4, 0.8, 0.0]];

    #[test]
    fn a_window_moves_nodes_to_the_same_places() {
        let window = window_of(&OPACITY, &COLOR).unwrap();
        assert_eq!(in_window(&OPACITY, window, (20.0, 40.0)), [[20.0, 0.0], [40.0, 0.5]]);
        assert_eq!(gradients_in_window(&[[3.0, 0.5]], window, (20.0, 40.0)), [[6.0, 0.5]]);
        assert_eq!(window_of(&[[1.0, 0.0]], &[[1.0, 0.0, 0.0, 0.0]]), None);
    }

    #[test]
    fn gamma_gives_a_value_the_colour_of_another_place() {
        let nodes = bent(&COLOR, (0.0, 10.0), 2.0);
        // Half of the colour is at the place whose square is one half.
        assert!((nodes[4][0] - 10.0 * 0.5_f64.sqrt()).abs() < 1e-12 && nodes[4][2] == 0.4);
    }

    #[test]
    fn twice_the_exposure_is_twice_the_extinction_and_colours_keep_their_hue() {
        let (opacity, color) = exposed(&OPACITY, &COLOR, 2.0, false, false);
        assert!((opacity[8][1] - 0.75).abs() < 1e-12);
        assert_eq!(color[4][1..], [0.4, 0.8, 0.0]);
        let [_, rgb @ ..] = color[8];
        assert!((rgb[1] - 1.0).abs() < 1e-12 && rgb[2] > 0.3 && rgb[0] > rgb[2]);
        assert_eq!(exposed(&OPACITY, &COLOR, 2.0, false, true).0, OPACITY);
    }
}
