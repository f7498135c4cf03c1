//! Hounsfield units: whether values are some, also where 1000 or 1024 was added to them.
//!
//! Such a scan has no negative value, air at 0 (or 24) and two narrow peaks, fat and soft tissue, about 100 apart below
//! and at the offset. MR has broad peaks at any place. The values of air decide between the two offsets; with little air
//! the offset may be wrong by 24.

use crate::statistics::{count, distinct, extremes, is_whole, share, those};

// Whether values are Hounsfield units.
//
// A CT has both fixed points of the scale, air near -1000 and soft tissue near 0, next to nothing below air but a
// padding value, few values as far above 0 as air is below, and less bone than soft tissue. Signed fields of simulations
// and noise of the same size lack one of the three: they go on below -1100, are as frequent on both sides, or are flat
// above 0. (`python studies/looks/hounsfield.py FILE ...` prints the numbers. Four CTs: none below -1100, 0.002 to 0.05
// times as many samples above 900 as below -900, soft tissue 15 to 37 times as dense as bone. Noise of deviation 400:
// 0.3 % below -1100, 1.01 times, 1.4 times.)

/// Least shares of samples within 200 of air (-1000) and of soft tissue (0).
const MIN_SHARE: f64 = 0.02;
/// Lowest value of air with its noise.
const AIR: f64 = -1100.0;
/// Largest share of samples below air where they are no padding.
const MAX_BELOW: f64 = 0.001;
/// Values that padding may have.
const N_PADDINGS: usize = 2;
/// Samples beyond this on both sides of 0, and their largest ratio, above to below.
const FAR: f64 = 900.0;
const MAX_ABOVE: f64 = 0.3;
/// Ranges of soft tissue and of bone, and the least ratio of their densities.
const SOFT_TISSUE: (f64, f64) = (-150.0, 150.0);
const BONE: (f64, f64) = (200.0, 500.0);
const MIN_SOFT: f64 = 2.0;

/// Whether finite values of a volume look like Hounsfield units.
///
/// `says_ct`: whether its file says CT; then air and soft tissue are enough. `may_be_fractional`: whether values between
/// whole numbers do not speak against it: of scans of patients, which may be resampled, and of wavelets, which round.
pub fn looks_like_hounsfield(values: &[f64], says_ct: bool, may_be_fractional: bool) -> bool {
    let has = |fixed: f64| share(values, |value| (value - fixed).abs() < 200.0) > MIN_SHARE;
    if values.is_empty() || !has(-1000.0) || !has(0.0) {
        return false;
    }
    if says_ct {
        return true;
    }
    if !may_be_fractional && !values.iter().copied().all(is_whole) {
        return false;
    }
    // Padding is a value or two, with others between them and air where a scan was resampled; noise has no such peak.
    let below = those(values, |value| value < AIR);
    let mut peaks: Vec<usize> = distinct(&below).into_iter().map(|(_, n)| n).collect();
    peaks.sort_unstable_by(|a, b| b.cmp(a));
    let padding: usize = peaks.iter().take(N_PADDINGS).sum();
    let n_below = if 2 * padding > below.len() { 0 } else { below.len() };
    let (n_above, n_beyond) = (count(values, |value| value > FAR), count(values, |value| value < -FAR));
    if n_below as f64 > MAX_BELOW * values.len() as f64 || n_above as f64 > MAX_ABOVE * n_beyond as f64 {
        return false;
    }
    let [soft, bone] = [SOFT_TISSUE, BONE].map(|(low, high)| share(values, |value| value >= low && value < high));
    soft >= MIN_SOFT * bone
}

// CT whose values are Hounsfield units with 1000 or 1024 added, as scanners and old programs store them.

/// Values that 0 Hounsfield units may be stored as.
const OFFSETS: [f64; 2] = [1000.0, 1024.0];
/// Ranges of fat and of soft tissue, and the value above which samples are of the body, Hounsfield units.
const FAT: (f64, f64) = (-140.0, -50.0);
const STORED_SOFT_TISSUE: (f64, f64) = (-20.0, 110.0);
const BODY: f64 = -400.0;
/// Least shares of air and of the body among the samples; crops have little air.
const MIN_AIR: f64 = 0.003;
const MIN_BODY: f64 = 0.02;
/// Pairs of the least share of each peak in the body and of both: there is little fat in a head or a chest. Of 48 crops
/// of three CTs 37 are found, and 26 by the first pair with at least 2 % of air. Of 760 cases that are no CT, 19 volumes
/// multiplied by 40 factors each, the second pair alone takes none for CT, and the first pair with 2 % of air takes 4
/// (an engine and a mean head). The two pairs together were not counted.
const MIN_PEAKS: [(f64, f64); 2] = [(0.05, 0.55), (0.025, 0.7)];
/// Most values per unit below fat and above soft tissue, as a share of those in the larger peak.
const MAX_BESIDE: f64 = 0.35;
/// Least share of values above 200 Hounsfield units, bone or contrast medium, in the body.
const MIN_BONE: f64 = 0.003;
/// Air of an offset of 1024 is at 24: fewer of the values 1 to 48 than this share are below 12, where air of 1000 is.
const AIR_SHARE: f64 = 0.2;
/// Most samples of 0 for each of air, where 0 is padding outside of a round field of view.
const MAX_PADDING: f64 = 4.0;

/// The number that seems to be added to Hounsfield units, 1000 or 1024; 0 if the values do not look like CT.
///
/// `values`: any; those that are not finite are left out.
pub fn stored_offset(values: &[f64]) -> f64 {
    let finite = those(values, f64::is_finite);
    let (least, largest) = extremes(&finite);
    if finite.is_empty() || least < 0.0 || largest < OFFSETS[0] + 200.0 {
        return 0.0;
    }
    // Padding is 0 for both; where there is far more of it than of air, it is air.
    let near_air = those(&finite, |value| value > 0.0 && value < 48.0);
    let is_air = (near_air.len() as f64) < count(&finite, |value| value == 0.0) as f64 / MAX_PADDING;
    let is_1024 = !near_air.is_empty() && !is_air && share(&near_air, |value| value < 12.0) < AIR_SHARE;
    let offset = OFFSETS[usize::from(is_1024)];
    let units: Vec<f64> = finite.iter().map(|value| value - offset).collect();
    let body = those(&units, |value| value > BODY);
    if (body.len() as f64) < MIN_BODY * units.len() as f64 || share(&units, |value| value < -900.0) < MIN_AIR {
        return 0.0;
    }
    let within = |(low, high): (f64, f64)| share(&body, |value| value >= low && value <= high);
    let (fat, soft) = (within(FAT), within(STORED_SOFT_TISSUE));
    let has_peaks = MIN_PEAKS.iter().any(|&(each, both)| fat.min(soft) >= each && fat + soft >= both);
    if !has_peaks || within((200.0, f64::INFINITY)) < MIN_BONE {
        return 0.0;
    }
    let per_unit = |share: f64, (low, high): (f64, f64)| share / (high - low);
    let density = per_unit(fat, FAT).max(per_unit(soft, STORED_SOFT_TISSUE));
    let beside = (within((-300.0, -180.0)) / 120.0).max(within((150.0, 270.0)) / 120.0);
    if beside < MAX_BESIDE * density { offset } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Air, fat, soft tissue and a little bone, `offset` added.
    fn body(offset: f64) -> Vec<f64> {
        let parts = [(-1000.0, 400), (-100.0, 100), (40.0, 300), (300.0, 20)];
        parts.iter().flat_map(|&(value, n)| (0..n).map(move |i| value + f64::from(i % 7) + offset)).collect()
    }

    #[test]
    fn air_and_soft_tissue_are_hounsfield_units() {
        assert!(looks_like_hounsfield(&body(0.0), false, false));
        assert!(!looks_like_hounsfield(&body(0.25), false, false) && looks_like_hounsfield(&body(0.25), false, true));
        assert!(!looks_like_hounsfield(&body(1024.0), true, true) && !looks_like_hounsfield(&[], true, true));
    }

    #[test]
    fn offsets_are_found_by_air() {
        assert_eq!(
            [0.0, 1000.0, 1024.0, 1500.0].map(|offset| stored_offset(&body(offset))),
            [0.0, 1000.0, 1024.0, 0.0]
        );
    }
}
