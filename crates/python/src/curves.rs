//! Curves of looks: opacity of voxels, light of channels, changes; see `_native.pyi`.

use pyo3::prelude::*;
use wavesplat::look::changes::{self, ColorRow, OpacityRow};
use wavesplat::look::{channel_ramp, voxels};

use crate::look::RgbTuple;

type Curves = (Vec<(f64, f64)>, Vec<(f64, f64, f64, f64)>);

fn curves(opacity: Vec<OpacityRow>, color: Vec<ColorRow>) -> Curves {
    (opacity.into_iter().map(Into::into).collect(), color.into_iter().map(Into::into).collect())
}

fn curves_of((opacity, color): channel_ramp::Ramp) -> Curves {
    let opacity = opacity.into_iter().map(|node| (node.value, node.opacity)).collect();
    (opacity, color.into_iter().map(|node| (node.value, node.rgb[0], node.rgb[1], node.rgb[2])).collect())
}

#[pyfunction]
pub fn opaque_after(n_samples: [usize; 3], spacing: [f64; 3]) -> f64 {
    voxels::opaque_after(n_samples, spacing)
}

#[pyfunction]
pub fn lightened(color: RgbTuple) -> RgbTuple {
    channel_ramp::lightened(color.into()).into()
}

#[pyfunction]
#[pyo3(name = "channel_ramp")]
pub fn ramp(color: RgbTuple, low: f64, high: f64, n_voxels: f64) -> Curves {
    curves_of(channel_ramp::ramp(color.into(), low, high, n_voxels, None, channel_ramp::WHITE))
}

#[pyfunction]
pub fn ramp_of_part(color: RgbTuple, low: f64, high: f64, n_voxels: f64) -> Curves {
    curves_of(channel_ramp::ramp_of_part(color.into(), low, high, n_voxels))
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
pub fn window_of(opacity: Vec<OpacityRow>, color: Vec<ColorRow>) -> Option<(f64, f64)> {
    changes::window_of(&opacity, &color)
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
pub fn in_window(
    opacity: Vec<OpacityRow>,
    color: Vec<ColorRow>,
    gradients: Vec<OpacityRow>,
    window: (f64, f64),
    wanted: (f64, f64),
) -> (Curves, Vec<(f64, f64)>) {
    let moved = curves(changes::in_window(&opacity, window, wanted), changes::in_window(&color, window, wanted));
    (moved, changes::gradients_in_window(&gradients, window, wanted).into_iter().map(Into::into).collect())
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
pub fn bent(color: Vec<ColorRow>, window: (f64, f64), gamma: f64) -> Vec<(f64, f64, f64, f64)> {
    changes::bent(&color, window, gamma).into_iter().map(Into::into).collect()
}

#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
pub fn exposed(
    opacity: Vec<OpacityRow>,
    color: Vec<ColorRow>,
    exposure: f64,
    is_channel: bool,
    is_projection: bool,
) -> Curves {
    let (opacity, color) = changes::exposed(&opacity, &color, exposure, is_channel, is_projection);
    curves(opacity, color)
}
