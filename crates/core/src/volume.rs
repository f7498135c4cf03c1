//! Volume: scalar samples (voxels) on a grid, borrowed in their own type.
//!
//! Narrow types are used as they are, and so are wide types (32- and 64-bit) with values of usual magnitude; where an
//! f32 pipeline would overflow, or lose small differences on a large offset, samples are mapped to the density
//! `d = (sample − offset) · scale` when they are read.

use glam::DAffine3;

use crate::error::{Error, Result};
use crate::grid::Grid;
use crate::samples::{Samples, Statistics};

/// Samples and their grid. Always consistent.
#[derive(Clone, Debug)]
pub struct Volume<'a> {
    samples: Samples<'a>,
    grid: Grid,
}

impl<'a> Volume<'a> {
    /// Checks shape, affine and samples; `size` is `[nx, ny, nz]`, `name` appears in messages only.
    pub fn new(name: &str, samples: Samples<'a>, size: [usize; 3], world_from_index: DAffine3) -> Result<Self> {
        let statistics = Statistics::of(&samples);
        Self::with_statistics(name, samples, size, world_from_index, statistics)
    }

    /// Makes a volume like [`Volume::new`], with statistics that were computed before for the same samples.
    pub fn with_statistics(
        name: &str,
        samples: Samples<'a>,
        size: [usize; 3],
        world_from_index: DAffine3,
        statistics: Statistics,
    ) -> Result<Self> {
        let expected = size.iter().try_fold(1_usize, |n, &m| n.checked_mul(m)).unwrap_or(usize::MAX);
        if samples.len() != expected {
            let shape_zyx = [size[2], size[1], size[0]];
            return Err(Error::SampleCount { name: name.to_owned(), shape_zyx, expected, actual: samples.len() });
        }
        let grid = Grid::new(name, size, world_from_index, statistics, samples.is_narrow())?;
        Ok(Self { samples, grid })
    }

    /// The samples, `x` fastest.
    pub fn samples(&self) -> &Samples<'a> {
        &self.samples
    }

    /// Grid of the samples.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;

    fn volume(samples: &[f32], affine: DAffine3) -> Result<Volume<'_>> {
        Volume::new("test", Samples::F32(samples), [2, 2, 2], affine)
    }

    #[test]
    fn statistics_leave_out_what_is_not_finite() {
        let s = [f32::NAN, 1.0, -2.0, f32::INFINITY, f32::NEG_INFINITY, 0.0, 0.5, 0.25];
        let v = volume(&s, DAffine3::IDENTITY).unwrap();
        assert_eq!(v.grid().statistics(), Statistics { min: -2.0, max: 1.0, n_nonfinite: 3 });
    }

    #[test]
    fn bad_volumes_are_refused() {
        let s = [0.0_f32; 8];
        assert!(matches!(volume(&s[..7], DAffine3::IDENTITY), Err(Error::SampleCount { expected: 8, actual: 7, .. })));
        assert!(matches!(volume(&[f32::NAN; 8], DAffine3::IDENTITY), Err(Error::NoFiniteSample { .. })));
        let flat = Volume::new("flat", Samples::F32(&s), [8, 1, 1], DAffine3::IDENTITY);
        assert!(matches!(flat, Err(Error::ThinVolume { shape_zyx: [1, 1, 8], .. })));
        for scale in [DVec3::new(1.0, 0.0, 1.0), DVec3::new(f64::NAN, 1.0, 1.0)] {
            assert!(matches!(volume(&s, DAffine3::from_scale(scale)), Err(Error::DegenerateAffine { .. })));
        }
        let plane = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::X + DVec3::Y));
        assert!(matches!(volume(&s, plane), Err(Error::DegenerateAffine { .. })));
    }

    #[test]
    fn wide_types_are_mapped_only_where_f32_would_lose_them() {
        let map = |s: [f64; 2]| {
            let s = [s[0], s[1], s[0], s[0], s[0], s[0], s[0], s[0]];
            let volume = Volume::new("wide", Samples::F64(&s), [2, 2, 2], DAffine3::IDENTITY).unwrap();
            volume.grid().density_from_sample()
        };
        assert_eq!(map([-1000.0, 3000.0]), (0.0, 1.0));
        assert_eq!(map([1000.0, 1200.0]), (0.0, 1.0));
        assert_eq!(map([1e9, 1e9 + 4.0]), (1e9, 1.0));
        assert_eq!(map([0.0, 3.0 * 2.0_f64.powi(100)]), (0.0, 2.0_f64.powi(-101)));
        assert_eq!(map([7.0, 7.0]), (0.0, 1.0));
        assert_eq!(map([0.0, 0.0]), (0.0, 1.0));
        for extreme in [[0.0, f64::MAX], [-f64::MAX, f64::MAX], [0.0, f64::MIN_POSITIVE], [1.0, 1.0 + f64::EPSILON]] {
            let (offset, scale) = map(extreme);
            let densities = extreme.map(|s| ((s - offset) * scale) as f32);
            assert!(densities.iter().all(|d| d.abs() < 1e3) && densities[0] < densities[1], "{extreme:?}");
        }
        let narrow = [0_u16; 8];
        let v = Volume::new("narrow", Samples::U16(&narrow), [2, 2, 2], DAffine3::IDENTITY).unwrap();
        assert_eq!(v.grid().density_from_sample(), (0.0, 1.0));
    }

    /// Samples survive the map to densities and back, to the bit.
    #[test]
    fn what_f32_holds_is_kept_exactly() {
        for (centre, extent) in [(0.0, 1.0), (100.0, 20.0), (1e7, 5e3), (-3e-4, 1e-8), (1e30, 1e28), (0.0, 1e-30)] {
            let samples: [f32; 8] = std::array::from_fn(|i| (centre + extent * (i as f64 * 0.734).sin()) as f32);
            let v = volume(&samples, DAffine3::IDENTITY).unwrap();
            let (offset, scale) = v.grid().density_from_sample();
            for sample in samples {
                let density = ((f64::from(sample) - offset) * scale) as f32;
                assert_eq!((f64::from(density) / scale + offset) as f32, sample, "{centre} {extent}");
            }
        }
    }
}
