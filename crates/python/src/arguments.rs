//! Camera, transfer function and shading as Python passes them.

use glam::DVec3;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyString;
use wavesplat::{
    Camera, ColorNode, Error, Gradient, GradientNode, Light, LightFrame, OpacityNode, Projection, Shading,
    TransferFunction, TransferFunction2D,
};
use wavesplat_study::reference::ablation::{Ablation, FootprintTable, GradientScheme};

use crate::errors::to_py;

/// A text of Python, in which a half of a pair of UTF-16 that stands alone, which Rust's texts cannot have, is U+FFFD.
pub struct Text(pub String);

impl<'py> FromPyObject<'_, 'py> for Text {
    type Error = PyErr;

    fn extract(text: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(text.cast::<PyString>()?.to_string_lossy().into_owned()))
    }
}

/// Three numbers.
pub type Triple = (f64, f64, f64);

/// A vector of three numbers.
pub fn vector((x, y, z): Triple) -> DVec3 {
    DVec3::new(x, y, z)
}

/// See `_native.pyi`.
#[pyclass(name = "Camera", frozen, module = "wavesplat._native")]
pub struct PyCamera(pub Camera);

#[pymethods]
impl PyCamera {
    #[new]
    fn new(
        position: Triple,
        focal_point: Triple,
        view_up: Triple,
        parallel_scale: Option<f64>,
        view_angle: Option<f64>,
    ) -> PyResult<Self> {
        let projection = match (parallel_scale, view_angle) {
            (Some(parallel_scale), None) => Projection::Orthographic { parallel_scale },
            (None, Some(degrees)) => Projection::Perspective { view_angle_rad: degrees.to_radians() },
            (None, None) => {
                let problem = "neither parallel_scale nor view_angle is given";
                return Err(to_py(Error::Projection { problem }));
            }
            (Some(_), Some(_)) => {
                let problem = "both parallel_scale and view_angle are given";
                return Err(to_py(Error::Projection { problem }));
            }
        };
        let camera = Camera::new(vector(position), vector(focal_point), vector(view_up), projection);
        camera.map(Self).map_err(to_py)
    }
}

/// See `_native.pyi`.
#[pyclass(name = "TransferFunction", frozen, module = "wavesplat._native")]
pub struct PyTransferFunction(pub TransferFunction);

#[pymethods]
impl PyTransferFunction {
    #[new]
    fn new(
        opacity: Vec<(f64, f64)>,
        color: Vec<(f64, f64, f64, f64)>,
        opacity_unit: Option<f64>,
        gradient_opacity: Vec<(f64, f64)>,
    ) -> PyResult<Self> {
        let opacity = opacity.into_iter().map(|(value, opacity)| OpacityNode { value, opacity }).collect();
        let color = color.into_iter().map(|(value, r, g, b)| ColorNode { value, rgb: [r, g, b] }).collect();
        let node = |(magnitude, factor)| GradientNode { magnitude, factor };
        let gradient_opacity = gradient_opacity.into_iter().map(node).collect();
        let tf = TransferFunction::new(opacity, color, opacity_unit);
        tf.and_then(|tf| tf.with_gradient_opacity(gradient_opacity)).map(Self).map_err(to_py)
    }

    /// A function of value and gradient magnitude, or, if `of_fields`, of the values of two fields; `rgba`: one row of
    /// values per magnitude, or value of the other field.
    #[staticmethod]
    fn two_dimensional(
        values: Vec<f64>,
        magnitudes: Vec<f64>,
        rgba: Vec<[f64; 4]>,
        opacity_unit: Option<f64>,
        of_fields: bool,
    ) -> PyResult<Self> {
        let joint = if of_fields {
            TransferFunction2D::of_fields(values, magnitudes, rgba)
        } else {
            TransferFunction2D::new(values, magnitudes, rgba)
        };
        joint.and_then(|joint| TransferFunction::two_dimensional(joint, opacity_unit)).map(Self).map_err(to_py)
    }

    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn evaluate_at<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray1<'py, f64>,
        magnitudes: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let row = |(&value, &magnitude): (&f64, &f64)| {
            let [r, g, b] = self.0.color_at(value, magnitude);
            vec![r, g, b, -(-self.0.optical_depth(value, magnitude)).exp_m1()]
        };
        let (values, magnitudes) = (values.as_array(), magnitudes.as_array());
        let rows: Vec<Vec<f64>> = values.iter().zip(magnitudes.iter()).map(row).collect();
        let n = rows.len();
        numpy::PyArrayMethods::reshape(&rows.concat().into_pyarray(py), [n, 4])
    }

    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> = values
            .as_array()
            .iter()
            .map(|&v| {
                let [r, g, b] = self.0.color(v);
                vec![r, g, b, self.0.opacity(v)]
            })
            .collect();
        let n = rows.len();
        let flat = rows.concat().into_pyarray(py);
        numpy::PyArrayMethods::reshape(&flat, [n, 4])
    }
}

/// See `_native.pyi`.
#[pyclass(name = "Shading", frozen, module = "wavesplat._native")]
pub struct PyShading(pub Shading);

#[pymethods]
impl PyShading {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "numbers of one thing")]
    fn new(
        ambient: f32,
        diffuse: f32,
        specular: f32,
        specular_power: f32,
        gradient_smoothing: f64,
        gradient_offset: f64,
        unoriented: f32,
        even_cuts: f32,
        shoulder: f32,
        lights: Vec<(String, Triple, (f32, f32, f32))>,
        ambient_occlusion: f32,
        occlusion_radius: Option<f64>,
        shadow: f32,
    ) -> PyResult<Self> {
        let mut world_lights = Vec::new();
        for (frame, direction, (r, g, b)) in lights {
            let frame = match frame.as_str() {
                "camera" => LightFrame::Camera,
                "world" => LightFrame::World,
                _ => {
                    let known = "camera, world".to_owned();
                    return Err(to_py(Error::UnknownName { what: "light frame", name: frame, known }));
                }
            };
            world_lights.push(Light { frame, to_light: vector(direction), rgb: [r, g, b] });
        }
        let shading = Shading {
            ambient,
            diffuse,
            specular,
            specular_power,
            gradient: if gradient_smoothing == 0.0 {
                Gradient::Difference(gradient_offset)
            } else {
                Gradient::Smoothed(gradient_smoothing)
            },
            unoriented,
            even_cuts,
            shoulder,
            lights: world_lights,
            ambient_occlusion,
            occlusion_radius,
            shadow,
        };
        shading.validate().map_err(to_py)?;
        Ok(Self(shading))
    }
}

/// See `_native.pyi`.
#[pyclass(name = "Ablation", frozen, module = "wavesplat._native")]
pub struct PyAblation(pub Ablation);

#[pymethods]
impl PyAblation {
    #[new]
    fn new(
        view_angle_correction: bool,
        kernel_slicing: bool,
        gradient: &str,
        footprint: &str,
        footprint_entries: u32,
    ) -> PyResult<Self> {
        let gradient = GradientScheme::from_name(gradient).map_err(to_py)?;
        let footprint = FootprintTable::from_name(footprint, footprint_entries).map_err(to_py)?;
        let ablation = Ablation { view_angle_correction, kernel_slicing, gradient, footprint };
        ablation.validate().map_err(to_py)?;
        Ok(Self(ablation))
    }
}

/// An array with a row for each item.
pub fn rows<'py, const N: usize>(py: Python<'py>, rows: &[[f64; N]]) -> Bound<'py, PyArray2<f64>> {
    let array = PyArray1::from_slice(py, rows.as_flattened());
    numpy::PyArrayMethods::reshape(&array, [rows.len(), N]).expect("as many numbers as rows have")
}
