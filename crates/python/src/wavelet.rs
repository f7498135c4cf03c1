//! Volumes of retained wavelet coefficients, and their levels and bands, which are decoded while they are drawn.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use wavesplat::{
    CoefficientArrays, CoefficientDecoder, Keep, LevelError, LevelVolume, Norm, Statistics, WaveletError,
    WaveletFamily, WaveletVolume,
};

use crate::errors::to_py;
use crate::volume::{PyVolume, affine};

/// See `_native.pyi`.
#[pyclass(name = "WaveletVolume", frozen, module = "wavesplat._native")]
pub struct PyWaveletVolume(Arc<WaveletVolume>);

/// Arrays of the coefficients (`has_block`, `masks`, `values`), and the range of the samples if known.
type Arrays<'py> = (Bound<'py, PyArray1<u8>>, Bound<'py, PyArray1<u64>>, Bound<'py, PyArray1<f32>>, Option<(f32, f32)>);

#[pymethods]
impl PyWaveletVolume {
    #[new]
    #[pyo3(signature = (volume, *, family, keep, amount, levels, peak))]
    fn new(
        py: Python<'_>,
        volume: &PyVolume,
        family: &str,
        keep: &str,
        amount: f64,
        levels: Option<usize>,
        peak: bool,
    ) -> PyResult<Self> {
        let family = family_of(family)?;
        let keep = match keep {
            "threshold" => Keep::Amplitude(amount),
            "keep" => Keep::Fraction(amount),
            "psnr" => Keep::Psnr(amount),
            _ => return Err(PyTypeError::new_err("keep must be threshold, keep or psnr")),
        };
        let norm = if peak { Norm::Peak } else { Norm::L2 };
        let volume = volume.with_samples(py, |samples, size| {
            py.detach(|| WaveletVolume::new(family, size, samples, levels, norm, keep))
        })?;
        Ok(Self(Arc::new(volume.map_err(value_error)?)))
    }

    /// Makes a volume from the results of `parts`; numbers that do not fit are refused.
    #[staticmethod]
    #[pyo3(signature = (shape, family, levels, threshold, offset, has_block, masks, values, value_range))]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    #[expect(clippy::too_many_arguments, reason = "what a file holds")]
    fn from_parts(
        shape: (usize, usize, usize),
        family: &str,
        levels: usize,
        threshold: f64,
        offset: f32,
        has_block: PyReadonlyArray1<'_, u8>,
        masks: PyReadonlyArray1<'_, u64>,
        values: PyReadonlyArray1<'_, f32>,
        value_range: Option<(f32, f32)>,
    ) -> PyResult<Self> {
        let arrays = CoefficientArrays {
            family: family_of(family)?,
            size: [shape.2, shape.1, shape.0],
            n_levels: levels,
            threshold,
            offset,
            has_block: has_block.as_slice()?.to_vec(),
            masks: masks.as_slice()?.to_vec(),
            values: values.as_slice()?.to_vec(),
            range: value_range.map(|(lo, hi)| [lo, hi]),
        };
        let volume = WaveletVolume::from_arrays(arrays).map_err(value_error)?;
        Ok(Self(Arc::new(volume)))
    }

    /// Samples along (z, y, x).
    #[getter]
    fn shape(&self) -> (usize, usize, usize) {
        let [nx, ny, nz] = self.0.plan().size();
        (nz, ny, nx)
    }

    #[staticmethod]
    fn families() -> Vec<&'static str> {
        WaveletFamily::NAMES.map(|(name, _)| name).to_vec()
    }

    #[getter]
    fn n_levels(&self) -> usize {
        self.0.plan().n_levels()
    }

    #[getter]
    fn threshold(&self) -> f64 {
        self.0.threshold()
    }

    /// Offset that is added to the synthesised samples.
    #[getter]
    fn offset(&self) -> f32 {
        self.0.offset()
    }

    /// PSNR that was reached, dB; None where no PSNR was asked for.
    #[getter]
    fn psnr(&self) -> Option<f64> {
        self.0.psnr_db()
    }

    #[getter]
    fn n_kept_by_level(&self) -> Vec<usize> {
        self.0.n_kept_by_level()
    }

    #[getter]
    fn n_bytes(&self) -> usize {
        self.0.n_bytes()
    }

    /// Flags of the blocks, masks of their coefficients, the coefficients, and smallest and largest sample if known.
    fn parts<'py>(&self, py: Python<'py>) -> Arrays<'py> {
        let CoefficientArrays { has_block, masks, values, range, .. } = self.0.to_arrays();
        (has_block.into_pyarray(py), masks.into_pyarray(py), values.into_pyarray(py), range.map(Into::into))
    }

    /// Smallest and largest sample; the first call decodes the whole volume.
    #[getter]
    fn value_range(&self, py: Python<'_>) -> PyResult<(f32, f32)> {
        let range = py.detach(|| Ok(CoefficientDecoder::new(self.0.clone(), 0, &[])?.range()));
        range.map(Into::into).map_err(value_error)
    }

    /// All samples [z, y, x], with a weight for each level's details, the finest first, and for the coarsest low-pass
    /// box.
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
    fn samples<'py>(&self, py: Python<'py>, weights: Vec<f32>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let samples =
            py.detach(|| Ok(CoefficientDecoder::new(self.0.clone(), 0, &weights)?.all())).map_err(value_error)?;
        let [nx, ny, nz] = self.0.plan().size();
        samples.into_pyarray(py).reshape([nz, ny, nx])
    }

    /// A level with weighted details, for drawing; at its own resolution where its samples are evenly spaced.
    #[pyo3(signature = (level, weights, world_from_index, name, cache_bytes))]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists and arrays over by value")]
    fn decoded(
        &self,
        py: Python<'_>,
        level: usize,
        weights: Vec<f32>,
        world_from_index: PyReadonlyArray2<'_, f64>,
        name: &str,
        cache_bytes: usize,
    ) -> PyResult<PyDecodedVolume> {
        let world_from_index = affine(&world_from_index)?;
        let opened = py.detach(|| LevelVolume::open(&self.0, level, &weights, world_from_index, name, cache_bytes));
        match opened {
            Ok(opened) => Ok(PyDecodedVolume(Arc::new(opened))),
            Err(LevelError::Grid(error)) => Err(to_py(error)),
            Err(error) => Err(PyValueError::new_err(error.to_string())),
        }
    }
}

/// `ValueError` for arguments or arrays that do not fit together.
#[expect(clippy::needless_pass_by_value, reason = "used as map_err(value_error)")]
fn value_error(error: WaveletError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn family_of(name: &str) -> PyResult<WaveletFamily> {
    WaveletFamily::from_name(name).ok_or_else(|| PyTypeError::new_err("no such family"))
}

/// See `_native.pyi`.
#[pyclass(name = "DecodedVolume", frozen, module = "wavesplat._native")]
pub struct PyDecodedVolume(pub Arc<LevelVolume>);

#[pymethods]
impl PyDecodedVolume {
    #[getter]
    fn value_range(&self) -> (f64, f64) {
        let Statistics { min, max, .. } = self.0.grid().statistics();
        (min, max)
    }

    /// Most bytes of decoded samples that are kept.
    #[getter]
    fn cache_bytes(&self) -> usize {
        self.0.cache_bytes()
    }

    /// Every n-th sample along each axis, [z, y, x].
    fn every<'py>(&self, py: Python<'py>, step: usize) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let ([nx, ny, nz], samples) = py.detach(|| self.0.samples_every(step));
        samples.into_pyarray(py).reshape([nz, ny, nx])
    }
}
