//! Samples: the numbers of a volume in their own type, and their range.
//!
//! An 8-bit scan is never copied to float as a whole.

/// A sample type that the renderer reads.
pub trait Sample: Copy + Send + Sync + PartialOrd + 'static {
    /// The sample as f64, exact for every type here.
    fn to_f64(self) -> f64;
    /// The sample as f32, exact for 8- and 16-bit types.
    fn to_f32(self) -> f32;
}

macro_rules! sample {
    ($($t:ty),*) => {$(
        impl Sample for $t {
            #[allow(clippy::cast_lossless, clippy::unnecessary_cast, reason = "one macro for all sample types")]
            #[inline(always)]
            fn to_f64(self) -> f64 { self as f64 }
            #[allow(clippy::cast_lossless, clippy::unnecessary_cast, reason = "one macro for all sample types")]
            #[inline(always)]
            fn to_f32(self) -> f32 { self as f32 }
        }
    )*};
}
sample!(u8, i8, u16, i16, u32, i32, f32, f64);

/// The sample buffer in its own type, `x` fastest.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs, reason = "each variant is named after its sample type")]
pub enum Samples<'a> {
    U8(&'a [u8]),
    I8(&'a [i8]),
    U16(&'a [u16]),
    I16(&'a [i16]),
    U32(&'a [u32]),
    I32(&'a [i32]),
    F32(&'a [f32]),
    F64(&'a [f64]),
}

/// Runs `$body` with `$s` bound to the typed slice.
#[macro_export]
macro_rules! with_samples {
    ($samples:expr, $s:ident => $body:expr) => {
        match $samples {
            $crate::Samples::U8($s) => $body,
            $crate::Samples::I8($s) => $body,
            $crate::Samples::U16($s) => $body,
            $crate::Samples::I16($s) => $body,
            $crate::Samples::U32($s) => $body,
            $crate::Samples::I32($s) => $body,
            $crate::Samples::F32($s) => $body,
            $crate::Samples::F64($s) => $body,
        }
    };
}

impl Samples<'_> {
    /// Number of samples.
    pub fn len(&self) -> usize {
        with_samples!(self, s => s.len())
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether the type is narrow enough to be used in f32 as it is.
    pub fn is_narrow(&self) -> bool {
        matches!(self, Self::U8(_) | Self::I8(_) | Self::U16(_) | Self::I16(_))
    }

    /// The sample at a linear index.
    pub fn get(&self, index: usize) -> f64 {
        with_samples!(self, s => s[index].to_f64())
    }

    /// All samples, each the nearest f32.
    pub fn to_f32(&self) -> Vec<f32> {
        with_samples!(self, s => s.iter().map(|sample| sample.to_f32()).collect())
    }
}

/// Samples in memory that the owner can change, `x` fastest.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "each variant is named after its sample type")]
pub enum SampleBuffer {
    U8(Vec<u8>),
    I8(Vec<i8>),
    U16(Vec<u16>),
    I16(Vec<i16>),
    U32(Vec<u32>),
    I32(Vec<i32>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

impl SampleBuffer {
    /// The samples, borrowed.
    pub fn samples(&self) -> Samples<'_> {
        match self {
            Self::U8(s) => Samples::U8(s),
            Self::I8(s) => Samples::I8(s),
            Self::U16(s) => Samples::U16(s),
            Self::I16(s) => Samples::I16(s),
            Self::U32(s) => Samples::U32(s),
            Self::I32(s) => Samples::I32(s),
            Self::F32(s) => Samples::F32(s),
            Self::F64(s) => Samples::F64(s),
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.samples().len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes of a sample.
    pub fn sample_bytes(&self) -> usize {
        fn size_of_one<T>(_: &[T]) -> usize {
            size_of::<T>()
        }
        with_samples!(self.samples(), s => size_of_one(s))
    }
}

/// Range of the finite samples, and number of the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Smallest finite sample.
    pub min: f64,
    /// Largest finite sample.
    pub max: f64,
    /// Number of samples that are NaN or infinite; they are drawn as empty.
    pub n_nonfinite: usize,
}

impl Statistics {
    /// Reads every sample once.
    pub fn of(samples: &Samples) -> Self {
        fn scan<T: Sample>(samples: &[T]) -> Statistics {
            let mut stats = Statistics { min: f64::INFINITY, max: f64::NEG_INFINITY, n_nonfinite: 0 };
            for sample in samples.iter().map(|s| s.to_f64()) {
                if sample.is_finite() {
                    stats.min = if sample < stats.min { sample } else { stats.min };
                    stats.max = if sample > stats.max { sample } else { stats.max };
                } else {
                    stats.n_nonfinite += 1;
                }
            }
            stats
        }
        /// Integers have no NaN; comparing them in their own type lets the compiler use whole vectors.
        fn scan_integers<T: Sample + Ord>(samples: &[T]) -> Statistics {
            let Some(&first) = samples.first() else {
                return Statistics { min: f64::INFINITY, max: f64::NEG_INFINITY, n_nonfinite: 0 };
            };
            let (lo, hi) = samples.iter().fold((first, first), |(lo, hi), &s| (lo.min(s), hi.max(s)));
            Statistics { min: lo.to_f64(), max: hi.to_f64(), n_nonfinite: 0 }
        }
        match samples {
            Samples::U8(s) => scan_integers(s),
            Samples::I8(s) => scan_integers(s),
            Samples::U16(s) => scan_integers(s),
            Samples::I16(s) => scan_integers(s),
            Samples::U32(s) => scan_integers(s),
            Samples::I32(s) => scan_integers(s),
            Samples::F32(s) => scan(s),
            Samples::F64(s) => scan(s),
        }
    }
}
