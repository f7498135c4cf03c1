//! Bindings of the drawing functions.

use std::sync::OnceLock;
use std::time::Instant;

use numpy::{IntoPyArray, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use wavesplat::{
    ClipPlane, Composite, Crop, DepthColors, DrawnBy, Effort, Frame, FrameOptions, Framing, Kernel, Measured, Picture,
    Plane, PngBits, PsnrTarget, Reduction, RungError, Sampling, Scene, SceneColor, SceneLayer, StageTimes, ThickSlab,
    png_of_rgba,
};

use crate::arguments::{PyCamera, PyShading, PyTransferFunction, Triple, vector};
use crate::errors::to_py;
use crate::gpu::{device, report_of};
use crate::labels::PyLabels;
use crate::progress::PyProgress;
use crate::shapes::PyShapes;
use crate::volume::{Drawable, with_volumes};

/// Corners of a crop box.
pub type Corners = Option<(Triple, Triple)>;

pub(crate) fn crop(index: Corners, world: Corners) -> Option<Crop> {
    let index = index.map(|(lo, hi)| Crop::Index { lo: vector(lo), hi: vector(hi) });
    index.or(world.map(|(lo, hi)| Crop::World { lo: vector(lo), hi: vector(hi) }))
}

/// Operator of a name, with its numbers in the order of its fields.
fn composite(name: &str, numbers: &[f64]) -> PyResult<Composite> {
    Ok(match (name, numbers) {
        ("over", []) => Composite::Over,
        ("maximum", []) => Composite::Maximum,
        ("depth-shaded-maximum", &[strength, black]) => Composite::DepthShadedMaximum { strength, black },
        ("attenuated-maximum", &[black, white, attenuation]) => {
            Composite::AttenuatedMaximum { black, white, attenuation }
        }
        ("local-maximum", &[threshold]) => Composite::LocalMaximum { threshold },
        ("minimum", []) => Composite::Minimum,
        ("mean", []) => Composite::Mean,
        ("sum", []) => Composite::Sum,
        ("x-ray", &[clear, attenuation]) => Composite::XRay { clear, attenuation },
        ("first-hit", &[iso_value]) => Composite::FirstHit { iso_value },
        _ => return Err(PyValueError::new_err(format!("no composite {name:?} of the numbers {numbers:?}"))),
    })
}

pub(crate) fn clip_planes(planes: Vec<(Triple, Triple)>) -> Vec<ClipPlane> {
    planes.into_iter().map(|(origin, normal)| ClipPlane { origin: vector(origin), normal: vector(normal) }).collect()
}

pub(crate) fn image(py: Python<'_>, picture: Picture) -> PyResult<Bound<'_, PyArray3<f32>>> {
    let Picture { width_px, height_px, rgba, .. } = picture;
    rgba.into_flattened().into_pyarray(py).reshape([height_px, width_px, 4])
}

/// Measured errors of a picture, as a dictionary.
#[derive(Clone, FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
pub struct PyMeasured {
    /// Mean square error and its relative deviation, per rung of the ladder; `None` where a rung was not measured.
    errors: Vec<Option<[f64; 2]>>,
    pixel_in_samples: f64,
    covered: f64,
    direction: [f64; 3],
    aside: [f64; 3],
    cut: u64,
    is_smooth: bool,
}

impl From<&PyMeasured> for Measured {
    fn from(measured: &PyMeasured) -> Self {
        let error = |k: usize| measured.errors.get(k).copied().flatten();
        Self {
            errors: std::array::from_fn(|k| {
                error(k).map(|[mean_square, deviation]| RungError { mean_square, deviation })
            }),
            framing: Framing {
                pixel_in_samples: measured.pixel_in_samples,
                covered: measured.covered,
                direction: measured.direction,
                aside: measured.aside,
                cut: measured.cut,
            },
            is_smooth: measured.is_smooth,
        }
    }
}

impl From<Measured> for PyMeasured {
    fn from(measured: Measured) -> Self {
        let Measured { errors, framing, is_smooth } = measured;
        Self {
            errors: errors.map(|e| e.map(|RungError { mean_square, deviation }| [mean_square, deviation])).to_vec(),
            pixel_in_samples: framing.pixel_in_samples,
            covered: framing.covered,
            direction: framing.direction,
            aside: framing.aside,
            cut: framing.cut,
            is_smooth,
        }
    }
}

/// A field that colours a layer, and its transfer function.
pub type PyColor<'py> = (Drawable<'py>, PyRef<'py, PyTransferFunction>);

/// A volume, its transfer function, its shading, and the field that colours it.
pub type PyLayer<'py> =
    (Drawable<'py>, PyRef<'py, PyTransferFunction>, Option<PyRef<'py, PyShading>>, Option<PyColor<'py>>);

/// Calls `work` with the scene of layers.
fn with_scene<T>(
    py: Python<'_>,
    layers: &[PyLayer<'_>],
    mut work: impl FnMut(Scene<'_>) -> PyResult<T>,
) -> PyResult<T> {
    let colors = layers.iter().filter_map(|(.., color)| color.as_ref());
    let drawables: Vec<&Drawable<'_>> =
        layers.iter().map(|(drawable, ..)| drawable).chain(colors.map(|(drawable, _)| drawable)).collect();
    with_volumes(py, &drawables, &mut |mut volumes| {
        // Behind the layers' volumes are the volumes of the fields that colour layers.
        let mut of_colors = volumes.split_off(layers.len()).into_iter();
        let layer = |(volume, (_, tf, shading, color)): (_, &PyLayer<'_>)| SceneLayer {
            volume,
            transfer_function: tf.0.clone(),
            shading: shading.as_ref().map(|shading| shading.0.clone()),
            color: color.as_ref().and_then(|(_, tf)| {
                let volume = of_colors.next()?;
                Some(SceneColor { volume, transfer_function: tf.0.clone() })
            }),
        };
        work(Scene::of(volumes.into_iter().zip(layers).map(layer).collect()))
    })
}

/// Options of a frame, as a dictionary; see `_native.pyi`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct PyFrame<'py> {
    labels: Option<PyRef<'py, PyLabels>>,
    pub width: usize,
    pub height: usize,
    kernel: String,
    composite: String,
    numbers: Vec<f64>,
    sheets_per_slice: f64,
    oversampling: f64,
    psnr: Option<f64>,
    like: Option<PyMeasured>,
    crop_index: Corners,
    crop_world: Corners,
    clip_planes: Vec<(Triple, Triple)>,
    background: Option<[f32; 4]>,
    threads: Option<usize>,
    device: String,
    depth: bool,
    depth_colors: Option<(Vec<[f32; 3]>, Option<Triple>)>,
    shapes: Option<PyRef<'py, PyShapes>>,
    pre_integration: bool,
    early_ray_termination: bool,
}

impl PyFrame<'_> {
    /// Options of the frame that do not belong to the scene.
    pub fn options(&self) -> PyResult<FrameOptions> {
        let effort = match self.psnr {
            Some(psnr_db) => Effort::Psnr(PsnrTarget { psnr_db, like: self.like.as_ref().map(Measured::from) }),
            None => {
                Effort::Fixed(Sampling { sheets_per_slice: self.sheets_per_slice, oversampling: self.oversampling })
            }
        };
        Ok(FrameOptions {
            kernel: Kernel::from_name(&self.kernel).map_err(to_py)?,
            composite: composite(&self.composite, &self.numbers)?,
            effort,
            with_depth: self.depth,
            depth_colors: self
                .depth_colors
                .clone()
                .map(|(colors, axis)| DepthColors { colors, axis: axis.map(vector) }),
            pre_integration: self.pre_integration,
            early_ray_termination: self.early_ray_termination,
            device: device(&self.device),
            n_threads: self.threads,
            clock: Some(seconds),
        })
    }

    /// Fills in the scene's labels, crop, clip planes, background and shapes.
    pub fn fill(&self, scene: &mut Scene<'_>) {
        scene.labels = self.labels.as_ref().map(|labels| labels.0.clone());
        scene.crop = crop(self.crop_index, self.crop_world);
        scene.clip_planes = clip_planes(self.clip_planes.clone());
        scene.background = self.background;
        if let Some(shapes) = &self.shapes {
            scene.shapes = shapes.0.clone();
        }
    }
}

/// See `_native.pyi`.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arguments over by value")]
pub fn render<'py>(
    py: Python<'py>,
    layers: Vec<PyLayer<'py>>,
    camera: &PyCamera,
    frame: PyFrame<'py>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = frame.options()?;
    let size = [frame.width, frame.height];
    let watched = PyProgress::new(progress);
    let result = with_scene(py, &layers, |mut scene| {
        frame.fill(&mut scene);
        watched.watch(py, || scene.render_with_progress(&camera.0, size, &options, &watched))
    })?;
    picture_and_report(py, result.map_err(to_py)?)
}

/// Dictionary of a frame: picture and report.
pub fn picture_and_report(py: Python<'_>, frame: Frame) -> PyResult<Bound<'_, PyDict>> {
    let Frame { mut picture, report, drawn_by, sampling, estimate, times } = frame;
    let [width, height] = [picture.width_px, picture.height_px];
    let plane = |values: Option<Vec<f32>>| -> PyResult<Option<Bound<'_, PyArray2<f32>>>> {
        values.map(|v| v.into_pyarray(py).reshape([height, width])).transpose()
    };
    let dict = PyDict::new(py);
    dict.set_item("depth", plane(picture.depth.take())?)?;
    dict.set_item("value", plane(picture.value.take())?)?;
    dict.set_item("rgba", image(py, picture)?)?;
    let numbers = PyDict::new(py);
    numbers.set_item("sheets_per_slice", sampling.sheets_per_slice)?;
    numbers.set_item("oversampling", sampling.oversampling)?;
    if let Some(estimate) = estimate {
        numbers.set_item("expected_psnr_db", estimate.psnr_db)?;
        numbers.set_item("expected_psnr_spread_db", estimate.spread_db)?;
        numbers.set_item("measured", estimate.measured.map(PyMeasured::from))?;
    }
    if let Some(StageTimes { prepare, plan, draw, warp }) = times {
        let seconds = PyDict::new(py);
        for (stage, time) in [("prepare", prepare), ("plan", plan), ("draw", draw), ("warp", warp)] {
            seconds.set_item(stage, time)?;
        }
        numbers.set_item("seconds", seconds)?;
    }
    numbers.set_item("n_texels", report.n_texels)?;
    numbers.set_item("n_skipped_slabs", report.n_skipped_slabs)?;
    numbers.set_item("n_base_planes", report.n_base_planes)?;
    numbers.set_item("n_base_texels", report.n_base_texels)?;
    numbers.set_item("n_sheets", report.n_sheets)?;
    numbers.set_item("n_nonfinite_samples", report.n_nonfinite_samples)?;
    if let Some(range) = report.depth_colors {
        numbers.set_item("depth_colors", range)?;
    }
    if report.n_fragments[0] > 0 {
        numbers.set_item("n_fragments", report.n_fragments[0])?;
        numbers.set_item("n_joined_rays", report.n_fragments[1])?;
    }
    numbers.set_item("n_threads", report.n_threads)?;
    numbers.set_item("simd", report.simd)?;
    let DrawnBy { name, reason, gpu } = drawn_by;
    let device = match gpu {
        Some((adapter, report)) => report_of(py, &adapter, &report)?,
        None => PyDict::new(py),
    };
    device.set_item("name", name)?;
    device.set_item("reason", reason)?;
    numbers.set_item("device", device)?;
    dict.set_item("report", numbers)?;
    Ok(dict)
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
    let (across, down) = (vector(across), vector(down));
    let plane = Plane { origin: vector(origin), across, down, width_px: width, height_px: height };
    let slab = ThickSlab { reduction: Reduction::from_name(slab).map_err(to_py)?, n_planes, step: vector(step) };
    let watched = PyProgress::new(None);
    let values = volume
        .with_volume(py, |subject| watched.watch(py, || subject.slice(&plane, &slab, kernel, threads, &watched)))?;
    values.map_err(to_py)?.into_pyarray(py).reshape([height, width])
}

/// See `_native.pyi`.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands volumes over by value")]
pub fn quality_settings(
    py: Python<'_>,
    name: &str,
    layers: Vec<PyLayer<'_>>,
    operator: (String, Vec<f64>),
    camera: &PyCamera,
    height: usize,
) -> PyResult<(f64, f64)> {
    let operator = composite(&operator.0, &operator.1)?;
    with_scene(py, &layers, |scene| {
        let sampling = scene.sampling(name, operator, &camera.0, height).map_err(to_py)?;
        Ok((sampling.sheets_per_slice, sampling.oversampling))
    })
}

/// Seconds since the first call.
fn seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// Associated float RGBA to the bytes of an unassociated 8- or 16-bit PNG; colours are used as given.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn encode_png<'py>(py: Python<'py>, rgba: PyReadonlyArray3<'py, f32>, bits: u32) -> PyResult<Bound<'py, PyBytes>> {
    let [height, width] = size_of(&rgba)?;
    let bits = match bits {
        8 => PngBits::Eight,
        16 => PngBits::Sixteen,
        _ => return Err(PyValueError::new_err(format!("bits is {bits}; pass 8 or 16"))),
    };
    let pixels = rgba.as_slice()?;
    let png = py.detach(|| png_of_rgba(pixels, width, height, bits)).map_err(to_py)?;
    Ok(PyBytes::new(py, &png))
}

/// Associated float RGBA as bytes of unassociated RGBA.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn straight_bytes<'py>(py: Python<'py>, rgba: PyReadonlyArray3<'py, f32>) -> PyResult<Bound<'py, PyBytes>> {
    size_of(&rgba)?;
    let pixels = rgba.as_slice()?;
    Ok(PyBytes::new(py, &py.detach(|| wavesplat::straight_bytes(pixels))))
}

/// Associated float RGBA over an opaque colour, as bytes of RGB.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn rgb_bytes<'py>(
    py: Python<'py>,
    rgba: PyReadonlyArray3<'py, f32>,
    paper: [f32; 3],
) -> PyResult<Bound<'py, PyBytes>> {
    size_of(&rgba)?;
    let pixels = rgba.as_slice()?;
    Ok(PyBytes::new(py, &py.detach(|| wavesplat::rgb_bytes(pixels, paper))))
}

/// Height and width of a picture.
fn size_of(rgba: &PyReadonlyArray3<f32>) -> PyResult<[usize; 2]> {
    match *rgba.shape() {
        [height, width, 4] => Ok([height, width]),
        _ => Err(PyTypeError::new_err("rgba must have the shape [height, width, 4]")),
    }
}
