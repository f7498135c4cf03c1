//! Volumes of retained coefficients: they keep the wanted coefficients, and take little more memory.

use std::sync::Arc;

use wavesplat_core::Samples;
use wavesplat_wavelet::{
    CoefficientArrays, CoefficientDecoder, Keep, Norm, TransformPlan, WaveletError, WaveletFamily, WaveletVolume,
    analyse, to_amplitudes,
};

/// The signal of Marschner and Lobb on −1..1, scaled to 0..255.
fn ripples(n: usize) -> Vec<f32> {
    use std::f64::consts::PI;
    let at = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
    let sample = |i: usize| {
        let (x, y, z) = (at(i % n), at(i / n % n), at(i / (n * n)));
        let rho = (2.0 * PI * 6.0 * (PI * x.hypot(y) / 2.0).cos()).cos();
        255.0 * (1.0 - (PI * z / 2.0).sin() + 0.25 * (1.0 + rho)) / 2.5
    };
    (0..n * n * n).map(|i| sample(i) as f32).collect()
}

fn psnr_db(a: &[f32], b: &[f32], range: f64) -> f64 {
    let square: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / a.len() as f64;
    10.0 * (range * range / square).log10()
}

#[test]
fn with_nothing_dropped_the_samples_come_back() {
    for (name, family) in WaveletFamily::NAMES {
        for size in [[1, 1, 1], [9, 1, 17], [23, 8, 11], [33, 20, 9]] {
            let n: usize = size.iter().product();
            let samples: Vec<f32> = (0..n).map(|i| ((i * 7919) % 251) as f32).collect();
            let volume =
                WaveletVolume::new(family, size, samples.clone(), None, Norm::L2, Keep::Amplitude(0.0)).unwrap();
            let back = volume.to_samples(&[]);
            assert!(back.iter().zip(&samples).all(|(a, b)| (a - b).abs() < 2.5e-3), "{name} {size:?}");
        }
    }
}

#[test]
fn the_printed_share_of_the_ripples_is_kept() {
    let n = 32;
    let keep = |family| {
        let volume = WaveletVolume::new(family, [n; 3], ripples(n), None, Norm::L2, Keep::Amplitude(12.0)).unwrap();
        100.0 * volume.n_kept() as f64 / (n * n * n) as f64
    };
    // Printed in the method's paper: 19.95 %.
    assert!((19.9..=20.2).contains(&keep(WaveletFamily::Cdf53)));
    assert!(keep(WaveletFamily::Cdf97) <= 18.8);
}

#[test]
fn what_is_kept_are_the_large_amplitudes_in_their_places() {
    let (n, threshold) = (21, 9.0);
    let samples = ripples(n);
    let volume = WaveletVolume::new(
        WaveletFamily::Cdf97,
        [n; 3],
        samples.clone(),
        Some(2),
        Norm::Peak,
        Keep::Amplitude(threshold),
    )
    .unwrap();
    let plan = TransformPlan::new(WaveletFamily::Cdf97, [n; 3], Some(2)).unwrap();
    let mut want = samples;
    analyse(&plan, &mut want);
    let mut amplitudes = want.clone();
    to_amplitudes(&plan, Norm::Peak, &mut amplitudes);
    for (want, amplitude) in want.iter_mut().zip(&amplitudes) {
        *want = if f64::from(amplitude.abs()) < threshold { 0.0 } else { *want };
    }
    assert_eq!(volume.coefficients(&[]), want);
    assert_eq!(volume.n_kept(), want.iter().filter(|c| **c != 0.0).count());
    assert_eq!(volume.n_kept_by_level().iter().sum::<usize>(), volume.n_kept());
}

#[test]
fn bands_sum_to_the_whole() {
    let n = 24;
    let volume =
        WaveletVolume::new(WaveletFamily::Cdf53, [n; 3], ripples(n), Some(3), Norm::L2, Keep::Fraction(0.3)).unwrap();
    let all = volume.to_samples(&[]);
    let mut sum = vec![0.0; all.len()];
    for level in 0..4 {
        let weights: Vec<f32> = (0..4).map(|l| if l == level { 1.0 } else { 0.0 }).collect();
        let band = volume.to_samples(&weights);
        assert!(band.iter().any(|b| b.abs() > 1.0), "level {level} holds something");
        sum.iter_mut().zip(band).for_each(|(sum, band)| *sum += band);
    }
    assert!(sum.iter().zip(&all).all(|(a, b)| (a - b).abs() < 1e-3));
}

#[test]
fn a_share_and_a_psnr_are_kept() {
    let n = 40;
    let samples = ripples(n);
    for (name, family) in WaveletFamily::NAMES {
        for fraction in [0.02, 0.2] {
            let volume =
                WaveletVolume::new(family, [n; 3], samples.clone(), None, Norm::L2, Keep::Fraction(fraction)).unwrap();
            let got = volume.n_kept() as f64 / samples.len() as f64;
            assert!((got - fraction).abs() < 0.002, "{name}: {got} for {fraction}");
        }
        let mut n_before = 0;
        for wanted in [30.0, 50.0] {
            let volume =
                WaveletVolume::new(family, [n; 3], samples.clone(), None, Norm::L2, Keep::Psnr(wanted)).unwrap();
            let (lo, hi) = samples.iter().fold((f32::MAX, f32::MIN), |(lo, hi), s| (lo.min(*s), hi.max(*s)));
            let got = psnr_db(&volume.to_samples(&[]), &samples, f64::from(hi - lo));
            assert!(got >= wanted - 1e-6 && got < wanted + 1.0, "{name}: {got} dB for {wanted}");
            assert!(volume.n_kept() > n_before);
            n_before = volume.n_kept();
        }
    }
    let nothing =
        WaveletVolume::new(WaveletFamily::Haar, [n; 3], samples.clone(), None, Norm::L2, Keep::Fraction(0.0)).unwrap();
    assert_eq!(nothing.n_kept(), 0);
    assert!(nothing.to_samples(&[]).iter().all(|s| *s == 0.0));
}

/// Kept coefficients cluster; where they do not, a block of a single one still costs its bits.
#[test]
fn memory_is_proportional_to_what_is_kept() {
    let n = 96;
    let samples = ripples(n);
    for fraction in [0.02, 0.1, 1.0] {
        let volume =
            WaveletVolume::new(WaveletFamily::Cdf97, [n; 3], samples.clone(), None, Norm::L2, Keep::Fraction(fraction))
                .unwrap();
        let kept_bytes = 4 * volume.n_kept();
        assert!(volume.n_bytes() <= 3 * kept_bytes, "{fraction}: {} for {kept_bytes}", volume.n_bytes());
    }
}

/// A volume and its arrays.
fn arrays_of(family: WaveletFamily, size: [usize; 3]) -> (WaveletVolume, CoefficientArrays) {
    let samples: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 251) as f32).collect();
    let volume = WaveletVolume::new(family, size, samples.clone(), None, Norm::L2, Keep::Fraction(0.2)).unwrap();
    let arrays = volume.to_arrays();
    (volume, arrays)
}

#[test]
fn arrays_make_the_same_volume() {
    for (name, family) in WaveletFamily::NAMES {
        for size in [[1, 1, 1], [2, 9, 40], [23, 8, 11]] {
            let (volume, arrays) = arrays_of(family, size);
            assert_eq!(arrays.values.len(), volume.n_kept());
            assert_eq!(arrays.masks.len(), 8 * arrays.has_block.iter().map(|has| usize::from(*has)).sum::<usize>());
            let again = WaveletVolume::from_arrays(arrays.clone()).unwrap();
            assert_eq!(again.to_arrays(), arrays, "{name} {size:?}");
            assert_eq!(again.coefficients(&[]), volume.coefficients(&[]), "{name} {size:?}");
            assert_eq!(again.n_kept_by_level(), volume.n_kept_by_level(), "{name} {size:?}");
            // A known range is taken from the arrays, not computed.
            let found = CoefficientDecoder::new(Arc::new(again.clone()), 0, &[]).unwrap().range();
            let known = WaveletVolume::from_arrays(CoefficientArrays { range: Some([-1.0, 7.5]), ..arrays }).unwrap();
            assert_eq!(known.to_arrays().range, Some([-1.0, 7.5]));
            assert_eq!(CoefficientDecoder::new(Arc::new(known), 0, &[]).unwrap().range(), [-1.0, 7.5]);
            assert!(found != [-1.0, 7.5] && found[0] <= found[1], "{found:?}");
        }
    }
}

#[test]
fn arrays_that_do_not_fit_together_are_refused() {
    let (_, arrays) = arrays_of(WaveletFamily::Cdf97, [23, 8, 11]);
    let check = |change: fn(&mut CoefficientArrays), problem: &str| {
        let mut arrays = arrays.clone();
        change(&mut arrays);
        let refused = WaveletVolume::from_arrays(arrays).map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains(problem), "{refused}");
    };
    check(|a| a.size = [23, 0, 11], "size [23, 0, 11] (x, y, z) is not the size of a volume");
    check(|a| a.size = [1 << 22; 3], "is not the size of a volume");
    // Sizes that fit into a usize, but into no memory.
    check(
        |a| a.size = [1 << 62, 1, 1],
        "has_block has 33 entries, size [4611686018427387904, 1, 1] (x, y, z) needs at least",
    );
    check(|a| a.size = [1, 1 << 40, 1], "needs at least 2147483648");
    check(|a| a.size = [1 << 21; 3], "needs at least");
    check(|a| a.size = [21, 8, 11], "has a mask bit outside subband");
    check(|a| a.n_levels += 1, "levels are more than the");
    check(|a| a.n_levels = usize::MAX, "levels are more than the 5 that cdf97 has at size [23, 8, 11]");
    check(|a| a.values[3] = f32::NAN, "value 3 is NaN, which is not a finite number");
    check(|a| a.offset = f32::INFINITY, "the offset is inf, which is not a finite number");
    check(|a| a.range = Some([2.0, 1.0]), "from 2 to 1 is no range");
    check(|a| a.range = Some([f32::NAN, 1.0]), "no range");
    check(|a| a.range = Some([0.0, f32::INFINITY]), "no range");
    check(|a| a.has_block.truncate(3), "has_block has 3 entries, size [23, 8, 11] (x, y, z) needs at least 4");
    check(|a| a.has_block.truncate(30), "has_block has 30 entries, the others need 33");
    check(|a| a.has_block.push(0), "has_block has");
    check(|a| a.masks.truncate(8), "masks has 8 entries, the others need");
    check(|a| a.masks.push(0), "masks has");
    check(|a| a.masks[0] = u64::MAX, "has a mask bit outside subband");
    check(|a| a.values.truncate(3), "values has 3 entries, the others need");
    check(|a| a.values.push(1.0), "values has");
}

#[test]
fn samples_of_another_size_are_refused() {
    let volume =
        |size, samples| WaveletVolume::new(WaveletFamily::Haar, size, samples, None, Norm::L2, Keep::Psnr(30.0));
    let refused = |size, n| volume(size, vec![0.0; n]).map(|_| ()).unwrap_err();
    assert_eq!(refused([3, 4, 5], 59), WaveletError::SampleCount { size: [3, 4, 5], expected: 60, actual: 59 });
    assert_eq!(refused([3, 0, 5], 0), WaveletError::VolumeSize { size: [3, 0, 5] });
    assert_eq!(refused([1 << 40; 3], 1), WaveletError::VolumeSize { size: [1 << 40; 3] });
    assert_eq!(
        TransformPlan::new(WaveletFamily::Haar, [0; 3], None).map(|_| ()),
        Err(WaveletError::VolumeSize { size: [0; 3] })
    );
    let volume = Arc::new(volume([8, 8, 8], vec![1.0; 512]).unwrap());
    let decoder = CoefficientDecoder::new(volume, 4, &[]).map(|_| ());
    assert_eq!(decoder, Err(WaveletError::NoSuchLevel { level: 4, coarsest: 3 }));
}

/// A field of range about 2, in f64.
fn waves([nx, ny, nz]: [usize; 3]) -> Vec<f64> {
    let wave = |i: usize| {
        let [x, y, z] = [i % nx, i / nx % ny, i / (nx * ny)].map(|k| k as f64);
        (0.4 * x).sin() * (0.3 * y).cos() + 0.2 * (0.9 * z).sin() + 0.03 * ((i * 7919) % 251) as f64 / 251.0
    };
    (0..nx * ny * nz).map(wave).collect()
}

fn psnr_of_f64(got: &[f32], want: &[f64]) -> f64 {
    let (lo, hi) = want.iter().fold((f64::MAX, f64::MIN), |(lo, hi), s| (lo.min(*s), hi.max(*s)));
    let square: f64 = got.iter().zip(want).map(|(a, b)| (f64::from(*a) - b).powi(2)).sum();
    10.0 * ((hi - lo).powi(2) * want.len() as f64 / square).log10()
}

/// Samples far from 0 reach a PSNR near the limit of f32, like others; a PSNR beyond it is refused.
#[test]
fn an_offset_costs_no_psnr() {
    let size = [23, 18, 15];
    for (name, family) in WaveletFamily::NAMES {
        for (offset, wanted) in [(0.0, 60.0), (-1e3, 90.0), (1e4, 65.0), (1e5, 45.0), (3e6, 20.0)] {
            let samples: Vec<f64> = waves(size).iter().map(|s| s + offset).collect();
            let keep = Keep::Psnr(wanted);
            let volume = WaveletVolume::new(family, size, Samples::F64(&samples), None, Norm::L2, keep).unwrap();
            let volume = Arc::new(volume);
            for got in [volume.to_samples(&[]), CoefficientDecoder::new(volume.clone(), 0, &[]).unwrap().all()] {
                let got = psnr_of_f64(&got, &samples);
                assert!(got >= wanted - 1e-3, "{name}, {offset}: {got} dB for {wanted}");
                let told = volume.psnr_db().unwrap();
                assert!((got - told).abs() < 0.1, "{name}, {offset}: {got} dB, told {told}");
            }
            let too_much = WaveletVolume::new(family, size, Samples::F64(&samples), None, Norm::L2, Keep::Psnr(190.0));
            assert!(matches!(too_much, Err(WaveletError::PsnrOutOfReach { psnr_db: 190.0, .. })), "{name}, {offset}");
        }
    }
}

/// Every level of a constant far from 0 is that constant, and details alone are 0.
#[test]
fn levels_have_the_offset_and_details_do_not() {
    for (name, family) in WaveletFamily::NAMES {
        let size = [19, 12, 9];
        let samples = vec![70_000_i32; size.iter().product()];
        let volume =
            WaveletVolume::new(family, size, Samples::I32(&samples), None, Norm::L2, Keep::Amplitude(1.0)).unwrap();
        let volume = Arc::new(volume);
        assert_eq!((volume.offset(), volume.n_kept()), (70_000.0, 0), "{name}");
        let coarsest = volume.plan().n_levels();
        for level in 0..=coarsest {
            let decoder = CoefficientDecoder::new(volume.clone(), level, &[]).unwrap();
            assert!(decoder.all().iter().all(|s| *s == 70_000.0), "{name}, level {level}");
            assert_eq!(decoder.range(), [70_000.0; 2], "{name}, level {level}");
        }
        let mut weights = vec![1.0; coarsest + 1];
        weights[coarsest] = 0.5;
        assert!(volume.to_samples(&weights).iter().all(|s| *s == 35_000.0), "{name}");
        weights[coarsest] = 0.0;
        let details = CoefficientDecoder::new(volume.clone(), 0, &weights).unwrap().all();
        assert!(details.iter().all(|s| *s == 0.0), "{name}");
        let again = WaveletVolume::from_arrays(volume.to_arrays()).unwrap();
        assert_eq!(again.to_samples(&[]), volume.to_samples(&[]), "{name}");
    }
}
