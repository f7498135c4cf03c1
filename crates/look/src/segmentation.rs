//! Masks and labels: whole numbers that are the same from sample to sample.

use crate::evidence::{Evidence, Neighbourhood, Source};
use crate::facts::{DataKind, KindFacts, Reasoned};
use crate::statistics::{commonest, distinct, extremes, is_whole, mean};

/// Labels: largest number of them, and least share of samples in regions of one value. (Balls of radius 2: 0.86, larger
/// ones and nuclei: over 0.95; scans of 8 bits: up to 0.35; noise: 0.3; scans enlarged 4 times by repetition: 0.76.)
const MAX_LABELS: usize = 2000;
const MIN_ALIKE: f64 = 0.8;
/// Few labels, such as the parts of a lesion, and the same share of them: a scan has more values than these. At least
/// this share of the borders between the levels of a smooth scan are steps of 1.
const FEW_LABELS: usize = 8;
const MIN_ALIKE_OF_FEW: f64 = 0.5;
const MAX_GENTLE: f64 = 0.95;
/// Labels of thin parts that lie apart, such as pieces of bone or vessels: largest share of the neighbours that have
/// neither the same value nor the background's, with the least share in regions of few labels. (Pieces of the bones of a
/// CT at 3 mm: 0.61 in regions, no others; vessels with an aneurysm: 0.82, no others; scans: 0.46 others at least.)
const MAX_OTHERS: f64 = 0.02;
/// Units of values that labels may have: files that must name one say that they have none.
const UNITS_OF_LABELS: [&str; 2] = ["", "1"];

/// Whether a volume holds a mask, labels or a segmentation's probabilities, and why.
pub fn segmentation<S: Source>(evidence: &Evidence<'_>, source: &S) -> Result<Option<Reasoned>, S::Error> {
    let (facts, values) = (&evidence.facts, &evidence.seen.values[..]);
    let found = distinct(values);
    if found.len() <= 2 && !has_others(facts, values, source)? {
        let how_many = if found.len() == 2 { "two values" } else { "one value, or none" };
        return Ok(Some((DataKind::Mask, format!("a mask: it has but {how_many}"))));
    }
    let are_whole = found.iter().all(|&(value, _)| is_whole(value));
    if facts.modality == Some("SEG") {
        let (kind, reason) = if are_whole {
            (DataKind::Labels, "labels: the file says SEG")
        } else {
            (DataKind::Probability, "probabilities: the file says SEG, and has values between whole numbers")
        };
        return Ok(Some((kind, reason.to_owned())));
    }
    // Files give values a unit as simulations do: numbers of labels have none. Exported as DICOM of a scan, label maps
    // say CT and HU, so the modality decides nothing.
    let is_measured = facts.modality.is_none() && facts.value_unit.is_some_and(|unit| !UNITS_OF_LABELS.contains(&unit));
    if !are_whole || extremes(values).0 < 0.0 || found.len() > MAX_LABELS || is_measured {
        return Ok(None);
    }
    let own = Filled::of(&evidence.around, facts);
    let levels = distinct(&own.samples);
    let alike = own.share_alike(&levels);
    if alike < MIN_ALIKE_OF_FEW {
        return Ok(None); // nearly all scans, of which nothing else is counted
    }
    let is_few = found.len() <= FEW_LABELS && own.has_steps(&levels);
    let seem_labels = alike >= MIN_ALIKE || is_few || own.share_of_others(&levels) <= MAX_OTHERS;
    let reason = "labels: whole numbers that are the same from sample to sample, by the values";
    Ok((seem_labels && source.is_whole()?).then(|| (DataKind::Labels, reason.to_owned())))
}

/// Whether a volume has more than two values, although the samples that decide the kind have only two.
fn has_others<S: Source>(facts: &KindFacts<'_>, values: &[f64], source: &S) -> Result<bool, S::Error> {
    let (low, high) = facts.range;
    if [low, high].iter().any(|end| !is_whole(*end) && !values.contains(end)) {
        return Ok(true);
    }
    let (low, high) = (facts.as_sample(low), facts.as_sample(high));
    source.spread(|samples, _| samples.iter().any(|&value| value.is_finite() && value != low && value != high))
}

/// Samples and their neighbours, each missing one with a value of its own.
struct Filled {
    samples: Vec<f64>,
    pairs: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Filled {
    /// The value of missing samples is 2 less than the least one, as that of a background.
    fn of(around: &Neighbourhood<'_>, facts: &KindFacts<'_>) -> Self {
        let all = || around.pairs.iter().flat_map(|&(before, after)| [before, after]).chain([around.samples]);
        let finite = all().flatten().copied().filter(|value| value.is_finite());
        let missing = facts.as_sample(finite.fold(f64::INFINITY, f64::min) - 2.0);
        let filled = |of: &[f64]| of.iter().map(|&value| if value.is_finite() { value } else { missing }).collect();
        let pairs = around.pairs.iter().map(|&(before, after)| (filled(before), filled(after))).collect();
        Self { samples: filled(around.samples), pairs }
    }

    /// Share of the samples, the commonest value left out, that lie in regions of one value; mean over the axes.
    ///
    /// A sample counts where both neighbours along an axis equal it: it is inside. Small cells are mostly border, so one
    /// with an equal neighbour on one side counts too, by half where the other one has the commonest value, as around
    /// cells, and by half where it is further than 1 away: pictures with few grey levels have steps of 1 between them.
    fn share_alike(&self, levels: &[(f64, usize)]) -> f64 {
        let Some(background) = commonest(levels) else { return 0.0 };
        let weight = |own: f64, equal: f64, other: f64| {
            if equal != own {
                0.0
            } else if other == own {
                1.0
            } else {
                0.5 * f64::from(other == background) + 0.5 * f64::from((other - own).abs() > 1.0)
            }
        };
        let share = |(before, after): &(Vec<f64>, Vec<f64>)| {
            let (mut whole, mut n) = (0.0, 0_usize);
            for ((&own, &before), &after) in self.samples.iter().zip(before).zip(after) {
                if own != background {
                    whole += f64::max(weight(own, before, after), weight(own, after, before));
                    n += 1;
                }
            }
            whole / n as f64
        };
        if self.pairs.is_empty() || levels.len() < 2 {
            return 0.0;
        }
        mean(&self.pairs.iter().map(share).collect::<Vec<_>>())
    }

    /// Whether neighbours with other values often differ by more than 1, or too few are known to decide.
    fn has_steps(&self, levels: &[(f64, usize)]) -> bool {
        if levels.len() < 4 || self.pairs.is_empty() {
            return true;
        }
        let (mut n, mut n_gentle) = (0_usize, 0_usize);
        for side in self.sides() {
            for (own, side) in self.samples.iter().zip(side) {
                let step = (side - own).abs();
                n += usize::from(step > 0.0);
                n_gentle += usize::from(step > 0.0 && step <= 1.0);
            }
        }
        n == 0 || (n_gentle as f64 / n as f64) < MAX_GENTLE
    }

    /// Share of the neighbours with neither the sample's value nor the commonest one; samples of that are left out.
    fn share_of_others(&self, levels: &[(f64, usize)]) -> f64 {
        let Some(background) = commonest(levels) else { return 1.0 };
        if self.pairs.is_empty() || levels.len() < 2 {
            return 1.0;
        }
        let share = |side: &Vec<f64>| {
            let (mut n, mut n_others) = (0_usize, 0_usize);
            for (&own, &side) in self.samples.iter().zip(side) {
                n += usize::from(own != background);
                n_others += usize::from(own != background && side != own && side != background);
            }
            n_others as f64 / n as f64
        };
        mean(&self.sides().map(share).collect::<Vec<_>>())
    }

    fn sides(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.pairs.iter().flat_map(|(before, after)| [before, after])
    }
}
