//! `wavesplat._native`: converts, releases the interpreter lock, calls, maps errors. No algorithm lives here.

mod arguments;
mod errors;
mod labels;
mod progress;
mod reference;
mod rendering;
mod study;
mod volume;
mod wavelet;

use pyo3::prelude::*;

/// The compiled half of the Python package; its contract is `_native.pyi`.
#[pymodule]
mod _native {
    use super::{Bound, PyModule, PyModuleMethods, PyResult};
    #[pymodule_export]
    use crate::arguments::{PyAblation, PyCamera, PyShading, PyTransferFunction};
    #[pymodule_export]
    use crate::labels::PyLabels;
    #[pymodule_export]
    use crate::reference::{raycast, splat_literal};
    #[pymodule_export]
    use crate::rendering::{encode_png, plane, quality_settings, render};
    #[pymodule_export]
    use crate::study::{render_standard, splat_ablated};
    #[pymodule_export]
    use crate::volume::PyVolume;
    #[pymodule_export]
    use crate::wavelet::{PyDecodedVolume, PyWaveletVolume};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
