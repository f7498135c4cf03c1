//! The error of a file that is not read.

use thiserror::Error;

/// A file that is not read: the reason, with its mend, and the file's name.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{reason}: {name}")]
pub struct FileError {
    /// The reason, and how to mend it.
    pub reason: String,
    /// The file's name, as it was given.
    pub name: String,
}
