//! Light of fluorescence channels over a window of values: of its own, in one colour, opaque where it is bright.
//!
//! Opacity is that of a voxel ([`voxels`](crate::voxels)), so that light belongs to the matter, not to its box.

use wavesplat_core::{ColorNode, OpacityNode};

use crate::colors::Rgb;
use crate::voxels::{opacity_of_share, rising};

/// Share of a colour at the low end of a window, where matter is nearly clear, and the place of the full colour.
pub const DARKEST: f64 = 0.2;
/// Place of the full colour in the window, 0..1; beyond it white is mixed in.
pub const FULL_COLOR: f64 = 0.65;
/// Share of white in the colour of the highest values.
pub const WHITE: f64 = 0.35;
/// Least luminance (Rec. 709) of a colour at the end of the window; a pure blue has 0.07 and is lost on black.
const MIN_LUMINANCE: f64 = 0.2;
/// Luminance of red, green and blue (Rec. 709).
pub const LUMINANCE: Rgb = [0.2126, 0.7152, 0.0722];
/// Places of the nodes of opacity in the window: closest where its square bends most against a straight line.
const PLACES: [f64; 14] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
/// Values 0..1 at which the opacity of red, green or blue has nodes, and the value below which it is noise in black.
const PLACES_OF_PARTS: [f64; 12] = [0.0, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0];
const NOISE_OF_BLACK: f64 = 0.03;

/// Opacities and colours over a window.
pub type Ramp = (Vec<OpacityNode>, [ColorNode; 3]);

/// A ramp of light in one colour from `low` to `high`: brightness rises with the value, opacity with its square.
///
/// `n_voxels`: voxels of the highest values that are opaque together. `clear`: value up to which nothing shows, `low` if
/// `None`. `white`: share of white in the colour of the highest values.
pub fn ramp(color: Rgb, low: f64, high: f64, n_voxels: f64, clear: Option<f64>, white: f64) -> Ramp {
    let middle = low + FULL_COLOR * (high - low);
    let first = clear.map_or(low, |clear| low.max(clear).min(middle));
    let opacity = PLACES.map(|t| OpacityNode { value: first + t * (high - first), opacity: rising(t, n_voxels) });
    let color = [
        ColorNode { value: low, rgb: color.map(|share| DARKEST * share) },
        ColorNode { value: middle, rgb: color },
        ColorNode { value: high, rgb: color.map(|share| share + white * (1.0 - share)) },
    ];
    (opacity.to_vec(), color)
}

/// A ramp of the red, green or blue of a picture: its light, extinction times colour, is in proportion to the value.
///
/// So light of all three adds up to the hue that is stored. Noise of black is clear.
pub fn ramp_of_part(color: Rgb, low: f64, high: f64, n_voxels: f64) -> Ramp {
    let node = |t: f64| {
        let share = DARKEST + (1.0 - DARKEST) * (t / FULL_COLOR).min(1.0);
        let depth = if t > NOISE_OF_BLACK { t / share } else { 0.0 };
        OpacityNode { value: low + t * (high - low), opacity: opacity_of_share(depth, n_voxels) }
    };
    (PLACES_OF_PARTS.map(node).to_vec(), ramp(color, low, high, n_voxels, None, 0.0).1)
}

/// The colour mixed with just enough white to be seen on black.
pub fn lightened(color: Rgb) -> Rgb {
    let luminance: f64 = color.iter().zip(LUMINANCE).map(|(share, weight)| share * weight).sum();
    let white = if luminance < 1.0 { ((MIN_LUMINANCE - luminance) / (1.0 - luminance)).max(0.0) } else { 0.0 };
    color.map(|share| share + white * (1.0 - share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_of_a_part_of_a_picture_is_in_proportion_to_its_value() {
        let (opacity, color) = ramp_of_part([1.0, 0.0, 0.0], 0.0, 1.0, 3.0);
        // Extinction times colour at two values of which one is half of the other.
        let light = |k: usize| -(-opacity[k].opacity).ln_1p() * (color[0].rgb[0] + 0.8 * (opacity[k].value / 0.65));
        assert!((light(5) / light(3) - 2.0).abs() < 1e-9, "{} {}", light(5), light(3));
        assert_eq!([opacity[0].opacity, opacity[1].opacity], [0.0; 2]);
    }

    #[test]
    fn a_blue_is_lightened_and_a_green_stays() {
        let blue = lightened([0.0, 0.0, 1.0]);
        let luminance: f64 = blue.iter().zip(LUMINANCE).map(|(a, b)| a * b).sum();
        assert!((luminance - MIN_LUMINANCE).abs() < 1e-12 && blue[2] == 1.0);
        assert_eq!(lightened([0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn nothing_shows_up_to_the_clear_value() {
        let (opacity, color) = ramp([0.0, 1.0, 0.0], 10.0, 110.0, 3.0, Some(40.0), WHITE);
        assert_eq!((opacity[0].value, opacity[0].opacity, color[0].value), (40.0, 0.0, 10.0));
        assert_eq!(color[2].rgb, [0.35, 1.0, 0.35]);
    }
}
