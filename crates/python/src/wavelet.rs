//! Volumes of retained wavelet coefficients.

use numpy::{IntoPyArray, PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use wavesplat_wavelet::{Family, Keep, Norm, WaveletVolume};

/// See `_native.pyi`.
#[pyclass(name = "WaveletVolume", frozen, module = "wavesplat._native")]
pub struct PyWaveletVolume(WaveletVolume);

#[pymethods]
impl PyWaveletVolume {
    #[new]
    #[pyo3(signature = (samples, *, family, keep, amount, levels, peak))]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn new(
        py: Python<'_>,
        samples: PyReadonlyArray3<'_, f32>,
        family: &str,
        keep: &str,
        amount: f64,
        levels: Option<usize>,
        peak: bool,
    ) -> PyResult<Self> {
        let [nz, ny, nx] = *samples.shape() else { return Err(PyTypeError::new_err("samples must be 3-D")) };
        let family = Family::from_name(family).ok_or_else(|| PyTypeError::new_err("no such family"))?;
        let keep = match keep {
            "threshold" => Keep::Amplitude(amount),
            "keep" => Keep::Fraction(amount),
            "psnr" => Keep::Psnr(amount),
            _ => return Err(PyTypeError::new_err("keep must be threshold, keep or psnr")),
        };
        let norm = if peak { Norm::Peak } else { Norm::L2 };
        let samples = samples.as_slice()?;
        Ok(Self(py.detach(|| WaveletVolume::new(family, [nx, ny, nz], samples, levels, norm, keep))))
    }

    #[staticmethod]
    fn families() -> Vec<&'static str> {
        Family::NAMES.map(|(name, _)| name).to_vec()
    }

    #[getter]
    fn n_levels(&self) -> usize {
        self.0.plan().n_levels()
    }

    #[getter]
    fn threshold(&self) -> f64 {
        self.0.threshold()
    }

    #[getter]
    fn n_kept_by_level(&self) -> Vec<usize> {
        self.0.n_kept_by_level()
    }

    #[getter]
    fn n_bytes(&self) -> usize {
        self.0.n_bytes()
    }

    /// The samples [z, y, x], with a weight for each level's details, the finest first, and for the last low box.
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
    fn samples<'py>(&self, py: Python<'py>, weights: Vec<f32>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let samples = py.detach(|| self.0.to_samples(&weights));
        let [nx, ny, nz] = self.0.plan().size();
        samples.into_pyarray(py).reshape([nz, ny, nx])
    }
}
