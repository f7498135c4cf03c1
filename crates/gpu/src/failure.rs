//! Why a frame was not drawn on a GPU: the CPU draws it then, and the report says so.

use std::fmt;

/// Why a GPU did not draw a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// No adapter is there, or none that was asked for.
    NoAdapter(String),
    /// A device was opened and did not draw what the CPU draws.
    Untrusted(String),
    /// What was asked for is drawn by the CPU alone.
    NotOnGpu(String),
    /// It needs more memory than it may take, or than there is.
    Memory(String),
    /// The driver refused memory.
    Allocation(String),
    /// The device is gone.
    Lost(String),
    /// The device or its driver refused something.
    Refused(String),
    /// The callback asked to stop.
    Cancelled,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter(why)
            | Self::Untrusted(why)
            | Self::NotOnGpu(why)
            | Self::Memory(why)
            | Self::Allocation(why) => f.write_str(why),
            Self::Lost(why) => write!(f, "the device was lost: {why}"),
            Self::Refused(why) => write!(f, "the device refused: {why}"),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}

impl std::error::Error for Failure {}

/// A result of work on a GPU.
pub type GpuResult<T> = Result<T, Failure>;
