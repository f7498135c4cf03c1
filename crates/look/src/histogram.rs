//! The range of values that counts, the threshold between background and object, and samples without padding.
//!
//! Otsu's threshold (1979) parts the background (air, empty field) from the object: it maximises the variance between
//! the two classes. It is taken on the square roots, so that a few very bright spots (tracer in a bladder, vessels) do
//! not become the object and everything else its background. Percentiles stand in for smallest and largest so that a
//! hot pixel or a metal implant cannot flatten the curves.

use crate::numbers::linspace;
use crate::statistics::{deviation, distinct, extremes, histogram, mean, percentiles, sum, those};

/// Number of bins of the histogram.
pub const N_BINS: usize = 512;
/// Percentiles that count as the smallest and largest value.
pub const ROBUST: [f64; 2] = [0.1, 99.9];
/// Padding around what was scanned: least share of the samples of one value.
const MIN_PADDING: f64 = 0.1;
/// Air in padding: least distance of the means of air and object, in the sum of their deviations. (Grey and white
/// matter: 1.5; speckle: 2.4.)
const MIN_APART: f64 = 2.5;

/// The range of finite values that counts: the 0.1 and 99.9 percentiles, or the extremes if those are equal.
pub fn robust_range(values: &[f64]) -> (f64, f64) {
    let [low, high] = percentiles(values, ROBUST);
    if low < high { (low, high) } else { extremes(values) }
}

/// Otsu's threshold: it parts the values into the classes with the largest variance between their square roots.
///
/// `low`, `high`: values that count as smallest and largest.
pub fn otsu(values: &[f64], low: f64, high: f64) -> f64 {
    let roots: Vec<f64> = values.iter().map(|value| ((value - low) / (high - low)).clamp(0.0, 1.0).sqrt()).collect();
    let edges = linspace(0.0, 1.0, N_BINS + 1);
    let counts = histogram(&roots, N_BINS, 0.0, 1.0);
    let weights: Vec<f64> =
        counts.iter().zip(edges.windows(2)).map(|(&n, ends)| n as f64 * f64::midpoint(ends[0], ends[1])).collect();
    let whole = sum(&weights);
    let (mut n_below, mut sum_below) = (0, 0.0);
    let mut between = [0.0; N_BINS - 1];
    for (bin, between) in between.iter_mut().enumerate() {
        n_below += counts[bin];
        sum_below += weights[bin];
        let n_above = values.len() - n_below;
        let apart = sum_below / n_below as f64 - (whole - sum_below) / n_above as f64;
        let variance = (n_below * n_above) as f64 * (apart * apart);
        *between = if variance.is_nan() { 0.0 } else { variance };
    }
    // An empty gap between the classes makes a plateau; its middle is the steadiest choice.
    let least = between.iter().copied().fold(0.0, f64::max) * (1.0 - 1e-9);
    let best: Vec<usize> = (0..between.len()).filter(|&bin| between[bin] >= least).collect();
    let edge = edges[1 + best[best.len() / 2]];
    low + edge * edge * (high - low)
}

/// Background, object and largest value of a padded scan, see [`otsu_of_scan`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scan {
    /// Mean of the background; the value that counts as smallest where there is no padding.
    pub background: f64,
    /// Otsu's threshold above the background.
    pub threshold: f64,
    /// The value that counts as largest.
    pub high: f64,
}

/// The mean of the background, Otsu's threshold above it, and the value that counts as largest, of a padded scan.
///
/// Samples outside of a scan may have one value. Such padding would be the background, and the air of the scan the
/// object, so the padding is left out if the rest falls into two classes far apart.
///
/// `low`, `high`: values that count as smallest and largest, padding included. Of a scan that is next to nothing but
/// padding, a bone alone, `high` may lie within the scan: then the scan's own largest value counts.
pub fn otsu_of_scan(values: &[f64], low: f64, high: f64) -> Scan {
    let threshold = otsu(values, low, high);
    let as_a_whole = Scan { background: low, threshold, high };
    let (least, _) = extremes(values);
    let scanned = those(values, |value| value > least);
    let n_padding = values.len() - scanned.len();
    if (n_padding as f64) < MIN_PADDING * values.len() as f64 || scanned.is_empty() {
        return as_a_whole;
    }
    if distinct(&scanned).into_iter().any(|(_, n)| n > n_padding) {
        return as_a_whole;
    }
    let (start, end) = robust_range(&scanned);
    if start >= end {
        return as_a_whole;
    }
    let again = otsu(&scanned, start, end);
    let (air, matter) = (those(&scanned, |value| value <= again), those(&scanned, |value| value > again));
    if again > threshold && !air.is_empty() && !matter.is_empty() {
        let background = mean(&air);
        if mean(&matter) - background > MIN_APART * (deviation(&air) + deviation(&matter)) {
            return Scan { background, threshold: again, high: if high > again { high } else { end } };
        }
    }
    as_a_whole
}

/// Finite samples, x fastest, without the outer planes that have the value of the first corner, or are missing.
///
/// Statistics of them do not depend on how much empty space was put around the data. `shape`: numbers of samples along
/// z, y and x.
pub fn without_padding(samples: &[f64], shape: [usize; 3]) -> Vec<f64> {
    let [n_z, n_y, n_x] = shape;
    let Some(&corner) = samples.first() else { return Vec::new() };
    let is_matter = |value: f64| value.is_finite() && value != corner;
    let mut ends = shape.map(|n| (n, 0));
    for (row, line) in samples.chunks_exact(n_x).enumerate() {
        let Some(first) = line.iter().position(|&value| is_matter(value)) else { continue };
        let last = line.iter().rposition(|&value| is_matter(value)).unwrap_or(first);
        for (end, place) in ends.iter_mut().zip([(row / n_y, row / n_y), (row % n_y, row % n_y), (first, last)]) {
            *end = (end.0.min(place.0), end.1.max(place.1 + 1));
        }
    }
    let [z, y, x] = if ends[0].0 < n_z { ends } else { shape.map(|n| (0, n)) };
    let mut found = Vec::with_capacity((z.1 - z.0) * (y.1 - y.0) * (x.1 - x.0));
    for plane in z.0..z.1 {
        for row in y.0..y.1 {
            let line = &samples[(plane * n_y + row) * n_x..][..n_x];
            found.extend(line[x.0..x.1].iter().copied().filter(|value| value.is_finite()));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_heaps_are_parted_and_padding_is_no_background() {
        let mut values: Vec<f64> = (0..1000).map(|i| f64::from(i % 10)).collect();
        values.extend((0..300).map(|i| 100.0 + f64::from(i % 10)));
        let (low, high) = robust_range(&values);
        let threshold = otsu(&values, low, high);
        assert!((10.0..100.0).contains(&threshold), "{threshold}");
        values.extend([-500.0; 2000]);
        let (low, high) = robust_range(&values);
        let scan = otsu_of_scan(&values, low, high);
        assert_eq!(scan.background, 4.5);
        assert!((10.0..100.0).contains(&scan.threshold), "{scan:?}");
    }

    #[test]
    fn padding_is_cut_off_plane_by_plane() {
        let mut samples = vec![7.0; 4 * 5 * 6];
        let at = |z: usize, y: usize, x: usize| (z * 5 + y) * 6 + x;
        (samples[at(1, 2, 3)], samples[at(2, 2, 5)], samples[at(3, 0, 0)]) = (1.0, 2.0, f64::NAN);
        assert_eq!(without_padding(&samples, [4, 5, 6]), [1.0, 7.0, 7.0, 7.0, 7.0, 2.0]);
        assert_eq!(without_padding(&[3.0; 8], [2, 2, 2]), [3.0; 8]);
    }
}
