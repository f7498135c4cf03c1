//! Volumes whose samples Python reads while they are drawn, described by a survey, one pass over all samples.

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::DVec3;
use numpy::{
    IntoPyArray, PyArray3, PyArray4, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyReadonlyArray4,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use wavesplat::boxes::{Slices, StridedSamples, VolumeBox, light_steps, needed_samples};
use wavesplat::{Grid, Kernel, LazyVolume, LevelBrightness, LevelPart, Statistics, Storage, Survey};

use crate::errors::to_py;
use crate::volume::{NumpySamples, affine};

/// Numbers along z, y, x.
pub type Zyx = (usize, usize, usize);

/// A box of samples, first and end along z, y, x.
pub type PyBox = (Zyx, Zyx);

pub fn xyz((z, y, x): Zyx) -> [usize; 3] {
    [x, y, z]
}

pub fn py_box(part: &[Range<usize>; 3]) -> PyBox {
    let [x, y, z] = part;
    ((z.start, y.start, x.start), (z.end, y.end, x.end))
}

fn ranges((lo, hi): PyBox) -> [Range<usize>; 3] {
    let (lo, hi) = (xyz(lo), xyz(hi));
    [0, 1, 2].map(|a| lo[a]..hi[a])
}

/// See `_native.pyi`.
#[pyclass(name = "Survey", frozen, module = "wavesplat._native")]
pub struct PySurvey {
    survey: Mutex<Survey>,
    size: [usize; 3],
}

/// Cells along a side of a brick; bounds [z, y, x, 2]; strided samples [z, y, x].
type Parts<'py> = (usize, Bound<'py, PyArray4<f32>>, Vec<Bound<'py, PyArray3<f32>>>);

#[pymethods]
impl PySurvey {
    #[new]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
    fn new(shape: Zyx, kernel: &str, bounds_bytes: usize, steps: Vec<Zyx>) -> PyResult<Self> {
        let steps: Vec<[usize; 3]> = steps.iter().map(|step| xyz(*step).map(|n| n.max(1))).collect();
        let size = checked_size(shape)?;
        let kernel = Kernel::from_name(kernel).map_err(to_py)?;
        Ok(Self { survey: Mutex::new(Survey::new(size, kernel, bounds_bytes, &steps)), size })
    }

    /// Makes a survey from the results of `parts`; numbers that do not fit are refused.
    #[staticmethod]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn from_parts(
        shape: Zyx,
        kernel: &str,
        side: usize,
        statistics: (f64, f64, usize),
        bounds: PyReadonlyArray4<'_, f32>,
        strided: Vec<(Zyx, PyReadonlyArray3<'_, f32>)>,
    ) -> PyResult<Self> {
        let size = checked_size(shape)?;
        let kernel = Kernel::from_name(kernel).map_err(to_py)?;
        let (min, max, n_nonfinite) = statistics;
        let strided = strided.iter().map(|(step, array)| {
            let [nz, ny, nx] = *array.shape() else { return Err(PyTypeError::new_err("strided must be 3-D")) };
            let own =
                StridedSamples { step: xyz(*step), size: [nx, ny, nz], values: array.as_slice()?.to_vec().into() };
            let fits = own.step.iter().all(|n| *n > 0) && [0, 1, 2].map(|a| size[a].div_ceil(own.step[a])) == own.size;
            if fits { Ok(own) } else { Err(PyValueError::new_err("strided samples of another volume")) }
        });
        let strided = strided.collect::<PyResult<_>>()?;
        let bounds = bounds.as_slice()?.as_chunks::<2>().0.to_vec();
        let statistics = Statistics { min, max, n_nonfinite };
        let survey = Survey::from_parts(size, kernel, side, statistics, bounds, strided);
        let survey = survey.ok_or_else(|| PyValueError::new_err("a survey of another volume"))?;
        Ok(Self { survey: Mutex::new(survey), size })
    }

    /// Adds the samples of a box that begins at `lo` (z, y, x).
    fn add(&self, py: Python<'_>, samples: &Bound<'_, PyAny>, lo: Zyx) -> PyResult<()> {
        let array = NumpySamples::new(samples)?;
        array.with_samples(py, |samples, n| {
            let part = VolumeBox { lo: xyz(lo), size: n, samples };
            self.check_inside(&part)?;
            py.detach(|| self.locked().add(&part));
            Ok(())
        })?
    }

    /// Adds the coefficients or filled samples in the part `inner` of a box that begins at `lo`, of a volume with these
    /// statistics.
    #[expect(clippy::too_many_arguments, reason = "a box, and the volume around it")]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn add_prepared(
        &self,
        py: Python<'_>,
        samples: &Bound<'_, PyAny>,
        lo: Zyx,
        inner: PyBox,
        kernel: &str,
        statistics: (f64, f64, usize),
        world_from_index: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let array = NumpySamples::new(samples)?;
        let kernel = Kernel::from_name(kernel).map_err(to_py)?;
        let world_from_index = affine(&world_from_index)?;
        array.with_samples(py, |samples, n| {
            let part = VolumeBox { lo: xyz(lo), size: n, samples };
            self.check_inside(&part)?;
            let inner = ranges(inner);
            if (0..3).any(|a| inner[a].start < part.lo[a] || inner[a].end > part.lo[a] + n[a]) {
                return Err(PyValueError::new_err("the inner box must lie in the box"));
            }
            let (min, max, n_nonfinite) = statistics;
            let statistics = Statistics { min, max, n_nonfinite };
            let grid = Grid::new("box", self.size, world_from_index, statistics, samples.is_narrow()).map_err(to_py)?;
            py.detach(|| {
                let slices = Slices::of_box(&part, &grid, kernel, [0.0; 2]);
                self.locked().add_prepared(&slices, &inner);
            });
            Ok(())
        })?
    }

    /// Frees the bounds.
    fn forget_bounds(&self) {
        self.locked().forget_bounds();
    }

    /// Whether the survey has bounds.
    #[getter]
    fn has_bounds(&self) -> bool {
        !self.locked().bounds().1.is_empty()
    }

    /// Smallest and largest finite sample, and number of samples that are not finite.
    #[getter]
    fn statistics(&self) -> (f64, f64, usize) {
        let Statistics { min, max, n_nonfinite } = self.locked().statistics();
        (min, max, n_nonfinite)
    }

    /// Cells along a side of a brick, the bounds of bricks, and the strided samples.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let survey = self.locked();
        let (side, bounds) = survey.bounds();
        let [nx, ny, nz] = self.size.map(|n| (n - 1).div_ceil(side));
        let bounds = bounds.as_flattened().to_vec().into_pyarray(py).reshape([nz, ny, nx, 2])?;
        let strided = survey.strided().iter().map(|own| array_of(py, own)).collect::<PyResult<_>>()?;
        Ok((side, bounds, strided))
    }

    /// Strided samples at index `which`.
    fn strided<'py>(&self, py: Python<'py>, which: usize) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let survey = self.locked();
        array_of(py, survey.strided().get(which).ok_or_else(|| PyValueError::new_err("no such strided samples"))?)
    }
}

impl PySurvey {
    /// The survey, also after a panic of a thread that held it: it is valid between calls.
    fn locked(&self) -> MutexGuard<'_, Survey> {
        self.survey.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn check_inside(&self, part: &VolumeBox) -> PyResult<()> {
        let inside = (0..3).all(|a| part.size[a] > 0 && part.lo[a].saturating_add(part.size[a]) <= self.size[a]);
        if inside { Ok(()) } else { Err(PyValueError::new_err("the box must lie in the volume")) }
    }
}

fn array_of<'py>(py: Python<'py>, own: &StridedSamples) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let [nx, ny, nz] = own.size;
    own.values.to_vec().into_pyarray(py).reshape([nz, ny, nx])
}

fn checked_size(shape: Zyx) -> PyResult<[usize; 3]> {
    let size = xyz(shape);
    if size.iter().any(|n| *n < 2) {
        return Err(PyValueError::new_err("a volume needs two samples along every axis"));
    }
    Ok(size)
}

/// Steps (z, y, x) between the samples from which occlusion and shadow are computed.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn light_step(shape: Zyx, world_from_index: PyReadonlyArray2<'_, f64>) -> PyResult<Zyx> {
    let any = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
    let grid = Grid::new("volume", xyz(shape), affine(&world_from_index)?, any, true).map_err(to_py)?;
    let (_, [x, y, z]) = light_steps(&grid);
    Ok((z, y, x))
}

/// Box of samples from which a box of coefficients, or of samples with filled holes, is computed.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
pub fn samples_for(
    shape: Zyx,
    part: PyBox,
    kernel: &str,
    n_nonfinite: usize,
    world_from_index: PyReadonlyArray2<'_, f64>,
) -> PyResult<PyBox> {
    let statistics = Statistics { min: 0.0, max: 1.0, n_nonfinite };
    let grid = Grid::new("volume", xyz(shape), affine(&world_from_index)?, statistics, true).map_err(to_py)?;
    Ok(py_box(&needed_samples(&ranges(part), &grid, Kernel::from_name(kernel).map_err(to_py)?)))
}

/// Samples of a box of a level, and the box's first sample (z, y, x).
type LevelBox<'py> = (PyReadonlyArray3<'py, f32>, Zyx);

/// Affine of a finer level, a box of it and a box of this level, and smallest and largest sample.
type Brightness<'py> = (PyReadonlyArray2<'py, f64>, LevelBox<'py>, LevelBox<'py>, (f64, f64));

/// Shape and affine of the finest level; and the samples from which brightness is matched.
type LevelArguments<'py> = (Zyx, PyReadonlyArray2<'py, f64>, Option<Brightness<'py>>);

/// See `_native.pyi`.
#[pyclass(name = "LazyVolume", frozen, module = "wavesplat._native")]
pub struct PyLazyVolume(pub Arc<LazyVolume>);

#[pymethods]
impl PyLazyVolume {
    #[new]
    #[pyo3(signature = (name, shape, world_from_index, *, kernel, is_narrow, survey, prepared, light, chunk, sample_bytes, level))]
    #[expect(clippy::too_many_arguments, reason = "keyword-only arguments of the binding")]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    fn new(
        py: Python<'_>,
        name: &str,
        shape: Zyx,
        world_from_index: PyReadonlyArray2<'_, f64>,
        kernel: &str,
        is_narrow: bool,
        survey: &PySurvey,
        prepared: Option<&PySurvey>,
        light: usize,
        chunk: Zyx,
        sample_bytes: usize,
        level: Option<LevelArguments<'_>>,
    ) -> PyResult<Self> {
        let kernel = Kernel::from_name(kernel).map_err(to_py)?;
        let survey = survey.locked();
        let prepared = prepared.map(PySurvey::locked);
        let own = affine(&world_from_index)?;
        let mut grid = Grid::new(name, xyz(shape), own, survey.statistics(), is_narrow).map_err(to_py)?;
        let mut looks = None;
        if let Some((finest_shape, finest, brightness)) = level {
            let finest = affine(&finest)?;
            let (own, level) = LazyVolume::level_grid(grid, xyz(finest_shape), finest).map_err(to_py)?;
            grid = own;
            let part = |(array, lo): LevelBox<'_>| -> PyResult<LevelPart> {
                let [nz, ny, nx] = *array.shape() else { return Err(PyTypeError::new_err("parts must be 3-D")) };
                Ok(LevelPart { lo: xyz(lo), size: [nx, ny, nz], samples: array.as_slice()?.to_vec() })
            };
            looks = Some(match brightness {
                None => LevelBrightness::new(level, None),
                Some((finer, fine, coarse, (lo, hi))) => {
                    let finer = affine(&finer)?;
                    let in_finer = LazyVolume::level_in(&grid, finer);
                    let spacing = DVec3::new(0.0, 1.0, 2.0).map(|a| finer.matrix3.col(a as usize).length());
                    let parts = [part(fine)?, part(coarse)?];
                    py.detach(|| LevelBrightness::of_parts(level, in_finer, parts, spacing, [lo, hi]))
                }
            });
        }
        let storage = Storage { chunk: xyz(chunk).map(|n| n.max(1)), sample_bytes };
        let volume = py.detach(|| LazyVolume::new(grid, storage, kernel, &survey, prepared.as_deref(), light, looks));
        volume.map(|volume| Self(Arc::new(volume))).map_err(to_py)
    }

    /// Smallest and largest finite sample.
    #[getter]
    fn value_range(&self) -> (f64, f64) {
        let Statistics { min, max, .. } = self.0.grid().statistics();
        (min, max)
    }
}
