//! The slow renderers that the fast one is measured against.

use numpy::PyArray3;
use pyo3::prelude::*;
use wavesplat_core::{Kernel, RenderOptions};
use wavesplat_splat::reference;
use wavesplat_splat::reference::raycast::RaycastOptions;

use crate::arguments::{PyCamera, PyShading, PyTransferFunction, Triple};
use crate::errors::to_py;
use crate::labels::PyLabels;
use crate::progress::PyProgress;
use crate::rendering::{Corners, clip_planes, crop, image};
use crate::volume::PyVolume;

/// See `_native.pyi`.
#[pyfunction]
#[pyo3(signature = (volume, transfer_function, camera, *, labels, width, height, kernel, shading, step, rays_per_pixel,
    crop_index, crop_world, clip_planes, threads))]
#[expect(clippy::too_many_arguments, reason = "keyword-only arguments of the binding")]
pub fn raycast<'py>(
    py: Python<'py>,
    volume: &PyVolume,
    transfer_function: &PyTransferFunction,
    camera: &PyCamera,
    labels: Option<&PyLabels>,
    width: usize,
    height: usize,
    kernel: &str,
    shading: Option<&PyShading>,
    step: f64,
    rays_per_pixel: usize,
    crop_index: Corners,
    crop_world: Corners,
    clip_planes: Vec<(Triple, Triple)>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let options = RenderOptions {
        width_px: width,
        height_px: height,
        shading: shading.map(|s| s.0.clone()),
        crop: crop(crop_index, crop_world),
        clip_planes: self::clip_planes(clip_planes),
        n_threads: threads,
        ..RenderOptions::default()
    };
    let sampling = RaycastOptions { kernel: Kernel::from_name(kernel).map_err(to_py)?, step, rays_per_pixel };
    let picture = volume.with_volume(py, |v| {
        let (tf, camera) = (&transfer_function.0, &camera.0);
        let progress = PyProgress::new(None);
        let labels = labels.map(|labels| &*labels.0);
        let cast = || reference::raycast::raycast_labelled(v, labels, tf, camera, &options, sampling, &progress);
        progress.watch(py, cast)?.map_err(to_py)
    })?;
    image(py, picture)
}

/// See `_native.pyi`.
#[pyfunction]
#[pyo3(signature = (volume, transfer_function, camera, *, width, height, kernel, shading, sheets_per_slice, threads))]
#[expect(clippy::too_many_arguments, reason = "keyword-only arguments of the binding")]
pub fn splat_literal<'py>(
    py: Python<'py>,
    volume: &PyVolume,
    transfer_function: &PyTransferFunction,
    camera: &PyCamera,
    width: usize,
    height: usize,
    kernel: &str,
    shading: Option<&PyShading>,
    sheets_per_slice: f64,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let kernel = Kernel::from_name(kernel).map_err(to_py)?;
    let options = RenderOptions {
        width_px: width,
        height_px: height,
        shading: shading.map(|s| s.0.clone()),
        sheets_per_slice,
        oversampling: 1.0,
        n_threads: threads,
        ..RenderOptions::default()
    };
    let picture = volume.with_volume(py, |v| {
        let (tf, camera) = (&transfer_function.0, &camera.0);
        py.detach(|| reference::splat::image(v, kernel, tf, camera, &options)).map_err(to_py)
    })?;
    image(py, picture)
}
