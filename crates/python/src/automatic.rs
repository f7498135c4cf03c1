//! Automatic looks, greys of projections and windows of channels; see `_native.pyi`.
#![expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]

use numpy::{PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use wavesplat::look::{
    self, AutomaticLook, CurveNodes, DataKind, FoundKind, LightSettings, RayOperator, Refusal, SliceFacts, Source,
    SpreadSamples, Subject, VolumeChannel,
};

use crate::arguments::{PyTransferFunction, Text};
use crate::errors::exceptions::ArgumentError;
use crate::kinds::{More, Nodes, PyFacts, Values, nodes};
use crate::look::{ChannelTuple, RgbTuple, channel};

type Grid3<'py> = PyReadonlyArray3<'py, f64>;

/// Samples spread over a volume [z, y, x], its own shape, and its spacing along x, y and z.
type SpreadOver<'py> = (Grid3<'py>, [usize; 3], [f64; 3]);

fn spread<'a>((samples, size, spacing): &'a SpreadOver<'_>) -> PyResult<SpreadSamples<'a>> {
    let &[n_z, n_y, n_x] = samples.shape() else { unreachable!("three axes") };
    Ok(SpreadSamples { samples: samples.as_slice()?, shape: [n_z, n_y, n_x], size: *size, spacing: *spacing })
}

/// An operator by its public name.
pub struct PyRayOperator(pub RayOperator);

impl<'py> FromPyObject<'_, 'py> for PyRayOperator {
    type Error = PyErr;

    fn extract(name: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let Text(name) = name.extract()?;
        RayOperator::named(&name).map(Self).ok_or_else(|| {
            let names = RayOperator::NAMES.map(|(name, _)| name).join(", ");
            ArgumentError::new_err(format!("unknown composite operator '{name}'; use one of: {names}"))
        })
    }
}

/// The reason why a volume has no automatic look: "uniform", "too far apart", or None.
#[pyfunction]
pub fn look_refused(range: (f64, f64), has_missing: bool, composite: Option<PyRayOperator>) -> Option<&'static str> {
    Refusal::of(range, has_missing, composite.map(|one| one.0)).map(|refusal| match refusal {
        Refusal::Uniform => "uniform",
        Refusal::TooFarApart => "too far apart",
    })
}

/// The channel of a volume, all of its file, window, whether it is part of a colour, and the largest value of its type.
type ChannelOfVolume = (Option<ChannelTuple>, Vec<ChannelTuple>, Option<(f64, f64)>, bool, Option<f64>);

fn volume_channel((own, all, window, is_part_of_color, largest_of_type): &ChannelOfVolume) -> VolumeChannel<'_> {
    VolumeChannel {
        own: own.as_ref().map(channel),
        all: all.iter().map(channel).collect(),
        window: *window,
        is_part_of_color: *is_part_of_color,
        largest_of_type: *largest_of_type,
    }
}

/// See `Subject` of `_native.pyi`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct PySubject<'py> {
    facts: PyFacts,
    kind: String,
    reason: String,
    has_few_bright: bool,
    values: Values<'py>,
    gradients: Values<'py>,
    fill: Option<f64>,
    size: [usize; 3],
    slices: (bool, Option<usize>, bool),
    channel: ChannelOfVolume,
    spread: Py<PyAny>,
}

/// Curves, opacity unit, settings of the light, operator, whether it is for white, view, whether it is cut open, reason.
type Chosen =
    (Nodes, Option<f64>, Option<Vec<(&'static str, f64)>>, &'static str, bool, Option<&'static str>, bool, String);

fn settings(light: LightSettings) -> Vec<(&'static str, f64)> {
    light.to_vec()
}

#[pyfunction]
pub fn automatic_look(
    py: Python<'_>,
    subject: PySubject<'_>,
    composite: Option<PyRayOperator>,
    color: Option<RgbTuple>,
) -> PyResult<Chosen> {
    let kind = DataKind::ALL.into_iter().find(|kind| kind.name() == subject.kind).expect("a kind that was found");
    let found = FoundKind {
        kind,
        reason: subject.reason,
        has_noise: false, // looks do not depend on it
        has_few_bright: subject.has_few_bright,
    };
    let (are_few, distant_axis, is_thin) = subject.slices;
    let asked = Subject {
        facts: subject.facts.facts(),
        found: &found,
        values: subject.values.as_slice()?,
        gradients: subject.gradients.as_slice()?,
        fill: subject.fill,
        size: subject.size,
        slices: SliceFacts { are_few, distant_axis, is_thin },
        channel: volume_channel(&subject.channel),
    };
    let more = More { is_whole: subject.spread.clone_ref(py), spread: subject.spread };
    let (composite, color) = (composite.map(|one| one.0), color.map(Into::into));
    let look = py.detach(|| asked.look(composite, color, &more))?;
    let AutomaticLook { curves, opacity_unit, light, operator, is_on_white, view, is_cut_open, reason } = look;
    let light = light.map(settings);
    Ok((nodes(&curves), opacity_unit, light, operator.name(), is_on_white, view, is_cut_open, reason))
}

#[pyfunction]
pub fn is_block(py: Python<'_>, samples: Grid3<'_>, function: PyRef<'_, PyTransferFunction>) -> PyResult<bool> {
    let samples = (samples, [0; 3], [0.0; 3]);
    let (samples, function) = (spread(&samples)?, &function.0);
    Ok(py.detach(|| look::is_block(&samples, |value| function.opacity(value))))
}

#[pyfunction]
pub fn greys_of_projection(
    py: Python<'_>,
    of: SpreadOver<'_>,
    composite: PyRayOperator,
    is_hounsfield: bool,
) -> PyResult<Nodes> {
    let of = spread(&of)?;
    Ok(nodes(&py.detach(|| CurveNodes::of_projection(&of, composite.0, is_hounsfield))))
}

#[pyfunction]
pub fn greys_of_pixels(
    py: Python<'_>,
    pixels: Values<'_>,
    composite: PyRayOperator,
    range: (f64, f64),
) -> PyResult<Nodes> {
    let pixels = pixels.as_slice()?;
    Ok(nodes(&py.detach(|| CurveNodes::of_pixels(pixels, composite.0, range))))
}

#[pyfunction]
pub fn attenuation(py: Python<'_>, of: SpreadOver<'_>, is_hounsfield: bool) -> PyResult<(f64, f64)> {
    let of = spread(&of)?;
    Ok(py.detach(|| of.attenuation(is_hounsfield)))
}

#[pyfunction]
pub fn channel_window(of: ChannelOfVolume, largest: f64, samples: Py<PyAny>) -> PyResult<(f64, f64, String)> {
    let of = volume_channel(&of);
    let found = if of.is_part_of_color {
        of.window(largest, Vec::new)
    } else {
        let more = Python::attach(|py| More { is_whole: samples.clone_ref(py), spread: samples });
        more.spread(|samples, shape| of.window(largest, || look::without_padding(samples, shape)))?
    };
    Ok((found.low, found.high, found.note))
}

#[pyfunction]
pub fn is_whole_range(window: (f64, f64), largest: f64) -> bool {
    look::is_whole_range(window, largest)
}
