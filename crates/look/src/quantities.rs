//! Quantities of calculated maps, as `NIfTI` and DICOM name them.

/// Apparent diffusion coefficient.
pub const ADC: &str = "apparent diffusion coefficient";
/// Diffusivities of a tensor: mean, axial, radial.
pub const DIFFUSIVITY: &str = "diffusivity";
/// Fractional anisotropy.
pub const ANISOTROPY: &str = "fractional anisotropy";
/// Longitudinal relaxation time.
pub const T1: &str = "relaxation time T1";
/// Transverse relaxation time.
pub const T2: &str = "relaxation time T2";
/// Transverse relaxation time with the field's unevenness.
pub const T2_STAR: &str = "relaxation time T2*";
/// Blood flow of perfusion.
pub const BLOOD_FLOW: &str = "blood flow";
/// Blood volume of perfusion.
pub const BLOOD_VOLUME: &str = "blood volume";
/// Times of perfusion: to the peak, of transit.
pub const PERFUSION: &str = "time of perfusion";
/// Standard scores.
pub const Z_STATISTIC: &str = "z statistic";
/// Statistics of Student's test.
pub const T_STATISTIC: &str = "t statistic";
/// Statistics of Fisher's test.
pub const F_STATISTIC: &str = "F statistic";
/// p-values, of which low ones matter.
pub const P_VALUE: &str = "p-value";

/// All of them.
pub const ALL: [&str; 13] = [
    ADC,
    DIFFUSIVITY,
    ANISOTROPY,
    T1,
    T2,
    T2_STAR,
    BLOOD_FLOW,
    BLOOD_VOLUME,
    PERFUSION,
    Z_STATISTIC,
    T_STATISTIC,
    F_STATISTIC,
    P_VALUE,
];
