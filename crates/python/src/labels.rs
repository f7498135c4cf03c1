//! Segmentations as Python passes them.

use std::sync::Arc;

use numpy::{PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use wavesplat::{Codes, Grid, Kernel, LabelLook, Labels, Statistics};

use crate::errors::to_py;
use crate::volume::affine;

/// See `_native.pyi`.
#[pyclass(name = "Labels", frozen, module = "wavesplat._native")]
pub struct PyLabels(pub Arc<Labels>);

/// Name, (red, green, blue), opacity, scan, tint.
type LabelArguments = (String, (f64, f64, f64), f64, f64, f64);

/// Memory budget for decoded fields, bytes.
const BUDGET_BYTES: usize = 512 << 20;

#[pymethods]
impl PyLabels {
    #[new]
    #[pyo3(signature = (codes, looks, world_from_index, smooth))]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn new(
        py: Python<'_>,
        codes: &Bound<'_, PyAny>,
        looks: Vec<LabelArguments>,
        world_from_index: PyReadonlyArray2<'_, f64>,
        smooth: bool,
    ) -> PyResult<Self> {
        let wrong = || PyTypeError::new_err("codes must be a C-contiguous 3-D array of u8 or u16");
        let (codes, shape) = if let Ok(array) = codes.cast::<PyArray3<u8>>() {
            (Codes::U8(Arc::from(array.readonly().as_slice().map_err(|_| wrong())?)), array.shape().to_vec())
        } else {
            let array = codes.cast::<PyArray3<u16>>().map_err(|_| wrong())?;
            (Codes::U16(Arc::from(array.readonly().as_slice().map_err(|_| wrong())?)), array.shape().to_vec())
        };
        let [nz, ny, nx] = shape[..] else { return Err(wrong()) };
        let all_known = (0..nx * ny * nz).all(|i| codes.get(i) < looks.len());
        if !all_known {
            return Err(PyTypeError::new_err("codes must be places in the list of looks"));
        }
        let look = |(name, (r, g, b), opacity, scan, tint): LabelArguments| {
            let look = LabelLook { rgb: [r, g, b], opacity, scan, tint };
            look.validate(&name).map(|()| look)
        };
        let looks = looks.into_iter().map(look).collect::<Result<_, _>>().map_err(to_py)?;
        let any = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        let grid = Grid::new("labels", [nx, ny, nz], affine(&world_from_index)?, any, true).map_err(to_py)?;
        let kernel = if smooth { Kernel::Gaussian } else { Kernel::Linear };
        let labels = py.detach(|| Labels::new(codes, looks, &grid, kernel, BUDGET_BYTES));
        labels.map(|labels| Self(Arc::new(labels))).map_err(to_py)
    }
}
