//! Colours of things that have none of their own, and conversions between the spaces that colours are given in.

/// Red, green and blue, 0..1, in sRGB.
pub type Rgb = [f64; 3];

/// Golden section of the circle of hues, and where the first colour is on it.
const GOLDEN_SECTION: f64 = 0.618_033_988_75;
const FIRST_HUE: f64 = 0.05;

/// The colour of a label by its place among others.
///
/// Steps of a golden section leave no large gap in the circle of hues after any number of labels, and a colour does not
/// depend on how many labels there are.
pub fn label_color(place: i64) -> Rgb {
    let hue = (FIRST_HUE + place as f64 * GOLDEN_SECTION).rem_euclid(1.0);
    let (lightness, saturation) = if place % 2 == 0 { (0.55, 0.65) } else { (0.68, 0.5) };
    rgb_from_hls(hue, lightness, saturation)
}

/// A colour by hue, lightness and saturation, all 0..1.
pub fn rgb_from_hls(hue: f64, lightness: f64, saturation: f64) -> Rgb {
    let most =
        if lightness <= 0.5 { lightness * (1.0 + saturation) } else { lightness + saturation - lightness * saturation };
    let least = 2.0 * lightness - most;
    [hue + 1.0 / 3.0, hue, hue - 1.0 / 3.0].map(|hue| {
        let hue = hue.rem_euclid(1.0);
        if hue < 1.0 / 6.0 {
            least + (most - least) * hue * 6.0
        } else if hue < 0.5 {
            most
        } else if hue < 2.0 / 3.0 {
            least + (most - least) * (2.0 / 3.0 - hue) * 6.0
        } else {
            least
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pure_hues_are_the_corners_of_the_cube() {
        let found = [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|hue| rgb_from_hls(hue, 0.5, 1.0));
        assert_eq!(found, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(rgb_from_hls(0.3, 0.4, 0.0), [0.4; 3]);
    }

    #[test]
    fn the_first_hundred_labels_differ() {
        let colors: Vec<Rgb> = (0..100).map(label_color).collect();
        for (k, a) in colors.iter().enumerate() {
            assert!(a.iter().all(|share| (0.0..=1.0).contains(share)));
            assert!(colors[..k].iter().all(|b| a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum::<f64>() > 0.01));
        }
    }
}
