//! Errors, split by who can mend them: the caller, the file, the machine.

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Class of an [`Error`], by who can mend it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The caller passed something that cannot be drawn.
    Argument,
    /// The request exceeds the machine's memory or a limit.
    Limit,
    /// The caller asked to stop.
    Cancelled,
}

/// Error of this crate; its message says what happened, where, and how to mend it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each variant is its documentation")]
pub enum Error {
    #[error(
        "volume {name:?}: shape {shape_zyx:?} needs {expected} samples, the buffer has {actual}; \
         check the axis order (z, y, x) or pass {expected} samples"
    )]
    SampleCount { name: String, shape_zyx: [usize; 3], expected: usize, actual: usize },
    #[error(
        "volume {name:?}: shape {shape_zyx:?} (z, y, x) has fewer than 2 samples along an axis, so it fills no space; \
         pass a stack of at least 2 slices of at least 2 x 2 samples"
    )]
    ThinVolume { name: String, shape_zyx: [usize; 3] },
    #[error(
        "volume {name:?}: none of its {n_samples} samples is finite, so there is nothing to draw; check the file or its scaling"
    )]
    NoFiniteSample { name: String, n_samples: usize },
    #[error(
        "volume {name:?}: world_from_index {matrix:?} (rows) {problem}; \
         pass an invertible affine with finite numbers and a last row of 0 0 0 1, or a positive spacing"
    )]
    DegenerateAffine { name: String, matrix: Box<[[f64; 4]; 3]>, problem: &'static str },
    #[error("{what} is {value}, which is not {allowed}; {mend}")]
    OutOfRange { what: String, value: String, allowed: &'static str, mend: &'static str },
    #[error("transfer function: the {curve} curve has no node; pass at least one (value, ...) node")]
    EmptyCurve { curve: &'static str },
    #[error(
        "transfer function: {curve} node {index} has value {value}, below node {before_index} at {before}; \
         sort the nodes by value (equal values make a step)"
    )]
    UnsortedCurve { curve: &'static str, index: usize, value: f64, before_index: usize, before: f64 },
    #[error(
        "camera: position and focal point are both {position:?}; move one of them, the view direction is their difference"
    )]
    CameraOnFocalPoint { position: [f64; 3] },
    #[error(
        "camera: view_up {view_up:?} is parallel to the view direction {direction:?}; pass an up vector that is not"
    )]
    UpParallelToView { view_up: [f64; 3], direction: [f64; 3] },
    #[error("camera: {problem}; pass parallel_scale (orthographic) or view_angle (perspective), one of the two")]
    Projection { problem: &'static str },
    #[error(
        "camera 0 is {first} and camera {number} {other}; give key frames of one kind: \
         a small view_angle from far away looks nearly orthographic"
    )]
    MixedLenses { first: &'static str, number: usize, other: &'static str },
    #[error(
        "crop: the box from {lo:?} to {hi:?} holds nothing of the volume, which reaches from {volume_lo:?} to {volume_hi:?}; swap or move the corners"
    )]
    EmptyCrop { lo: [f64; 3], hi: [f64; 3], volume_lo: [f64; 3], volume_hi: [f64; 3] },
    #[error("unknown {what} {name:?}; use one of: {known}")]
    UnknownName { what: &'static str, name: String, known: String },
    #[error("{what} would need {needed_mib} MiB, more than the limit of {limit_mib} MiB; {mend}")]
    TooLarge { what: &'static str, needed_mib: u64, limit_mib: u64, mend: &'static str },
    #[error("rendering was cancelled by the progress callback")]
    Cancelled,
}

impl Error {
    /// Class of the error.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::TooLarge { .. } => ErrorKind::Limit,
            Self::Cancelled => ErrorKind::Cancelled,
            _ => ErrorKind::Argument,
        }
    }

    /// An [`Error::OutOfRange`] for a number.
    pub fn out_of_range(
        what: impl Into<String>,
        value: impl std::fmt::Display,
        allowed: &'static str,
        mend: &'static str,
    ) -> Self {
        Self::OutOfRange { what: what.into(), value: format!("{value}"), allowed, mend }
    }
}
