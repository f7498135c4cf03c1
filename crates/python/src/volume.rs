//! Samples shared with the Python side's arrays.

use std::sync::{Arc, Mutex, PoisonError};

use glam::{DAffine3, DMat3, DVec3};
use numpy::{Element, PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use wavesplat_core::{Composite, Grid, Kernel, Samples, Shading, Statistics, TransferFunction, Volume};
use wavesplat_splat::is_steep;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::source::slices::{Prepared, Slices};

use crate::errors::to_py;
use crate::rendering::Corners;
use crate::wavelet::PyDecodedVolume;

/// A C-contiguous array [z, y, x] of one of the sample types.
enum Array {
    U8(Py<PyArray3<u8>>),
    I8(Py<PyArray3<i8>>),
    U16(Py<PyArray3<u16>>),
    I16(Py<PyArray3<i16>>),
    U32(Py<PyArray3<u32>>),
    I32(Py<PyArray3<i32>>),
    F32(Py<PyArray3<f32>>),
    F64(Py<PyArray3<f64>>),
}

/// What can be drawn.
#[derive(FromPyObject)]
pub enum Drawable<'py> {
    /// Samples.
    Samples(PyRef<'py, PyVolume>),
    /// Wavelet coefficients.
    Decoded(PyRef<'py, PyDecodedVolume>),
}

impl Drawable<'_> {
    /// Index positions of the finest grid as those of what is drawn.
    pub fn own_index(&self, corners: Corners) -> Corners {
        match self {
            Self::Samples(_) => corners,
            Self::Decoded(volume) => {
                corners.map(|(lo, hi)| (volume.level_from_finest(lo), volume.level_from_finest(hi)))
            }
        }
    }

    /// The transfer function to draw with: for light, that of what the drawn samples stand for.
    pub fn transfer_function(
        &self,
        tf: &TransferFunction,
        composite: Composite,
        shading: Option<&Shading>,
    ) -> PyResult<TransferFunction> {
        match (self, composite) {
            (Self::Decoded(volume), Composite::Over) => Ok(volume.filtered(tf, shading)?.0),
            _ => Ok(tf.clone()),
        }
    }

    /// Whether a transfer function gets the quality settings of a steep one.
    pub fn is_steep(&self, py: Python<'_>, tf: &TransferFunction, shading: Option<&Shading>) -> PyResult<bool> {
        match self {
            Self::Samples(volume) => volume.is_steep(py, tf),
            // As its levels are made as bright for, or are themselves.
            Self::Decoded(volume) => Ok(volume.filtered(tf, shading)?.1),
        }
    }

    /// What is kept of transfer functions.
    pub fn cache(&self) -> &VisibilityCache {
        match self {
            Self::Samples(volume) => &volume.cache,
            Self::Decoded(volume) => &volume.cache,
        }
    }

    /// Calls `work` with the grid.
    pub fn with_grid<T>(&self, py: Python<'_>, work: impl FnOnce(&Grid) -> PyResult<T>) -> PyResult<T> {
        match self {
            Self::Samples(volume) => volume.with_volume(py, |v| work(v.grid())),
            Self::Decoded(volume) => work(volume.grid()),
        }
    }

    /// Calls `work` with something that gives the slices for a kernel.
    pub fn with_slices<T>(
        &self,
        py: Python<'_>,
        kernel: Kernel,
        work: impl for<'s> FnOnce(&'s (dyn Fn() -> Slices<'s> + Sync + 's)) -> PyResult<T>,
    ) -> PyResult<T> {
        match self {
            Self::Samples(volume) => {
                let volume = &**volume;
                volume.with_volume(py, |v| work(&|| volume.slices(v, kernel)))
            }
            Self::Decoded(volume) => {
                let volume = &**volume;
                work(&|| {
                    let slices = volume.prepared(kernel).slices(volume.grid());
                    slices.expect("what was prepared of a decoder has slices")
                })
            }
        }
    }
}

/// Samples, affine, and what was computed from them once.
#[pyclass(name = "Volume", frozen, module = "wavesplat._native")]
pub struct PyVolume {
    name: String,
    array: Array,
    world_from_index: DAffine3,
    statistics: Statistics,
    /// Bounds of bricks, spline coefficients or filled densities, per kernel.
    prepared: Mutex<Vec<(Kernel, Arc<Prepared>)>>,
    /// What is kept of transfer functions.
    pub cache: VisibilityCache,
    /// The function that was drawn last, and whether it is steep.
    latest: Mutex<Option<(TransferFunction, bool)>>,
}

#[pymethods]
impl PyVolume {
    #[new]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn new(
        py: Python<'_>,
        samples: &Bound<'_, PyAny>,
        world_from_index: PyReadonlyArray2<'_, f64>,
        name: String,
    ) -> PyResult<Self> {
        let array = Array::new(samples)?;
        let world_from_index = affine(&world_from_index)?;
        let unknown = Statistics { min: 0.0, max: 0.0, n_nonfinite: 0 };
        let (prepared, cache, latest) = (Mutex::default(), VisibilityCache::default(), Mutex::default());
        let mut volume = Self { name, array, world_from_index, statistics: unknown, prepared, cache, latest };
        volume.statistics = volume.with_samples(py, |samples, _| py.detach(|| Statistics::of(&samples)))?;
        volume.with_volume(py, |_| Ok(()))?;
        Ok(volume)
    }

    /// Smallest and largest finite sample.
    #[getter]
    fn value_range(&self) -> (f64, f64) {
        (self.statistics.min, self.statistics.max)
    }

    /// How many samples are NaN or infinite.
    #[getter]
    fn n_nonfinite(&self) -> usize {
        self.statistics.n_nonfinite
    }
}

impl PyVolume {
    /// Calls `work` with the samples and their `[nx, ny, nz]`.
    pub fn with_samples<T>(&self, py: Python<'_>, work: impl FnOnce(Samples<'_>, [usize; 3]) -> T) -> PyResult<T> {
        macro_rules! borrow {
            ($array:expr, $variant:path) => {{
                let array = $array.bind(py).readonly();
                let [nz, ny, nx] = *array.shape() else { return Err(PyTypeError::new_err("samples must be 3-D")) };
                Ok(work($variant(array.as_slice()?), [nx, ny, nz]))
            }};
        }
        match &self.array {
            Array::U8(a) => borrow!(a, Samples::U8),
            Array::I8(a) => borrow!(a, Samples::I8),
            Array::U16(a) => borrow!(a, Samples::U16),
            Array::I16(a) => borrow!(a, Samples::I16),
            Array::U32(a) => borrow!(a, Samples::U32),
            Array::I32(a) => borrow!(a, Samples::I32),
            Array::F32(a) => borrow!(a, Samples::F32),
            Array::F64(a) => borrow!(a, Samples::F64),
        }
    }

    /// Calls `work` with the volume.
    pub fn with_volume<T>(&self, py: Python<'_>, work: impl FnOnce(&Volume<'_>) -> PyResult<T>) -> PyResult<T> {
        self.with_samples(py, |samples, size| {
            let volume = Volume::with_statistics(&self.name, samples, size, self.world_from_index, self.statistics);
            work(&volume.map_err(to_py)?)
        })?
    }

    /// Whether a transfer function is steep; kept until another is asked for.
    fn is_steep(&self, py: Python<'_>, tf: &TransferFunction) -> PyResult<bool> {
        let known = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, is_steep)) = known.as_ref().filter(|(of, _)| of == tf) {
            return Ok(*is_steep);
        }
        drop(known);
        let is_steep = self.with_volume(py, |volume| Ok(is_steep(volume.grid(), tf)))?;
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = Some((tf.clone(), is_steep));
        Ok(is_steep)
    }

    /// Slices for a kernel; what they need is prepared with the first picture and kept.
    pub fn slices<'a>(&self, volume: &Volume<'a>, kernel: Kernel) -> Slices<'a> {
        let mut prepared = self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        let known = prepared.iter().find(|(k, _)| *k == kernel).map(|(_, known)| known.clone());
        let known = known.unwrap_or_else(|| {
            let new = Arc::new(Prepared::new(volume, kernel));
            prepared.push((kernel, new.clone()));
            new
        });
        Slices::with_prepared(volume, known)
    }
}

impl Array {
    fn new(samples: &Bound<'_, PyAny>) -> PyResult<Self> {
        fn cast<T: Element>(samples: &Bound<'_, PyAny>) -> Option<Py<PyArray3<T>>> {
            samples.cast::<PyArray3<T>>().ok().filter(|a| a.is_c_contiguous()).map(|a| a.clone().unbind())
        }
        let array = cast(samples)
            .map(Self::U8)
            .or_else(|| cast(samples).map(Self::I8))
            .or_else(|| cast(samples).map(Self::U16))
            .or_else(|| cast(samples).map(Self::I16))
            .or_else(|| cast(samples).map(Self::U32))
            .or_else(|| cast(samples).map(Self::I32))
            .or_else(|| cast(samples).map(Self::F32))
            .or_else(|| cast(samples).map(Self::F64));
        array.ok_or_else(|| {
            PyTypeError::new_err("samples must be a C-contiguous 3-D array of u8, i8, u16, i16, u32, i32, f32 or f64")
        })
    }
}

/// The affine of a 4 x 4 matrix.
pub fn affine(matrix: &PyReadonlyArray2<'_, f64>) -> PyResult<DAffine3> {
    let m = matrix.as_array();
    if m.shape() != [4, 4] || (0..4).any(|c| m[[3, c]] != if c == 3 { 1.0 } else { 0.0 }) {
        return Err(PyTypeError::new_err("world_from_index must be 4 x 4 with a last row of 0 0 0 1"));
    }
    let column = |c: usize| DVec3::new(m[[0, c]], m[[1, c]], m[[2, c]]);
    Ok(DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) })
}
