//! Conversion of Rust errors to Python exceptions, by who can mend them.

use pyo3::PyErr;
use wavesplat::{Error, ErrorKind};

pub(crate) mod exceptions {
    #![allow(missing_docs, reason = "the classes are documented in wavesplat/errors.py")]
    pyo3::import_exception!(wavesplat.errors, ArgumentError);
    pyo3::import_exception!(wavesplat.errors, LimitError);
    pyo3::import_exception!(wavesplat.errors, CancelledError);
}

/// Python exception for an error.
#[expect(clippy::needless_pass_by_value, reason = "used as map_err(to_py)")]
pub fn to_py(error: Error) -> PyErr {
    let message = error.to_string();
    match error.kind() {
        ErrorKind::Argument => exceptions::ArgumentError::new_err(message),
        ErrorKind::Limit => exceptions::LimitError::new_err(message),
        ErrorKind::Cancelled => exceptions::CancelledError::new_err(message),
    }
}
