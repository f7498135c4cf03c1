//! Time of analysis, synthesis and decoding of a cube in f32, and the error of the round trip. Samples are decoded in
//! boxes, from 3 % of the coefficients.
//!
//! `cargo run --release -p wavesplat-wavelet --example timing -- [size] [family ...]`

use std::sync::Arc;
use std::time::Instant;

use wavesplat_wavelet::{
    CoefficientDecoder, Keep, Norm, TransformPlan, WaveletFamily, WaveletVolume, analyse, synthesise,
};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let n: usize = arguments.first().map_or(256, |n| n.parse().expect("the size is a number"));
    let wanted = |name: &str| arguments.len() < 2 || arguments[1..].iter().any(|a| a == name);
    // A smooth ball and a pattern without structure, 0..255.
    let samples: Vec<f32> = (0..n * n * n)
        .map(|i| {
            let r2: f32 = [i % n, i / n % n, i / n / n].iter().map(|&x| (x as f32 / n as f32 - 0.5).powi(2)).sum();
            200.0 * (-8.0 * r2).exp() + ((i * 7919) % 55) as f32
        })
        .collect();
    for (name, family) in WaveletFamily::NAMES.into_iter().filter(|(name, _)| wanted(name)) {
        let start = Instant::now();
        let plan = TransformPlan::new(family, [n; 3], None).unwrap();
        let planned = start.elapsed();
        let mut best = [f64::INFINITY; 2];
        let mut data = samples.clone();
        for _ in 0..3 {
            data.copy_from_slice(&samples);
            let start = Instant::now();
            analyse(&plan, &mut data);
            let between = Instant::now();
            synthesise(&plan, &mut data);
            best[0] = best[0].min((between - start).as_secs_f64());
            best[1] = best[1].min(between.elapsed().as_secs_f64());
        }
        let kept = WaveletVolume::new(family, [n; 3], samples.clone(), None, Norm::L2, Keep::Fraction(0.03)).unwrap();
        let decoder = CoefficientDecoder::new(Arc::new(kept), 0, &[]).unwrap();
        let decoding = (0..3).map(|_| {
            let start = Instant::now();
            std::hint::black_box(decoder.all());
            start.elapsed().as_secs_f64()
        });
        let decoding = 1e3 * decoding.fold(f64::INFINITY, f64::min);
        let error = data.iter().zip(&samples).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let [analysis, synthesis] = best.map(|seconds| 1e3 * seconds);
        println!(
            "{name:9} {n}^3: plan {:.1} ms, analysis {analysis:.0} ms, synthesis {synthesis:.0} ms, decoding {decoding:.0} ms, error {error:.1e} of 255",
            1e3 * planned.as_secs_f64()
        );
    }
}
