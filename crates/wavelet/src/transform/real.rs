//! Number types of transforms: `f32` and `f64`.

use std::ops::{Add, Mul, Sub};

mod sealed {
    pub trait SealedReal {}
    impl SealedReal for f32 {}
    impl SealedReal for f64 {}
}

/// Number type of a transform: `f32` or `f64`. Weights are computed in f64 and rounded once.
pub trait Real:
    sealed::SealedReal
    + Copy
    + Default
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + 'static
{
    /// The nearest number of this type.
    fn from_f64(x: f64) -> Self;
}

impl Real for f32 {
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x as Self
    }
}

impl Real for f64 {
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x
    }
}
