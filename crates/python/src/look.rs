//! Colours and looks; see `_native.pyi`.

use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use wavesplat::look::channel_colors::{self, ChannelFacts};
use wavesplat::look::colormaps::{ColorMap, MapRange, Rise};
use wavesplat::look::colors;

use crate::arguments::rows;

type RgbTuple = (f64, f64, f64);
/// Name, colour and wavelength of a channel.
type ChannelTuple = (String, Option<RgbTuple>, Option<f64>);

fn channel((name, color, emission_nm): &ChannelTuple) -> ChannelFacts<'_> {
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
pub fn map_colors<'py>(py: Python<'py>, name: &str) -> Option<Bound<'py, PyArray2<f64>>> {
    ColorMap::named(name).map(|map| rows(py, &map.colors()))
}

#[pyfunction]
pub fn map_is_diverging(name: &str) -> Option<bool> {
    ColorMap::named(name).map(|map| map.is_diverging)
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
pub fn rise_nodes(name: Option<&str>, numbers: Vec<f64>, range: RangeTuple) -> Option<Vec<(f64, f64)>> {
    let rise = match (name, &numbers[..]) {
        (Some(name), _) => Rise::NAMED.into_iter().find(|(known, _)| *known == name)?.1,
        (None, &[alpha]) => Rise::Constant(alpha),
        (None, _) => Rise::Numbers(numbers),
    };
    let nodes = rise.over(|place| map_range(range).value_at(place));
    Some(nodes.into_iter().map(|node| (node.value, node.opacity)).collect())
}
