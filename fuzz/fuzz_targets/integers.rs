//! Fuzz target: the integer transform is lossless for numbers of any size, taken as samples or as coefficients.

#![no_main]

use wavesplat_wavelet::{TransformPlan, WaveletFamily, analyse_integers, synthesise_integers};

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let Some(([x, y, z, levels], numbers)) = data.split_first_chunk() else { return };
    let size = [x, y, z].map(|n| usize::from(n % 20));
    let Ok(plan) = TransformPlan::new(WaveletFamily::Cdf53, size, Some(usize::from(*levels))) else { return };
    let mut numbers: Vec<i32> = numbers.as_chunks().0.iter().map(|word| i32::from_le_bytes(*word)).collect();
    numbers.resize(plan.n_samples(), 0);
    let before = numbers.clone();
    synthesise_integers(&plan, &mut numbers);
    analyse_integers(&plan, &mut numbers);
    assert!(numbers == before);
    analyse_integers(&plan, &mut numbers);
    synthesise_integers(&plan, &mut numbers);
    assert!(numbers == before);
});
