//! Kinds of data, their evidence, and histograms; see `_native.pyi`.
#![expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use wavesplat::look::{
    self, CurveNodes, Evidence, FoundKind, KindFacts, Neighbourhood, NumberType, SeenSamples, SidePair, Source,
};

pub type Values<'py> = PyReadonlyArray1<'py, f64>;
type Array<'py> = Bound<'py, PyArray1<f64>>;

#[pyfunction]
pub fn step_for(n_samples: usize, most: usize) -> usize {
    look::step_for(n_samples, most)
}

#[pyfunction]
pub fn robust_range(py: Python<'_>, values: Values<'_>) -> PyResult<(f64, f64)> {
    let values = values.as_slice()?;
    Ok(py.detach(|| look::robust_range(values)))
}

#[pyfunction]
pub fn otsu(py: Python<'_>, values: Values<'_>, low: f64, high: f64) -> PyResult<f64> {
    let values = values.as_slice()?;
    Ok(py.detach(|| look::otsu(values, low, high)))
}

#[pyfunction]
pub fn otsu_of_scan(py: Python<'_>, values: Values<'_>, low: f64, high: f64) -> PyResult<(f64, f64, f64)> {
    let values = values.as_slice()?;
    let scan = py.detach(|| look::otsu_of_scan(values, low, high));
    Ok((scan.background, scan.threshold, scan.high))
}

#[pyfunction]
pub fn looks_like_hounsfield(
    py: Python<'_>,
    values: Values<'_>,
    says_ct: bool,
    may_be_fractional: bool,
) -> PyResult<bool> {
    let values = values.as_slice()?;
    Ok(py.detach(|| look::looks_like_hounsfield(values, says_ct, may_be_fractional)))
}

#[pyfunction]
pub fn stored_offset(py: Python<'_>, values: Values<'_>) -> PyResult<f64> {
    let values = values.as_slice()?;
    Ok(py.detach(|| look::stored_offset(values)))
}

/// See `KindFacts` of `_native.pyi`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
#[expect(clippy::struct_excessive_bools, reason = "each is a fact of a file")]
pub struct PyFacts {
    name: String,
    modality: Option<String>,
    value_unit: Option<String>,
    quantity: Option<String>,
    is_lengths: bool,
    has_channel: bool,
    is_anatomical: bool,
    is_of_wavelets: bool,
    is_placed_by_default: bool,
    has_no_place: bool,
    metres: Option<f64>,
    spacing: [f64; 3],
    range: (f64, f64),
    numbers: String,
    is_single: bool,
}

impl PyFacts {
    pub fn facts(&self) -> KindFacts<'_> {
        KindFacts {
            name: &self.name,
            modality: self.modality.as_deref(),
            value_unit: self.value_unit.as_deref(),
            quantity: self.quantity.as_deref(),
            is_lengths: self.is_lengths,
            has_channel: self.has_channel,
            is_anatomical: self.is_anatomical,
            is_of_wavelets: self.is_of_wavelets,
            is_placed_by_default: self.is_placed_by_default,
            has_no_place: self.has_no_place,
            metres: self.metres,
            spacing: self.spacing,
            range: self.range,
            numbers: match &self.numbers[..] {
                "u" => NumberType::Unsigned,
                "i" => NumberType::Signed,
                _ => NumberType::Float,
            },
            is_single: self.is_single,
        }
    }
}

/// Samples with their neighbours, as Python passes them.
type Around<'py> = (Values<'py>, Vec<(Values<'py>, Values<'py>)>);

fn around<'a>((samples, pairs): &'a Around<'_>) -> PyResult<Neighbourhood<'a>> {
    let pair = |(before, after): &'a (Values<'_>, Values<'_>)| Ok((before.as_slice()?, after.as_slice()?));
    let pairs = pairs.iter().map(pair).collect::<PyResult<Vec<SidePair<'a>>>>()?;
    Ok(Neighbourhood { samples: samples.as_slice()?, pairs })
}

/// Functions of Python that read more samples.
pub struct More {
    pub spread: Py<PyAny>,
    pub is_whole: Py<PyAny>,
}

impl Source for More {
    type Error = PyErr;

    fn spread<R>(&self, look: impl FnOnce(&[f64], [usize; 3]) -> R) -> PyResult<R> {
        Python::attach(|py| {
            let samples = self.spread.call0(py)?;
            let samples: PyReadonlyArray3<'_, f64> = samples.extract(py)?;
            let &[n_z, n_y, n_x] = samples.shape() else { unreachable!("three axes") };
            Ok(look(samples.as_slice()?, [n_z, n_y, n_x]))
        })
    }

    fn is_whole(&self) -> PyResult<bool> {
        Python::attach(|py| self.is_whole.call0(py)?.extract(py))
    }
}

/// Kind, reason, whether samples have noise, few of them are bright, they were calculated, and they show a patient where
/// they are placed as by default; values, gradients at these, and the value of samples without data.
type FoundInSamples<'py> = (&'static str, String, bool, bool, bool, bool, Array<'py>, Array<'py>, Option<f64>);

#[pyfunction]
pub fn kind_of_data<'py>(
    py: Python<'py>,
    facts: PyFacts,
    looked_at: Around<'py>,
    finest: Option<Around<'py>>,
    spread: Py<PyAny>,
    is_whole: Py<PyAny>,
) -> PyResult<FoundInSamples<'py>> {
    let looked_at = around(&looked_at)?;
    let finest = finest.as_ref().map(around).transpose()?;
    let more = More { spread, is_whole };
    let has_no_place = facts.has_no_place;
    let (found, seen) = py.detach(|| {
        let facts = facts.facts();
        let seen = SeenSamples::in_samples(&looked_at, &facts);
        let evidence = Evidence { facts, seen, around: finest.unwrap_or(looked_at) };
        look::kind(&evidence, &more).map(|found| (found, evidence.seen))
    })?;
    let fill = seen.fill();
    let (is_calculated, shows_patient) = (found.is_calculated(), found.shows_patient(has_no_place));
    let (values, gradients) = (seen.values.into_pyarray(py), seen.gradients.into_pyarray(py));
    let FoundKind { kind, reason, has_noise, has_few_bright } = found;
    Ok((kind.name(), reason, has_noise, has_few_bright, is_calculated, shows_patient, values, gradients, fill))
}

/// Nodes of opacity and of colour.
pub type Nodes = (Vec<(f64, f64)>, Vec<(f64, f64, f64, f64)>);

pub fn nodes(of: &CurveNodes) -> Nodes {
    let color = |node: &wavesplat::ColorNode| (node.value, node.rgb[0], node.rgb[1], node.rgb[2]);
    (of.opacity.iter().map(|node| (node.value, node.opacity)).collect(), of.color.iter().map(color).collect())
}
