//! GPUs: their list, their self-test, and their memory budget.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use wavesplat::Device;
use wavesplat::gpu::{Adapter, Choice, GpuReport, Gpus, adapters};

/// Device of the name "cpu", "auto" or "gpu", or of a part of a GPU's name.
pub fn device(name: &str) -> Device {
    match name {
        "cpu" => Device::Cpu,
        "auto" => Device::Auto,
        "gpu" => Device::Gpu,
        part => Device::Named(part.to_owned()),
    }
}

/// Dictionary of the fields of an adapter.
fn fields_of<'py>(py: Python<'py>, adapter: &Adapter) -> PyResult<Bound<'py, PyDict>> {
    let fields = PyDict::new(py);
    fields.set_item("name", &adapter.name)?;
    fields.set_item("backend", adapter.backend)?;
    fields.set_item("kind", adapter.kind)?;
    fields.set_item("driver", &adapter.driver)?;
    fields.set_item("vendor_id", adapter.ids[0])?;
    fields.set_item("device_id", adapter.ids[1])?;
    Ok(fields)
}

/// Dictionary of the cost of a frame.
pub fn report_of<'py>(py: Python<'py>, adapter: &Adapter, report: &GpuReport) -> PyResult<Bound<'py, PyDict>> {
    let fields = fields_of(py, adapter)?;
    fields.set_item("dispatches", report.n_dispatches)?;
    fields.set_item("longest_dispatch_seconds", report.longest_seconds)?;
    fields.set_item("sample_bytes", report.n_sample_bytes)?;
    fields.set_item("paged", report.is_paged)?;
    fields.set_item("page_bytes", report.n_page_bytes)?;
    fields.set_item("moved_bytes", report.n_bytes_moved)?;
    fields.set_item("seconds", report.seconds)?;
    fields.set_item("prepare_seconds", report.wall.prepare)?;
    fields.set_item("march_seconds", report.wall.march)?;
    fields.set_item("read_back_seconds", report.wall.read_back)?;
    if let Some([n_fetches, n_texels]) = report.counted {
        fields.set_item("fetches", n_fetches)?;
        fields.set_item("texels", n_texels)?;
    }
    Ok(fields)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn gpu_adapters(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    // A fork of a process that asked for GPUs cannot use any.
    let found = if Gpus::of_process().is_forked_child() { Vec::new() } else { py.detach(adapters) };
    PyList::new(py, found.iter().map(|adapter| fields_of(py, adapter)).collect::<PyResult<Vec<_>>>()?)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn gpu_check<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyDict>> {
    let opened = py.detach(|| Gpus::of_process().tested(&Choice::Named(name.to_owned())));
    let fields = PyDict::new(py);
    match opened {
        Ok(gpu) => {
            let limits = gpu.limits();
            fields.set_item("reason", py.None())?;
            fields.set_item("gathers", gpu.gathers())?;
            fields.set_item("timestamps", gpu.has_timestamps())?;
            fields.set_item("texture_side", limits[0])?;
            fields.set_item("texture_layers", limits[1])?;
            fields.set_item("buffer_bytes", limits[2])?;
        }
        Err(failure) => fields.set_item("reason", failure.to_string())?,
    }
    Ok(fields)
}

/// See `_native.pyi`.
#[pyfunction]
pub fn gpu_memory(n_bytes: Option<usize>) -> usize {
    let gpus = Gpus::of_process();
    if let Some(n_bytes) = n_bytes {
        gpus.set_budget(n_bytes);
    }
    gpus.budget_bytes()
}

/// See `_native.pyi`.
#[pyfunction]
pub fn gpu_count(counts: bool) {
    Gpus::of_process().set_counts(counts);
}

/// See `_native.pyi`.
#[pyfunction]
pub fn gpu_settle(py: Python<'_>) {
    py.detach(|| Gpus::of_process().settle());
}
