//! Maps of shares: fractional anisotropy (FA), and probabilities, recognized by name and values.
//!
//! Neither has a field in `NIfTI` that programs fill, so each is a guess, and is said to be one.
//!
//! - FA is at most the square root of 3/2, which tensors with a negative eigenvalue reach in noise, and mostly below a
//!   third of that. Above 1, that range is its own. Clipped to 1, the rim that noise makes is a heap at 1 above a gap,
//!   which a scan that is clipped at a percentile has not. Else the name must say FA, as a scan normalised to 1 has it
//!   too.
//! - Probabilities of tissue are mostly near their ends. Scans that are normalised to 1 are mostly between them.
//! - Probabilities of a lesion, or of one structure of an atlas, are 0 in nearly all of the volume.

use crate::facts::{DataKind, KindFacts, NumberType, Reasoned};
use crate::measured_maps::split;
use crate::statistics::{median, percentiles, share, those};
use crate::words::in_digits;

/// Largest anisotropy, and largest median of it inside the brain. (FSL's FA of a brain: 0.18.)
const MAX_FA: f64 = 1.2248;
const MAX_MEDIAN_FA: f64 = 0.45;
/// FA clipped to 1: largest median and 90th percentile of what is not 0, least share of exactly 0 outside of the brain,
/// least share of exactly 1, and the value from which on less than that lies below 1. (FSL's FA of a brain, clipped: see
/// `test_derived_maps`. Nine MR scans clipped at percentiles 98 and 99.9: none fits, four by the gap alone.)
const MAX_MEDIAN_CLIPPED: f64 = 0.3;
const MAX_UPPER_CLIPPED: f64 = 0.75;
const MIN_OUTSIDE: f64 = 0.3;
const MIN_HEAP: f64 = 2e-4;
const GAP_FROM: f64 = 0.9;
/// Least value of shares, which splines overshoot, and the value that no share reaches.
const LEAST: f64 = -0.05;
const ABOVE_SHARES: f64 = 1.1;
/// Largest value of shares in per cent.
const PER_CENT: f64 = 100.0;
/// Value from which on a share counts as not 0, and the largest share of the volume that such values of a lesion have.
/// (A stroke: 0.09; a hippocampus: 0.03; fractional anisotropy: 0.23; heads: 0.38 and more.)
const NOT_ZERO: f64 = 0.02;
const MAX_SMALL: f64 = 0.1;
/// Values near 1 and values in between, least share of the former among those that are not 0, and their least ratio.
/// (Grey and white matter: shares 0.33 to 0.44, ratios 1.8 to 2.3; heads: at most 0.23 and 0.9; CT windowed: 0.06.)
const SHARE_NEAR_ONE: f64 = 0.9;
const BETWEEN: (f64, f64) = (0.3, 0.7);
const MIN_SHARE_NEAR_ONE: f64 = 0.25;
const MIN_RATIO: f64 = 1.5;
/// Largest share of the volume that tissue has.
const MAX_FULL: f64 = 0.8;
/// Words of names.
const FA_WORD: &str = "fa";
const PROBABILITY_WORDS: [&str; 9] =
    ["prob", "probs", "probability", "probseg", "probmap", "posterior", "posteriors", "pve", "tpm"];

/// Whether a patient's volume holds fractional anisotropy or probabilities, and why; `None` for other volumes.
///
/// `values`: samples spread over the volume, finite. Lengths of vectors can lie between 0 and 1 too.
pub fn share_kind(facts: &KindFacts<'_>, values: &[f64]) -> Option<Reasoned> {
    let (low, high) = facts.range;
    if !facts.is_anatomical || facts.is_lengths || !(low >= LEAST && high > 0.0) {
        return None;
    }
    let words = split(facts.name);
    if high <= PER_CENT && PROBABILITY_WORDS.iter().any(|&word| words.contains(word)) {
        let reason = format!("probabilities up to {}, by the file's name and by the values", in_digits(high, 3));
        return Some((DataKind::Probability, reason));
    }
    if high > MAX_FA || facts.numbers != NumberType::Float {
        return None;
    }
    let found = those(values, |value| value > NOT_ZERO * high);
    if !found.is_empty() && is_clipped_anisotropy(values, &found, high) {
        let reason = "fractional anisotropy: mostly small, with a heap at 1 to which it is clipped, by the values";
        return Some((DataKind::Fa, reason.to_owned()));
    }
    anisotropy(&found, high, words.contains(FA_WORD)).or_else(|| probability(&found, high, values.len()))
}

/// See [`share_kind`]. `found`: samples that are not 0. `high`: the largest value.
fn anisotropy(found: &[f64], high: f64, says_fa: bool) -> Option<Reasoned> {
    if found.is_empty() || median(found) > MAX_MEDIAN_FA {
        return None;
    }
    let how = if says_fa {
        ", by the file's name and by the values".to_owned()
    } else if high > ABOVE_SHARES {
        format!(": mostly small, and up to {}, by the values", in_digits(high, 3))
    } else {
        return None;
    };
    Some((DataKind::Fa, format!("fractional anisotropy{how}")))
}

/// Whether samples look like anisotropy that was clipped to 1. `found`: the `values` that are not 0.
fn is_clipped_anisotropy(values: &[f64], found: &[f64], high: f64) -> bool {
    if high != 1.0 || share(values, |value| value == 0.0) < MIN_OUTSIDE {
        return false;
    }
    let [median, upper] = percentiles(found, [50.0, 90.0]);
    let heap = share(found, |value| value == 1.0);
    let below = share(found, |value| value > GAP_FROM && value < 1.0);
    median <= MAX_MEDIAN_CLIPPED && upper <= MAX_UPPER_CLIPPED && heap >= MIN_HEAP && heap > below
}

/// See [`share_kind`]. `found`: samples that are not 0, of `n_values`. `high`: the largest value.
fn probability(found: &[f64], high: f64, n_values: usize) -> Option<Reasoned> {
    if high > ABOVE_SHARES {
        return None;
    }
    let share = |is_counted: fn(f64) -> bool| if found.is_empty() { 0.0 } else { share(found, is_counted) };
    let near_one = share(|value| value > SHARE_NEAR_ONE);
    let between = share(|value| value > BETWEEN.0 && value < BETWEEN.1);
    let n = found.len() as f64;
    // Of p-values, which are near 1 nearly everywhere, nothing could be seen.
    let reason = if near_one >= f64::max(MIN_SHARE_NEAR_ONE, MIN_RATIO * between) && n <= MAX_FULL * n_values as f64 {
        "probabilities: from 0 to 1, mostly near one of them, by the values"
    } else if n < MAX_SMALL * n_values as f64 {
        "probabilities, or other shares of 1, in a small part of the volume, by the values"
    } else {
        return None;
    };
    Some((DataKind::Probability, reason.to_owned()))
}
