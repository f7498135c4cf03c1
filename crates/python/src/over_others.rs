//! Looks of volumes over others, and light of channels on slices; see `_native.pyi`.
#![expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use wavesplat::look::changes::ColorRow;
use wavesplat::look::{ChannelLight, MapColors, OverLook, OverValues, is_of_two_signs};

use crate::arguments::PyTransferFunction;
use crate::automatic::PyRayOperator;
use crate::kinds::{Nodes, nodes};
use crate::look::RgbTuple;

#[pyfunction]
pub fn map_over(
    places: PyReadonlyArray1<'_, f64>,
    colors: PyReadonlyArray2<'_, f64>,
    is_diverging: bool,
    values: (f64, f64),
    is_window: bool,
    longest_side: f64,
) -> Option<(Nodes, Option<f64>)> {
    let colors: Vec<_> = colors.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
    let map = MapColors { places: &places.as_array().to_vec(), colors: &colors, is_diverging };
    let (low, high) = values;
    let values = if is_window { OverValues::Window(low, high) } else { OverValues::OfVolume(low, high) };
    map.over(values, longest_side).map(|(curves, unit)| (nodes(&curves), unit))
}

/// Values and opacities, and the thickness that they are for.
type Opacity = (Vec<(f64, f64)>, Option<f64>);

#[pyfunction]
pub fn cleared(
    function: PyRef<'_, PyTransferFunction>,
    made_for: PyRayOperator,
    has_name: bool,
    composite: PyRayOperator,
    range: (f64, f64),
    longest_side: f64,
) -> Option<Opacity> {
    let look = OverLook { function: &function.0, made_for: made_for.0, has_name };
    let (opacity, unit) = look.cleared(composite.0, range, longest_side)?;
    Some((opacity.into_iter().map(|node| (node.value, node.opacity)).collect(), unit))
}

#[pyfunction]
pub fn has_two_signs(function: PyRef<'_, PyTransferFunction>) -> bool {
    is_of_two_signs(&function.0)
}

/// Values of black and of the full colour, the colour, and nodes of the curve between.
type LightTuple = (f64, f64, RgbTuple, Vec<(f64, f64, f64, f64)>);

#[pyfunction]
pub fn channel_light(color: Vec<ColorRow>, is_projection: bool) -> LightTuple {
    let ChannelLight { low, high, color, curve } = ChannelLight::of(&color, is_projection);
    (low, high, color.into(), curve.into_iter().map(Into::into).collect())
}
