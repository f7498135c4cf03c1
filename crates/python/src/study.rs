//! Renderers for comparison with the method: standard splatting, and the method without one of its parts.

use numpy::PyArray3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wavesplat::{Composite, Kernel, with_threads};
use wavesplat_study::RenderOptions;
use wavesplat_study::reference::splat;
use wavesplat_study::standard::{self, Buffer, StandardOptions};

use crate::arguments::{PyAblation, PyCamera, PyShading, PyTransferFunction, Triple};
use crate::errors::to_py;
use crate::progress::PyProgress;
use crate::rendering::{Corners, clip_planes, crop, image};
use crate::volume::{Drawable, PyVolume};

/// See `_native.pyi`.
#[pyfunction]
#[pyo3(signature = (volume, transfer_function, camera, *, width, height, kernel, shading, oversampling, buffer,
    view_angle_correction, crop_index, crop_world, clip_planes, background, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword-only arguments of the binding")]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands volumes over by value")]
pub fn render_standard<'py>(
    py: Python<'py>,
    volume: Drawable<'py>,
    transfer_function: &PyTransferFunction,
    camera: &PyCamera,
    width: usize,
    height: usize,
    kernel: &str,
    shading: Option<&PyShading>,
    oversampling: f64,
    buffer: &str,
    view_angle_correction: bool,
    crop_index: Corners,
    crop_world: Corners,
    clip_planes: Vec<(Triple, Triple)>,
    background: Option<[f32; 4]>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = RenderOptions {
        width_px: width,
        height_px: height,
        shading: shading.map(|s| s.0.clone()),
        oversampling,
        crop: crop(crop_index, crop_world),
        clip_planes: self::clip_planes(clip_planes),
        background,
        n_threads: threads,
        ..RenderOptions::default()
    };
    options.validate().map_err(to_py)?;
    let standard = StandardOptions {
        buffer: Buffer::from_name(buffer).map_err(to_py)?,
        view_angle_correction,
        kernel: Kernel::from_name(kernel).map_err(to_py)?,
    };
    let watched = PyProgress::new(progress);
    let result = volume.with_volume(py, |subject| {
        let curves = subject.look(&transfer_function.0, Composite::Over, None).map_err(to_py)?;
        let options = RenderOptions { crop: options.crop.map(|crop| subject.crop_on_level(crop)), ..options };
        watched.watch(py, || {
            // Samples themselves are splatted with any kernel, so slices prepared for the linear one serve.
            let slices = with_threads(options.n_threads, || subject.slices(Kernel::Linear));
            standard::render(&slices, &curves, &camera.0, &options, standard, &watched)
        })
    })?;
    let (picture, report) = result.map_err(to_py)?;
    let dict = PyDict::new(py);
    dict.set_item("depth", py.None())?;
    dict.set_item("value", py.None())?;
    dict.set_item("rgba", image(py, picture)?)?;
    let numbers = PyDict::new(py);
    numbers.set_item("method", "standard")?;
    numbers.set_item("buffer", buffer)?;
    numbers.set_item("view_angle_correction", view_angle_correction)?;
    numbers.set_item("oversampling", oversampling)?;
    numbers.set_item("n_splats", report.n_splats)?;
    numbers.set_item("n_sheets", report.n_sheets)?;
    numbers.set_item("n_nonfinite_samples", report.n_nonfinite_samples)?;
    numbers.set_item("n_threads", report.n_threads)?;
    numbers.set_item("simd", report.simd)?;
    dict.set_item("report", numbers)?;
    Ok(dict)
}

/// See `_native.pyi`.
#[pyfunction]
#[pyo3(signature = (volume, transfer_function, camera, *, ablation, width, height, kernel, shading, sheets_per_slice,
    oversampling, crop_index, crop_world, clip_planes, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword-only arguments of the binding")]
pub fn splat_ablated<'py>(
    py: Python<'py>,
    volume: &PyVolume,
    transfer_function: &PyTransferFunction,
    camera: &PyCamera,
    ablation: &PyAblation,
    width: usize,
    height: usize,
    kernel: &str,
    shading: Option<&PyShading>,
    sheets_per_slice: f64,
    oversampling: f64,
    crop_index: Corners,
    crop_world: Corners,
    clip_planes: Vec<(Triple, Triple)>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let kernel = Kernel::from_name(kernel).map_err(to_py)?;
    let options = RenderOptions {
        width_px: width,
        height_px: height,
        shading: shading.map(|s| s.0.clone()),
        sheets_per_slice,
        oversampling,
        crop: crop(crop_index, crop_world),
        clip_planes: self::clip_planes(clip_planes),
        n_threads: threads,
        ..RenderOptions::default()
    };
    let monitor = PyProgress::new(progress);
    let picture = volume.with_volume(py, |v| {
        let (tf, camera) = (&transfer_function.0, &camera.0);
        let draw = || splat::picture(v, kernel, tf, camera, &options, &ablation.0, &monitor);
        monitor.watch(py, draw)?.map_err(to_py)
    })?;
    image(py, picture)
}
