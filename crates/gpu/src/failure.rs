//! Failures of drawing a frame on a GPU: the CPU draws it then, and the report has the reason.

use std::fmt;

/// Reason why a GPU did not draw a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// There is no adapter, or none that matches the choice.
    NoAdapter(String),
    /// A device was opened and did not draw what the CPU draws.
    Untrusted(String),
    /// The CPU draws this frame: the GPU does not support the scene, or is not used at this time.
    DrawnByCpu(String),
    /// The frame needs more memory than the budget or the device's limits allow.
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
            | Self::DrawnByCpu(why)
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
