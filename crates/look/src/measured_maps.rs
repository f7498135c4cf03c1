//! Maps of what was calculated from scans: diffusion, perfusion, statistics.
//!
//! A file says what a map holds by its quantity (the intent of `NIfTI`, the image type of DICOM). Otherwise it is
//! guessed by words of the file's name, as BIDS, FSL, SPM and `FreeSurfer` write them. By values alone, two kinds are
//! recognized:
//!
//! - Diffusivities in mm²/s are floating-point numbers up to 0.001 at least and 0.02 at most: water in a body has 0.003.
//! - p-values are near 1 nearly everywhere, outside of the body too, and fall to near 0 somewhere.
//!
//! Relaxation times and perfusion without a name look like scans of their own contrast, and stay such.

use std::collections::BTreeSet;

use crate::facts::{DataKind, KindFacts, NumberType, Reasoned};
use crate::quantities as q;
use crate::statistics::share;
use crate::words::in_digits;

/// The largest p that counts as significant.
pub(crate) const SIGNIFICANT: f64 = 0.05;
/// Least share of zeros that are the outside of a mask.
const MIN_MASKED: f64 = 0.2;
/// Largest value of diffusivities in mm²/s: least of maps of a body, which has water, and most, with noise.
const MIN_DIFFUSIVITY: f64 = 0.001;
const MAX_DIFFUSIVITY: f64 = 0.02;
/// Values that count as near 1, and the least share of them among p-values.
const NEAR_ONE: f64 = 0.9;
const MIN_NEAR_ONE: f64 = 0.7;
/// Longest word whose number at the end is a part of it, as in "T2".
const LONGEST_SHORT: usize = 3;

/// The quantity that a word names alone.
fn of_word(word: &str) -> Option<&'static str> {
    Some(match word {
        "adc" | "adcmap" => q::ADC,
        "t1map" | "t1mapping" | "qt1" => q::T1,
        "t2map" | "t2mapping" | "qt2" => q::T2,
        "t2starmap" | "t2smap" | "qt2star" => q::T2_STAR,
        "cbf" | "rcbf" | "relcbf" | "cbfmap" => q::BLOOD_FLOW,
        "cbv" | "rcbv" | "relcbv" | "cbvmap" => q::BLOOD_VOLUME,
        "mtt" | "relmtt" | "ttp" | "tmax" => q::PERFUSION,
        "zstat" | "zscore" | "zmap" | "zfstat" => q::Z_STATISTIC,
        "tstat" | "tscore" | "tmap" | "spmt" => q::T_STATISTIC,
        "fstat" | "spmf" => q::F_STATISTIC,
        _ => return None,
    })
}

/// Quantities by short words, each of which needs another one beside it: `T1_map`, `dti_MD`.
const BY_TWO_WORDS: [(&[&str], &[&str], &str); 4] = [
    (&["t1"], &["map"], q::T1),
    (&["t2"], &["map"], q::T2),
    (&["t2star"], &["map"], q::T2_STAR),
    (&["md", "ad", "rd"], &["map", "dti", "dki", "dwimap", "tensor"], q::DIFFUSIVITY),
];
/// Names of p-values, alone or in two words, and of 1 - p, as FSL's randomise writes them.
const P_WORDS: [&str; 4] = ["pval", "pvals", "pvalue", "pvalues"];
const P_PAIRS: [[&str; 2]; 3] = [["p", "value"], ["p", "values"], ["p", "val"]];
const ONE_MINUS_P: &str = "corrp";
/// Names of uptake values.
const UPTAKE_WORDS: [&str; 4] = ["suv", "suvbw", "suvlbm", "suvr"];
const BY_NAME: &str = "by the file's name and by the values";

/// Whether a patient's volume holds a calculated map, and why; `None` for other volumes.
///
/// `values`: samples spread over the volume, finite. Lengths of vectors have names of what the vectors are.
pub fn map_kind(facts: &KindFacts<'_>, values: &[f64]) -> Option<Reasoned> {
    if facts.is_lengths || !facts.is_anatomical || !matches!(facts.modality, None | Some("MR")) || values.is_empty() {
        return None;
    }
    let (low, high) = facts.range;
    if facts.quantity == Some(q::P_VALUE) && 0.0 <= low && low <= high && high <= 1.0 {
        return Some(p_values(values, "the file says so"));
    }
    let is_map = |quantity: &&str| *quantity != q::P_VALUE && q::ALL.contains(quantity);
    if let Some(quantity) = facts.quantity.filter(is_map).filter(|_| low >= 0.0) {
        return Some((DataKind::Map, format!("a map of the {quantity}: the file says so")));
    }
    let by_name = || by_words(&words_of(facts.name), values, low, high);
    if let Some(found) = facts.modality.is_none().then(by_name).flatten() {
        return Some(found);
    }
    if low < 0.0 || facts.numbers != NumberType::Float {
        return None;
    }
    if (MIN_DIFFUSIVITY..=MAX_DIFFUSIVITY).contains(&high) {
        let reason = format!("a map of diffusion in mm²/s: up to {}, by the values", in_digits(high, 2));
        return Some((DataKind::Map, reason));
    }
    if high <= 1.0 && low < SIGNIFICANT && share(values, |value| value > NEAR_ONE) >= MIN_NEAR_ONE {
        let reason = "p-values: near 1 nearly everywhere, and near 0 somewhere, by the values";
        return Some((DataKind::PValues, reason.to_owned()));
    }
    None
}

/// The words of a name in small letters.
pub fn split(name: &str) -> BTreeSet<String> {
    let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit();
    name.to_lowercase().split(|c| !is_letter(c)).filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

/// The words of a name in small letters, and each without the number at its end ("zstat1").
fn words_of(name: &str) -> BTreeSet<String> {
    let mut words = split(name);
    let without_number = |word: &String| word.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
    let more: Vec<String> = words.iter().filter(|word| word.len() > LONGEST_SHORT).map(without_number).collect();
    words.extend(more);
    words
}

/// The kind by words of a name, if the values can be of that kind.
fn by_words(words: &BTreeSet<String>, values: &[f64], low: f64, high: f64) -> Option<Reasoned> {
    let has = |word: &str| words.contains(word);
    let have = |any: &[&str]| any.iter().any(|word| has(word));
    if low < 0.0 {
        return None; // values with two signs are statistics, recognized elsewhere
    }
    if high <= 1.0 && has(ONE_MINUS_P) {
        return Some((DataKind::Probability, format!("1 - p of a test, {BY_NAME}")));
    }
    if high <= 1.0 && (have(&P_WORDS) || P_PAIRS.iter().any(|[one, other]| has(one) && has(other))) {
        return Some(p_values(values, BY_NAME));
    }
    if have(&UPTAKE_WORDS) {
        return Some((DataKind::Pet, format!("PET in SUV, {BY_NAME}")));
    }
    let by_one = words.iter().find_map(|word| of_word(word));
    let by_two = || BY_TWO_WORDS.iter().find(|(one, other, _)| have(one) && have(other)).map(|&(_, _, of)| of);
    by_one.or_else(by_two).map(|found| (DataKind::Map, format!("a map of the {found}, {BY_NAME}")))
}

fn p_values(values: &[f64], by: &str) -> Reasoned {
    if share(values, |value| value == 0.0) < MIN_MASKED {
        return (DataKind::PValues, format!("p-values, {by}"));
    }
    // Between 0 and the p of the rim, values pass through significant ones.
    let reason = "p-values with 0 outside of a mask, which would show as significant, so high ones show";
    (DataKind::Map, format!("{reason}; {by}"))
}
