//! The samples that decide the kind of data, with their neighbours, and what they say about noise.

use crate::facts::KindFacts;
use crate::statistics::{commonest, distinct, extremes, median, share, sum, those};

/// Samples at most for histograms, percentiles and cameras: enough for steady percentiles, and a fraction of a second on
/// any volume.
pub const HISTOGRAM_SAMPLES: usize = 2_000_000;
/// The same for the kind of data, each with its neighbours along the axes.
pub const KIND_SAMPLES: usize = 150_000;
/// The same for the unit of the values, which every picture needs.
pub const UNIT_SAMPLES: usize = 20_000;
/// Least number of finite samples among those spread evenly; where a volume has fewer, more are looked at.
pub const MIN_FINITE: usize = 10_000;

/// The step from one sample to the next along each axis that leaves about `most` of them.
pub fn step_for(n_samples: usize, most: usize) -> usize {
    ((n_samples as f64 / most as f64).powf(1.0 / 3.0).ceil() as usize).max(1)
}

/// The two neighbours of samples along an axis, as many of each as there are samples.
pub type SidePair<'a> = (&'a [f64], &'a [f64]);

/// Samples spread over a volume, and their neighbours along each axis that has any; those not finite are missing.
#[derive(Clone, Debug, Default)]
pub struct Neighbourhood<'a> {
    /// The samples.
    pub samples: &'a [f64],
    /// Their neighbours.
    pub pairs: Vec<SidePair<'a>>,
}

/// The finite samples that were looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SeenSamples {
    /// Their values.
    pub values: Vec<f64>,
    /// Magnitudes of the differences of neighbours, sample units per voxel, at `values`.
    pub gradients: Vec<f64>,
}

impl SeenSamples {
    /// The finite samples of a neighbourhood, with the extremes of the volume where they do not differ.
    pub fn in_samples(around: &Neighbourhood<'_>, facts: &KindFacts<'_>) -> Self {
        let mut gradients = vec![0.0_f64; around.samples.len()];
        for &(before, after) in &around.pairs {
            for (i, gradient) in gradients.iter_mut().enumerate() {
                // The square of a sample near the limits of numbers would overflow.
                *gradient = gradient.hypot(slope(before[i], around.samples[i], after[i]));
            }
        }
        let (mut values, mut kept) = (Vec::with_capacity(gradients.len()), Vec::with_capacity(gradients.len()));
        for (&value, gradient) in around.samples.iter().zip(gradients) {
            if value.is_finite() {
                values.push(value);
                kept.push(gradient);
            }
        }
        let (low, high) = extremes(&values);
        if low >= high {
            // All that varies was not looked at, such as the border of a small volume: curves need a range.
            values.extend([facts.range.0, facts.range.1]);
            kept.extend([0.0, 0.0]);
        }
        Self { values, gradients: kept }
    }

    /// The value of samples without data: a negative one, the least, that a large share of samples has exactly.
    ///
    /// `None` where another phase has the largest value as often.
    pub fn fill(&self) -> Option<f64> {
        fill_of(&self.values)
    }
}

/// Samples of a volume that only some decisions need.
pub trait Source {
    /// An error of reading them.
    type Error;
    /// Calls a function with every n-th sample along each axis, some millions at most, x fastest, and their numbers along
    /// z, y and x.
    fn spread<R>(&self, look: impl FnOnce(&[f64], [usize; 3]) -> R) -> Result<R, Self::Error>;
    /// Whether floating-point numbers in memory are all whole, also those that samples spread over them missed.
    fn is_whole(&self) -> Result<bool, Self::Error>;
}

/// Facts of a volume and its samples, by which its kind is decided.
#[derive(Clone, Debug)]
pub struct Evidence<'a> {
    /// Facts that its file states.
    pub facts: KindFacts<'a>,
    /// Its finite samples that were looked at.
    pub seen: SeenSamples,
    /// Samples of its finest level with their direct neighbours.
    pub around: Neighbourhood<'a>,
}

/// The difference along an axis, sample units per voxel: of both neighbours, of one where the other is missing.
fn slope(before: f64, own: f64, after: f64) -> f64 {
    let mut slope = 0.5 * (after - before);
    if !before.is_finite() {
        slope = after - own;
    }
    if !after.is_finite() {
        slope = own - before;
    }
    if slope.is_finite() { slope } else { 0.0 }
}

/// Minimum share of samples with exactly the least value for which that value means "no data", such as -30 dBZ.
pub const MIN_FILL: f64 = 0.1;

pub fn fill_of(values: &[f64]) -> Option<f64> {
    let (least, largest) = extremes(values);
    let is_fill = !values.is_empty()
        && least < 0.0
        && share(values, |value| value == least) >= MIN_FILL
        && share(values, |value| value == largest) < MIN_FILL;
    is_fill.then_some(least)
}

// Roughness of samples: how much neighbours bend beside how much they rise.
//
// For samples a, b, c in a row the bend is |a - 2b + c| and the rise |c - a| / 2. A wave of n samples has 2 pi / n of
// bend to its rise; independent noise 3.5, since their deviations are sqrt(6) and sqrt(1/2) of the noise's. Scans have
// noise, and boundaries about as sharp as their samples; codes that solve equations need some samples for what they
// solve. (Medians and sums of 22 scans: 1.2 to 3.4, but for an engine's sum, 0.97, and smoothed phantoms, 0.9. Fuel, a
// jet of heptane, a protein's density, bytes all: 0.4 to 0.8.)

/// Largest roughness of data without noise.
const MAX_SMOOTH: f64 = 0.9;

impl Neighbourhood<'_> {
    /// Whether samples have no noise, as the results of simulations.
    pub fn is_smooth(&self) -> bool {
        self.roughness() < MAX_SMOOTH
    }

    /// Ratio of bend to rise, over all samples and in the median of those that rise, whichever is larger.
    ///
    /// Samples take no part along axes where a neighbour is missing. Infinity where nothing rises.
    pub fn roughness(&self) -> f64 {
        let (mut bend, mut rise) = (vec![0.0_f64; self.samples.len()], vec![0.0_f64; self.samples.len()]);
        for &(before, after) in &self.pairs {
            for (i, &own) in self.samples.iter().enumerate() {
                let (low, high) = (before[i], after[i]);
                if low.is_finite() && own.is_finite() && high.is_finite() {
                    bend[i] += (low - 2.0 * own + high).abs();
                    rise[i] += 0.5 * (high - low).abs();
                }
            }
        }
        // A background of one value is no matter, smooth or not.
        let finite = those(self.samples, f64::is_finite);
        let background = commonest(&distinct(&finite)).unwrap_or(f64::NAN);
        let (mut ratios, mut bends, mut rises) = (Vec::new(), Vec::new(), Vec::new());
        for ((&own, bend), rise) in self.samples.iter().zip(bend).zip(rise) {
            if bend.is_finite() && rise.is_finite() {
                bends.push(bend);
                rises.push(rise);
                if rise > 0.0 && own != background {
                    ratios.push(bend / rise);
                }
            }
        }
        if ratios.is_empty() {
            return f64::INFINITY;
        }
        let (whole, middle) = (sum(&bends) / sum(&rises), median(&ratios));
        // Where sums overflow, the ratio of them is not a number, and nothing is smooth.
        if middle > whole { middle } else { whole }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_need_one_neighbour() {
        assert_eq!(slope(1.0, 2.0, 5.0), 2.0);
        assert_eq!((slope(f64::NAN, 2.0, 5.0), slope(1.0, 2.0, f64::INFINITY)), (3.0, 1.0));
        assert_eq!((slope(f64::NAN, 2.0, f64::NAN), slope(1.0, f64::NAN, 5.0)), (0.0, 2.0));
    }

    #[test]
    fn a_wave_is_smooth_and_what_alternates_is_noise() {
        let wave: Vec<f64> = (0..1002).map(|i| (f64::from(i) * 0.2).sin()).collect();
        let around = |of: &[f64]| {
            let pairs = vec![(&of[..1000], &of[2..])];
            Neighbourhood { samples: &of[1..1001], pairs }.roughness()
        };
        assert!((around(&wave) - 0.2).abs() < 0.01, "{}", around(&wave));
        let rough: Vec<f64> = wave.iter().enumerate().map(|(i, value)| value + f64::from(i as u32 % 2)).collect();
        assert!(around(&rough) > MAX_SMOOTH);
    }

    #[test]
    fn a_negative_value_of_many_samples_means_no_data() {
        assert_eq!(fill_of(&[-30.0, -30.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]), Some(-30.0));
        assert_eq!((fill_of(&[-30.0, -30.0, 1.0, 1.0]), fill_of(&[0.0, 0.0, 1.0]), fill_of(&[])), (None, None, None));
    }
}
