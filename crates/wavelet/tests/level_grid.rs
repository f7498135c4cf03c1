//! Levels as volumes of their own: positions and values of their samples.

use std::sync::Arc;

use wavesplat_core::{Decoder as _, LevelGrid};
use wavesplat_wavelet::{
    CoarseLevel, CoefficientDecoder, Keep, Norm, TransformPlan, WaveletError, WaveletFamily, WaveletVolume,
};

/// Families whose low-pass coefficients are samples.
const LIFTED: [WaveletFamily; 3] = [WaveletFamily::Haar, WaveletFamily::Cdf53, WaveletFamily::Cdf97];

fn volume(family: WaveletFamily, size: [usize; 3], sample: impl Fn([usize; 3]) -> f32) -> Arc<WaveletVolume> {
    let [nx, ny, nz] = size;
    let samples: Vec<f32> = (0..nx * ny * nz).map(|i| sample([i % nx, i / nx % ny, i / (nx * ny)])).collect();
    Arc::new(WaveletVolume::new(family, size, samples, None, Norm::L2, Keep::Amplitude(0.0)).unwrap())
}

fn level_of(volume: &Arc<WaveletVolume>, level: usize) -> (LevelGrid, CoarseLevel) {
    let coarse = CoarseLevel::new(CoefficientDecoder::new(volume.clone(), level, &[]).unwrap()).unwrap();
    (coarse.grid(), coarse)
}

fn all(decoder: &CoarseLevel) -> Vec<f32> {
    let size = decoder.size();
    let mut all = vec![f32::NAN; size.iter().product()];
    decoder.decode([0; 3], size, &mut all);
    all
}

/// Checks origin, spacing and size along an axis.
fn check_axis(family: WaveletFamily, n: usize, level: usize, want: (f64, f64, usize)) {
    let grid = TransformPlan::new(family, [n, 64, 64], None).unwrap().level_grid(level).unwrap();
    assert_eq!((grid.origin[0], grid.spacing[0], grid.size[0]), want, "{family:?} of {n} at level {level}");
}

#[test]
fn low_samples_lie_on_every_second_one_or_between_two() {
    for family in [WaveletFamily::Cdf53, WaveletFamily::Cdf97] {
        check_axis(family, 17, 0, (0.0, 1.0, 17));
        // Nine coefficients of 17 samples reach the end; eight of 16 end at 14, and one more sample reaches it.
        check_axis(family, 17, 1, (0.0, 2.0, 9));
        check_axis(family, 16, 1, (0.0, 2.0, 9));
        check_axis(family, 16, 3, (0.0, 8.0, 3));
        // An axis that is split up before the others.
        check_axis(family, 2, 5, (0.0, 2.0, 2));
    }
    check_axis(WaveletFamily::Haar, 16, 0, (0.0, 1.0, 16));
    // Eight coefficients from 0.5 to 14.5, and one sample before and one after.
    check_axis(WaveletFamily::Haar, 16, 1, (-1.5, 2.0, 10));
    check_axis(WaveletFamily::Haar, 17, 1, (-1.5, 2.0, 10));
    // Four coefficients from 1.5 to 13.5.
    check_axis(WaveletFamily::Haar, 16, 2, (-2.5, 4.0, 6));
    check_axis(WaveletFamily::Haar, 2, 5, (-1.5, 2.0, 3));
}

#[test]
fn every_level_reaches_both_ends() {
    for family in LIFTED {
        for size in [[64, 17, 2], [5, 6, 7], [31, 32, 33]] {
            let plan = TransformPlan::new(family, size, None).unwrap();
            for level in 0..=plan.n_levels() {
                let grid = plan.level_grid(level).unwrap();
                for a in 0..3 {
                    let last = grid.origin[a] + grid.spacing[a] * (grid.size[a] - 1) as f64;
                    let end = (size[a] - 1) as f64;
                    assert!(grid.size[a] >= 2, "{family:?} {size:?} {level}: a volume needs two samples");
                    assert!(grid.origin[a] <= 0.0 && last >= end, "{family:?} {size:?} {level}");
                    assert!(last < end + grid.spacing[a], "{family:?} {size:?} {level}: no more than is needed");
                    let mut position = [0.0; 3];
                    position[a] = last;
                    assert_eq!(grid.level_from_finest(position)[a], (grid.size[a] - 1) as f64);
                }
            }
        }
    }
}

#[test]
fn spline_coefficients_are_no_samples() {
    for family in [WaveletFamily::Spline4, WaveletFamily::Bspline2, WaveletFamily::Bspline3, WaveletFamily::Bspline4] {
        let plan = TransformPlan::new(family, [20, 21, 22], None).unwrap();
        assert_eq!(plan.level_grid(0).map(|grid| (grid.origin, grid.size)), Some(([0.0; 3], [20, 21, 22])));
        assert_eq!(plan.level_grid(1), None);
        let volume = volume(family, [20, 21, 22], |[x, ..]| x as f32);
        let refused = CoarseLevel::new(CoefficientDecoder::new(volume, 1, &[]).unwrap()).map(|_| ()).unwrap_err();
        assert_eq!(refused, WaveletError::NoSampleGrid { family, level: 1 });
        assert!(refused.to_string().starts_with(&format!("level 1 of family {:?} has no sample grid", family.name())));
    }
}

#[test]
fn a_ramp_has_its_values_where_the_low_samples_lie() {
    let slope = [1.0, -2.0, 0.5];
    for family in LIFTED {
        let ramp = volume(family, [64, 48, 50], |p| (0..3).map(|a| slope[a] * p[a] as f32).sum());
        for level in 0..3 {
            let (grid, coarse) = level_of(&ramp, level);
            let samples = all(&coarse);
            let [nx, ny, _] = grid.size;
            for (i, got) in samples.iter().enumerate() {
                let index = [i % nx, i / nx % ny, i / (nx * ny)];
                // The mirrored ends bend the ramp there.
                if (0..3).all(|a| (4..grid.size[a] - 4).contains(&index[a])) {
                    let want: f64 = (0..3)
                        .map(|a| f64::from(slope[a]) * (grid.origin[a] + grid.spacing[a] * index[a] as f64))
                        .sum();
                    assert!((f64::from(*got) - want).abs() < 1e-3, "{family:?} level {level} {index:?}: {got} {want}");
                }
            }
        }
    }
}

#[test]
fn the_ends_are_repeated_in_every_box() {
    let sample = |[x, y, z]: [usize; 3]| ((x * 31 + y * 17 + z * 7) % 23) as f32;
    for family in LIFTED {
        let volume = volume(family, [18, 15, 8], sample);
        for level in 1..3 {
            let (grid, coarse) = level_of(&volume, level);
            let low = CoefficientDecoder::new(volume.clone(), level, &[]).unwrap();
            let (low_size, low) = (low.size(), low.all());
            let n_before = usize::from(family == WaveletFamily::Haar);
            let want = |index: [usize; 3]| {
                let [x, y, z] = [0, 1, 2].map(|a| index[a].saturating_sub(n_before).min(low_size[a] - 1));
                low[(z * low_size[1] + y) * low_size[0] + x]
            };
            assert!((0..3).any(|a| grid.size[a] > low_size[a]), "something is repeated");
            for lo in [[0; 3], [1, 0, 1], grid.size.map(|n| n - 1), grid.size.map(|n| n - 2)] {
                for hi in [grid.size, [0, 1, 2].map(|a| (lo[a] + 1).min(grid.size[a]))] {
                    let n = [0, 1, 2].map(|a| hi[a] - lo[a]);
                    let mut part = vec![f32::NAN; n.iter().product()];
                    coarse.decode(lo, hi, &mut part);
                    for (i, got) in part.iter().enumerate() {
                        let index = [lo[0] + i % n[0], lo[1] + i / n[0] % n[1], lo[2] + i / (n[0] * n[1])];
                        assert_eq!(got.to_bits(), want(index).to_bits(), "{family:?} {level} {lo:?} {hi:?} {index:?}");
                    }
                }
            }
        }
    }
}
