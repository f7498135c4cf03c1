//! The widest vectors that this machine has, for loops that the compiler vectorises.
//!
//! Kernels are plain loops over rows of fixed length, compiled once per level below. Every level gives the same bits:
//! lanes never mix, no operation is fused, and the order of operations is the source's. The level is chosen once per
//! picture and passed as a value. This is the only module with `unsafe`.
#![allow(unsafe_code, reason = "functions compiled for a level may only be called where the machine has it")]

/// What the compiler may use. A value is proof that the machine has it: they are only made by [`Level::all`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level(Width);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Width {
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// All levels that this machine has, the widest last.
    pub fn all() -> Vec<Self> {
        #[allow(unused_mut, reason = "only x86-64 has more than one")]
        let mut levels = vec![Self(Width::Baseline)];
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx2") {
                levels.push(Self(Width::Avx2));
            }
            if has_avx512() {
                levels.push(Self(Width::Avx512));
            }
        }
        levels
    }

    /// The widest level that this machine has; `WAVESPLAT_SIMD` = `baseline`, `avx2` or `avx512` asks for less.
    pub fn best() -> Self {
        let wanted = std::env::var("WAVESPLAT_SIMD").unwrap_or_default();
        let levels = Self::all();
        let named = levels.iter().find(|level| level.name() == wanted);
        *named.or(levels.last()).unwrap_or(&Self(Width::Baseline))
    }

    /// For reports.
    pub fn name(self) -> &'static str {
        match self.0 {
            Width::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Width::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Width::Avx512 => "avx512",
        }
    }

    /// Runs a kernel with the vectors of the level. The closure, and what it calls, must be `#[inline(always)]`,
    /// else they are compiled for the baseline.
    #[inline]
    pub fn run<T>(self, kernel: impl FnOnce() -> T) -> T {
        match self.0 {
            Width::Baseline => kernel(),
            // SAFETY: `self` exists, so `all` has found the instructions on this machine.
            #[cfg(target_arch = "x86_64")]
            Width::Avx2 => unsafe { run_avx2(kernel) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Width::Avx512 => unsafe { run_avx512(kernel) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<T>(kernel: impl FnOnce() -> T) -> T {
    kernel()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2")]
fn run_avx512<T>(kernel: impl FnOnce() -> T) -> T {
    kernel()
}
