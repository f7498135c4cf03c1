//! Documents as Python holds them: objects of dict, list, str, int, float, bool and None are read where they lie.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString, PyTuple};
use wavesplat::document::{
    self, CameraDocument, ChangedNode, CurvesDocument, FieldError, Found, LensField, LookDocument, MaterialsDocument,
    TableDocument, ValueNode,
};

use crate::arguments::Triple;
use crate::errors::exceptions::ArgumentError;

/// Position, focal point, view up, parallel scale and view angle.
type CameraFields = (Triple, Triple, Triple, Option<f64>, Option<f64>);

/// Scale, nodes of opacity and colour, unit, nodes of the gradient, and unit as a share.
type CurvesFields = (String, Vec<[f64; 2]>, Vec<[f64; 4]>, Option<f64>, Vec<[f64; 2]>, Option<f64>);
/// Values, magnitudes, colours, unit, and whether the rows are of a second field.
type TableFields = (Vec<f64>, Vec<f64>, Vec<[f64; 4]>, Option<f64>, bool);

#[derive(Clone)]
struct PyNode<'py>(Bound<'py, PyAny>);

impl ValueNode for PyNode<'_> {
    const NULL: &'static str = "None";

    fn field(&self, name: &str) -> Option<Self> {
        match self.0.cast::<PyDict>() {
            Ok(fields) => fields.get_item(name).ok().flatten(),
            Err(_) => self.0.get_item(name).ok(),
        }
        .map(Self)
    }

    fn names(&self) -> Vec<String> {
        self.0.try_iter().into_iter().flatten().flatten().map(|name| name.to_string()).collect()
    }

    fn is_object(&self) -> bool {
        self.0.cast::<PyMapping>().is_ok()
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

    fn text(&self) -> Option<String> {
        self.0.cast::<PyString>().ok()?.to_str().ok().map(str::to_owned)
    }

    fn is_switch(&self) -> bool {
        self.0.is_instance_of::<PyBool>()
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

    fn check_values(&self, document: &str) -> Result<(), FieldError> {
        check_all_values(&self.0, document)
    }
}

impl ChangedNode for PyNode<'_> {
    fn with_field(&self, name: &str, value: Option<Self>) -> Self {
        let fields = PyDict::new(self.0.py());
        // None of these can fail: the mapping was read before, and its names are texts.
        let _ = self.0.cast::<PyMapping>().map(|before| fields.update(before));
        let _ = match value {
            Some(value) => fields.set_item(name, value.0),
            None => fields.del_item(name),
        };
        Self(fields.into_any())
    }

    fn listed(&self, items: Vec<Self>) -> Self {
        let items = PyList::new(self.0.py(), items.into_iter().map(|item| item.0));
        items.map_or_else(|_| self.clone(), |items| Self(items.into_any()))
    }
}

/// Longest path in a message.
const MAX_PATH: usize = 100;

/// JSON bounds neither its whole numbers nor its texts: Python's `json` gives numbers that no float holds, and halves of
/// surrogate pairs, which no file and no font takes. Both are refused, before anything calculates with them.
fn check_all_values(value: &Bound<'_, PyAny>, document: &str) -> Result<(), FieldError> {
    // A stack instead of recursion: documents may be nested deeper than the stack of a thread. `containers` are those that
    // were met, each with its own container and its name there.
    let mut containers: Vec<(usize, Bound<'_, PyAny>)> = Vec::new();
    let mut pending = vec![(value.clone(), (0, value.clone()))];
    while let Some((found, place)) = pending.pop() {
        if let Ok(text) = found.cast::<PyString>() {
            if text.to_str().is_err() {
                return Err(unusable(
                    document,
                    &containers,
                    &place,
                    "has half of a surrogate pair in its text; remove it",
                ));
            }
        } else if found.is_instance_of::<PyInt>() {
            if !is_in_range(&found) {
                let fault = "is a whole number of more than 308 digits; write a smaller one";
                return Err(unusable(document, &containers, &place, fault));
            }
        } else if let Ok(fields) = found.cast::<PyMapping>() {
            containers.push(place);
            for item in fields.items().iter().flatten() {
                let Ok((name, part)) = item.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>() else { continue };
                if name.cast::<PyString>().is_ok_and(|name| name.to_str().is_err()) {
                    let place = containers.pop().unwrap_or((0, name));
                    return Err(unusable(
                        document,
                        &containers,
                        &place,
                        "has half of a surrogate pair in a name; remove it",
                    ));
                }
                pending.push((part, (containers.len(), name)));
            }
        } else if found.is_instance_of::<PyList>() || found.is_instance_of::<PyTuple>() {
            containers.push(place);
            for (number, part) in found.try_iter().into_iter().flatten().flatten().enumerate() {
                let Ok(number) = number.into_pyobject(found.py());
                pending.push((part, (containers.len(), number.into_any())));
            }
        }
    }
    Ok(())
}

/// Whether a float holds a whole number.
fn is_in_range(whole: &Bound<'_, PyAny>) -> bool {
    whole.extract::<f64>().is_ok_and(|nearest| nearest.abs() < f64::MAX || whole.eq(nearest).unwrap_or(false))
}

/// The error of a value that cannot be used. `place`: the number of its container plus 1, 0 for none, and its name there.
fn unusable(
    document: &str,
    containers: &[(usize, Bound<'_, PyAny>)],
    place: &(usize, Bound<'_, PyAny>),
    fault: &str,
) -> FieldError {
    let mut names = Vec::new();
    let mut at = place;
    while let Some(outer) = at.0.checked_sub(1) {
        names.push(if at.1.is_instance_of::<PyInt>() { format!("[{}]", at.1) } else { format!(".{}", at.1) });
        at = &containers[outer];
    }
    names.reverse();
    let path = names.concat();
    let path = path.strip_prefix('.').unwrap_or(&path);
    let shown = match path.char_indices().nth(MAX_PATH) {
        _ if path.is_empty() => "the document".to_owned(),
        None => format!("field {}", document::quoted(path)),
        Some((end, _)) => format!("a field below {}", document::quoted(&path[..end])),
    };
    let wanted = format!("{shown} {fault}");
    FieldError { document: document.to_owned(), path: String::new(), found: Found::Fault, wanted }
}

#[expect(clippy::needless_pass_by_value, reason = "used as map_err(refused)")]
fn refused(error: FieldError) -> PyErr {
    ArgumentError::new_err(error.to_string())
}

/// See `_native.pyi`.
#[pyfunction]
pub fn check_part(part: Bound<'_, PyAny>, place: &str, name: &str) -> PyResult<()> {
    document::check_part(&PyNode(part), place, name).map_err(refused)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn check_state(document: Bound<'_, PyAny>, before: &Bound<'_, PyDict>) -> PyResult<()> {
    let is_checked =
        |name: &str, value: &PyNode<'_>| before.get_item(name).ok().flatten().is_some_and(|known| known.is(&value.0));
    document::check_state(&PyNode(document), is_checked).map_err(refused)
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

/// See `_native.pyi`.
#[pyfunction]
pub fn check_values(value: &Bound<'_, PyAny>, what: &str) -> PyResult<()> {
    check_all_values(value, what).map_err(refused)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn patched<'py>(document: Bound<'py, PyAny>, operations: Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    document::patched(&PyNode(document), &PyNode(operations)).map(|changed| changed.0).map_err(refused)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn checked_view<'py>(view: &Bound<'py, PyAny>, crosshair: [f64; 3]) -> PyResult<Bound<'py, PyDict>> {
    let py = view.py();
    document::check_view(&PyNode(view.clone())).map_err(refused)?;
    let complete = PyDict::new(py);
    let json = py.import("json")?;
    for (section, fields) in document::default_view(crosshair) {
        let given = PyNode(view.clone()).field(section);
        let Some(fields) = fields else {
            let items = given.and_then(|given| given.items()).unwrap_or_default();
            let copies = items.iter().map(|item| PyDict::from_sequence(&item.0.call_method0("items")?));
            complete.set_item(section, PyList::new(py, copies.collect::<PyResult<Vec<_>>>()?)?)?;
            continue;
        };
        let own = PyDict::new(py);
        for (name, value) in fields {
            let found = given.as_ref().and_then(|given| given.field(name)).map(|found| found.0);
            let default = || json.call_method1("loads", (value.to_string(),));
            own.set_item(name, found.map_or_else(default, Ok)?)?;
        }
        if let Some(given) = given {
            own.update(given.0.cast::<PyMapping>()?)?;
        }
        complete.set_item(section, own)?;
    }
    Ok(complete)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn curves_fields(document: Bound<'_, PyAny>, in_look: bool) -> PyResult<CurvesFields> {
    let curves = CurvesDocument::read(&PyNode(document), in_look).map_err(refused)?;
    let (unit, share) = (curves.opacity_unit, curves.opacity_unit_share);
    Ok((curves.values, curves.opacity, curves.color, unit, curves.gradient_opacity, share))
}

/// See `_native.pyi`.
#[pyfunction]
pub fn table_fields(document: Bound<'_, PyAny>) -> PyResult<TableFields> {
    let table = TableDocument::read(&PyNode(document)).map_err(refused)?;
    Ok((table.values, table.magnitudes, table.rgba, table.opacity_unit, table.is_of_fields))
}

/// See `_native.pyi`.
#[pyfunction]
pub fn look_texts(document: Bound<'_, PyAny>) -> PyResult<[Option<String>; 7]> {
    LookDocument::read(&PyNode(document)).map(|look| look.texts).map_err(refused)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn lights_of(shading: Bound<'_, PyAny>) -> PyResult<Vec<Bound<'_, PyAny>>> {
    document::lights(&PyNode(shading)).map(plain).map_err(refused)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn check_settings(document: Bound<'_, PyAny>, is_light: bool) -> PyResult<()> {
    document::check_settings(&PyNode(document), is_light).map_err(refused)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn materials_fields(document: Bound<'_, PyAny>) -> PyResult<(Vec<Bound<'_, PyAny>>, Option<f64>)> {
    let found = MaterialsDocument::read(&PyNode(document)).map_err(refused)?;
    Ok((plain(found.materials), found.opacity_unit))
}

/// See `_native.pyi`.
#[pyfunction]
pub fn check_material(entry: Bound<'_, PyAny>, number: usize) -> PyResult<()> {
    document::check_material(&PyNode(entry), number).map_err(refused)
}

fn plain(nodes: Vec<PyNode<'_>>) -> Vec<Bound<'_, PyAny>> {
    nodes.into_iter().map(|node| node.0).collect()
}
