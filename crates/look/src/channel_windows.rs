//! Windows of fluorescence channels: values that are clear, and that have the full light.
//!
//! The window is the file's where somebody chose it and samples lie in it, else percentiles of the samples. The red, green
//! and blue of a colour picture have one window, all that their type can hold.

use crate::channel_colors::{ChannelFacts, color_of};
use crate::channel_ramp::{LUMINANCE, lightened, ramp};
use crate::colors::Rgb;
use crate::scans::CurveNodes;
use crate::statistics::{median, percentiles, share};
use crate::words::in_digits;

/// Upper ends of windows that span the values of a type, or of a camera: writers put them where they know no window.
const BITS_OF_RANGES: [i32; 9] = [8, 10, 11, 12, 13, 14, 15, 16, 32];
/// Largest ratio of the distances of the 90th and 10th percentiles to the median where nearly all is noise (noise: 1;
/// spots in it: 1.4; nuclei 1.75 to 2.2; cells 3.2), and deviations above the median up to which noise is clear.
const MOSTLY_NOISE: f64 = 1.6;
const NOISE: f64 = 4.0;
/// Part of a file's window that is nearly clear, least share of the samples beyond it, and largest share beyond the end.
const DARK_PART: f64 = 0.3;
const MIN_SHARE: f64 = 3e-4;
const MAX_SHARE: f64 = 0.3;
/// Largest difference of values that are equal but for rounding.
pub(crate) const ROUNDING: f64 = 1e-6;
/// Colour of fluorescence whose file has none: green, as GFP has it, white where it is brightest.
const GREEN: Rgb = [0.35, 1.0, 0.45];
/// Largest luminance of the full colour of fluorescence, so that white and yellow have room for what is brighter, and the
/// share of white in the colour of the highest values.
const MAX_LUMINANCE: f64 = 0.75;
const WHITE: f64 = 0.5;

/// The channel of a volume, as its file describes it.
#[derive(Clone, Debug, Default)]
pub struct VolumeChannel<'a> {
    /// The channel of the samples.
    pub own: Option<ChannelFacts<'a>>,
    /// All channels of the file.
    pub all: Vec<ChannelFacts<'a>>,
    /// Values that the file wants shown in black and in the full colour.
    pub window: Option<(f64, f64)>,
    /// Whether samples are the red, green or blue of a colour picture.
    pub is_part_of_color: bool,
    /// The largest whole number that the type of the samples can hold; `None` of other types.
    pub largest_of_type: Option<f64>,
}

/// Values of a channel that are clear and that have the full light, and the source of them.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelWindow {
    /// The value up to which nothing shows.
    pub low: f64,
    /// The value of the full light.
    pub high: f64,
    /// The source, in words that follow the window.
    pub note: String,
}

impl VolumeChannel<'_> {
    /// The window of a channel. `largest`: of the volume. `values`: finite ones, without padding.
    pub fn window(&self, largest: f64, values: impl FnOnce() -> Vec<f64>) -> ChannelWindow {
        if self.is_part_of_color {
            let high = self.highest(largest);
            return ChannelWindow { low: 0.0, high, note: ", all that its colours can hold".to_owned() };
        }
        let values = values();
        let (low, high) = window_of_values(&values);
        let given = |note: String| ChannelWindow { low, high, note };
        let Some(window) = self.window.filter(|&window| !is_whole_range(window, largest)) else {
            return given(", by the values".to_owned());
        };
        if let Some(problem) = problem_of(window, &values) {
            let [first, last] = [window.0, window.1].map(|value| in_digits(value, 6));
            return given(format!(", by the values, since of the file's window, {first} to {last}, {problem}"));
        }
        ChannelWindow { low: window.0, high: window.1, note: ", as the file says".to_owned() }
    }

    /// The value of a full red, green or blue: the file's, else the largest of the type, or of fractions 1.
    fn highest(&self, largest: f64) -> f64 {
        if let Some(high) = self.window.map(|(_, high)| high).or(self.largest_of_type) {
            return high;
        }
        let ends = [1.0, 255.0, 65535.0];
        ends.into_iter().find(|end| largest <= end * (1.0 + ROUNDING)).unwrap_or(largest)
    }

    /// Light in the colour of the channel, or in another one: nothing is shaded.
    ///
    /// `values`: finite ones, without padding. `n_voxels`: voxels of the highest values that are opaque together.
    pub fn light(&self, largest: f64, values: &[f64], n_voxels: f64, wanted: Option<Rgb>) -> CurveNodes {
        let ChannelWindow { low, high, .. } = self.window(largest, || values.to_vec());
        let own = || self.own.as_ref().and_then(|own| color_of(own, &self.all));
        let color = lightened(wanted.or_else(own).unwrap_or(GREEN));
        let luminance: f64 = color.iter().zip(LUMINANCE).map(|(share, weight)| share * weight).sum();
        let color = color.map(|share| f64::min(1.0, MAX_LUMINANCE / luminance) * share);
        // Windows of files often begin below the background, which in space is fog.
        let (opacity, color) = ramp(color, low, high, n_voxels, Some(clear_of_values(values)), WHITE);
        CurveNodes { opacity, color: color.to_vec() }
    }
}

/// Whether a window spans all possible values, so that nobody chose it. `largest`: of the volume.
pub fn is_whole_range((low, high): (f64, f64), largest: f64) -> bool {
    low == 0.0 && BITS_OF_RANGES.iter().any(|&n| high == f64::from(n).exp2() - 1.0) && largest <= high
}

/// Why a file's window cannot show samples; `None` where it can.
fn problem_of((low, high): (f64, f64), values: &[f64]) -> Option<String> {
    if share(values, |value| value > low + DARK_PART * (high - low)) < MIN_SHARE {
        return Some(format!("only the lowest {} % is used", in_digits(100.0 * DARK_PART, 6)));
    }
    let is_beyond = share(values, |value| value >= high) > MAX_SHARE;
    is_beyond.then(|| format!("more than {} % of the samples are beyond the end", in_digits(100.0 * MAX_SHARE, 6)))
}

/// A window from just above the background (median plus deviation) to the value that few samples exceed.
pub fn window_of_values(values: &[f64]) -> (f64, f64) {
    let [background, highest @ ..] = percentiles(values, [50.0, 99.7, 99.9, 99.97]);
    let distances: Vec<f64> = values.iter().map(|value| (value - background).abs()).collect();
    let spread = 1.4826 * median(&distances);
    // Spots may be too small for the first percentile, and in a dense channel it may be close to the background.
    let is_far = |(one, n): &(f64, f64)| *one > background && *one >= background + n * spread;
    let far = highest.into_iter().zip([4.0, 6.0, 0.0]).find(is_far);
    let high = far.map_or(highest[2], |(one, _)| one);
    let low = (background + spread).min(background + 0.25 * (high - background));
    (low, if high > low { high } else { low + (1e-6 * low.abs()).max(1e-6) })
}

/// The value up to which a channel is clear in space: the low end of its window, and noise that is nearly all of it.
///
/// Noise that reaches over the end is a haze, which a few bright things stand in.
fn clear_of_values(values: &[f64]) -> f64 {
    let (low, high) = window_of_values(values);
    let [lower, middle, upper] = percentiles(values, [10.0, 50.0, 90.0]);
    if upper - middle > MOSTLY_NOISE * (middle - lower) {
        return low;
    }
    let distances: Vec<f64> = values.iter().map(|value| (value - middle).abs()).collect();
    let deviation = 1.4826 * median(&distances);
    low.max((middle + NOISE * deviation).min(0.5 * (middle + high)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values() -> Vec<f64> {
        (0..10_000).map(|k| if k % 100 == 0 { 500.0 } else { 100.0 + f64::from(k % 11) }).collect()
    }

    #[test]
    fn windows_of_files_count_where_they_show_samples() {
        let of = |window| VolumeChannel { window: Some(window), ..VolumeChannel::default() }.window(500.0, values);
        assert_eq!((of((90.0, 400.0)).low, of((90.0, 400.0)).note), (90.0, ", as the file says".to_owned()));
        assert_eq!(of((0.0, 65535.0)).note, ", by the values");
        assert!(of((0.0, 9000.0)).note.ends_with("window, 0 to 9000, only the lowest 30 % is used"));
        assert!(of((0.0, 50.0)).note.ends_with("more than 30 % of the samples are beyond the end"));
    }

    #[test]
    fn parts_of_a_picture_have_one_window() {
        let part = VolumeChannel { is_part_of_color: true, ..VolumeChannel::default() };
        let high = |largest| part.window(largest, Vec::new).high;
        assert_eq!([high(0.7), high(200.0), high(1e6)], [1.0, 255.0, 1e6]);
    }

    #[test]
    fn light_has_the_colour_of_the_channel_or_green() {
        let light = VolumeChannel::default().light(500.0, &values(), 3.0, None);
        let full = light.color[1].rgb;
        assert!(full[1] > full[0] && full[1] > full[2] && light.opacity[0].opacity == 0.0, "{light:?}");
        let red = VolumeChannel::default().light(500.0, &values(), 3.0, Some([1.0, 0.0, 0.0]));
        assert!(red.color[1].rgb[0] > 0.9 && red.color[1].rgb[2] < 0.1);
    }
}
