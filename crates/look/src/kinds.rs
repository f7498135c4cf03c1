//! The kind of data in a volume, by what its file says, else by what its values look like.
//!
//! Facts of the file (modality, unit, whether the axes are a patient's) come first. Where they are missing, the values
//! decide by tests that are reported beside it: Hounsfield units have air and soft tissue at the fixed points of their
//! scale; a mask has two values; labels are whole numbers that are the same from sample to sample; a field has both
//! signs, or fractions, or no noise; PET has no negative values, coarse samples and a few very bright spots. Shares,
//! such as probabilities, and other calculated maps have files of their own: `measured_maps.rs`, `shares.rs`.

use crate::evidence::{Evidence, SeenSamples, Source, fill_of};
use crate::facts::{DataKind, KindFacts, MODALITIES, NumberType, Reasoned};
use crate::histogram::{otsu, robust_range};
use crate::measured_maps::map_kind;
use crate::numbers::linspace;
use crate::segmentation::segmentation;
use crate::shares::share_kind;
use crate::statistics::{count, distinct, extremes, histogram, is_whole, median, percentiles, those};

/// The kind of data, and why it is thought so.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundKind {
    /// The kind.
    pub kind: DataKind,
    /// Why it is thought so, in words.
    pub reason: String,
    /// Whether samples have noise, unlike results of calculations.
    pub has_noise: bool,
    /// Whether nearly all samples are the noise of a background, and a few are far above it, as beads are.
    pub has_few_bright: bool,
}

impl FoundKind {
    /// Whether the kind was found by the values alone.
    pub fn is_guess(&self) -> bool {
        self.reason.ends_with("by the values")
    }

    /// Whether the samples were calculated: fields without noise, and values of both signs, which no image has.
    pub fn is_calculated(&self) -> bool {
        self.kind == DataKind::SignedField || (self.kind == DataKind::Field && !self.has_noise)
    }

    /// Whether a volume whose header names a patient's axes shows a patient, where it is placed as by default.
    ///
    /// Headers name these axes for calculated data too, and for things whose place nobody measured. `has_no_place`: the
    /// header names them by its format's default alone.
    pub fn shows_patient(&self, has_no_place: bool) -> bool {
        match self.kind {
            DataKind::Field | DataKind::SignedField => !has_no_place && self.has_noise,
            DataKind::Scan => !has_no_place,
            _ => true,
        }
    }
}

/// PET: least distance of samples, millimetres, and least ratio of the 99.9th to the 90th percentile. (A PET of a body:
/// 3.4 mm, 13 times; MR of heads: 1 mm, 2 to 3 times.)
const PET_SPACING_MM: f64 = 1.8;
const PET_TAIL: f64 = 8.0;
/// Signs: least ratio of the smaller of the two tails to the larger one. A tail ends at a percentile; of data without
/// noise, of which no sample is an accident, at the extreme.
const MIN_TAIL: f64 = 0.15;
const TAILS: [f64; 2] = [0.5, 99.5];
/// The same of whole numbers, which are scans with an offset more often.
const MIN_WHOLE_TAIL: f64 = 0.5;
/// Least ratio of the extremes of both signs; below, the smaller one is rounding. (Density of the cores of atoms: 3e-7.)
const MIN_END: f64 = 1e-5;
/// Dense tissue: least median, as a share of the range. (EM of a worm: 0.65; fluorescence: 0.1 to 0.2.)
const MIN_BRIGHT: f64 = 0.45;
/// Fluorescence, where only values decide: largest share of samples of one value (a background without noise was not
/// counted from photons), least ratio of the 99.9th percentile to the median of the object, both above the background
/// (cells 2.8 to 11, a mouse brain 3.9; vessels 1.3, an engine 1.8).
const MAX_EQUAL: f64 = 0.25;
const MIN_GLOW: f64 = 2.5;
/// Padding: least share of the samples, and least distance of its value from the next one, as a share of the distance
/// from the median of the others.
const MIN_PADDING: f64 = 0.1;
const MIN_GAP: f64 = 0.25;
/// A few bright samples over noise: least ratio of the distances of the 10th and 90th percentiles to the median, either
/// way, deviations of the noise above the median that are far, largest share of samples that far, and least number of
/// neighbours that are both so. (Beads: 0.83 to 1, up to 0.015; cells: 0.3 to 0.7; EM 0.4; vessels in PC-MR: 0.2.)
const MIN_EVEN: f64 = 0.78;
/// Deviations of the noise above its median that are far.
pub const FAR: f64 = 8.0;
const MAX_FAR: f64 = 0.02;
const MIN_TOGETHER: usize = 4;
const FEW_BRIGHT: &str =
    "fluorescence, or other light: nearly all is noise, and a few samples are far above it, by the values";
const DENSE: &str = "dense matter that fills the volume, as in electron microscopy: mostly bright, by the values";
const NO_SCALE: &str = "a scan of no fixed scale";
/// Number of bins of the histogram in which the peak of air is searched; it must lie in this lowest share of the bins.
const N_AIR_BINS: usize = 64;
const MAX_AIR_PLACE: f64 = 0.1;

/// The kind of data that a volume holds, with the reason.
pub fn kind<S: Source>(evidence: &Evidence<'_>, source: &S) -> Result<FoundKind, S::Error> {
    let Evidence { facts, seen: SeenSamples { values, .. }, around } = evidence;
    let has_noise = !around.is_smooth();
    let found = match segmentation(evidence, source)? {
        Some(found) => Some(found),
        None => map_kind(facts, values).or_else(|| by_facts(facts, values)),
    };
    let may_glow = found.as_ref().is_none_or(|(kind, _)| *kind == DataKind::Fluorescence);
    let has_few_bright = has_noise && may_glow && few_are_bright(facts, values, source)?;
    let (kind, reason) = found
        .or_else(|| has_few_bright.then(|| (DataKind::Fluorescence, FEW_BRIGHT.to_owned())))
        .or_else(|| by_microscope(facts, values, has_noise))
        .or_else(|| share_kind(facts, values))
        .unwrap_or_else(|| by_values(facts, values, has_noise));
    Ok(FoundKind { kind, reason, has_noise, has_few_bright: has_few_bright && kind == DataKind::Fluorescence })
}

/// Whether nearly all samples are noise that is as wide below its median as above it, and a few are far above.
///
/// A few that lie alone are hot pixels of a camera, not beads. `values` show the noise; the few need more samples.
fn few_are_bright<S: Source>(facts: &KindFacts<'_>, values: &[f64], source: &S) -> Result<bool, S::Error> {
    if facts.is_anatomical && !(facts.is_fine() || facts.is_placed_by_default) {
        return Ok(false);
    }
    let [low, middle, high] = percentiles(values, [10.0, 50.0, 90.0]);
    let (lower, upper) = (middle - low, high - middle);
    let distances: Vec<f64> = values.iter().map(|value| (value - middle).abs()).collect();
    let deviation = 1.4826 * median(&distances);
    if !(deviation > 0.0 && MIN_EVEN * lower <= upper && upper <= lower / MIN_EVEN) {
        return Ok(false);
    }
    source.spread(|samples, [_, n_y, n_x]| {
        let (above, below) = (middle + FAR * deviation, middle - FAR * deviation);
        let far: Vec<usize> = (0..samples.len()).filter(|&place| samples[place] > above).collect();
        if count(samples, |value| value < below) >= far.len() || far.len() as f64 > MAX_FAR * samples.len() as f64 {
            return false;
        }
        let is_far = |place: usize| samples.get(place).is_some_and(|&value| value > above);
        let together = |&place: &usize| {
            usize::from((place + 1) % n_x != 0 && is_far(place + 1))
                + usize::from(place / n_x % n_y + 1 < n_y && is_far(place + n_x))
                + usize::from(is_far(place + n_x * n_y))
        };
        far.iter().map(together).sum::<usize>() >= MIN_TOGETHER
    })
}

fn by_facts(facts: &KindFacts<'_>, values: &[f64]) -> Option<Reasoned> {
    let prefix = if facts.modality == Some("CT") { "the file says CT, and " } else { "" };
    if matches!(facts.modality, None | Some("CT")) && facts.is_hounsfield(values) {
        return Some((DataKind::Ct, format!("CT in Hounsfield units: {prefix}the values have air and soft tissue")));
    }
    let offset = facts.offset(values);
    if offset != 0.0 {
        let reason =
            format!("CT in Hounsfield units with {offset} added: {prefix}air, fat and soft tissue, by the values");
        return Some((DataKind::Ct, reason));
    }
    let &(modality, kind) = MODALITIES.iter().find(|&&(modality, _)| facts.modality == Some(modality))?;
    let what = if kind == DataKind::Dose { "dose map" } else { kind.name() };
    Some((kind, format!("{what}: the file says {modality}")))
}

/// The kind of an image whose file names channels of a microscope; the unit of length alone is no evidence.
fn by_microscope(facts: &KindFacts<'_>, values: &[f64], has_noise: bool) -> Option<Reasoned> {
    if !facts.has_channel || (facts.is_anatomical && !facts.is_fine()) {
        return None;
    }
    // Fluorescence is dark with a bright tail; stained tissue in an electron microscope fills the picture.
    if !is_dense(values) {
        let reason = "fluorescence: the file names channels, and mostly dark, by the values";
        return Some((DataKind::Fluorescence, reason.to_owned()));
    }
    has_noise.then(|| (DataKind::Em, DENSE.to_owned()))
}

fn by_values(facts: &KindFacts<'_>, values: &[f64], has_noise: bool) -> Reasoned {
    // Fractions were calculated where a header says no more of a patient than its format does by default.
    let is_calculated = facts.has_no_place && !values.iter().copied().all(is_whole);
    let may_be_of_patient = facts.is_anatomical && !facts.is_fine() && !is_calculated;
    let is_of_patient = may_be_of_patient && (has_noise || !facts.is_placed_by_default);
    let (kind, reason) = if has_two_signs(facts, values, is_of_patient, has_noise) && !is_rounding(facts) {
        (DataKind::SignedField, "a field with two signs, by the values")
    } else if facts.is_lengths {
        (DataKind::Field, "a field: the lengths of vectors")
    } else if is_of_patient {
        of_patient(facts, values)
    } else if facts.numbers == NumberType::Float {
        (DataKind::Field, "a field of floating-point numbers")
    } else if !has_noise {
        (DataKind::Field, "a field of whole numbers without noise, by the values")
    } else {
        let of_matter = without_padding(values);
        if is_dense(&of_matter) {
            (DataKind::Em, DENSE)
        } else if glows(&of_matter) {
            let reason = "fluorescence: noise, and a few samples far brighter than the rest, by the values";
            (DataKind::Fluorescence, reason)
        } else {
            (DataKind::Scan, NO_SCALE)
        }
    };
    (kind, reason.to_owned())
}

fn of_patient(facts: &KindFacts<'_>, values: &[f64]) -> (DataKind, &'static str) {
    let air = if facts.numbers == NumberType::Float { air_of_normalised(values) } else { None };
    if facts.numbers == NumberType::Unsigned || (extremes(values).0 < 0.0 && air.is_none()) {
        return (DataKind::Scan, NO_SCALE);
    }
    if facts.least_spacing() >= PET_SPACING_MM {
        let above: Vec<f64> = values.iter().map(|value| value - air.unwrap_or(0.0)).collect();
        // A ratio, from which exposure and gain cancel.
        let [upper, top] = percentiles(&above, [90.0, 99.9]);
        if upper.is_nan() || upper <= 0.0 || top / upper >= PET_TAIL {
            return (DataKind::Pet, "PET: coarse samples and a few very bright spots, by the values");
        }
    }
    if air.is_some() {
        let reason = "MR, or another scan of a patient, normalised: its air has a negative value, by the values";
        return (DataKind::Mr, reason);
    }
    (DataKind::Mr, "MR, or another scan of a patient without a fixed scale, by the values")
}

/// The negative value of air in a scan whose mean was subtracted, or that was scaled: commonest, and nearly least.
///
/// `None` where the commonest value is not that: differences and statistics of two signs are commonest at 0.
fn air_of_normalised(values: &[f64]) -> Option<f64> {
    let (low, high) = robust_range(values);
    if low >= high {
        return None;
    }
    let counts = histogram(values, N_AIR_BINS, low, high);
    let most = counts.iter().max()?;
    let place = counts.iter().position(|n| n == most)?;
    let edges = linspace(low, high, N_AIR_BINS + 1);
    let air = 0.5 * (edges[place] + edges[place + 1]);
    (air < 0.0 && (place as f64) < MAX_AIR_PLACE * N_AIR_BINS as f64).then_some(air)
}

/// Whether values go to both sides of 0, neither by the noise of a background nor by an offset.
fn has_two_signs(facts: &KindFacts<'_>, values: &[f64], is_of_patient: bool, has_noise: bool) -> bool {
    let least = match facts.numbers {
        NumberType::Unsigned => return false,
        NumberType::Signed if is_of_patient => return false,
        NumberType::Signed => MIN_WHOLE_TAIL,
        NumberType::Float => MIN_TAIL,
    };
    if fill_of(values).is_some() || (is_of_patient && air_of_normalised(values).is_some()) {
        return false;
    }
    let (low, high) = if has_noise { percentiles(values, TAILS).into() } else { extremes(values) };
    low < 0.0 && 0.0 < high && f64::min(-low, high) >= least * f64::max(-low, high)
}

/// Whether one sign is so small beside the other that it is rounding; peaks of single samples count too.
fn is_rounding(facts: &KindFacts<'_>) -> bool {
    let (below, above) = (-facts.range.0, facts.range.1);
    below.min(above) < MIN_END * below.max(above)
}

fn is_dense(values: &[f64]) -> bool {
    let [low, middle, high] = percentiles(values, [1.0, 50.0, 99.0]);
    middle > low + MIN_BRIGHT * (high - low)
}

/// The values without a frame around the image: many of exactly the least value, far from all others.
fn without_padding(values: &[f64]) -> Vec<f64> {
    let (least, _) = extremes(values);
    let others = those(values, |value| value > least);
    let n_padding = values.len() - others.len();
    let is_padded = !others.is_empty()
        && n_padding as f64 >= MIN_PADDING * values.len() as f64
        && extremes(&others).0 - least >= MIN_GAP * (median(&others) - least);
    if is_padded { others } else { values.to_vec() }
}

/// Whether values are those of light that few structures give off: a noisy background and a long bright tail.
fn glows(values: &[f64]) -> bool {
    let (low, high) = robust_range(values);
    let most = distinct(values).into_iter().map(|(_, n)| n).max().unwrap_or(0);
    if low >= high || most as f64 > MAX_EQUAL * values.len() as f64 {
        return false;
    }
    let threshold = otsu(values, low, high);
    let inside = those(values, |value| value > threshold);
    let background = median(values);
    !inside.is_empty() && high - background > MIN_GLOW * f64::max(median(&inside) - background, 1e-12)
}
