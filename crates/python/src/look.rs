//! Colours and looks; see `_native.pyi`.

use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavesplat::Composite;
use wavesplat::look::channel_colors::{self, ChannelFacts};
use wavesplat::look::colormaps::{ColorMap, MapRange, Rise};
use wavesplat::look::colors;
use wavesplat::look::presets::{OpacityUnit, Preset, SlicerPreset, ours, slicer_name, slicers};
use wavesplat::look::scale::Scale;
use wavesplat::look::texts;

use crate::arguments::{Text, rows};

/// Red, green, blue.
pub type RgbTuple = (f64, f64, f64);
/// Name, colour and wavelength of a channel.
pub type ChannelTuple = (String, Option<RgbTuple>, Option<f64>);

pub fn channel((name, color, emission_nm): &ChannelTuple) -> ChannelFacts<'_> {
    ChannelFacts { name, color: color.map(Into::into), emission_nm: *emission_nm }
}

#[pyfunction]
pub fn label_color(place: i64) -> RgbTuple {
    colors::label_color(place).into()
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
pub fn channel_color(facts: ChannelTuple, others: Vec<ChannelTuple>) -> Option<RgbTuple> {
    let all: Vec<_> = others.iter().map(channel).collect();
    channel_colors::color_of(&channel(&facts), &all).map(Into::into)
}

#[pyfunction]
pub fn distinct_colors(wanted: Vec<Option<RgbTuple>>, own: Vec<Option<RgbTuple>>) -> Vec<RgbTuple> {
    let [wanted, own] = [wanted, own].map(|list| list.into_iter().map(|one| one.map(Into::into)).collect::<Vec<_>>());
    channel_colors::distinct_colors(&wanted, &own).into_iter().map(Into::into).collect()
}

/// Values of the first and the last colour, whether places are even in the logarithm, and gamma.
type RangeTuple = (f64, f64, bool, f64);

fn map_range((low, high, is_log, gamma): RangeTuple) -> MapRange {
    MapRange { low, high, is_log, gamma }
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands texts over by value")]
pub fn map_colors(py: Python<'_>, name: Text) -> Option<Bound<'_, PyArray2<f64>>> {
    ColorMap::named(&name.0).map(|map| rows(py, &map.colors()))
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands texts over by value")]
pub fn map_is_diverging(name: Text) -> Option<bool> {
    ColorMap::named(&name.0).map(|map| map.is_diverging)
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn map_nodes(
    places: PyReadonlyArray1<'_, f64>,
    colors: PyReadonlyArray2<'_, f64>,
    range: RangeTuple,
) -> Vec<(f64, f64, f64, f64)> {
    let colors: Vec<_> = colors.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
    let nodes = map_range(range).color_nodes(&places.as_array().to_vec(), &colors);
    nodes.into_iter().map(|node| (node.value, node.rgb[0], node.rgb[1], node.rgb[2])).collect()
}

#[pyfunction]
pub fn rise_nodes(name: Option<Text>, numbers: Vec<f64>, range: RangeTuple) -> Option<Vec<(f64, f64)>> {
    let rise = match (name, &numbers[..]) {
        (Some(name), _) => Rise::NAMED.into_iter().find(|(known, _)| *known == name.0)?.1,
        (None, &[alpha]) => Rise::Constant(alpha),
        (None, _) => Rise::Numbers(numbers),
    };
    let nodes = rise.over(|place| map_range(range).value_at(place));
    Some(nodes.into_iter().map(|node| (node.value, node.opacity)).collect())
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands texts over by value")]
pub fn plain_name(name: Text) -> String {
    texts::plain(&name.0)
}

/// Our presets, each as the fields of its document.
#[pyfunction]
pub fn presets(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    ours().iter().map(|preset| document(py, preset)).collect()
}

fn document<'py>(py: Python<'py>, preset: &Preset) -> PyResult<Bound<'py, PyDict>> {
    let curves = PyDict::new(py);
    curves.set_item("values", preset.scale.name())?;
    match preset.opacity_unit {
        OpacityUnit::Voxel => curves.set_item("opacity_unit", py.None())?,
        OpacityUnit::World(unit) => curves.set_item("opacity_unit", unit)?,
        OpacityUnit::Share(share) => curves.set_item("opacity_unit_share", share)?,
    }
    set_curves(&curves, preset.opacity, preset.color, preset.gradient_opacity)?;
    let found = PyDict::new(py);
    found.set_item("version", 1)?;
    found.set_item("name", preset.name)?;
    found.set_item("kind", preset.kind)?;
    found.set_item("description", preset.description)?;
    found.set_item("transfer_function", curves)?;
    let light = preset.shading.map(|settings| -> PyResult<_> {
        let light = PyDict::new(py);
        settings.iter().try_for_each(|(name, value)| light.set_item(name, value))?;
        Ok(light)
    });
    found.set_item("shading", light.transpose()?)?;
    found.set_item("composite", if preset.composite == Composite::Maximum { "maximum" } else { "over" })?;
    found.set_item("background", preset.is_on_white.then_some("white"))?;
    found.set_item("part", preset.is_of_brain.then_some("brain"))?;
    Ok(found)
}

fn set_curves(
    fields: &Bound<'_, PyDict>,
    opacity: &[(f64, f64)],
    color: &[(f64, [f64; 3])],
    gradients: &[(f64, f64)],
) -> PyResult<()> {
    let color: Vec<_> = color.iter().map(|&(value, [r, g, b])| (value, r, g, b)).collect();
    fields.set_item("opacity", opacity.to_vec())?;
    fields.set_item("color", color)?;
    fields.set_item("gradient_opacity", gradients.to_vec())
}

/// 3D Slicer's presets: public name, whether its values are Hounsfield units, and the fields of Slicer's record.
#[pyfunction]
pub fn slicer_presets(py: Python<'_>) -> PyResult<Vec<(String, bool, Bound<'_, PyDict>)>> {
    let fields = |one: &SlicerPreset| {
        let found = PyDict::new(py);
        found.set_item("name", one.name)?;
        found.set_item("shade", one.is_lit)?;
        let terms = [("ambient", one.ambient), ("diffuse", one.diffuse), ("specular", one.specular)];
        terms.iter().try_for_each(|(name, value)| found.set_item(name, value))?;
        found.set_item("specular_power", one.specular_power)?;
        set_curves(&found, one.opacity, one.color, one.gradient_opacity)?;
        Ok((slicer_name(one), one.is_hounsfield(), found))
    };
    slicers().iter().map(fields).collect()
}

/// Nodes with values instead of places on a scale, or, of `widths`, of differences.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands texts over by value")]
pub fn scale_nodes(scale: Text, nodes: Vec<Vec<f64>>, low: f64, high: f64, widths: bool) -> Option<Vec<Vec<f64>>> {
    let scale = Scale::NAMES.iter().find(|(name, _)| *name == scale.0)?.1;
    match nodes.first().map_or(0, Vec::len) {
        0 => Some(nodes),
        2 => nodes_of::<2>(scale, nodes, low, high, widths),
        _ => nodes_of::<4>(scale, nodes, low, high, widths),
    }
}

fn nodes_of<const N: usize>(
    scale: Scale,
    nodes: Vec<Vec<f64>>,
    low: f64,
    high: f64,
    widths: bool,
) -> Option<Vec<Vec<f64>>> {
    let nodes: Vec<[f64; N]> = nodes.into_iter().map(|node| node.try_into().ok()).collect::<Option<_>>()?;
    let found = if widths { scale.widened(&nodes, low, high) } else { scale.placed(&nodes, low, high) };
    Some(found.into_iter().map(Vec::from).collect())
}
