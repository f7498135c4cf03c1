//! Colours and looks; see `_native.pyi`.

use pyo3::prelude::*;
use wavesplat::look::channel_colors::{self, ChannelFacts};
use wavesplat::look::colors;

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
