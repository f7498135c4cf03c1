//! Decoding boxes from the kept coefficients against synthesis of the whole.

use std::sync::Arc;

use wavesplat_core::Decoder as _;
use wavesplat_wavelet::{CoefficientDecoder, Keep, Norm, WaveletFamily, WaveletVolume, synthesise, synthesise_to};

/// A ball with a texture, and nothing around it.
fn samples([nx, ny, nz]: [usize; 3]) -> Vec<f32> {
    let at = |i: usize| [i % nx, i / nx % ny, i / (nx * ny)];
    let middle = [nx, ny, nz].map(|n| 0.4 * n as f32);
    let radius = 0.3 * nx.min(ny).min(nz) as f32;
    (0..nx * ny * nz)
        .map(|i| {
            let p = at(i);
            let distance = (0..3).map(|a| (p[a] as f32 - middle[a]).powi(2)).sum::<f32>().sqrt();
            if distance < radius { 100.0 + ((i * 7919) % 97) as f32 } else { 3.0 }
        })
        .collect()
}

#[test]
fn boxes_of_every_level_are_those_of_synthesis() {
    for size in [[45, 70, 37], [64, 33, 16], [3, 50, 1], [1, 1, 9]] {
        let samples = samples(size);
        for (name, family) in WaveletFamily::NAMES {
            let volume = Arc::new(
                WaveletVolume::new(family, size, samples.clone(), None, Norm::L2, Keep::Amplitude(8.0)).unwrap(),
            );
            let coefficients = volume.coefficients(&[]);
            for level in 0..=volume.plan().n_levels() {
                let want = synthesise_to(volume.plan(), &coefficients, level);
                let decoder = CoefficientDecoder::new(volume.clone(), level, &[]).unwrap();
                let size @ [nx, ny, nz] = decoder.size();
                assert_eq!(size, volume.plan().low_size(level));
                let check = |got: f32, [x, y, z]: [usize; 3]| {
                    let want = want[(z * ny + y) * nx + x] + volume.offset();
                    assert!(
                        (got - want).abs() < 1e-3,
                        "{name} {size:?} level {level} at {x} {y} {z}: {got} for {want}"
                    );
                };
                let all = decoder.all();
                for (i, got) in all.iter().enumerate() {
                    check(*got, [i % nx, i / nx % ny, i / (nx * ny)]);
                }
                // A box somewhere has the same bits.
                let lo = size.map(|n| n / 3);
                let hi = size.map(|n| (n / 3 + 35).min(n));
                let [bx, by, bz] = [0, 1, 2].map(|a| hi[a] - lo[a]);
                let mut part = vec![f32::NAN; bx * by * bz];
                decoder.decode(lo, hi, &mut part);
                for (i, got) in part.iter().enumerate() {
                    let [x, y, z] = [lo[0] + i % bx, lo[1] + i / bx % by, lo[2] + i / (bx * by)];
                    assert_eq!(
                        got.to_bits(),
                        all[(z * ny + y) * nx + x].to_bits(),
                        "{name} {size:?} level {level} of {nz}"
                    );
                }
            }
        }
    }
}

#[test]
fn weighted_levels_are_those_of_synthesis_and_sum_to_the_whole() {
    let size = [40, 37, 50];
    let samples = samples(size);
    let volume =
        WaveletVolume::new(WaveletFamily::Cdf97, size, samples.clone(), Some(4), Norm::L2, Keep::Fraction(0.1))
            .unwrap();
    let volume = Arc::new(volume);
    let mut sum = vec![0.0; samples.len()];
    for k in 0..=4 {
        let mut weights = [0.0; 5];
        weights[k] = 1.0;
        let band = CoefficientDecoder::new(volume.clone(), 0, &weights).unwrap().all();
        let mut want = volume.coefficients(&weights);
        synthesise(volume.plan(), &mut want);
        assert!(band.iter().zip(&want).all(|(a, b)| (a - b).abs() < 1e-3), "level {k}");
        sum.iter_mut().zip(&band).for_each(|(sum, b)| *sum += b);
    }
    let whole = CoefficientDecoder::new(volume, 0, &[]).unwrap().all();
    assert!(sum.iter().zip(&whole).all(|(a, b)| (a - b).abs() < 2e-3));
}
