//! Volumes of retained wavelet coefficients, and levels and bands of them that are decoded as they are drawn.

use std::sync::{Arc, Mutex, PoisonError};

use glam::{DAffine3, DMat3, DVec3};
use numpy::{IntoPyArray, PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use wavesplat_core::{Decoder as _, Grid, Kernel, LevelGrid, Shading, Statistics, TransferFunction};
use wavesplat_lod::LevelHistogram;
use wavesplat_splat::optics::visibility_cache::VisibilityCache;
use wavesplat_splat::source::block_cache::{bytes_of_all, samples_every};
use wavesplat_splat::source::slices::Prepared;
use wavesplat_wavelet::{
    CoarseLevel, CoefficientArrays, CoefficientDecoder, Keep, Norm, WaveletError, WaveletFamily, WaveletVolume,
};

use crate::arguments::Triple;
use crate::errors::to_py;
use crate::volume::{PyVolume, affine};

/// See `_native.pyi`.
#[pyclass(name = "WaveletVolume", frozen, module = "wavesplat._native")]
pub struct PyWaveletVolume(Arc<WaveletVolume>);

/// Arrays that hold the coefficients, and the range of the samples where it is known.
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
            py.detach(|| WaveletVolume::new(family, size, samples.to_f32(), levels, norm, keep))
        })?;
        Ok(Self(Arc::new(volume.map_err(value_error)?)))
    }

    /// From what `parts` gave; wrong numbers are refused.
    #[staticmethod]
    #[pyo3(signature = (shape, family, levels, threshold, has_block, masks, values, value_range))]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arrays over by value")]
    #[expect(clippy::too_many_arguments, reason = "what a file holds")]
    fn from_parts(
        shape: (usize, usize, usize),
        family: &str,
        levels: usize,
        threshold: f64,
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

    #[getter]
    fn n_kept_by_level(&self) -> Vec<usize> {
        self.0.n_kept_by_level()
    }

    #[getter]
    fn n_bytes(&self) -> usize {
        self.0.n_bytes()
    }

    /// Which blocks there are, the bits of their coefficients, the coefficients, and smallest and largest sample where they
    /// were found before.
    fn parts<'py>(&self, py: Python<'py>) -> Arrays<'py> {
        let CoefficientArrays { has_block, masks, values, range, .. } = self.0.to_arrays();
        (has_block.into_pyarray(py), masks.into_pyarray(py), values.into_pyarray(py), range.map(Into::into))
    }

    /// Smallest and largest sample; at first everything is decoded for it.
    #[getter]
    fn value_range(&self, py: Python<'_>) -> PyResult<(f32, f32)> {
        let range = py.detach(|| Ok(CoefficientDecoder::new(self.0.clone(), 0, &[])?.range()));
        range.map(Into::into).map_err(value_error)
    }

    /// The samples [z, y, x], with a weight for each level's details, the finest first, and for the last low box.
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
    fn samples<'py>(&self, py: Python<'py>, weights: Vec<f32>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let samples =
            py.detach(|| Ok(CoefficientDecoder::new(self.0.clone(), 0, &weights)?.all())).map_err(value_error)?;
        let [nx, ny, nz] = self.0.plan().size();
        samples.into_pyarray(py).reshape([nz, ny, nx])
    }

    /// A level with weighted details, to be drawn; at its own resolution where its samples are evenly spaced.
    #[pyo3(signature = (level, weights, world_from_index, name, cache_bytes))]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists and arrays over by value")]
    fn decoded(
        &self,
        py: Python<'_>,
        level: usize,
        mut weights: Vec<f32>,
        world_from_index: PyReadonlyArray2<'_, f64>,
        name: &str,
        cache_bytes: usize,
    ) -> PyResult<PyDecodedVolume> {
        let world_from_index = affine(&world_from_index)?;
        let (n_dropped, all_weights) = (level, weights.clone());
        let coarsest = self.0.plan().n_levels();
        if level > coarsest {
            return Err(value_error(WaveletError::NoSuchLevel { level, coarsest }));
        }
        let has_grid = self.0.plan().level_grid(level).is_some();
        let level = if has_grid { level } else { 0 };
        if !has_grid {
            weights[..n_dropped].fill(0.0);
        }
        let finest_spacing = [0, 1, 2].map(|a| world_from_index.matrix3.col(a).length());
        let opened = py.detach(|| {
            let decoder = CoefficientDecoder::new(self.0.clone(), level, &weights)?;
            let range = decoder.range().map(f64::from);
            let decoder = CoarseLevel::new(decoder)?;
            let histogram = if n_dropped > 0 {
                let finest = CoefficientDecoder::new(self.0.clone(), 0, &all_weights)?;
                let range = finest.range().map(f64::from);
                Some(LevelHistogram::new(&finest, &decoder, &decoder.grid(), finest_spacing, range, cache_bytes))
            } else {
                None
            };
            Ok((decoder, range, histogram))
        });
        let (decoder, range, histogram) = opened.map_err(value_error)?;
        let level_grid = decoder.grid();
        let [min, max] = range;
        let statistics = Statistics { min, max, n_nonfinite: 0 };
        let finest = Grid::new(name, self.0.plan().size(), world_from_index, statistics, false).map_err(to_py)?;
        let LevelGrid { origin, spacing, .. } = level_grid;
        let matrix3 = DMat3::from_diagonal(DVec3::from_array(spacing));
        let finest_from_level = DAffine3 { matrix3, translation: DVec3::from_array(origin) };
        let bounds = [DVec3::ZERO, finest.last_index()]
            .map(|corner| DVec3::from_array(level_grid.level_from_finest(corner.to_array())));
        let grid = Grid::new(name, decoder.size(), world_from_index * finest_from_level, statistics, false);
        let grid = grid.map_err(to_py)?.as_level_of(finest.default_opacity_unit(), bounds);
        let cache_bytes = cache_bytes.min(bytes_of_all(grid.size()));
        let decoder = Arc::new(decoder);
        Ok(PyDecodedVolume {
            grid,
            level: level_grid,
            histogram,
            filtered: Mutex::default(),
            decoder,
            cache_bytes,
            prepared: Mutex::default(),
            cache: VisibilityCache::default(),
        })
    }
}

/// A `ValueError` for what does not fit together.
#[expect(clippy::needless_pass_by_value, reason = "used as map_err(value_error)")]
fn value_error(error: WaveletError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn family_of(name: &str) -> PyResult<WaveletFamily> {
    WaveletFamily::from_name(name).ok_or_else(|| PyTypeError::new_err("no such family"))
}

/// See `_native.pyi`.
#[pyclass(name = "DecodedVolume", frozen, module = "wavesplat._native")]
pub struct PyDecodedVolume {
    grid: Grid,
    level: LevelGrid,
    /// What the levels carried that are left out.
    histogram: Option<LevelHistogram>,
    /// The function that was drawn last, and what it is for this level.
    filtered: Mutex<Option<Filtered>>,
    decoder: Arc<CoarseLevel>,
    cache_bytes: usize,
    /// For the kernel that was used last.
    prepared: Mutex<Option<(Kernel, Arc<Prepared>)>>,
    /// What is kept of transfer functions.
    pub cache: VisibilityCache,
}

/// A transfer function, and the one that a level is drawn with in its place.
struct Filtered {
    of: TransferFunction,
    shading: Option<Shading>,
    tf: TransferFunction,
    is_steep: bool,
}

#[pymethods]
impl PyDecodedVolume {
    #[getter]
    fn value_range(&self) -> (f64, f64) {
        let Statistics { min, max, .. } = self.grid.statistics();
        (min, max)
    }

    /// Bytes of decoded samples that are kept at most.
    #[getter]
    fn cache_bytes(&self) -> usize {
        self.cache_bytes
    }

    /// Every n-th sample along each axis, [z, y, x].
    fn every<'py>(&self, py: Python<'py>, step: usize) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let ([nx, ny, nz], samples) = py.detach(|| samples_every(&*self.decoder, step.max(1)));
        samples.into_pyarray(py).reshape([nz, ny, nx])
    }
}

impl PyDecodedVolume {
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// An index position of the finest grid as one of the level.
    pub fn level_from_finest(&self, index: Triple) -> Triple {
        let [x, y, z] = self.level.level_from_finest([index.0, index.1, index.2]);
        (x, y, z)
    }

    /// The transfer function that makes of a coarser level what it makes of the finest, and whether it or the one that was
    /// given is steep; kept until another is asked for.
    pub fn filtered(&self, tf: &TransferFunction, shading: Option<&Shading>) -> PyResult<(TransferFunction, bool)> {
        let mut kept = self.filtered.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = &*kept
            && (&kept.of, kept.shading.as_ref()) == (tf, shading)
        {
            return Ok((kept.tf.clone(), kept.is_steep));
        }
        let is_steep = wavesplat_splat::is_steep(&self.grid, tf);
        let filtered = if let Some(histogram) = &self.histogram {
            let unit = tf.opacity_unit().unwrap_or(self.grid.default_opacity_unit());
            let spacing = self.grid.spacing() / DVec3::from_array(self.level.spacing) / unit;
            histogram.filter(tf, spacing.to_array(), shading, is_steep).map_err(to_py)?
        } else {
            tf.clone()
        };
        // One that is smooth may need so much extinction that its level is steep.
        let is_steep = is_steep || wavesplat_splat::is_steep(&self.grid, &filtered);
        *kept = Some(Filtered { of: tf.clone(), shading: shading.cloned(), tf: filtered.clone(), is_steep });
        Ok((filtered, is_steep))
    }

    /// What is decoded for a kernel; kept until another is asked for.
    pub fn prepared(&self, kernel: Kernel) -> Arc<Prepared> {
        let mut kept = self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((known, prepared)) = &*kept
            && *known == kernel
        {
            return prepared.clone();
        }
        *kept = None;
        let new = Arc::new(Prepared::of_decoder(self.decoder.clone(), &self.grid, kernel, self.cache_bytes));
        *kept = Some((kernel, new.clone()));
        new
    }
}
