//! Frames whose samples Python reads while they are drawn.

use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use wavesplat::{
    BlockState, FrameOptions, Part, Samples, Scene, SceneColor, SceneLayer, SceneVolume, Stream, StreamOptions,
};

use crate::arguments::{PyCamera, PyShading, PyTransferFunction};
use crate::errors::to_py;
use crate::lazy::{PyBox, PyLazyVolume, py_box};
use crate::progress::PyProgress;
use crate::rendering::{PyFrame, picture_and_report};
use crate::volume::NumpySamples;

/// A lazy field that colours a layer, and its transfer function.
type PyLazyColor<'py> = (PyRef<'py, PyLazyVolume>, PyRef<'py, PyTransferFunction>);

/// A lazy volume, its transfer function, its shading, and the field that colours it.
type PyLazyLayer<'py> =
    (PyRef<'py, PyLazyVolume>, PyRef<'py, PyTransferFunction>, Option<PyRef<'py, PyShading>>, Option<PyLazyColor<'py>>);

/// See `_native.pyi`.
#[pyclass(name = "Stream", frozen, module = "wavesplat._native")]
pub struct PyStream(RwLock<Stream>, PyStreamFacts);

/// Constants of a stream that are read without its lock.
struct PyStreamFacts {
    n_blocks: usize,
}

/// See `_native.pyi`.
#[pyclass(name = "BlockState", frozen, module = "wavesplat._native")]
pub struct PyBlockState(BlockState);

#[pymethods]
impl PyBlockState {
    #[new]
    fn new() -> Self {
        Self(BlockState::default())
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.to_bytes())
    }

    /// Reads a state that `to_bytes` wrote; other bytes are refused.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let state = BlockState::from_bytes(bytes, 1 << 24);
        let refused = "these bytes hold no state of a block; give the bytes that BlockState.to_bytes returned";
        state.map(Self).ok_or_else(|| PyValueError::new_err(refused))
    }
}

/// Scene of lazy layers, its frame options, and the size of the picture.
fn scene_of(layers: &[PyLazyLayer<'_>], frame: &PyFrame<'_>) -> PyResult<(Scene<'static>, FrameOptions, [usize; 2])> {
    let layer = |(volume, tf, shading, color): &PyLazyLayer<'_>| SceneLayer {
        volume: SceneVolume::Lazy(volume.0.clone()),
        transfer_function: tf.0.clone(),
        shading: shading.as_ref().map(|shading| shading.0.clone()),
        color: color.as_ref().map(|(volume, tf)| SceneColor {
            volume: SceneVolume::Lazy(volume.0.clone()),
            transfer_function: tf.0.clone(),
        }),
    };
    let mut scene = Scene::of(layers.iter().map(layer).collect());
    frame.fill(&mut scene);
    Ok((scene, frame.options()?, [frame.width, frame.height]))
}

/// See `_native.pyi`.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arguments over by value")]
pub fn smallest_budget(
    py: Python<'_>,
    layers: Vec<PyLazyLayer<'_>>,
    camera: &PyCamera,
    frame: PyFrame<'_>,
    segment_slices: Option<usize>,
) -> PyResult<usize> {
    let (scene, options, size) = scene_of(&layers, &frame)?;
    let streaming = StreamOptions { segment_slices, ..StreamOptions::default() };
    let camera = &camera.0;
    py.detach(|| scene.smallest_budget(camera, size, &options, &streaming)).map_err(to_py)
}

#[pymethods]
impl PyStream {
    #[new]
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arguments over by value")]
    #[expect(clippy::too_many_arguments, reason = "the frame, and how it is streamed")]
    fn new(
        py: Python<'_>,
        layers: Vec<PyLazyLayer<'_>>,
        camera: &PyCamera,
        frame: PyFrame<'_>,
        budget_bytes: usize,
        n_blocks: usize,
        segment_slices: Option<usize>,
        part: Option<[[f64; 3]; 2]>,
    ) -> PyResult<Self> {
        let (scene, options, size) = scene_of(&layers, &frame)?;
        let part = part.map(|corners| {
            let [lo, hi] = corners.map(Into::into);
            Part { lo, hi }
        });
        let streaming = StreamOptions { budget_bytes, n_blocks, segment_slices, part };
        let camera = &camera.0;
        let stream = py.detach(|| scene.stream(camera, size, &options, &streaming)).map_err(to_py)?;
        let facts = PyStreamFacts { n_blocks: stream.n_blocks() };
        Ok(Self(RwLock::new(stream), facts))
    }

    #[getter]
    fn n_blocks(&self) -> usize {
        self.1.n_blocks
    }

    fn n_steps(&self, block: usize) -> PyResult<usize> {
        self.check(block, None)?;
        Ok(self.locked().n_steps(block))
    }

    /// First and end of the steps of each segment of a block.
    fn segments(&self, block: usize) -> PyResult<Vec<(usize, usize)>> {
        self.check(block, None)?;
        Ok(self.locked().segments(block).into_iter().map(|range| (range.start, range.end)).collect())
    }

    /// Whether all rays of a block are done after a state.
    fn is_done(&self, block: usize, state: &PyBlockState) -> PyResult<bool> {
        self.check(block, None)?;
        Ok(self.locked().is_done(block, &state.0))
    }

    /// Texels of a block over all slabs.
    fn n_texels(&self, block: usize) -> PyResult<u64> {
        self.check(block, None)?;
        Ok(self.locked().n_texels(block))
    }

    /// Bytes that each block reads if no ray ends early.
    fn bytes_to_read(&self, py: Python<'_>) -> Vec<u64> {
        py.detach(|| self.locked().bytes_to_read())
    }

    /// Number of boxes that all steps read if no ray ends early.
    fn n_boxes(&self, py: Python<'_>) -> usize {
        py.detach(|| self.locked().n_boxes())
    }

    /// Number of rays of a block.
    fn n_rays(&self, block: usize) -> PyResult<u64> {
        self.check(block, None)?;
        Ok(self.locked().n_rays(block))
    }

    /// Most bytes of samples that are held while a block is drawn.
    fn peak_sample_bytes(&self, block: usize) -> PyResult<u64> {
        self.check(block, None)?;
        Ok(self.locked().peak_sample_bytes(block))
    }

    /// Box of samples that a step is drawn from, per source: layers, then fields that colour them.
    fn held(&self, block: usize, step: usize) -> PyResult<Vec<PyBox>> {
        self.check(block, Some(step))?;
        Ok(self.locked().held(block, step).iter().map(py_box).collect())
    }

    /// Boxes of samples that a step reads, per source.
    fn reads(
        &self,
        py: Python<'_>,
        block: usize,
        step: usize,
        is_first: bool,
        state: &PyBlockState,
    ) -> PyResult<Vec<Vec<PyBox>>> {
        self.check(block, Some(step))?;
        let reads = py.detach(|| self.locked().reads(block, step, is_first, &state.0));
        Ok(reads.iter().map(|boxes| boxes.iter().map(py_box).collect()).collect())
    }

    /// Draws a step from the samples of `held`, and returns the state after it.
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
    fn draw(
        &self,
        py: Python<'_>,
        block: usize,
        step: usize,
        samples: Vec<Bound<'_, PyAny>>,
        state: &PyBlockState,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<PyBlockState> {
        self.check(block, Some(step))?;
        let arrays = samples.iter().map(NumpySamples::new).collect::<PyResult<Vec<_>>>()?;
        let watched = PyProgress::new(progress);
        let drawn = with_arrays(py, &arrays, &[], &mut |samples| {
            watched.watch(py, || self.locked().draw(block, step, samples, &state.0, &watched))
        })?;
        drawn.map(PyBlockState).map_err(to_py)
    }

    /// State of a block after its segments, which are given front to back.
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands lists over by value")]
    fn fold(&self, py: Python<'_>, segments: Vec<PyRef<'_, PyBlockState>>) -> PyBlockState {
        let segments = segments.iter().map(|state| state.0.clone()).collect();
        PyBlockState(py.detach(|| self.locked().fold(segments)))
    }

    /// Puts the final state of a block into the picture.
    fn put(&self, py: Python<'_>, block: usize, state: &PyBlockState) -> PyResult<()> {
        self.check(block, None)?;
        py.detach(|| self.locked_to_write().put(block, state.0.clone()));
        Ok(())
    }

    #[getter]
    fn n_planes(&self) -> usize {
        self.locked().n_planes()
    }

    /// Number of the base plane of a block, and the block's state as one of all tiles of that plane.
    fn plane_state(&self, block: usize, state: &PyBlockState) -> PyResult<(usize, PyBlockState)> {
        self.check(block, None)?;
        let (plane, state) = self.locked().plane_state(block, state.0.clone());
        Ok((plane, PyBlockState(state)))
    }

    /// Puts the final state of the tiles of a base plane into the picture.
    fn put_plane(&self, py: Python<'_>, plane: usize, state: &PyBlockState) -> PyResult<()> {
        if plane >= self.n_planes() {
            return Err(PyValueError::new_err("there is no such base plane"));
        }
        py.detach(|| self.locked_to_write().put_plane(plane, state.0.clone()));
        Ok(())
    }

    /// Picture of all blocks that were put.
    fn picture<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let frame = py.detach(|| self.locked().picture());
        picture_and_report(py, frame)
    }
}

impl PyStream {
    fn locked(&self) -> RwLockReadGuard<'_, Stream> {
        self.0.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn locked_to_write(&self) -> RwLockWriteGuard<'_, Stream> {
        self.0.write().unwrap_or_else(PoisonError::into_inner)
    }

    fn check(&self, block: usize, step: Option<usize>) -> PyResult<()> {
        let is_there = block < self.1.n_blocks && step.is_none_or(|step| step < self.locked().n_steps(block));
        if is_there { Ok(()) } else { Err(PyValueError::new_err("there is no such block or step")) }
    }
}

/// Calls `work` with the samples of all arrays.
fn with_arrays<T>(
    py: Python<'_>,
    arrays: &[NumpySamples],
    before: &[Samples<'_>],
    work: &mut dyn FnMut(&[Samples<'_>]) -> PyResult<T>,
) -> PyResult<T> {
    let Some((first, others)) = arrays.split_first() else { return work(before) };
    first.with_samples(py, |samples, _| with_arrays(py, others, &[before, &[samples]].concat(), work))?
}
