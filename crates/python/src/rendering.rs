//! The drawing functions.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use numpy::{IntoPyArray, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use wavesplat_core::{ClipPlane, Composite, CompositeNumbers, Crop, Kernel, Picture, RenderOptions};
use wavesplat_splat::quality::target_psnr::{Errors, Framing, Measured, Sampling, Wanted, render_to_psnr};
use wavesplat_splat::reference::raycast::RaycastOptions;
use wavesplat_splat::slice_plane::{Plane, Reduction, ThickSlab, plane_values};
use wavesplat_splat::{Layer, ProgressCallback, reference, with_threads};

use crate::arguments::{PyCamera, PyShading, PyTransferFunction, Triple, vector};
use crate::errors::to_py;
use crate::labels::PyLabels;
use crate::volume::{Drawable, PyVolume};

/// Corners of a crop box.
pub type Corners = Option<(Triple, Triple)>;

pub(crate) fn crop(index: Corners, world: Corners) -> Option<Crop> {
    let index = index.map(|(lo, hi)| Crop::Index { lo: vector(lo), hi: vector(hi) });
    index.or(world.map(|(lo, hi)| Crop::World { lo: vector(lo), hi: vector(hi) }))
}

pub(crate) fn clip_planes(planes: Vec<(Triple, Triple)>) -> Vec<ClipPlane> {
    planes.into_iter().map(|(origin, normal)| ClipPlane { origin: vector(origin), normal: vector(normal) }).collect()
}

/// Tells a Python function about progress, from any thread, at most every few hundredths of a second; stops when it says
/// so or when the caller is interrupted.
pub(crate) struct PyMonitor {
    callback: Option<Py<PyAny>>,
    state: Mutex<MonitorState>,
    /// The thread that draws for Python, and draws along: it alone is told of signals.
    caller: ThreadId,
    interrupted: AtomicBool,
}

struct MonitorState {
    told: Option<Instant>,
    looked_out: Instant,
    error: Option<PyErr>,
}

/// Often enough for a smooth bar, seldom enough to cost nothing.
const PROGRESS_EVERY: Duration = Duration::from_millis(40);

/// Often enough for a prompt Ctrl-C. More seldom than the bar moves: for a look, the caller waits for the interpreter
/// lock, five milliseconds where other threads run Python.
const SIGNALS_EVERY: Duration = Duration::from_millis(100);

impl PyMonitor {
    pub(crate) fn new(callback: Option<Py<PyAny>>) -> Self {
        let state = Mutex::new(MonitorState { told: None, looked_out: Instant::now(), error: None });
        Self { callback, state, caller: thread::current().id(), interrupted: AtomicBool::new(false) }
    }

    /// Runs `work` without the interpreter lock; an error that stopped it takes the place of its result.
    pub(crate) fn watch<T: Send>(&self, py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        let result = py.detach(work);
        let error = self.state.lock().ok().and_then(|mut state| state.error.take());
        error.map_or(Ok(result), Err)
    }

    /// Looks out for signals, where the caller itself asks.
    fn look_out(&self) {
        if thread::current().id() != self.caller {
            return;
        }
        let Ok(mut state) = self.state.try_lock() else { return };
        if state.looked_out.elapsed() >= SIGNALS_EVERY {
            #[expect(clippy::redundant_closure_for_method_calls, reason = "the method alone is not general enough")]
            let signals = Python::attach(|py| py.check_signals());
            if let Err(error) = signals {
                state.error = Some(error);
                self.interrupted.store(true, Ordering::Relaxed);
            }
            state.looked_out = Instant::now();
        }
    }

    /// Asks the Python function. False stops, anything else goes on; an exception stops and reaches the caller.
    fn ask(&self, callback: &Py<PyAny>, fraction: f32) -> ControlFlow<()> {
        let Ok(mut state) = self.state.try_lock() else { return ControlFlow::Continue(()) };
        if fraction < 1.0 && state.told.is_some_and(|told| told.elapsed() < PROGRESS_EVERY) {
            return ControlFlow::Continue(());
        }
        state.told = Some(Instant::now());
        let answer = Python::attach(|py| {
            let answer = callback.call1(py, (fraction,))?;
            PyResult::Ok(answer.is_none(py) || answer.extract::<bool>(py).unwrap_or(true))
        });
        match answer {
            Ok(true) => ControlFlow::Continue(()),
            Ok(false) => ControlFlow::Break(()),
            Err(error) => {
                state.error = Some(error);
                ControlFlow::Break(())
            }
        }
    }
}

impl ProgressCallback for PyMonitor {
    fn progress(&self, fraction: f32) -> ControlFlow<()> {
        self.look_out();
        if self.interrupted.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        self.callback.as_ref().map_or(ControlFlow::Continue(()), |callback| self.ask(callback, fraction))
    }
}

pub(crate) fn image(py: Python<'_>, picture: Picture) -> PyResult<Bound<'_, PyArray3<f32>>> {
    let Picture { width_px, height_px, rgba, .. } = picture;
    rgba.into_flattened().into_pyarray(py).reshape([height_px, width_px, 4])
}

/// What a picture told of its error, as a dictionary.
#[derive(Clone, Copy, FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
pub struct PyMeasured {
    along: [f64; 2],
    along_decay: f64,
    across: [f64; 2],
    across_decay: [f64; 2],
    deviation: f64,
    sheets_per_slice: f64,
    oversampling: f64,
    pixel_in_samples: f64,
    slice_in_samples: f64,
    covered: f64,
    is_smooth: bool,
}

impl From<PyMeasured> for Measured {
    fn from(told: PyMeasured) -> Self {
        Self {
            errors: Errors {
                along: told.along,
                along_decay: told.along_decay,
                across: told.across,
                across_decay: told.across_decay,
                deviation: told.deviation,
            },
            at: Sampling { sheets_per_slice: told.sheets_per_slice, oversampling: told.oversampling },
            framing: Framing {
                pixel_in_samples: told.pixel_in_samples,
                slice_in_samples: told.slice_in_samples,
                covered: told.covered,
            },
            is_smooth: told.is_smooth,
        }
    }
}

impl From<Measured> for PyMeasured {
    fn from(measured: Measured) -> Self {
        let Measured { errors, at, framing, is_smooth } = measured;
        Self {
            along: errors.along,
            along_decay: errors.along_decay,
            across: errors.across,
            across_decay: errors.across_decay,
            deviation: errors.deviation,
            sheets_per_slice: at.sheets_per_slice,
            oversampling: at.oversampling,
            pixel_in_samples: framing.pixel_in_samples,
            slice_in_samples: framing.slice_in_samples,
            covered: framing.covered,
            is_smooth,
        }
    }
}

/// See `_native.pyi`.
#[pyfunction]
#[pyo3(signature = (volume, transfer_function, camera, *, labels, width, height, kernel, composite, iso_value,
    local_threshold, depth_shading, attenuation, shading, sheets_per_slice, oversampling, psnr, like, crop_index,
    crop_world, clip_planes, background, threads, depth, pre_integration, early_ray_termination, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword-only arguments of the binding")]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands volumes over by value")]
pub fn render<'py>(
    py: Python<'py>,
    volume: Drawable<'py>,
    transfer_function: &PyTransferFunction,
    camera: &PyCamera,
    labels: Option<&PyLabels>,
    width: usize,
    height: usize,
    kernel: &str,
    composite: &str,
    iso_value: Option<f64>,
    local_threshold: Option<f64>,
    depth_shading: Option<(f64, f64)>,
    attenuation: Option<(f64, f64)>,
    shading: Option<&PyShading>,
    sheets_per_slice: f64,
    oversampling: f64,
    psnr: Option<f64>,
    like: Option<PyMeasured>,
    crop_index: Corners,
    crop_world: Corners,
    clip_planes: Vec<(Triple, Triple)>,
    background: Option<[f32; 4]>,
    threads: Option<usize>,
    depth: bool,
    pre_integration: bool,
    early_ray_termination: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let none = CompositeNumbers::NONE;
    let numbers = CompositeNumbers {
        iso_value: iso_value.unwrap_or(none.iso_value),
        local_threshold: local_threshold.unwrap_or(none.local_threshold),
        depth_shading: depth_shading.map_or(none.depth_shading, <[f64; 2]>::from),
        attenuation: attenuation.map_or(none.attenuation, <[f64; 2]>::from),
    };
    let kernel = Kernel::from_name(kernel).map_err(to_py)?;
    let options = RenderOptions {
        width_px: width,
        height_px: height,
        composite: Composite::from_name(composite, &numbers).map_err(to_py)?,
        shading: shading.map(|s| s.0.clone()),
        sheets_per_slice,
        oversampling,
        crop: crop(volume.own_index(crop_index), crop_world),
        clip_planes: self::clip_planes(clip_planes),
        background,
        with_depth: depth,
        pre_integration,
        early_ray_termination,
        n_threads: threads,
    };
    options.validate().map_err(to_py)?;
    let monitor = PyMonitor::new(progress);
    let curves = volume.transfer_function(&transfer_function.0, options.composite, options.shading.as_ref())?;
    let cache = volume.cache();
    let result = volume.with_slices(py, kernel, |slices| {
        monitor.watch(py, || {
            let slices = with_threads(options.n_threads, slices);
            let (tf, camera) = (&curves, &camera.0);
            let labels = labels.map(|labels| &labels.0);
            let layer = Layer { slices: &slices, transfer_function: tf, labels, cache };
            let Some(psnr_db) = psnr else {
                let drawn = wavesplat_splat::render_layer(&layer, camera, &options, &monitor);
                return drawn.map(|(picture, report)| (picture, report, None));
            };
            let wanted = Wanted { psnr_db, like: like.map(Measured::from) };
            let drawn = render_to_psnr(&layer, camera, &options, &wanted, &monitor);
            drawn.map(|(picture, report, chosen)| (picture, report, Some(chosen)))
        })
    })?;
    let (mut picture, report, chosen) = result.map_err(to_py)?;
    let plane = |values: Option<Vec<f32>>| -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        values.map(|v| v.into_pyarray(py).reshape([height, width])).transpose()
    };
    let dict = PyDict::new(py);
    dict.set_item("depth", plane(picture.depth.take())?)?;
    dict.set_item("value", plane(picture.value.take())?)?;
    dict.set_item("rgba", image(py, picture)?)?;
    let numbers = PyDict::new(py);
    let own = Sampling { sheets_per_slice: options.sheets_per_slice, oversampling: options.oversampling };
    let Sampling { sheets_per_slice, oversampling } = chosen.map_or(own, |chosen| chosen.sampling);
    numbers.set_item("sheets_per_slice", sheets_per_slice)?;
    numbers.set_item("oversampling", oversampling)?;
    if let Some(chosen) = chosen {
        numbers.set_item("expected_psnr_db", chosen.psnr_db)?;
        numbers.set_item("expected_psnr_spread_db", chosen.spread_db)?;
        numbers.set_item("measured", chosen.measured.map(PyMeasured::from))?;
    }
    numbers.set_item("n_texels", report.n_texels)?;
    numbers.set_item("n_skipped_sheets", report.n_skipped_sheets)?;
    numbers.set_item("n_base_planes", report.n_base_planes)?;
    numbers.set_item("n_base_texels", report.n_base_texels)?;
    numbers.set_item("n_sheets", report.n_sheets)?;
    numbers.set_item("n_nonfinite_samples", report.n_nonfinite_samples)?;
    numbers.set_item("n_threads", report.n_threads)?;
    numbers.set_item("simd", report.simd)?;
    dict.set_item("report", numbers)?;
    Ok(dict)
}

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
        let monitor = PyMonitor::new(None);
        let labels = labels.map(|labels| &labels.0);
        let cast = || reference::raycast::raycast_labelled(v, labels, tf, camera, &options, sampling, &monitor);
        monitor.watch(py, cast)?.map_err(to_py)
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

/// See `_native.pyi`.
#[pyfunction]
#[pyo3(signature = (volume, *, origin, across, down, width, height, kernel, slab, n_planes, step, threads))]
#[expect(clippy::too_many_arguments, reason = "keyword-only arguments of the binding")]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands what is drawn over by value")]
pub fn plane<'py>(
    py: Python<'py>,
    volume: Drawable<'py>,
    origin: Triple,
    across: Triple,
    down: Triple,
    width: usize,
    height: usize,
    kernel: &str,
    slab: &str,
    n_planes: usize,
    step: Triple,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let kernel = Kernel::from_name(kernel).map_err(to_py)?;
    let size = RenderOptions { width_px: width, height_px: height, n_threads: threads, ..RenderOptions::default() };
    size.validate().map_err(to_py)?;
    let (across, down) = (vector(across), vector(down));
    let plane = Plane { origin: vector(origin), across, down, width_px: width, height_px: height };
    let slab = ThickSlab { reduction: Reduction::from_name(slab).map_err(to_py)?, n_planes, step: vector(step) };
    let monitor = PyMonitor::new(None);
    let values = volume.with_slices(py, kernel, |slices| {
        monitor.watch(py, || {
            let slices = with_threads(threads, slices);
            plane_values(&slices, &plane, &slab, threads, &monitor)
        })
    })?;
    values.map_err(to_py)?.into_pyarray(py).reshape([height, width])
}

/// See `_native.pyi`.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands volumes over by value")]
pub fn quality_settings(
    py: Python<'_>,
    name: &str,
    volume: Drawable<'_>,
    transfer_function: &PyTransferFunction,
    shading: Option<&PyShading>,
    camera: &PyCamera,
    height: usize,
) -> PyResult<(f64, f64)> {
    let curves = &transfer_function.0;
    let is_steep = volume.is_steep(py, curves, shading.map(|s| &s.0))?;
    volume.with_grid(py, |grid| {
        let samples_per_pixel = camera.0.pixel_size(grid.middle(), height) / grid.mean_spacing();
        let settings = wavesplat_core::quality_settings(name, is_steep, grid.coarseness(), samples_per_pixel);
        let (sheets, oversampling) = settings.map_err(to_py)?;
        // What two dimensions decide cannot be integrated along a slab: only more sheets find what is thin.
        let finer = if is_steep && curves.joint().is_some() { SHEETS_OF_TWO_DIMENSIONS } else { 1.0 };
        Ok((sheets * finer, oversampling))
    })
}

/// Times as many sheets for steep functions of two dimensions.
const SHEETS_OF_TWO_DIMENSIONS: f64 = 3.0;

/// Associated float RGBA to the bytes of an unassociated 8- or 16-bit PNG; colours are used as given.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn encode_png<'py>(py: Python<'py>, rgba: PyReadonlyArray3<'py, f32>, bits: u32) -> PyResult<Bound<'py, PyBytes>> {
    let [height, width, 4] = *rgba.shape() else {
        return Err(PyTypeError::new_err("rgba must have the shape [height, width, 4]"));
    };
    if bits != 8 && bits != 16 {
        return Err(PyValueError::new_err(format!("bits is {bits}; pass 8 or 16")));
    }
    let pixels = rgba.as_slice()?;
    let bytes = py.detach(|| png_bytes(pixels, width, height, bits));
    bytes.map(|b| PyBytes::new(py, &b)).map_err(|e| PyValueError::new_err(e.to_string()))
}

fn png_bytes(pixels: &[f32], width: usize, height: usize, bits: u32) -> Result<Vec<u8>, png::EncodingError> {
    let top = if bits == 8 { 255.0 } else { 65535.0 };
    let mut data = Vec::with_capacity(pixels.len() * bits as usize / 8);
    for pixel in pixels.chunks_exact(4) {
        let alpha = pixel[3].clamp(0.0, 1.0);
        let unassociate = |c: f32| if alpha > 0.0 { (c / alpha).clamp(0.0, 1.0) } else { 0.0 };
        for c in [unassociate(pixel[0]), unassociate(pixel[1]), unassociate(pixel[2]), alpha] {
            let level = (c * top).round() as u16;
            if bits == 8 { data.push(level as u8) } else { data.extend(level.to_be_bytes()) }
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(if bits == 8 { png::BitDepth::Eight } else { png::BitDepth::Sixteen });
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&data)?;
    writer.finish()?;
    Ok(bytes)
}
