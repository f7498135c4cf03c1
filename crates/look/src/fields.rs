//! Curves of fields: values, opacities, and which end of the values is shown.
//!
//! What few samples have is seen, and most of the box is clear: a field fills its box, and the box would be a wall. Where
//! samples are missing, the rest is an object, whose shape is seen: more of it is seen, and none of it is clear.
//! Values stand in a logarithm where a few are far larger than the others. Of a field whose values reach much further
//! down than up the low ones are seen; of one with two signs, both ends are.

use crate::colormaps::shades;
use crate::colors::Rgb;
use crate::numbers::{interpolated, linspace};
use crate::scans::CurveNodes;
use crate::statistics::{extremes, is_whole, median, percentile, percentiles, share, those};
use crate::voxels::{opacity_of_voxel, rising};

/// Voxels of a field that are opaque together, as a multiple of those of a channel: a field fills its box. With two signs
/// fewer voxels have the values of an end.
const FIELD_DEPTH: f64 = 3.0;
const SIGNED_DEPTH: f64 = 1.5;
/// Share of the samples that is seen of a field, and of one with two signs of each sign.
const SEEN: f64 = 0.3;
const SEEN_SIGNED: f64 = 0.2;
/// Heavy tails: least ratio of the 99.9th percentile to the median; of magnitudes with a sign, of the 99.5th to the 95th.
/// (Normal noise: 1.4; its exponential: 3; the exponential of twice its size: 6; Cauchy's distribution: 10.)
const HEAVY: f64 = 8.0;
const HEAVY_SIGNED: f64 = 5.0;
/// Part of the largest value at which a logarithmic scale begins at the lowest: six decades. Share of values below 0, at
/// most, which solvers leave of densities; and the largest byte, since bytes were scaled by somebody who saw them.
const LEAST_PART: f64 = 1e-6;
const MAX_NEGATIVE: f64 = 0.02;
const MAX_BYTE: f64 = 255.0;
/// Nodes of colours, and of those with two signs, which are even on both sides of 0.
const N_NODES: usize = 17;
const N_SIGNED: usize = 33;
/// Low values stand out: least ratio of the lower part of the range to the upper one. A background in the middle: the
/// largest share of the range that half of the samples have.
const MIN_LOW: f64 = 3.0;
const MAX_INNER: f64 = 0.1;
/// A phase of one value at the range's end: the least ratio of its values to the end, either way, and its least part of
/// the samples beyond half of the end. (Drops with soft borders: 0.64 to 0.7; tails of exponentials of normal noise, and
/// a Gaussian blob: 0.24 to 0.28.)
const PLATEAU: f64 = 0.8;
const MIN_PHASE: f64 = 0.5;
/// Place up to which a field is clear at most: what begins beyond it is a phase, and is seen from half way to it.
const MAX_CLEAR: f64 = 0.9;
/// A background of about one value: the largest distance of values that are the same, as a share of the range, and the
/// largest share of the other samples.
const SAME_VALUE: f64 = 0.01;
const MAX_MATTER: f64 = 0.1;
/// Least place of what is seen beyond 0, and beyond a background in the middle, as a share of the way to the end.
const MIN_SIGNED: f64 = 0.12;
/// The map that fields are shown in, and where it begins: its dark end cannot be seen on black.
pub(crate) const FIELD_MAP: &str = "inferno";
const FIELD_START: f64 = 0.4;
/// Places, 0..1, and colours of values below and above zero: strong at the ends, none paler than is seen on white or
/// darker than is seen on black.
const SIGN_PLACES: [f64; 5] = [0.0, 0.35, 0.5, 0.65, 1.0];
const SIGN_COLORS: [Rgb; 5] =
    [[0.20, 0.48, 1.00], [0.46, 0.67, 0.95], [0.70, 0.70, 0.70], [0.95, 0.63, 0.46], [1.00, 0.34, 0.20]];
/// Largest share of finite samples in the box for which they are taken for an object surrounded by missing samples, and
/// the opacity of a ray through such an object at its common values.
const MAX_OBJECT: f64 = 0.9;
const VEIL: f64 = 0.4;

/// The part of a volume's box that has samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilledPart {
    /// Share of the box.
    pub share: f64,
    /// Least opacity of a voxel of it.
    pub veil: f64,
}

impl FilledPart {
    /// The part with finite samples; if many are missing, the others are an object whose shape is shown.
    ///
    /// `samples`: x fastest, spread over the volume. `shape`: their numbers along z, y and x. `n_planes`: of the volume.
    pub fn of(samples: &[f64], shape: [usize; 3], n_planes: usize) -> Self {
        let [n_z, n_y, n_x] = shape;
        let share = share(samples, f64::is_finite);
        if !(0.0 < share && share < MAX_OBJECT) {
            return Self { share: share.max(1e-6), veil: 0.0 };
        }
        let mut along = [vec![0.0; n_y * n_x], vec![0.0; n_z * n_x], vec![0.0; n_z * n_y]];
        for (place, _) in samples.iter().enumerate().filter(|(_, value)| value.is_finite()) {
            let (z, y, x) = (place / (n_y * n_x), place / n_x % n_y, place % n_x);
            along[0][y * n_x + x] += 1.0;
            along[1][z * n_x + x] += 1.0;
            along[2][z * n_y + y] += 1.0;
        }
        let thickness = n_planes as f64 / n_z as f64 * median(&those(&along.concat(), |n| n > 0.0));
        Self { share, veil: opacity_of_voxel(VEIL, thickness) }
    }

    /// The share of the samples that is seen where a share of the box is.
    fn seen(&self, share: f64) -> f64 {
        f64::min(1.0, share / self.share)
    }
}

impl CurveNodes {
    /// A field of one sign in a perceptual colour map, bright where few samples are: the end that fewer have is opaque.
    ///
    /// `fill`: the value of samples without data, which are clear. `n_voxels`: voxels of light that are opaque together.
    pub fn of_field(values: &[f64], fill: Option<f64>, n_voxels: f64, part: FilledPart) -> Self {
        let with_data = fill.map(|fill| those(values, |value| value > fill));
        let (n, values) = (values.len(), with_data.as_deref().unwrap_or(values));
        let part = FilledPart { share: part.share * values.len() as f64 / n as f64, ..part };
        let middle = median(values);
        let places = linspace(0.0, 1.0, N_NODES);
        let nodes = values_at(&places, values, middle);
        let (below, above) = (middle - nodes[0], nodes[N_NODES - 1] - middle);
        let [lower, upper] = percentiles(values, [25.0, 75.0]);
        let shows_low = below > MIN_LOW * above;
        // A background in the middle, such as a pressure's: both what is below it and what is above it is seen.
        let shows_both = upper - lower < MAX_INNER * (below + above) && MIN_LOW * below.min(above) > below.max(above);
        let few = 100.0 * part.seen(SEEN) / if shows_both { 2.0 } else { 1.0 };
        let from_high: Vec<f64> = places.iter().map(|place| 1.0 - place).collect();
        let mut opacity = vec![0.0; N_NODES];
        for (is_shown, risen, few) in [(shows_low, &from_high, few), (!shows_low, &places, 100.0 - few)] {
            if is_shown || shows_both {
                let mut clear = interpolated(percentile(values, few), &nodes, risen);
                if clear > MAX_CLEAR {
                    clear = 0.5;
                }
                if shows_both {
                    let background = interpolated(middle, &nodes, risen);
                    clear = clear.max(background + MIN_SIGNED * (1.0 - background));
                }
                for (opacity, &place) in opacity.iter_mut().zip(risen) {
                    *opacity += rising(beyond(place, clear, 1.0), FIELD_DEPTH * n_voxels);
                }
            }
        }
        let mut colors = shades(FIELD_MAP, FIELD_START, N_NODES);
        if shows_low {
            colors.reverse();
        }
        let curve = nodes.iter().copied().zip(opacity.into_iter().map(|alpha| alpha.max(part.veil)));
        let mut found = Self::new(curve, nodes.iter().copied().zip(colors));
        if let Some(fill) = fill.filter(|_| found.opacity[0].opacity > 0.0) {
            // Samples without data are clear, although the lowest values, which are close to them, are visible.
            let (least, _) = extremes(values);
            let edge = [(least - 0.5 * (least - fill), 0.0), (least, found.opacity[0].opacity)];
            let others = found.opacity.iter().filter(|node| node.value > least).map(|node| (node.value, node.opacity));
            found.opacity = Self::new(edge.into_iter().chain(others), []).opacity;
        }
        found
    }

    /// A field with two signs in blue below zero and red above, as long below 0 as above it; of each sign some is seen.
    pub fn of_signed_field(values: &[f64], n_voxels: f64, part: FilledPart) -> Self {
        let sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
        let [limit, upper] = percentiles(&sizes, [99.5, 95.0]);
        let limit = if limit == 0.0 { extremes(&sizes).1 } else { limit };
        let places = linspace(-1.0, 1.0, N_SIGNED);
        let nodes: Vec<f64> = if limit > HEAVY_SIGNED * upper {
            // Linear up to the median: symmetric logarithms.
            let linear = f64::max(median(&those(&sizes, |size| size > 0.0)), limit * LEAST_PART);
            let scale = (limit / linear).ln_1p();
            places.iter().map(|place| linear * sign(*place) * (place.abs() * scale).exp_m1()).collect()
        } else {
            places.iter().map(|place| limit * place).collect()
        };
        let mut opacity = vec![0.0; N_SIGNED];
        for side in [-1.0, 1.0] {
            let own: Vec<f64> = values.iter().map(|value| side * value).collect();
            let ends = percentiles(&own, [100.0 * (1.0 - part.seen(SEEN_SIGNED)), 99.95]);
            let mut steps: Vec<(f64, f64)> = nodes.iter().zip(&places).map(|(v, p)| (side * v, side * p)).collect();
            steps.retain(|&(_, place)| place > 0.0);
            if side < 0.0 {
                steps.reverse();
            }
            let (away, risen): (Vec<f64>, Vec<f64>) = steps.into_iter().unzip();
            let [few, most] = ends.map(|end| interpolated(end, &away, &risen));
            // Each sign is seen to its own end, so that the weaker one is not lost beside the stronger one.
            if most > MIN_SIGNED {
                let clear = MIN_SIGNED.max(few).min(0.8 * most);
                for (opacity, place) in opacity.iter_mut().zip(&places) {
                    *opacity += rising(beyond(side * place, clear, most), SIGNED_DEPTH * n_voxels);
                }
            }
        }
        let alpha = |(&place, alpha): (&f64, f64)| if place == 0.0 { 0.0 } else { alpha.max(part.veil) };
        let opacity = places.iter().zip(opacity).map(alpha);
        let color = |place: &f64| {
            let place = (place + 1.0) / 2.0;
            std::array::from_fn(|c| interpolated(place, &SIGN_PLACES, &SIGN_COLORS.map(|rgb| rgb[c])))
        };
        Self::new(nodes.iter().copied().zip(opacity), nodes.iter().copied().zip(places.iter().map(color)))
    }
}

/// -1, 0 or 1.
fn sign(place: f64) -> f64 {
    if place == 0.0 { 0.0 } else { place.signum() }
}

/// Values at places of a window, 0..1: even ones, or even in the logarithm where a few are far larger than most.
fn values_at(places: &[f64], values: &[f64], middle: f64) -> Vec<f64> {
    let high = percentile(values, 99.9);
    // Below a median of 0 nothing is few, and a phase of one value, such as drops in a gas, is no tail.
    if let Some(least) = least_of_logarithm(values).filter(|_| high > HEAVY * middle && middle > 0.0) {
        let plateau = share(values, |value| value > PLATEAU * high && value < high / PLATEAU);
        if plateau < MIN_PHASE * share(values, |value| value > 0.5 * high) {
            return places.iter().map(|&place| least * (high / least).powf(place)).collect();
        }
    }
    let [low, upper] = percentiles(&matter(values, middle), [1.0, 99.0]);
    let (low, upper) = (low.min(middle), upper.max(middle));
    let (low, upper) = if low < upper { (low, upper) } else { extremes(values) };
    places.iter().map(|place| low + (upper - low) * place).collect()
}

/// Values without a background of about one value, where nearly all samples are background; else all of them.
fn matter(values: &[f64], middle: f64) -> Vec<f64> {
    let [low, high] = percentiles(values, [0.1, 99.9]);
    let others = those(values, |value| (value - middle).abs() > SAME_VALUE * (high - low));
    let are_few = !others.is_empty() && (others.len() as f64) < MAX_MATTER * values.len() as f64;
    if are_few { others } else { values.to_vec() }
}

/// The share of the way from the place up to which all is clear to that of the end, 0..1.
fn beyond(place: f64, clear: f64, end: f64) -> f64 {
    ((place - clear) / f64::max(end - clear, 1e-3)).clamp(0.0, 1.0)
}

/// The value at which a logarithmic scale of mostly positive samples begins; `None` where they have none.
fn least_of_logarithm(values: &[f64]) -> Option<f64> {
    let positive = those(values, |value| value > 0.0);
    let is_of_bytes = extremes(values).1 <= MAX_BYTE && values.iter().copied().all(is_whole);
    if 2 * positive.len() < values.len() || share(values, |value| value < 0.0) > MAX_NEGATIVE || is_of_bytes {
        return None;
    }
    Some(f64::max(percentile(&positive, 5.0), percentile(values, 99.9) * LEAST_PART))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: FilledPart = FilledPart { share: 1.0, veil: 0.0 };

    #[test]
    fn few_samples_are_seen_and_long_tails_are_logarithms() {
        let values: Vec<f64> = (1..=1000).map(|k| (f64::from(k) / 100.0).exp()).collect();
        let found = CurveNodes::of_field(&values, None, 3.0, WHOLE);
        let ratios: Vec<f64> = found.opacity.windows(2).map(|pair| pair[1].value / pair[0].value).collect();
        assert!(ratios.iter().all(|ratio| (ratio / ratios[0] - 1.0).abs() < 1e-9), "{ratios:?}");
        let clear = found.opacity.iter().filter(|node| node.opacity == 0.0).count();
        assert!((9..15).contains(&clear) && found.opacity[16].opacity > 0.4, "{found:?}");
        // A field that reaches further down than up shows its low values, in the bright end of the map.
        let low: Vec<f64> = values.iter().map(|value| -value).collect();
        let found = CurveNodes::of_field(&low, None, 3.0, WHOLE);
        assert!(found.opacity[0].opacity > 0.4 && found.color[0].rgb[1] > found.color[16].rgb[1]);
    }

    #[test]
    fn signs_are_as_long_as_each_other_and_0_is_clear() {
        let values: Vec<f64> = (-500..=1000).map(f64::from).collect();
        let found = CurveNodes::of_signed_field(&values, 3.0, FilledPart { share: 0.5, veil: 0.01 });
        assert_eq!(found.opacity[0].value, -found.opacity[32].value);
        assert_eq!((found.opacity[16].opacity, found.opacity[17].opacity), (0.0, 0.01));
        assert!(found.color[0].rgb[2] > 0.9 && found.color[32].rgb[0] > 0.9);
    }

    #[test]
    fn an_object_among_missing_samples_has_a_veil() {
        let samples: Vec<f64> = (0..1000).map(|k| if k % 10 < 3 { 1.0 } else { f64::NAN }).collect();
        let part = FilledPart::of(&samples, [10, 10, 10], 20);
        // Most lines through it are rows of 3 samples, which are twice as far apart.
        assert_eq!((part.share, part.veil), (0.3, opacity_of_voxel(VEIL, 6.0)));
        assert_eq!(FilledPart::of(&[1.0; 8], [2; 3], 2), WHOLE);
    }
}
