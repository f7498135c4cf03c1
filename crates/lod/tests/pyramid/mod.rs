//! Pyramids of wavelet levels, and helpers of both tests.

use std::sync::Arc;

use wavesplat_core::{ColorNode, Decoder as _, LevelGrid, OpacityNode, TransferFunction};
use wavesplat_lod::LevelHistogram;
use wavesplat_wavelet::{CoarseLevel, CoefficientDecoder, Keep, Norm, WaveletFamily, WaveletVolume};

/// Families whose low-pass coefficients are samples.
pub const LIFTED: [WaveletFamily; 3] = [WaveletFamily::Haar, WaveletFamily::Cdf53, WaveletFamily::Cdf97];

pub fn volume(family: WaveletFamily, size: [usize; 3], sample: impl Fn([usize; 3]) -> f32) -> Arc<WaveletVolume> {
    let [nx, ny, nz] = size;
    let samples: Vec<f32> = (0..nx * ny * nz).map(|i| sample([i % nx, i / nx % ny, i / (nx * ny)])).collect();
    Arc::new(WaveletVolume::new(family, size, samples, None, Norm::L2, Keep::Amplitude(0.0)).unwrap())
}

pub fn level_of(volume: &Arc<WaveletVolume>, level: usize) -> (LevelGrid, CoarseLevel) {
    let coarse = CoarseLevel::new(CoefficientDecoder::new(volume.clone(), level, &[]).unwrap()).unwrap();
    (coarse.grid(), coarse)
}

pub fn all(decoder: &CoarseLevel) -> Vec<f32> {
    let size = decoder.size();
    let mut all = vec![f32::NAN; size.iter().product()];
    decoder.decode([0; 3], size, &mut all);
    all
}

/// Transfer function with opacity through the nodes, blue below 30, red from 40 on.
pub fn curve(nodes: &[(f64, f64)]) -> TransferFunction {
    let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
    let color = vec![ColorNode { value: 30.0, rgb: [0.0, 0.0, 1.0] }, ColorNode { value: 40.0, rgb: [1.0, 0.0, 0.0] }];
    TransferFunction::new(opacity, color, None).unwrap()
}

/// Memory budget that is enough for any volume here.
pub const BUDGET: usize = 1 << 30;

pub fn histogram_of(volume: &Arc<WaveletVolume>, level: usize) -> LevelHistogram {
    let (grid, coarse) = level_of(volume, level);
    let fine = CoefficientDecoder::new(volume.clone(), 0, &[]).unwrap();
    LevelHistogram::new(&fine, &coarse, &grid, [1.0; 3], fine.range().map(f64::from), BUDGET)
}

/// Interpolated samples of a level at the positions of the finest samples, and at `per_sample - 1` positions between
/// neighbours.
pub fn coarse_values(volume: &Arc<WaveletVolume>, level: usize, per_sample: usize) -> Vec<f64> {
    let (grid, coarse) = level_of(volume, level);
    let samples = all(&coarse);
    let [nx, ny, _] = grid.size;
    let [fx, fy, fz] = volume.plan().size().map(|n| (n - 1) * per_sample + 1);
    (0..fx * fy * fz)
        .map(|i| {
            let index = [i % fx, i / fx % fy, i / (fx * fy)].map(|i| i as f64 / per_sample as f64);
            let place = grid.level_from_finest(index);
            let below: [usize; 3] = [0, 1, 2].map(|a| (place[a] as usize).min(grid.size[a] - 2));
            let share = |corner: usize| -> f64 {
                let t = |a: usize| place[a] - below[a] as f64;
                (0..3).map(|a| if corner >> a & 1 == 1 { t(a) } else { 1.0 - t(a) }).product()
            };
            let at = |c: usize| samples[((below[2] + c / 4) * ny + below[1] + c / 2 % 2) * nx + below[0] + c % 2];
            (0..8).map(|corner| share(corner) * f64::from(at(corner))).sum()
        })
        .collect()
}
