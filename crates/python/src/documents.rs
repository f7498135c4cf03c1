//! Documents as Python holds them: objects of dict, list, str, int, float, bool and None are read where they lie.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyList, PyTuple};
use wavesplat::document::{self, CameraDocument, FieldError, LensField, ValueNode};

use crate::arguments::Triple;
use crate::errors::exceptions::ArgumentError;

/// Position, focal point, view up, parallel scale and view angle.
type CameraFields = (Triple, Triple, Triple, Option<f64>, Option<f64>);

struct PyNode<'py>(Bound<'py, PyAny>);

impl ValueNode for PyNode<'_> {
    fn field(&self, name: &str) -> Option<Self> {
        self.0.get_item(name).ok().map(Self)
    }

    fn names(&self) -> Vec<String> {
        self.0.try_iter().into_iter().flatten().flatten().map(|name| name.to_string()).collect()
    }

    fn is_list(&self) -> bool {
        self.0.is_instance_of::<PyList>()
    }

    fn items(&self) -> Option<Vec<Self>> {
        (self.is_list() || self.0.is_instance_of::<PyTuple>())
            .then(|| self.0.try_iter().into_iter().flatten().flatten().map(Self).collect())
    }

    fn number(&self) -> Option<f64> {
        let is_number = self.0.is_instance_of::<PyFloat>() || self.0.is_instance_of::<PyInt>();
        if is_number && !self.0.is_instance_of::<PyBool>() { self.0.extract().ok() } else { None }
    }

    fn whole(&self) -> Option<i64> {
        if self.0.is_exact_instance_of::<PyInt>() { self.0.extract().ok() } else { None }
    }

    fn is_null(&self) -> bool {
        self.0.is_none()
    }

    fn written(&self) -> String {
        self.0.repr().map_or_else(|_| "a number of very many digits".to_owned(), |text| text.to_string())
    }

    fn described(&self) -> String {
        let described =
            || self.0.py().import("wavesplat._system.values")?.call_method1("described", (&self.0,))?.extract();
        described().unwrap_or_else(|_: PyErr| self.written())
    }
}

#[expect(clippy::needless_pass_by_value, reason = "used as map_err(refused)")]
fn refused(error: FieldError) -> PyErr {
    ArgumentError::new_err(error.to_string())
}

/// See `_native.pyi`.
#[pyfunction]
#[pyo3(signature = (document, what, *, needed, known, hint))]
pub fn check_fields(
    document: Bound<'_, PyAny>,
    what: &str,
    needed: &Bound<'_, PyAny>,
    known: &Bound<'_, PyAny>,
    hint: &str,
) -> PyResult<()> {
    // Sets are collections too.
    let names = |of: &Bound<'_, PyAny>| of.try_iter()?.map(|name| name?.extract()).collect::<PyResult<Vec<String>>>();
    document::check_fields(&PyNode(document), what, &names(needed)?, &names(known)?, hint).map_err(refused)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn check_list(document: Bound<'_, PyAny>, what: &str, name: &str, form: &str) -> PyResult<()> {
    document::check_list(&PyNode(document), what, name, form).map_err(refused)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn optional_number(document: Bound<'_, PyAny>, what: &str, name: &str) -> PyResult<Option<f64>> {
    document::optional_number(&PyNode(document), what, name).map_err(refused)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn is_number(value: Bound<'_, PyAny>) -> bool {
    document::is_number(&PyNode(value))
}

/// See `_native.pyi`.
#[pyfunction]
pub fn is_point(value: Bound<'_, PyAny>) -> bool {
    document::is_point(&PyNode(value))
}

/// See `_native.pyi`.
#[pyfunction]
pub fn camera_fields(document: Bound<'_, PyAny>) -> PyResult<CameraFields> {
    let camera = CameraDocument::read(&PyNode(document)).map_err(refused)?;
    let (scale, angle) = match camera.lens {
        LensField::ParallelScale(scale) => (Some(scale), None),
        LensField::ViewAngle(angle) => (None, Some(angle)),
    };
    Ok((camera.position.into(), camera.focal_point.into(), camera.view_up.into(), scale, angle))
}
