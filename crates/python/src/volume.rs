//! Samples borrowed from `NumPy` arrays.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use numpy::{Element, PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use wavesplat::{Samples, SceneVolume, Statistics, Volume, VolumeCache};

use crate::errors::to_py;
use crate::lazy::PyLazyVolume;
use crate::wavelet::PyDecodedVolume;

/// A C-contiguous array [z, y, x] of one of the sample types.
#[allow(missing_docs, reason = "each variant is named after its sample type")]
pub enum NumpySamples {
    U8(Py<PyArray3<u8>>),
    I8(Py<PyArray3<i8>>),
    U16(Py<PyArray3<u16>>),
    I16(Py<PyArray3<i16>>),
    U32(Py<PyArray3<u32>>),
    I32(Py<PyArray3<i32>>),
    F32(Py<PyArray3<f32>>),
    F64(Py<PyArray3<f64>>),
}

/// A volume that can be drawn.
#[derive(FromPyObject)]
pub enum Drawable<'py> {
    /// Samples.
    Samples(PyRef<'py, PyVolume>),
    /// Wavelet coefficients.
    Decoded(PyRef<'py, PyDecodedVolume>),
    /// Samples that are read as they are drawn.
    Lazy(PyRef<'py, PyLazyVolume>),
}

impl Drawable<'_> {
    /// Calls `work` with the volume as a scene takes it.
    pub fn with_volume<T>(&self, py: Python<'_>, work: impl FnOnce(SceneVolume<'_>) -> PyResult<T>) -> PyResult<T> {
        match self {
            Self::Samples(volume) => {
                volume.with_volume(py, |v| work(SceneVolume::Samples(v.clone(), volume.cache.clone())))
            }
            Self::Decoded(volume) => work(SceneVolume::Level(volume.0.clone())),
            Self::Lazy(volume) => work(SceneVolume::Lazy(volume.0.clone())),
        }
    }
}

/// Calls `work` with the volumes of a scene's layers.
pub fn with_volumes<T>(
    py: Python<'_>,
    drawables: &[&Drawable<'_>],
    work: &mut dyn FnMut(Vec<SceneVolume<'_>>) -> PyResult<T>,
) -> PyResult<T> {
    fn rest<'a, T>(
        py: Python<'_>,
        drawables: &[&Drawable<'_>],
        before: &[SceneVolume<'a>],
        work: &mut dyn FnMut(Vec<SceneVolume<'_>>) -> PyResult<T>,
    ) -> PyResult<T> {
        let Some((first, others)) = drawables.split_first() else { return work(before.to_vec()) };
        first.with_volume(py, |volume| rest(py, others, &[before, &[volume]].concat(), work))
    }
    rest(py, drawables, &[], work)
}

/// Calls `work` with all volumes.
pub fn with_samples_of_all<T>(
    py: Python<'_>,
    volumes: &[&PyVolume],
    work: &mut dyn FnMut(&[Volume<'_>]) -> PyResult<T>,
) -> PyResult<T> {
    fn rest<'a, T>(
        py: Python<'_>,
        volumes: &[&PyVolume],
        before: &[Volume<'a>],
        work: &mut dyn FnMut(&[Volume<'_>]) -> PyResult<T>,
    ) -> PyResult<T> {
        let Some((first, others)) = volumes.split_first() else { return work(before) };
        first.with_volume(py, |volume| rest(py, others, &[before, std::slice::from_ref(volume)].concat(), work))
    }
    rest(py, volumes, &[], work)
}

/// Samples in memory, their affine, and their cache.
#[pyclass(name = "Volume", frozen, module = "wavesplat._native")]
pub struct PyVolume {
    name: String,
    array: NumpySamples,
    world_from_index: DAffine3,
    statistics: Statistics,
    /// Data that is computed from the samples and kept between frames.
    cache: Arc<VolumeCache>,
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
        let array = NumpySamples::new(samples)?;
        let world_from_index = affine(&world_from_index)?;
        let unknown = Statistics { min: 0.0, max: 0.0, n_nonfinite: 0 };
        let mut volume = Self { name, array, world_from_index, statistics: unknown, cache: Arc::default() };
        volume.statistics = volume.with_samples(py, |samples, _| py.detach(|| Statistics::of(&samples)))?;
        volume.with_volume(py, |_| Ok(()))?;
        Ok(volume)
    }

    /// Smallest and largest finite sample.
    #[getter]
    fn value_range(&self) -> (f64, f64) {
        (self.statistics.min, self.statistics.max)
    }

    /// Number of samples that are NaN or infinite.
    #[getter]
    fn n_nonfinite(&self) -> usize {
        self.statistics.n_nonfinite
    }
}

impl PyVolume {
    /// Calls `work` with the samples and their `[nx, ny, nz]`.
    pub fn with_samples<T>(&self, py: Python<'_>, work: impl FnOnce(Samples<'_>, [usize; 3]) -> T) -> PyResult<T> {
        self.array.with_samples(py, work)
    }

    /// Calls `work` with the volume.
    pub fn with_volume<T>(&self, py: Python<'_>, work: impl FnOnce(&Volume<'_>) -> PyResult<T>) -> PyResult<T> {
        self.with_samples(py, |samples, size| {
            let volume = Volume::with_statistics(&self.name, samples, size, self.world_from_index, self.statistics);
            work(&volume.map_err(to_py)?)
        })?
    }
}

impl NumpySamples {
    /// Calls `work` with the samples and their `[nx, ny, nz]`.
    pub fn with_samples<T>(&self, py: Python<'_>, work: impl FnOnce(Samples<'_>, [usize; 3]) -> T) -> PyResult<T> {
        macro_rules! borrow {
            ($array:expr, $variant:path) => {{
                let array = $array.bind(py).readonly();
                let [nz, ny, nx] = *array.shape() else { return Err(PyTypeError::new_err("samples must be 3-D")) };
                Ok(work($variant(array.as_slice()?), [nx, ny, nz]))
            }};
        }
        match self {
            NumpySamples::U8(a) => borrow!(a, Samples::U8),
            NumpySamples::I8(a) => borrow!(a, Samples::I8),
            NumpySamples::U16(a) => borrow!(a, Samples::U16),
            NumpySamples::I16(a) => borrow!(a, Samples::I16),
            NumpySamples::U32(a) => borrow!(a, Samples::U32),
            NumpySamples::I32(a) => borrow!(a, Samples::I32),
            NumpySamples::F32(a) => borrow!(a, Samples::F32),
            NumpySamples::F64(a) => borrow!(a, Samples::F64),
        }
    }

    /// Takes an array of a known sample type; a `TypeError` for any other.
    pub fn new(samples: &Bound<'_, PyAny>) -> PyResult<Self> {
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
