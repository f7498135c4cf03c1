//! What a volume of retained coefficients promises: it keeps what is asked for, and little else.

use std::sync::Arc;

use wavesplat_wavelet::{Decoder, Family, Keep, Norm, Parts, Plan, WaveletVolume, analyse, to_amplitudes};

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
    for (name, family) in Family::NAMES {
        for size in [[1, 1, 1], [9, 1, 17], [23, 8, 11], [33, 20, 9]] {
            let n: usize = size.iter().product();
            let samples: Vec<f32> = (0..n).map(|i| ((i * 7919) % 251) as f32).collect();
            let volume = WaveletVolume::new(family, size, samples.clone(), None, Norm::L2, Keep::Amplitude(0.0));
            let back = volume.to_samples(&[]);
            assert!(back.iter().zip(&samples).all(|(a, b)| (a - b).abs() < 2.5e-3), "{name} {size:?}");
        }
    }
}

#[test]
fn the_printed_share_of_the_ripples_is_kept() {
    let n = 32;
    let keep = |family| {
        let volume = WaveletVolume::new(family, [n; 3], ripples(n), None, Norm::L2, Keep::Amplitude(12.0));
        100.0 * volume.n_kept() as f64 / (n * n * n) as f64
    };
    // Printed in the method's paper: 19.95 %.
    assert!((19.9..=20.2).contains(&keep(Family::Cdf53)));
    assert!(keep(Family::Cdf97) <= 18.8);
}

#[test]
fn what_is_kept_are_the_large_amplitudes_in_their_places() {
    let (n, threshold) = (21, 9.0);
    let samples = ripples(n);
    let volume =
        WaveletVolume::new(Family::Cdf97, [n; 3], samples.clone(), Some(2), Norm::Peak, Keep::Amplitude(threshold));
    let plan = Plan::new(Family::Cdf97, [n; 3], Some(2));
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
    let volume = WaveletVolume::new(Family::Cdf53, [n; 3], ripples(n), Some(3), Norm::L2, Keep::Fraction(0.3));
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
    for (name, family) in Family::NAMES {
        for fraction in [0.02, 0.2] {
            let volume = WaveletVolume::new(family, [n; 3], samples.clone(), None, Norm::L2, Keep::Fraction(fraction));
            let got = volume.n_kept() as f64 / samples.len() as f64;
            assert!((got - fraction).abs() < 0.002, "{name}: {got} for {fraction}");
        }
        let mut n_before = 0;
        for wanted in [30.0, 50.0] {
            let volume = WaveletVolume::new(family, [n; 3], samples.clone(), None, Norm::L2, Keep::Psnr(wanted));
            let (lo, hi) = samples.iter().fold((f32::MAX, f32::MIN), |(lo, hi), s| (lo.min(*s), hi.max(*s)));
            let got = psnr_db(&volume.to_samples(&[]), &samples, f64::from(hi - lo));
            assert!(got >= wanted - 1e-6 && got < wanted + 1.0, "{name}: {got} dB for {wanted}");
            assert!(volume.n_kept() > n_before);
            n_before = volume.n_kept();
        }
    }
    let nothing = WaveletVolume::new(Family::Haar, [n; 3], samples.clone(), None, Norm::L2, Keep::Fraction(0.0));
    assert_eq!(nothing.n_kept(), 0);
    assert!(nothing.to_samples(&[]).iter().all(|s| *s == 0.0));
}

/// Kept coefficients cluster; where they do not, a block of one costs its bits.
#[test]
fn memory_is_proportional_to_what_is_kept() {
    let n = 96;
    let samples = ripples(n);
    for fraction in [0.02, 0.1, 1.0] {
        let volume =
            WaveletVolume::new(Family::Cdf97, [n; 3], samples.clone(), None, Norm::L2, Keep::Fraction(fraction));
        let kept_bytes = 4 * volume.n_kept();
        assert!(volume.n_bytes() <= 3 * kept_bytes, "{fraction}: {} for {kept_bytes}", volume.n_bytes());
    }
}

/// A volume and what is stored of it.
fn parts_of(family: Family, size: [usize; 3]) -> (WaveletVolume, Parts) {
    let samples: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 251) as f32).collect();
    let volume = WaveletVolume::new(family, size, samples.clone(), None, Norm::L2, Keep::Fraction(0.2));
    let parts = volume.to_parts();
    (volume, parts)
}

#[test]
fn parts_make_the_same_volume() {
    for (name, family) in Family::NAMES {
        for size in [[1, 1, 1], [2, 9, 40], [23, 8, 11]] {
            let (volume, parts) = parts_of(family, size);
            assert_eq!(parts.values.len(), volume.n_kept());
            assert_eq!(parts.masks.len(), 8 * parts.has_block.iter().map(|has| usize::from(*has)).sum::<usize>());
            let again = WaveletVolume::from_parts(parts.clone()).unwrap();
            assert_eq!(again.to_parts(), parts, "{name} {size:?}");
            assert_eq!(again.coefficients(&[]), volume.coefficients(&[]), "{name} {size:?}");
            assert_eq!(again.n_kept_by_level(), volume.n_kept_by_level(), "{name} {size:?}");
            // The range, once it is known.
            let found = Decoder::new(Arc::new(again.clone()), 0, &[]).range();
            let known = WaveletVolume::from_parts(Parts { range: Some([-1.0, 7.5]), ..parts }).unwrap();
            assert_eq!(known.to_parts().range, Some([-1.0, 7.5]));
            assert_eq!(Decoder::new(Arc::new(known), 0, &[]).range(), [-1.0, 7.5]);
            assert!(found != [-1.0, 7.5] && found[0] <= found[1], "{found:?}");
        }
    }
}

#[test]
fn parts_that_do_not_fit_together_are_refused() {
    let (_, parts) = parts_of(Family::Cdf97, [23, 8, 11]);
    let check = |change: fn(&mut Parts), problem: &str| {
        let mut parts = parts.clone();
        change(&mut parts);
        let refused = WaveletVolume::from_parts(parts).map(|_| ()).unwrap_err();
        assert!(refused.contains(problem), "{refused}");
    };
    check(|p| p.size = [23, 0, 11], "the size is not that of a volume");
    check(|p| p.size = [1 << 22; 3], "the size is not that of a volume");
    // Sizes that fit into a number, but into no memory.
    check(|p| p.size = [1 << 62, 1, 1], "too few blocks");
    check(|p| p.size = [1, 1 << 40, 1], "too few blocks");
    check(|p| p.size = [1 << 21; 3], "too few blocks");
    check(|p| p.size = [21, 8, 11], "bit lies outside");
    check(|p| p.n_levels += 1, "more levels");
    check(|p| p.n_levels = usize::MAX, "more levels");
    check(|p| p.values[3] = f32::NAN, "not a finite number");
    check(|p| p.range = Some([2.0, 1.0]), "no range");
    check(|p| p.range = Some([f32::NAN, 1.0]), "no range");
    check(|p| p.range = Some([0.0, f32::INFINITY]), "no range");
    check(|p| p.has_block.truncate(3), "too few blocks");
    check(|p| p.has_block.push(0), "left over");
    check(|p| p.masks.truncate(8), "too few words");
    check(|p| p.masks.push(0), "left over");
    check(|p| p.masks[0] = u64::MAX, "bit lies outside");
    check(|p| p.values.truncate(3), "too few coefficients");
    check(|p| p.values.push(1.0), "left over");
}
