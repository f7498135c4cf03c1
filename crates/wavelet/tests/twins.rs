//! Transforms by many threads have the same bits as by one.

use wavesplat_compute::parallel::with_threads;
use wavesplat_wavelet::{TransformPlan, WaveletFamily, analyse, analyse_integers, synthesise, synthesise_integers};

#[test]
fn the_number_of_threads_changes_no_bit() {
    let size = [70, 41, 23];
    let samples: Vec<f32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 1009) as f32).collect();
    for (name, family) in WaveletFamily::NAMES {
        let plan = TransformPlan::new(family, size, None).unwrap();
        let run = |n_threads| {
            with_threads(Some(n_threads), || {
                let mut coefficients = samples.clone();
                analyse(&plan, &mut coefficients);
                let mut back = coefficients.clone();
                synthesise(&plan, &mut back);
                coefficients.into_iter().chain(back).map(f32::to_bits).collect::<Vec<_>>()
            })
        };
        assert!(run(1) == run(7), "{name}");
    }
}

#[test]
fn the_number_of_threads_changes_no_integer() {
    let size = [33, 18, 50];
    let plan = TransformPlan::new(WaveletFamily::Cdf53, size, None).unwrap();
    let samples: Vec<i32> = (0..size.iter().product()).map(|i: usize| ((i * 7919) % 4099) as i32 - 2000).collect();
    let run = |n_threads| {
        with_threads(Some(n_threads), || {
            let mut data = samples.clone();
            analyse_integers(&plan, &mut data);
            let coefficients = data.clone();
            synthesise_integers(&plan, &mut data);
            assert!(data == samples);
            coefficients
        })
    };
    assert!(run(1) == run(7));
}
