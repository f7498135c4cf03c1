//! The kind of data in a volume in memory, from samples spread over it and the facts of its file.

use std::convert::Infallible;

use wavesplat_core::{Facts, Grid, Samples, Volume};
use wavesplat_files::NO_PLACE;
use wavesplat_files::length_units::metres;
use wavesplat_look::{
    Evidence, FoundKind, HISTOGRAM_SAMPLES, KIND_SAMPLES, KindFacts, MIN_FINITE, Neighbourhood, NumberType,
    SeenSamples, Source, kind, step_for,
};
use wavesplat_view::Stack;

/// The kind of data that a volume holds (CT, MR, PET, a field, labels, ...), and why it is thought so.
///
/// Facts of the file come first; where they are missing, the values decide. `wavesplat info` says the same of a file.
///
/// ```
/// use wavesplat::glam::DAffine3;
/// use wavesplat::{Facts, Samples, Volume, kind_of, look::DataKind};
///
/// # fn main() -> wavesplat::Result<()> {
/// // Air and soft tissue, with some noise.
/// let noise = |k: i16| k * 37 % 61 - 30;
/// let samples: Vec<i16> = (0..20 * 20 * 20).map(|k| noise(k % 800) + if k % 20 < 10 { -1000 } else { 40 }).collect();
/// let volume = Volume::new("scan", Samples::I16(&samples), [20; 3], DAffine3::IDENTITY)?;
/// let facts = Facts { modality: Some("CT".into()), is_anatomical: true, ..Facts::default() };
/// assert_eq!(kind_of(&volume, &facts).kind, DataKind::Ct);
/// # Ok(())
/// # }
/// ```
pub fn kind_of(volume: &Volume<'_>, facts: &Facts) -> FoundKind {
    with_evidence(volume, facts, |_, found, _| found)
}

/// The answer to a question about the kind of a volume, and the samples that decided it.
pub(crate) fn with_evidence<R>(
    volume: &Volume<'_>,
    facts: &Facts,
    ask: impl FnOnce(Evidence<'_>, FoundKind, &All<'_>) -> R,
) -> R {
    let all = All(volume);
    let (samples, pairs) = all.looked_at();
    let pairs = pairs.iter().map(|(before, after)| (&before[..], &after[..])).collect();
    let around = Neighbourhood { samples: &samples, pairs };
    let facts = kind_facts(volume, facts);
    let seen = SeenSamples::in_samples(&around, &facts);
    let evidence = Evidence { facts, seen, around };
    match kind(&evidence, &all) {
        Ok(found) => ask(evidence, found, &all),
        Err(never) => match never {},
    }
}

/// Azimuth and elevation of the view that suits a volume, degrees. `found`: gives its kind, where that decides.
pub(crate) fn natural_angles(grid: &Grid, facts: &Facts, found: impl Fn() -> FoundKind) -> (f64, f64) {
    let angles = Stack::of(grid).natural_view(
        facts.is_anatomical,
        || Ok::<_, Infallible>(is_upright(facts, &found)),
        || Ok(is_of_patient(grid, facts, &found)),
    );
    match angles {
        Ok(angles) => angles,
        Err(never) => match never {},
    }
}

/// Whether a volume shows a patient. `found`: gives its kind, where that decides.
fn is_of_patient(grid: &Grid, facts: &Facts, found: impl FnOnce() -> FoundKind) -> bool {
    if !facts.is_anatomical || facts.modality.is_some() || !Stack::of(grid).is_placed_by_default() {
        return facts.is_anatomical;
    }
    found().shows_patient(has_no_place(facts))
}

/// Whether the axes of the world grow to the right and up in pictures, as of calculated data. `found`: as above.
fn is_upright(facts: &Facts, found: impl FnOnce() -> FoundKind) -> bool {
    !facts.is_anatomical && facts.modality.is_none() && found().is_calculated()
}

fn has_no_place(facts: &Facts) -> bool {
    facts.conventions.iter().any(|convention| convention == NO_PLACE)
}

fn kind_facts<'a>(volume: &'a Volume<'_>, facts: &'a Facts) -> KindFacts<'a> {
    let grid = volume.grid();
    let statistics = grid.statistics();
    KindFacts {
        name: &facts.name,
        modality: facts.modality.as_deref(),
        value_unit: facts.value_unit.as_deref(),
        quantity: facts.quantity.as_deref(),
        is_anatomical: facts.is_anatomical,
        is_placed_by_default: Stack::of(grid).is_placed_by_default(),
        has_no_place: has_no_place(facts),
        metres: facts.unit.as_deref().and_then(metres),
        spacing: grid.spacing().to_array(),
        range: (statistics.min, statistics.max),
        numbers: match volume.samples() {
            Samples::U8(_) | Samples::U16(_) | Samples::U32(_) => NumberType::Unsigned,
            Samples::I8(_) | Samples::I16(_) | Samples::I32(_) => NumberType::Signed,
            Samples::F32(_) | Samples::F64(_) => NumberType::Float,
        },
        is_single: matches!(volume.samples(), Samples::F32(_)),
        ..KindFacts::default()
    }
}

/// Samples before and after others along an axis.
type OwnPair = (Vec<f64>, Vec<f64>);

/// All samples of a volume in memory.
pub(crate) struct All<'a>(&'a Volume<'a>);

impl All<'_> {
    fn size(&self) -> [usize; 3] {
        self.0.grid().size()
    }

    fn n_samples(&self) -> usize {
        self.size().iter().product()
    }

    /// Samples spread evenly over the volume, and their two neighbours along z, y and x where these have any.
    fn looked_at(&self) -> (Vec<f64>, Vec<OwnPair>) {
        let step = step_for(self.n_samples(), KIND_SAMPLES);
        let places = |n: usize, first: usize, n_left_out: usize| (first..n - n_left_out).step_by(step).collect();
        let inside = self.size().map(|n| if n >= 3 { places(n, 1, 1) } else { places(n, 0, 0) });
        let samples = self.at(&inside);
        let n_finite = samples.iter().filter(|sample| sample.is_finite()).count();
        if self.0.grid().statistics().n_nonfinite > 0 && n_finite < MIN_FINITE {
            return self.finite_with_neighbours();
        }
        let pairs = [2, 1, 0].into_iter().filter(|&axis| self.size()[axis] >= 3).map(|axis| {
            let moved = |first, n_left_out| {
                let mut moved = inside.clone();
                moved[axis] = places(self.size()[axis], first, n_left_out);
                self.at(&moved)
            };
            (moved(0, 2), moved(2, 0))
        });
        let pairs = pairs.collect();
        (samples, pairs)
    }

    /// The samples at places along x, y and z, x fastest.
    fn at(&self, [xs, ys, zs]: &[Vec<usize>; 3]) -> Vec<f64> {
        let [nx, ny, _] = self.size();
        let samples = self.0.samples();
        let rows = zs.iter().flat_map(|z| ys.iter().map(move |y| (z * ny + y) * nx));
        rows.flat_map(|row| xs.iter().map(move |x| samples.get(row + x))).collect()
    }

    /// Every n-th sample along each axis, some millions at most, and their numbers along x, y and z.
    fn every(&self) -> (Vec<f64>, [usize; 3]) {
        let step = step_for(self.n_samples(), HISTOGRAM_SAMPLES);
        let places = self.size().map(|n| (0..n).step_by(step).collect::<Vec<_>>());
        (self.at(&places), places.each_ref().map(Vec::len))
    }

    /// Finite samples, also of the border, and their neighbours, which may be missing.
    fn finite_with_neighbours(&self) -> (Vec<f64>, Vec<OwnPair>) {
        let (samples, [nx, ny, nz]) = self.every();
        let finite: Vec<usize> = (0..samples.len()).filter(|&k| samples[k].is_finite()).collect();
        let chosen: Vec<usize> = finite.iter().copied().step_by((finite.len() / KIND_SAMPLES).max(1)).collect();
        let pairs = [(nx * ny, nz), (nx, ny), (1, nx)].map(|(stride, n)| {
            let place = |k: usize| k / stride % n;
            let before = |&k: &usize| if place(k) > 0 { samples[k - stride] } else { f64::NAN };
            let after = |&k: &usize| if place(k) + 1 < n { samples[k + stride] } else { f64::NAN };
            (chosen.iter().map(before).collect(), chosen.iter().map(after).collect())
        });
        (chosen.iter().map(|&k| samples[k]).collect(), pairs.into())
    }
}

impl Source for All<'_> {
    type Error = Infallible;

    fn spread<R>(&self, look: impl FnOnce(&[f64], [usize; 3]) -> R) -> Result<R, Infallible> {
        let (samples, [nx, ny, nz]) = self.every();
        Ok(look(&samples, [nz, ny, nx]))
    }

    fn is_whole(&self) -> Result<bool, Infallible> {
        let is_whole = |value: f64| value.is_nan() || value.is_infinite() || value.fract() == 0.0;
        Ok(match self.0.samples() {
            Samples::F32(samples) => samples.iter().all(|&value| is_whole(value.into())),
            Samples::F64(samples) => samples.iter().all(|&value| is_whole(value)),
            _ => true,
        })
    }
}
